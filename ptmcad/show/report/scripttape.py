"""A model's equations as data for the page's script: one list of instructions, from which it reads
all it draws.

Guarantee: the instructions are those of the compiled system's formulas, with constants rounded to
doubles. No model is known by name, and nothing is computed here.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite
from typing import Any

from ptmcad.answer.regionmap import RegionMap
from ptmcad.formulas.instructions import MAX_CONSTANT, Instruction, script
from ptmcad.model.compile import CompiledSystem, compiled
from ptmcad.model.criterion import critical_point
from ptmcad.question.slice import Slice, relaxed_springs

MAX_OPERATIONS = 2000
"""The script runs through them for each step of each solution."""


def tape(result: RegionMap) -> dict[str, Any] | None:
    """What the script needs to follow solutions over the map; None where nothing can be followed.

    That is where no cell has solutions, a parameter has no value or a number is too large for
    doubles; and with free lengths in closed loops, whose roots are in no equation of the
    description.
    """
    slice = result.slice
    model, system = slice.model, compiled(slice.model)
    relaxed = relaxed_springs(model, slice.parameters)
    if relaxed and system.tangent:
        return None
    if not any(cell.solutions for cell in result.cells) or not _fits(slice):
        return None
    names = [name for name in model.variables if name in slice.parameters]
    instructions, places = script(_formulas(system, relaxed), _sources(system, names))
    constants = [instruction[1] for instruction in instructions if instruction[0] == "="]
    if len(instructions) > MAX_OPERATIONS or not all(map(isfinite, constants)):
        return None
    n = len(model.unknowns)
    return {
        **places,
        "moments": list(places["moments"].items()),
        "points": list(places["points"].values()),
        "operations": instructions,
        "parameters": [
            [[[i, j, float(c)] for i, j, c in side] for side in (e.numerator, e.denominator)]
            for e in (slice.parameters[name] for name in names)
        ],
        "angles": len(model.angles),
        "unknowns": n,
        "window": [[float(axis.low), float(axis.high)] for axis in slice.axes],
        "kinds": ["stable", *(critical_point(k, n) for k in range(1, n + 1))],
        "stableOnly": result.only_stable,
    }


def _formulas(system: CompiledSystem, relaxed: Sequence[int]) -> dict[str, Any]:
    """What the script draws and follows; what a model does not have is empty."""
    return {
        "force": system.stored(relaxed) if system.are_slopes else None,
        "energy": system.potential(relaxed),
        "equations": () if system.are_slopes else system.equations,
        "conditions": system.inequalities,
        "stability": system.stability,
        "moments": system.acting,
        "points": system.shown.points,
        "loads": system.shown.loads,
    }


def _sources(system: CompiledSystem, names: Sequence[str]) -> dict[int, Instruction]:
    """Where the script has variables from; a free length that is not there is zero."""
    unknowns = {number: ("u", k) for k, number in enumerate(system.unknowns)}
    return {
        number: unknowns.get(number, ("p", names.index(name)) if name in names else ("=", 0.0))
        for number, name in enumerate(system.names)
    }


def _fits(slice: Slice) -> bool:
    coefficients = [
        c for e in slice.parameters.values() for side in (e.numerator, e.denominator) for _, _, c in side
    ]  # fmt: skip
    ends = [end for axis in slice.axes for end in (axis.low, axis.high)]
    return all(name in slice.parameters for name in slice.model.without_free_lengths) and all(
        abs(value) < MAX_CONSTANT for value in (*coefficients, *ends)
    )
