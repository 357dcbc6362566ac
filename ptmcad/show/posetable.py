"""The equilibria at a point as a table for the terminal.

Guarantee: every digit is right; lines have at most `WIDTH` characters unless a single column needs more. What is not
decided is said, of a pose and of all of them.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from ptmcad.answer.poses import Pose, Poses
from ptmcad.answer.regionmap import Status
from ptmcad.answer.words import counted, noun, of_what, untold
from ptmcad.model import Mechanism, Model, built_in
from ptmcad.question.counts import POSE_COLUMNS, PoseColumn
from ptmcad.question.slice import merged
from ptmcad.show.units import declared_units
from ptmcad.text.enclosure import Enclosure, exact_text

WIDTH = 100

Column = list[str]
"""A header, with its unit in brackets, and entries."""

Numbers = tuple[str, str, Sequence[Enclosure] | list[str]]
"""Header, unit and entries before numbers are written."""

_MAX_BOUNDS = 6
"""Numbers that may be zero that are listed."""


def kind_of(pose: Pose, model: Model) -> str:
    """Stable, saddle, maximum or degenerate; of a system of equations stable, unstable or just a solution."""
    if pose.multiplicity > 1:
        return "degenerate"
    if pose.stable is None:
        return "undecided" if model.tells_stability else "solution"
    if pose.stable:
        return "stable"
    if pose.index is None:
        return "unstable"
    return "maximum" if pose.index == len(pose.eigenvalues) else "saddle"


def table(poses: Poses, digits: int | None = None) -> str:
    """Everything about each equilibrium: one row for each in every block of columns.

    Parameters
    ----------
    digits : significant digits, at most those that the poses were computed with; all of them unless given.
    """
    shown = poses.digits if digits is None else digits
    lines = [*_wrapped("point", _point(poses)), *_wrapped("result", _summary(poses))]
    for block in _blocks(poses, shown):
        lines += ["", *_laid_out(block)]
    if poses.equilibria:
        lines += [
            "",
            *(_wrapped("units", units) if (units := _units(poses)) else []),
            *(_wrapped("energy", [note]) if (note := _energy_note(poses)) else []),
            *(_wrapped("torsion", [_TORSION]) if poses.equilibria[0].torsion else []),
            *(line for each in _columns(poses).values() for line in _wrapped(each.head, [each.note])),
            *_bounds(poses),
        ]
    return "\n".join(lines)


def _units(poses: Poses) -> list[str]:
    """In what numbers are measured; nothing of a system, whose numbers have no units."""
    mechanism, units = poses.model.whole, poses.units
    if mechanism is None:
        return []
    length, force = (
        units.get(what) or (f"that of {name}" if name else "")
        for what, name in zip(("length", "force"), mechanism.units, strict=True)
    )
    product = declared_units(mechanism, units).get("energy", "their product")
    pivots = " and ".join(f"{angle} at {at}" for angle, at in mechanism.pivots.items())
    return [
        *([f"lengths and coordinates in {length}"] if length else []),
        *([f"forces in {force}"] if force else []),
        *_in_products(mechanism, product),
        # only of what is built in it is known where an angle is measured from
        *([f"angles between rod and base, {pivots}"] if pivots and mechanism.name in built_in() else []),
    ]


def _in_products(mechanism: Mechanism, product: str) -> list[str]:
    """What is measured in force times length."""
    moments = "moments" if mechanism.torsion else ""
    if not mechanism.has_potential:
        return [f"{moments} in {product}"] if moments else []
    if mechanism.closing or mechanism.xjoints:
        return [f"energies{moments and f' and {moments}'} in {product}"]
    return [f"energies{moments and f', {moments}'} and the Hessian's eigenvalues in {product}"]


def _energy_note(poses: Poses) -> str:
    """What the column of energies leaves out, or why there is none."""
    model = poses.model.whole or poses.model
    if model.has_potential:
        return of_what(model, poses.parameters)
    if model.drawable is None:
        return ""
    return "none" if poses.model.tells_stability else f"none, and {untold(model)}"


_TORSION = "deflection: angle - rest; moment: k sin(deflection), positive where it turns back an angle beyond rest"


def _point(poses: Poses) -> list[str]:
    values = {name: exact_text(value) for name, value in poses.parameters.items()}
    values = merged(values, poses.model)
    loads = [name for name in values if name in poses.model.forces]
    parts = [f"{name} = {value}" for name, value in values.items() if name not in loads]
    return parts + ([f"{n} = {values[n]}" for n in loads if values[n] != "0"] or (["no load"] if loads else []))


def _bounds(poses: Poses) -> list[str]:
    """The quantities that may be zero, with what is proved of them."""
    where: dict[str, list[str]] = {}
    for header, unit, entries in (quantity for group in _groups(poses) for quantity in group if quantity[1] != "rad"):
        for n, x in enumerate(entries, 1):
            if isinstance(x, Enclosure) and x.exact is None and x.low <= 0 <= x.high:
                where.setdefault(f"|{header}| < {exact_text(x.high)}{unit and f' {unit}'}", []).append(str(n))
    said = [f"{bound} in {noun(poses.model, len(n))} {', '.join(n)}" for bound, n in where.items()]
    more = [f"{len(said) - _MAX_BOUNDS} more such bounds"] if len(said) > _MAX_BOUNDS else []
    return _wrapped("bounds", ["of what may be zero: " + said[0], *said[1:_MAX_BOUNDS], *more], "; ") if said else []


def _summary(poses: Poses) -> list[str]:
    if poses.status is Status.UNDECIDED and not poses.equilibria:
        return [poses.remark]
    kinds = [kind_of(pose, poses.model) for pose in poses.equilibria]
    several = {"stable": "stable", "saddle": "saddles", "maximum": "maxima", "degenerate": "degenerate"}
    several |= {"unstable": "unstable", "solution": "solutions", "undecided": "undecided"}
    tally = [
        f"{kinds.count(kind)} {several[kind] if kinds.count(kind) > 1 else kind}" for kind in several if kind in kinds
    ]
    tells = f": {', '.join(tally)}" if kinds and "solution" not in kinds else ""
    parts = [f"{counted(poses.model, len(kinds))}{tells}", poses.status.value]
    if poses.status is Status.UNDECIDED:
        boxes = f"{poses.undecided} box{'' if poses.undecided == 1 else 'es'}"
        parts = [f"at least {parts[0]}, each certified", f"{boxes} of configurations undecided"]
    for name, column in _columns(poses).items():
        number = sum(pose.further.get(name) is True for pose in poses.equilibria)
        parts.insert(1, f"{number} {column.tally}")
    return parts + ([poses.remark] if poses.remark else [])


def _columns(poses: Poses) -> dict[str, PoseColumn]:
    """Those of predicates, where it is asked whether these hold."""
    return POSE_COLUMNS if any(pose.has_predicates for pose in poses.equilibria) else {}


def _wrapped(label: str, parts: Sequence[str], separator: str = ", ") -> list[str]:
    """The parts after a label, on as many lines as they need."""
    lines, indent = [], " " * 8
    line = f"{label:8}"
    for part, following in pairwise([*parts, ""]):
        piece = part + (separator if following else "")
        if len(line) + len(piece.rstrip()) > WIDTH and line.strip() and line != f"{label:8}":
            lines.append(line.rstrip())
            line = indent
        line += piece
    return [*lines, line.rstrip()]


def _blocks(poses: Poses, digits: int) -> list[list[Column]]:
    width = len(str(len(poses.equilibria)))

    def written(quantity: Numbers) -> Column:
        header, unit, entries = quantity
        head = f"{header} [{unit}]" if unit else header
        return [head, *(x if isinstance(x, str) else x.text(digits) for x in entries)]

    groups = [list(map(written, group)) for group in _groups(poses)]
    return [block for group in groups if group for block in _fitting(group, width)]


def _groups(poses: Poses) -> list[list[Numbers]]:
    found = poses.equilibria
    if not found:
        return []
    first, model = found[0], poses.model
    called = {"solution": noun(model, 1)}
    kinds = [kind_of(pose, model) for pose in found]
    states: list[Numbers] = [("state", "", [called.get(kind, kind) for kind in kinds])]
    if model.whole is not None:
        states.append(("flat", "", ["yes" if p.flat else "no" for p in found]))
    said = {True: "yes", False: "no", None: "undecided"}
    for name, column in _columns(poses).items():
        states.append((column.head, "", [said[p.further.get(name)] for p in found]))
    if first.eigenvalues:
        states.append(("index", "", ["-" if p.index is None else str(p.index) for p in found]))
    states.append(("mult.", "", [str(p.multiplicity) for p in found]))
    if first.energy is not None:
        states.append(("energy", "", [p.known_energy for p in found]))
    states += [(f"eigenvalue {k + 1}", "", [p.eigenvalues[k] for p in found]) for k in range(len(first.eigenvalues))]
    groups = zip(*(pose.quantities(model) for pose in found), strict=True)
    numbers: list[list[Numbers]] = [
        [(column[0].name, column[0].unit, [each.value for each in column]) for column in zip(*group, strict=True)]
        for group in groups
    ]
    return [states, *numbers]


def _fitting(columns: Sequence[Column], used: int) -> list[list[Column]]:
    """The columns in as few blocks as the width allows, in their order."""
    blocks: list[list[Column]] = [[]]
    width = used
    for column in columns:
        wide = 2 + max(map(len, column))
        if blocks[-1] and width + wide > WIDTH:
            blocks.append([])
            width = used
        blocks[-1].append(column)
        width += wide
    return blocks


def _laid_out(columns: Sequence[Column]) -> list[str]:
    """A block of columns as lines: headers, then one row for each equilibrium, each with its number."""
    numbered = [["#", *(str(k) for k in range(1, len(columns[0])))], *columns]
    widths = [max(map(len, column)) for column in numbered]
    rows = zip(*numbered, strict=True)
    return ["  ".join(entry.rjust(width) for entry, width in zip(row, widths, strict=True)) for row in rows]
