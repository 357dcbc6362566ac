"""The equilibria at a point as a JSON document, docs/poses.schema.json, and back.

Guarantee: reading what was written gives equal `Poses`. A number is written as text with all digits
right, or with a bound of what it differs from them, and as the middle and radius of its enclosure,
both exact; a document whose texts and enclosures disagree is refused, like one with a key or a
value that does not belong there, with the place of the first fault.
"""

from __future__ import annotations

import json
from fractions import Fraction
from typing import Any

from ptmcad.answer.poses import MAX_DIGITS, Pose, Poses, Spring, TorsionSpring
from ptmcad.answer.regionmap import Status
from ptmcad.question.counts import POSE_COLUMNS
from ptmcad.question.slice import check_names
from ptmcad.show.document.exactnumbers import merged
from ptmcad.show.document.slicedocument import MODEL, UNITS, VERSIONS
from ptmcad.text.codec import (
    COUNT,
    NATURAL,
    POSITIVE,
    RATIONAL,
    TEXT,
    TRUTH,
    Codec,
    Key,
    Known,
    choice,
    derived,
    either,
    line,
    listed,
    named,
    optional,
    record,
    record_of,
    unless_default,
)
from ptmcad.text.enclosure import Enclosure, exact_text
from ptmcad.text.node import Node, opened

FORMAT = "ptmcad-poses/1"
MAX_TEXT = 2_000_000
MAX_NAME = 40
MAX_REMARK = 300
MAX_ANGLE = 600
"""Characters of the name of a sum of angles."""
_PLAIN = r"[0-9]+(\.[0-9]+)?(e-?[0-9]+)?"
_DECIMAL = TEXT.narrowed(pattern=f"^-?{_PLAIN}( ± {_PLAIN})?$")


def write_poses(poses: Poses) -> str:
    """The poses as JSON text; the same text for equal poses."""
    data = {"format": FORMAT, **poses_codec(poses.digits).write(poses)}
    return json.dumps(data, indent=2, ensure_ascii=False) + "\n"


def read_poses(text: str) -> Poses:
    """The poses in a JSON document.

    Raises
    ------
    ValueError
        With the place of the first fault.
    """
    document = opened(text, FORMAT, MAX_TEXT, "ptmcad solve")
    digits = (place := document.entry("digits")).natural()
    if not 1 <= digits <= MAX_DIGITS:
        raise place.fault(f"is not between 1 and {MAX_DIGITS}")
    return poses_codec(digits).read(document)


def _made(**entries: Any) -> Poses:
    """Refuse poses that have not the parameters of their model, or not as many unknowns or torsion
    springs.
    """
    found = Poses(**entries)
    check_names(found.model, found.parameters)
    angles, reals = len(found.model.angles), len(found.model.reals)
    wanted = {"angles": angles, "degrees": angles, "cosines_sines": 2 * angles, "reals": reals}
    if any(pose.torsion for pose in found.equilibria):  # documents of earlier versions have none
        wanted["torsion"] = 0 if found.model.whole is None else len(found.model.whole.torsion)
    for n, pose in enumerate(found.equilibria):
        for key, length in wanted.items():
            if (number := len(getattr(pose, key))) != length:
                raise ValueError(f"equilibria[{n}].{key} has {number} entries, not {length}")
    return found


def poses_codec(digits: int) -> Codec[Poses]:
    """The codec of poses with so many digits."""
    exact: Codec[Fraction] = Codec(exact_text, Node.fraction, RATIONAL.schema)
    number: Codec[Enclosure] = record(
        lambda center, radius: Enclosure(center - radius, center + radius),
        text=derived(lambda x: x.text(digits), _DECIMAL),
        center=exact,
        radius=exact._replace(read=Node.size),
    )
    known: Known = {Fraction: exact, Enclosure: number}
    bare, free = (_pose(known, free) for free in (False, True))
    pose: Codec[Pose] = either(
        next(iter(POSE_COLUMNS)), lambda pose: pose.has_predicates, free, bare
    )
    return record_of(
        Poses,
        {**known, Pose: pose._replace(schema=merged(bare.schema, free.schema))},
        _made,
        model=MODEL,
        status=choice(Status).narrowed(enum=["exact", "certified", "on the variety", "undecided"]),
        digits=NATURAL.narrowed(minimum=1, maximum=MAX_DIGITS),
        remark=line(MAX_REMARK),
        parameters=named(exact, _name),
        units=UNITS,
        # those of 0.1.0 do not say who wrote them
        versions=VERSIONS._replace(default=None, always=True),
        **unless_default(Poses, "undecided"),
    )


def _pose(known: Known, free: bool) -> Codec[Pose]:
    """The codec of a pose; with free lengths predicates hold or not, and each spring has its own."""
    name = line(MAX_NAME)
    free_length = known[Fraction] if free else None
    springs: Known = {
        Spring: record_of(Spring, known, name=name, start=name, end=name, free_length=free_length),
        TorsionSpring: record_of(TorsionSpring, known, name=line(MAX_ANGLE)),
    }
    known = {**known, **springs}
    return record_of(
        Pose,
        known,
        index=COUNT,
        multiplicity=POSITIVE,
        further=None,
        nodes=named(listed(known[Enclosure], 2), _name),
        **unless_default(Pose, "reals", "torsion", known=known),
        **{
            name: Key(optional(TRUTH), entry_of="further")
            for name in (POSE_COLUMNS if free else ())
        },
    )


def _name(node: Node, key: str) -> str:
    if not key.isidentifier() or len(key) > MAX_NAME:
        raise node.fault("is not a name")
    return key
