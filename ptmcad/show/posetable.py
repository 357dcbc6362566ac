"""The equilibria at a point as a table for the terminal.

Guarantee: every digit is right; lines have at most `WIDTH` characters unless a single column needs
more. What is not decided is said, of a pose and of all of them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from fractions import Fraction

from ptmcad.answer.poses import Pose, Poses
from ptmcad.answer.regionmap import Status
from ptmcad.answer.words import counted, listed, noun, of_what, untold
from ptmcad.model import Model, built_in
from ptmcad.model.work import foreign, loads_at
from ptmcad.question.counts import POSE_COLUMNS, Predicate
from ptmcad.question.slice import merged
from ptmcad.show.table import WIDTH, aligned, wrapped
from ptmcad.show.units import declared_units
from ptmcad.text.enclosure import Enclosure, exact_text

Numbers = tuple[str, str, Sequence[Enclosure] | list[str]]
"""Header, unit and entries of a column."""
_MAX_BOUNDS = 6
"""Numbers that may be zero that are listed."""


def kind_of(pose: Pose, model: Model) -> str:
    """Stable, saddle, maximum or degenerate; of a system of equations stable, unstable or just a
    solution.
    """
    return "degenerate" if pose.multiplicity > 1 else model.criterion.kind(pose.stable, pose.index)


def table(poses: Poses, digits: int | None = None) -> str:
    """Everything about each equilibrium: one row for each in every block of columns.

    Parameters
    ----------
    digits : significant digits, at most those that the poses were computed with; all of them unless
        given.
    """
    shown = poses.digits if digits is None else digits
    lines = [
        *wrapped("point", point_texts(poses, lambda n, v: f"{n} = {exact_text(v)}")),
        *wrapped("result", _summary(poses)),
    ]
    for block in _blocks(poses, shown):
        lines += ["", *aligned([*zip(*block, strict=True)], right=len(block))]
    if poses.equilibria:
        notes = {"units": _units(poses), "energy": [_energy_note(poses)]}
        notes |= {label: [note] for label, note in poses.equilibria[0].notes.items()}
        notes |= {each.head: [each.note] for each in _columns(poses).values()}
        lines += [
            "",
            *(
                line
                for label, parts in notes.items()
                if any(parts)
                for line in wrapped(label, parts)
            ),
        ]
        lines += _bounds(poses)
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
    pose, product = (
        poses.equilibria[0],
        declared_units(mechanism, units).get("energy", "their product"),
    )
    parts = {
        "energies": pose.energy,
        "moments": mechanism.energy_unit in {spring.unit for spring in mechanism.elastic},
        "the Hessian's eigenvalues": pose.eigenvalues,
    }
    measured = {
        "lengths and coordinates": length,
        "forces": force,
        listed([name for name, values in parts.items() if values]): product,
    }
    pivots = " and ".join(f"{angle} at {at}" for angle, at in mechanism.pivots.items())
    return [
        *(f"{what} in {unit}" for what, unit in measured.items() if what and unit),
        # only of what is built in it is known where an angle is measured from
        *(
            [f"angles between rod and base, {pivots}"]
            if pivots and mechanism.name in built_in()
            else []
        ),
    ]


def _energy_note(poses: Poses) -> str:
    """What the column of energies leaves out, or why there is none."""
    model = poses.model.whole or poses.model
    if not foreign(model):
        return of_what(model, poses.parameters)
    return "none" if poses.known_stable is not None else f"none, and {untold(model)}"


def point_texts(poses: Poses, text: Callable[[str, Fraction], str]) -> list[str]:
    """The parameters with their values, as a function writes them; equal stiffnesses or free lengths
    as one, loads only where there are any.
    """
    model = poses.model
    shown = merged(poses.parameters, model)
    rest = [text(name, value) for name, value in shown.items() if name not in model.forces]
    loads = [text(name, value) for name, value in shown.items() if name in model.forces and value]
    acting = () if model.whole is None else loads_at(model.whole, poses.parameters)
    idle = acting and not any(any(forces) for _, forces in acting)
    return [*rest, *loads, *(["no load"] if idle else [])]


def _bounds(poses: Poses) -> list[str]:
    """The quantities that may be zero, with what is proved of them."""
    where: dict[str, list[str]] = {}
    for header, unit, entries in (
        quantity for group in _groups(poses) for quantity in group if quantity[1] != "rad"
    ):
        for n, x in enumerate(entries, 1):
            if isinstance(x, Enclosure) and x.exact is None and x.low <= 0 <= x.high:
                where.setdefault(
                    f"|{header}| < {exact_text(x.high)}{unit and f' {unit}'}", []
                ).append(str(n))
    said = [f"{bound} in {noun(poses.model, len(n))} {', '.join(n)}" for bound, n in where.items()]
    more = [f"{len(said) - _MAX_BOUNDS} more such bounds"] if len(said) > _MAX_BOUNDS else []
    return (
        wrapped("bounds", ["of what may be zero: " + said[0], *said[1:_MAX_BOUNDS], *more], "; ")
        if said
        else []
    )


_KINDS = ("stable", "saddle", "maximum", "degenerate", "unstable", "undecided")
_PLURALS = {"saddle": "saddles", "maximum": "maxima"}


def _summary(poses: Poses) -> list[str]:
    if poses.status is Status.UNDECIDED and not poses.equilibria:
        return [poses.remark]
    kinds = [kind_of(pose, poses.model) for pose in poses.equilibria]
    counted_kinds = () if "solution" in kinds else _KINDS
    tally = [
        f"{n} {_PLURALS.get(kind, kind) if n > 1 else kind}"
        for kind in counted_kinds
        if (n := kinds.count(kind))
    ]
    parts = [
        ": ".join(filter(None, (counted(poses.model, len(kinds)), ", ".join(tally)))),
        poses.status.value,
    ]
    if poses.status is Status.UNDECIDED:
        boxes = f"{poses.undecided} box{'' if poses.undecided == 1 else 'es'}"
        parts = [f"at least {parts[0]}, each certified", f"{boxes} of configurations undecided"]
    for name, column in _columns(poses).items():
        number = sum(pose.further.get(name) is True for pose in poses.equilibria)
        parts.insert(1, f"{number} {column.tally}")
    return parts + ([poses.remark] if poses.remark else [])


def _columns(poses: Poses) -> dict[str, Predicate]:
    """Those of predicates, where it is asked whether these hold."""
    return POSE_COLUMNS if any(pose.has_predicates for pose in poses.equilibria) else {}


def _blocks(poses: Poses, digits: int) -> Iterator[list[list[str]]]:
    """The columns in as few blocks as the width allows, in their order; each begins with the
    equilibria's numbers.
    """
    numbers = ["#", *(str(k + 1) for k in range(len(poses.equilibria)))]
    for group in _groups(poses):
        block = [numbers]
        for header, unit, entries in group:
            column = [f"{header} [{unit}]" if unit else header]
            column += [x if isinstance(x, str) else x.text(digits) for x in entries]
            if (
                len(block) > 1
                and sum(2 + max(map(len, each)) for each in (*block, column)) > WIDTH + 2
            ):
                yield block
                block = [numbers]
            block.append(column)
        if len(block) > 1:
            yield block


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
    states += [
        (f"eigenvalue {k + 1}", "", [p.eigenvalues[k] for p in found])
        for k in range(len(first.eigenvalues))
    ]
    groups = zip(*(pose.quantities(model) for pose in found), strict=True)
    numbers: list[list[Numbers]] = [
        [
            (*column[0][:2], [number for _, _, number in column])
            for column in zip(*group, strict=True)
        ]
        for group in groups
    ]
    return [states, *numbers]
