"""The key ``design`` of a record: what is made as large as possible, over which parameters, and
under what conditions.

Guarantee: whatever is wrong is a `ConfigError` with file, line and key.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import partial
from pathlib import Path
from typing import Any

from ptmcad.errors import ConfigError, ExpressionError, Place
from ptmcad.model.reading import NUMBER, two
from ptmcad.question.config.designed import Aim, Design
from ptmcad.question.config.objects import plain, tree_of
from ptmcad.question.config.problemrecord import Record
from ptmcad.question.config.resolution import axis_of, described_record, note_values
from ptmcad.question.config.scalars import (
    AXIS_NAME,
    Window,
    check_axis_name,
    number_of,
    number_text,
    window_of,
    with_ranges,
)
from ptmcad.question.config.typed import ranges_of
from ptmcad.question.inequalities import Inequality, condition_of, named
from ptmcad.question.shipped import A_DESIGN, FIRST, SECOND, RecordSource, record_tree
from ptmcad.question.slice import Axis
from ptmcad.text.codec import Codec, part, reading, record
from ptmcad.text.entry import Scalar, Tree, Written, from_python
from ptmcad.text.node import Node
from ptmcad.text.syntax import did_you_mean

MAX_PARAMETERS = 8


def _whole(entry: Node) -> int:
    found = number_of(number_text(entry), "the number of stable poses")
    if found.denominator != 1 or not 0 <= found <= 1000:
        raise entry.fault(f"the number of stable poses is a whole one, not {found}")
    return int(found)


def _flag(entry: Node) -> bool:
    if not isinstance(entry.value, Scalar) or entry.value.text.lower() not in ("true", "false"):
        raise entry.fault("write true or false")
    return entry.value.text.lower() == "true"


def _over(entry: Node) -> dict[str, Node]:
    what, like = "design parameters with their bounds", f"{{{FIRST}: [1/2, 2]}}"
    entries = with_ranges(entry, what, like)
    if not 1 <= len(entries) <= MAX_PARAMETERS:
        raise entry.fault(f"expected {what}, such as {like}")
    return entries


_TEXT = reading(lambda entry: number_text(entry).text.strip(), type="string")
_WHERE: Codec[dict[str, Any]] = record(
    dict,
    "{stable: 2}",
    stable=part(
        reading(_whole, **NUMBER),
        "How many stable poses there are, or solutions where nothing says what is stable.",
        2,
        shown=2,
    ),
    tension=part(
        reading(_flag, type="boolean"), "Whether all springs are in tension.", False, shown=False
    ),
    conditions=part(
        reading(
            lambda entry: (
                (entry,) if isinstance(entry.value, Scalar | Tree) else tuple(entry.items())
            ),
            anyOf=[{"type": "string"}, {"type": "array", "items": {"type": "string"}}],
        ),
        f"Inequalities between the design parameters, such as {FIRST} + {SECOND} <= 3.",
        (),
    ),
)
_NOTHING: Mapping[str, Any] = {"stable": 2, "tension": False, "conditions": ()}
DESIGN: Codec[dict[str, Any]] = record(
    dict,
    A_DESIGN,
    maximise=part(
        _TEXT,
        "range: the length of the widest interval of an axis with the wanted number of stable poses; area: that of the "
        "regions with this number; barrier: the energy that it takes to leave a stable pose for another; or a quantity "
        "or an expression, as of ptmcad map --value.",
        "range",
        shown="range",
    ),
    along=part(_TEXT, "The axis along which a range lies; the first one when it is not given.", ""),
    over=part(
        reading(
            _over,
            type="object",
            minProperties=1,
            maxProperties=MAX_PARAMETERS,
            propertyNames=AXIS_NAME,
            additionalProperties=two(NUMBER),
        ),
        "The design parameters with their bounds. Of a range the other axis is one of them, of an area no axis is, "
        "else both are.",
        None,
    ),
    where=part(_WHERE, "Conditions that every design satisfies.", _NOTHING),
    pose=part(
        _TEXT,
        "Of which pose a barrier, a quantity or an expression is.",
        "stable:1",
        shown="stable:1",
    ),
)


def design_from(question: RecordSource | Design, **changes: Any) -> Design:
    """The design that is meant by a record's file, by a mapping like a record, or by itself.

    Parameters
    ----------
    changes : entries in place of those of the record's ``design``; None for none.

    Raises
    ------
    ConfigError
        For anything wrong.
    """
    if isinstance(question, Design):
        given = [name for name, value in changes.items() if value is not None]
        if given:
            raise ConfigError(
                "a design that was read is complete: give the record instead", key=given[0]
            )
        return question
    return checked_design(
        tree_of(question),
        {
            n: from_python(v, Place(f"design.{n}"), plain)
            for n, v in changes.items()
            if v is not None
        },
    )


def design_from_options(
    config: str | Path,
    maximise: str | None,
    along: str | None,
    over: Iterable[str],
    where: Mapping[str, Any],
    pose: str | None,
) -> Design:
    """The design of the command line's options, over those of a record.

    Parameters
    ----------
    over : texts ``NAME=LO:HI``, in place of all that the record has.
    where : entries in place of those of the record.

    Raises
    ------
    ConfigError
        For anything wrong, with file, line and key, or the option.
    """
    windows = {
        name: [window.low.text, window.high.text]
        for name, window in ranges_of(over, "--over").items()
    }
    asked = {"maximise": maximise, "along": along, "pose": pose, "over": windows or None}
    given = {
        key: from_python(value, Place(f"--{key}"))
        for key, value in asked.items()
        if value is not None
    }
    conditions = {
        key: from_python(value, Place("--condition" if key == "conditions" else f"--{key}"))
        for key, value in where.items()
        if value not in (None, (), False)
    }
    if conditions:
        given["where"] = Tree(conditions, next(iter(conditions.values())).place)
    return checked_design(record_tree(config), given)


def _entries(node: Written | None) -> Mapping[str, Written]:
    return node.entries if isinstance(node, Tree) else {}


def checked_design(tree: Tree, given: Mapping[str, Written] | None = None) -> Design:
    """The design of a record.

    Parameters
    ----------
    given : entries in place of those of the record's ``design``.

    Raises
    ------
    ConfigError
        That knows all faults of the record.
    """
    record, faults = described_record(tree)
    node = record.design
    place = tree.place.below("design") if node is None else node.place
    entries = {**_entries(node), **_merged(_entries(node), given or {})}
    with faults:
        if not entries and (node is not None or "design" not in tree.entries):
            raise place.error(f"is missing: say what is designed, such as {A_DESIGN}")
    for other, asked in (("free", record.free), ("sweep", record.sweep)):
        with faults:
            if asked is not None:
                raise tree.entries[other].place.error(
                    f"a design has no {other!r}: its parameters are those of 'over'"
                )
    unread = record.unread | _entries(entries.get("over")).keys()
    if len(record.axes) != 2 or (faults.found and not entries):
        note_values(record, faults, unread)
    record = record._replace(design=None, unread=unread if faults.found else frozenset())
    return _design(record, Node.of(Tree(entries, place), faults))


def _merged(old: Mapping[str, Written], new: Mapping[str, Written]) -> dict[str, Written]:
    """The new entries, with the old ones of ``where`` that are not replaced."""
    found = dict(new)
    if isinstance(where := new.get("where"), Tree) and isinstance(before := old.get("where"), Tree):
        found["where"] = Tree({**before.entries, **where.entries}, where.place)
    return found


def _design(record: Record, asked: Node) -> Design:
    """What the entries of ``design`` ask of a record; what is wrong is noted, and raised."""
    faults = asked.faults
    assert faults is not None
    said = DESIGN.read(asked)
    maximise, along = said["maximise"], ""
    if maximise == Aim.RANGE.value:
        along = next(iter(record.axes))
        with faults:
            along = _along(said["along"] or along, tuple(record.axes), asked.at("along"))
    elif asked.has("along"):
        with faults:
            raise asked.at("along").fault("is for a range: leave it out")
    needed = () if maximise == Aim.AREA.value else tuple(n for n in record.axes if n != along)
    over, where = _parameters(record, said["over"], asked, needed), said["where"]
    conditions = asked.gathered(partial(_condition, record, over), where["conditions"])
    with faults:
        if where["tension"] and record.model.whole is None:
            raise (
                asked.at("where")
                .at("tension")
                .fault("a system has no springs that would be in tension")
            )
    found = Design(
        record,
        maximise,
        along,
        over,
        where["stable"],
        tuple(conditions),
        where["tension"],
        said["pose"],
    )
    if faults.found:
        note_values(record, faults, _entries(asked.at("over").value))
    # read in the middle of the bounds, so that what no design can be asked is said at once
    _ = (
        found.slice(found.middle)
        if found.aim in (Aim.RANGE, Aim.AREA)
        else found.point(found.middle)
    )
    return found


def _along(along: str, axes: tuple[str, ...], entry: Node) -> str:
    if along not in axes:
        hint = did_you_mean(along, axes, ": choose ", " or ")
        raise entry.fault(f"{along[:40]!r} is not an axis{hint}")
    return along


def _parameters(
    record: Record, given: Mapping[str, Node] | None, asked: Node, needed: tuple[str, ...]
) -> tuple[Axis, ...]:
    """The design parameters; without a word those axes that have to be among them."""
    entry = asked.at("over")
    windows = {name: record.axes[name] for name in needed}
    if given is not None:
        found = dict(
            asked.gathered(lambda part: (part.name, _bounds(record, part, needed)), given.values())
        )
        windows = {name: found[name] for name in (*needed, *found) if name in found}
        if missing := [name for name in needed if name not in given]:
            are = "is an axis" if len(missing) == 1 else "are axes"
            asked.note(
                entry.fault(
                    f"{' and '.join(missing)} {are} that a design fixes: give bounds here too"
                )
            )
    elif not needed and not asked.has("over"):
        asked.note(entry.fault("is missing: of an area say over which parameters it changes"))
    return tuple(
        asked.gathered(lambda window: axis_of(window[0], window[1], record.model), windows.items())
    )


def _bounds(record: Record, entry: Node, needed: tuple[str, ...]) -> Window:
    name = entry.name
    check_axis_name(name, entry.place)
    if name in record.axes and name not in needed:
        raise entry.fault(
            f"{name} varies over its whole window in every design: it is no design parameter"
        )
    if name not in record.axes and name not in record.model.parameters and not record.uses(name):
        hint = (
            did_you_mean(name, record.model.parameters)
            or ": use it in an expression under 'parameters'"
        )
        raise entry.fault(f"no parameter is called {name[:40]}{hint}")
    return window_of(entry, "bounds", "[1/2, 2]")


def _condition(record: Record, over: tuple[Axis, ...], item: Node) -> Inequality:
    known = {axis.name: (axis.low, axis.high) for axis in over}
    fixed = {n: s.text for n, s in record.values.items() if n not in record.axes}
    if not isinstance(item.value, Scalar):
        raise item.fault(f"expected an inequality such as {FIRST} + {SECOND} <= 3")
    try:
        condition = condition_of(item.value.text)
        for name in condition.names:
            named(known, fixed)(name)
    except (ExpressionError, RecursionError) as error:
        raise item.fault(str(error)) from error
    return condition
