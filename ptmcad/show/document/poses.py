"""The equilibria at a point as a JSON document, and back.

Guarantee: reading what was written gives equal `Poses`. A number is written as text with all digits right, or with a
bound of what it differs from them, and as the middle and radius of its enclosure, both exact; a document whose texts
and enclosures disagree is refused, like one with a key or a value that does not belong there, with the place of the
first fault.

The schema is published as docs/poses.schema.json; its version is part of `FORMAT`.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from fractions import Fraction
from typing import TypeVar

from ptmcad.answer.poses import MAX_DIGITS, Pose, Poses, Spring, TorsionSpring
from ptmcad.answer.regionmap import Status
from ptmcad.mechanism import mechanism_in
from ptmcad.question.slice import check_names
from ptmcad.show.document import codec
from ptmcad.show.document.codec import NATURAL, TEXT, TRUTH, Codec, line, listed, optional, record
from ptmcad.show.document.model import MODEL, either
from ptmcad.show.document.node import Node, opened
from ptmcad.text.enclosure import Enclosure, exact_text

FORMAT = "ptmcad-poses/1"
MAX_TEXT = 2_000_000
MAX_NAME = 40
MAX_REMARK = 300
MAX_ANGLE = 600
"""Characters of the name of a sum of angles."""
MAX_UNIT = 20

T = TypeVar("T")


_EXACT: Codec[Fraction] = Codec(exact_text, Node.fraction)


def write_poses(poses: Poses) -> str:
    """The poses as JSON text; the same text for equal poses."""
    return json.dumps(_poses(poses.digits).write(poses), indent=2, ensure_ascii=False) + "\n"


def read_poses(text: str) -> Poses:
    """The poses in a JSON document.

    Raises
    ------
    ValueError
        With the place of the first fault.
    """
    document = opened(text, FORMAT, MAX_TEXT, "ptmcad solve")
    place = document.mapping().get("digits")
    digits = MAX_DIGITS if place is None else place.natural()  # where it is missing, the record says so
    if place is not None and not 1 <= digits <= MAX_DIGITS:
        raise place.fault(f"is not between 1 and {MAX_DIGITS}")
    found = _poses(digits).read(document)
    _check_lengths(found, document)
    return found


def _check_lengths(found: Poses, document: Node) -> None:
    """Refuse poses that have not the parameters of their model, or not as many unknowns or torsion springs."""
    check_names(found.model, found.parameters)
    angles, reals = len(found.model.angles), len(found.model.reals)
    wanted = {"angles": angles, "degrees": angles, "cosines_sines": 2 * angles, "reals": reals}
    if any(pose.torsion for pose in found.equilibria):  # documents of earlier versions have none
        mechanism = mechanism_in(found.model)
        wanted["torsion"] = 0 if mechanism is None else len(mechanism.torsion)
    for place in document.mapping()["equilibria"].each(lambda node: node):
        entries = place.mapping()
        for key, length in wanted.items():
            if key in entries:
                entries[key].each(lambda node: node, length)
            elif length:
                raise place.fault(f"lacks the key '{key}'")


def _poses(digits: int) -> Codec[Poses]:
    """The codec of poses with so many digits."""
    bare, free = (_pose(digits, free) for free in (False, True))
    return record(
        lambda format, mechanism, system, **rest: Poses(model=either(mechanism, system), **rest),
        format=codec.Key(TEXT, lambda _: FORMAT),
        status=codec.choice(Status),
        remark=line(MAX_REMARK),
        **MODEL,
        parameters=_by_name(_EXACT),
        digits=NATURAL,
        bits=NATURAL,
        units=codec.Key(codec.named(line(MAX_UNIT)), default={}),
        undecided=codec.Key(NATURAL, default=0),
        equilibria=listed(
            Codec(
                lambda pose: (free if pose.may_be_admissible else bare).write(pose),
                lambda node: (free if "admissible" in node.mapping() else bare).read(node),
            )
        ),
    )


def _pose(digits: int, free: bool) -> Codec[Pose]:
    """The codec of a pose; with free lengths it is admissible or not, and each spring tells its own."""
    number: Codec[Enclosure] = Codec(
        lambda x: {"text": x.text(digits), "center": exact_text(x.center), "radius": exact_text(x.radius)},
        lambda node: _number(node, digits),
    )
    pair = listed(number, 2)
    spring = record(
        Spring,
        name=line(MAX_NAME),
        start=line(MAX_NAME),
        end=line(MAX_NAME),
        stiffness=_EXACT,
        length=number,
        force=number,
        **({"free_length": _EXACT} if free else {}),
    )
    torsion = record(
        TorsionSpring,
        name=line(MAX_ANGLE),
        stiffness=_EXACT,
        deflection=number,
        degrees=number,
        moment=number,
    )
    return record(
        Pose,
        stable=optional(TRUTH),
        **({"admissible": optional(TRUTH)} if free else {}),
        index=codec.COUNT,
        multiplicity=NATURAL,
        flat=TRUTH,
        angles=listed(number),
        degrees=listed(number),
        cosines_sines=listed(number),
        reals=codec.Key(listed(number), default=()),
        nodes=_by_name(pair),
        springs=listed(spring),
        torsion=codec.Key(listed(torsion), default=()),
        energy=optional(number),
        eigenvalues=listed(number),
    )


def _by_name(values: Codec[T]) -> Codec[Mapping[str, T]]:
    """Several of the same by names of points or parameters."""
    return Codec(
        codec.named(values).write,
        lambda node: {_name(place, key): values.read(place) for key, place in node.mapping().items()},
    )


def _name(node: Node, key: str) -> str:
    if not key.isidentifier() or len(key) > MAX_NAME:
        raise node.fault("is not a name")
    return key


def _number(node: Node, digits: int) -> Enclosure:
    entry = node.record("text", "center", "radius")
    center, radius = entry["center"].fraction(), entry["radius"].size()
    enclosure = Enclosure(center - radius, center + radius)
    if enclosure.text(digits) != entry["text"].text():
        raise node.fault(f"is not its enclosure rounded to {digits} digits")
    return enclosure
