"""The key ``design`` of a record: what is made as large as possible, over which parameters, and under what conditions.

Guarantee: whatever is wrong is a `ConfigError` with file, line and key.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Any

from ptmcad.errors import A_RECORD, ConfigError, ExpressionError, Faults, expect
from ptmcad.mechanism import Mechanism
from ptmcad.question.config.designed import Aim, Design
from ptmcad.question.config.objects import plain
from ptmcad.question.config.options import ranges_of
from ptmcad.question.config.record import Record, Window, check_axis_name, read_record
from ptmcad.question.config.resolution import axis_of, note_values, unread_names
from ptmcad.question.config.scalars import names_in_scalar, number_of, number_text
from ptmcad.question.design import Condition, condition_of, named
from ptmcad.question.examples import A_DESIGN, FIRST, SECOND
from ptmcad.question.shipped import record_tree
from ptmcad.question.slice import Axis
from ptmcad.text.syntax import did_you_mean
from ptmcad.text.yamltree import Node, Place, Scalar, Sequence, Tree, from_python

KEYS = ("maximise", "along", "over", "where", "pose")
WHERE_KEYS = ("stable", "tension", "conditions")
MAX_PARAMETERS = 8


def design_from(question: str | Path | Mapping[str, Any] | Design, **changes: Any) -> Design:
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
            raise ConfigError("a design that was read is complete: give the record instead", key=given[0])
        return question
    expect(question, (str, Path, Mapping), "question", A_RECORD)
    if isinstance(question, Mapping):
        tree = from_python(plain(question), Place())
        assert isinstance(tree, Tree)  # of a mapping
    else:
        tree = record_tree(question)
    return checked_design(
        tree, {n: from_python(plain(v), Place(f"design.{n}")) for n, v in changes.items() if v is not None}
    )


def design_from_options(
    config: str | Path, maximise: str | None, along: str | None, over: Iterable[str], where: Mapping[str, Any],
    pose: str | None,
) -> Design:  # fmt: skip
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
    given: dict[str, Node] = {}
    for key, value in (("maximise", maximise), ("along", along), ("pose", pose)):
        if value is not None:
            given[key] = Scalar(value, Place(f"--{key}"))
    if windows := ranges_of(over, "--over"):
        place = Place("--over")
        given["over"] = Tree({n: Sequence((w.low, w.high), w.place) for n, w in windows.items()}, place)
    for key, value in where.items():
        if value not in (None, (), False):
            option = Place(f"--{key.removesuffix('s') if key == 'conditions' else key}")
            node = from_python(list(value) if isinstance(value, tuple) else value, option)
            given["where"] = Tree({**_entries(given.get("where")), key: node}, option)
    return checked_design(record_tree(config), given)


def _entries(node: Node | None) -> Mapping[str, Node]:
    return node.entries if isinstance(node, Tree) else {}


def checked_design(tree: Tree, given: Mapping[str, Node] | None = None) -> Design:
    """The design of a record.

    Parameters
    ----------
    given : entries in place of those of the record's ``design``.

    Raises
    ------
    ConfigError
        That knows all faults of the record.
    """
    faults = Faults()
    record = read_record(tree, faults)
    if record.described is None:
        faults.check()  # without it nothing can be said of the rest
    node = record.design
    place = tree.place.below("design") if node is None else node.place
    entries = {**_entries(node), **_merged(_entries(node), given or {})}
    with faults:
        if not entries and (node is not None or "design" not in tree.entries):
            raise place.error(f"is missing: say what is designed, such as {A_DESIGN}")
    for other, asked in (("free", record.free), ("sweep", record.sweep)):
        with faults:
            if asked is not None:
                raise tree.entries[other].place.error(f"a design has no {other!r}: its parameters are those of 'over'")
    unread = unread_names(record, tree, faults) | _entries(entries.get("over")).keys()
    if faults.found and (not entries or len(record.axes) != 2):
        note_values(record._replace(unread=unread), faults)
    record = record._replace(design=None, unread=unread if faults.found else frozenset())
    return _Reader(record, entries, place, faults).design()


def _merged(old: Mapping[str, Node], new: Mapping[str, Node]) -> dict[str, Node]:
    """The new entries, with the old ones of ``where`` that are not replaced."""
    found = dict(new)
    if isinstance(where := new.get("where"), Tree) and isinstance(before := old.get("where"), Tree):
        found["where"] = Tree({**before.entries, **where.entries}, where.place)
    return found


@dataclass(frozen=True, slots=True)
class _Reader:
    """The entries of ``design``, read one by one; what is wrong is noted."""

    record: Record
    entries: Mapping[str, Node]
    place: Place
    faults: Faults

    def design(self) -> Design:
        self._check_keys(self.entries, KEYS)
        maximise, along, pose = self._text("maximise", "range"), "", self._text("pose", "stable:1")
        if maximise == Aim.RANGE.value:
            along = self._along()
        elif "along" in self.entries:
            with self.faults:
                raise self.entries["along"].place.error("is for a range: leave it out")
        over = self._over(maximise, along)
        where = self.entries.get("where")
        if where is not None and not isinstance(where, Tree):
            with self.faults:
                raise where.place.error("expected conditions such as {stable: 2}")
        parts = _entries(where)
        self._check_keys(parts, WHERE_KEYS)
        working = self._whole(parts["stable"]) if "stable" in parts else 2
        tension = self._flag(parts["tension"]) if "tension" in parts else False
        conditions = self._conditions(parts["conditions"], over) if "conditions" in parts else ()
        if self.faults.found:
            unread = _entries(self.entries.get("over")).keys()
            note_values(self.record._replace(unread=self.record.unread | unread), self.faults)
        found = Design(self.record, maximise, along, over, working, conditions, tension, pose)
        self._check_slice(found)
        return found

    def _check_keys(self, entries: Mapping[str, Node], known: tuple[str, ...]) -> None:
        for key, node in entries.items():
            with self.faults:
                if key not in known:
                    hint = did_you_mean(key, known) or f"; the keys are {', '.join(known)}"
                    raise node.place.error(f"unknown key{hint}")

    def _text(self, key: str, default: str) -> str:
        if key not in self.entries:
            return default
        text = default
        with self.faults:
            text = number_text(self.entries[key]).text.strip()
        return text

    def _along(self) -> str:
        axes = tuple(self.record.axes)
        node = self.entries.get("along")
        along = self._text("along", axes[0])
        if along not in axes and node is not None:
            with self.faults:
                hint = did_you_mean(along, axes) or f": choose {' or '.join(axes)}"
                raise node.place.error(f"{along[:40]!r} is not an axis{hint}")
            return axes[0]
        return along

    def _over(self, maximise: str, along: str) -> tuple[Axis, ...]:
        """The design parameters; without a word those axes that have to be among them."""
        axes = self.record.axes
        if maximise == Aim.AREA.value:
            needed: tuple[str, ...] = ()
        else:
            needed = tuple(name for name in axes if name != along)
        node = self.entries.get("over")
        if node is None:
            if not needed:
                with self.faults:
                    raise self.place.below("over").error("is missing: of an area say over which parameters it changes")
            return self._sorted({name: axes[name] for name in needed}, needed)
        windows: dict[str, Window] = {}
        if not isinstance(node, Tree) or not 1 <= len(node.entries) <= MAX_PARAMETERS:
            with self.faults:
                raise node.place.error(f"expected design parameters with their bounds, such as {{{FIRST}: [1/2, 2]}}")
            return ()
        for name, entry in node.entries.items():
            with self.faults:
                windows[name] = self._bounds(name, entry, needed)
        missing = [name for name in needed if name not in node.entries]
        if missing:
            with self.faults:
                raise node.place.error(
                    f"{' and '.join(missing)} {'is an axis' if len(missing) == 1 else 'are axes'} that a design fixes: "
                    "give bounds here too"
                )
        return self._sorted(windows, needed)

    def _bounds(self, name: str, node: Node, needed: tuple[str, ...]) -> Window:
        check_axis_name(name, node.place)
        record = self.record
        if name in record.axes and name not in needed:
            raise node.place.error(f"{name} varies over its whole window in every design: it is no design parameter")
        used = any(name in names_in_scalar(scalar) for scalar in record.values.values())
        if name not in record.axes and name not in record.model.parameters and not used:
            hint = did_you_mean(name, record.model.parameters) or ": use it in an expression under 'parameters'"
            raise node.place.error(f"no parameter is called {name[:40]}{hint}")
        if not isinstance(node, Sequence) or len(node.items) != 2:
            raise node.place.error("expected bounds such as [1/2, 2]")
        low, high = (number_text(item) for item in node.items)
        return Window(low, high, node.place)

    def _sorted(self, windows: Mapping[str, Window], first: tuple[str, ...]) -> tuple[Axis, ...]:
        names = [*(n for n in first if n in windows), *(n for n in windows if n not in first)]
        found = []
        for name in names:
            with self.faults:
                found.append(axis_of(name, windows[name], self.record.model))
        return tuple(found)

    def _whole(self, node: Node) -> int:
        found = Fraction(2)
        with self.faults:
            found = number_of(number_text(node), "the number of stable poses")
            if found.denominator != 1 or not 0 <= found <= 1000:
                raise node.place.error(f"the number of stable poses is a whole one, not {found}")
        return int(found)

    def _flag(self, node: Node) -> bool:
        with self.faults:
            if not isinstance(node, Scalar) or node.text.lower() not in ("true", "false"):
                raise node.place.error("write true or false")
            model = self.record.model
            if not isinstance(model, Mechanism):
                raise node.place.error("a system has no springs that would be in tension")
            return node.text.lower() == "true"
        return False

    def _conditions(self, node: Node, over: tuple[Axis, ...]) -> tuple[Condition, ...]:
        found = []
        known = {axis.name: (axis.low, axis.high) for axis in over}
        fixed = {n: s.text for n, s in self.record.values.items() if n not in self.record.axes}
        for item in node.items if isinstance(node, Sequence) else (node,):
            with self.faults:
                if not isinstance(item, Scalar):
                    raise item.place.error(f"expected an inequality such as {FIRST} + {SECOND} <= 3")
                try:
                    condition = condition_of(item.text)
                    for name in condition.names:
                        named(known, fixed)(name)
                except (ExpressionError, RecursionError) as error:
                    raise item.place.error(str(error)) from error
                found.append(condition)
        return tuple(found)

    def _check_slice(self, found: Design) -> None:
        """Read the design in the middle of the bounds, so that what no design can be asked is said at once."""
        middle = {axis.name: (axis.low + axis.high) / 2 for axis in found.over}
        check: Callable[[Mapping[str, Fraction]], object] = (
            found.slice if found.aim in (Aim.RANGE, Aim.AREA) else found.point
        )
        check(middle)
