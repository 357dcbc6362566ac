"""The equilibria at a point of a mechanism with closed loops and springs of free lengths, with everything of a pose.

Guarantee: all equilibria are there, each proved, and each told stable or not; every number settles the digits asked
for. What could not be decided makes the whole answer UNDECIDED. There is no index: with one degree of freedom left a
pose is stable where the energy's second derivative along the loops is positive.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from fractions import Fraction

from flint import arb, ctx, fmpq

from ptmcad.answer.poses import Pose, Poses
from ptmcad.answer.regionmap import Solution, Status
from ptmcad.certified.arb_evaluation import run_arb
from ptmcad.certified.arb_isolation import Box, newton
from ptmcad.certified.formula import Graph
from ptmcad.certified.plain.points import PlainCounter, plain_counter
from ptmcad.certified.plain.poses import (
    MAX_DOUBLINGS,
    all_pull,
    all_settled,
    assembled,
    boxes_of,
    numbers_of,
    point_slice,
    settle,
    solutions_at,
    tape_of,
)
from ptmcad.certified.plain.problem import FIRST, MAX_UNKNOWNS_AT_POINTS
from ptmcad.certified.plain.unsettled import not_settled
from ptmcad.certified.potential import potential
from ptmcad.certified.system import system
from ptmcad.certified.tape import Tape
from ptmcad.mechanism import ClosedMechanism, Mechanism
from ptmcad.mechanism.evaluate import value_at
from ptmcad.mechanism.fourbars import flat_everywhere
from ptmcad.question.domain import prove_slice
from ptmcad.question.slice import Count
from ptmcad.text.enclosure import Enclosure

NOT_TOLD = (
    "the equilibria could not be distinguished: there are infinitely many, one is nearly degenerate, a loop is nearly "
    "flat, or a spring has nearly no length there"
)


def loop_poses(model: ClosedMechanism, parameters: Mapping[str, Fraction], digits: int) -> Poses:
    """All equilibria of a mechanism whose closed loops leave one degree of freedom.

    Parameters
    ----------
    parameters : all variables of the description.
    digits : significant digits that every enclosure settles.

    Raises
    ------
    ConfigError, GeometryError
        As `ptmcad.certified.plain.points.plain_counter` does, or where a parameter is not what its kind asks for.
    """

    def undecided(reason: str, bits: int = 0) -> Poses:
        return Poses(model, parameters, (), Status.UNDECIDED, digits, bits, reason)

    slice = point_slice(model, parameters)
    prove_slice(slice)
    if flat := flat_everywhere(model.mechanism, slice.parameters):
        loop, fold = flat
        return undecided(loop.in_short(fold))
    found = solutions_at(plain_counter(slice, MAX_UNKNOWNS_AT_POINTS), Count.TOTAL)
    if found is None or not all(solution.signs for _, solution in found):
        return undecided(NOT_TOLD)
    written = tape_of(model.mechanism, parameters)
    poses, most = all_settled(_pose(model.mechanism, parameters, written, at, s, digits) for at, s in found)
    if isinstance(poses, str):
        return undecided(poses, most)
    has_energy = model.mechanism.has_potential
    ordered = sorted(poses, key=lambda p: (not p.stable, p.known_energy.center if has_energy else p.angles[0].center))
    return Poses(model, parameters, tuple(ordered), Status.CERTIFIED, digits, most)


def _pose(
    mechanism: Mechanism,
    parameters: Mapping[str, Fraction],
    written: tuple[Tape, tuple[str, ...]],
    counter: PlainCounter,
    solution: Solution,
    digits: int,
) -> tuple[Pose | str, int]:
    """The pose with all numbers settled, and the bits that this took; a sentence that says which number is not."""
    bits, found = 64 + 4 * digits, dict[str, Enclosure]()
    for attempt in range(MAX_DOUBLINGS):
        whole, box = boxes_of(counter, solution, bits)
        if attempt == 1:
            found |= _relaxed(mechanism, parameters, (whole, box), bits)
        with ctx.workprec(bits):
            numbers = numbers_of(mechanism, written, run_arb(written[0], box, bits), {}, found)
            settle(found, numbers, written, digits, attempt)
        if found.keys() >= numbers.keys():
            pose = assembled(mechanism, parameters, found, None)
            stable = solution.signs == "+"
            tense = stable and all_pull(pose.springs)
            return replace(pose, stable=stable, energy=found.get("energy"), admissible=tense), bits
        bits *= 2
    return not_settled(mechanism, found, numbers.keys() - found.keys()), bits // 2


def _relaxed(
    mechanism: Mechanism, parameters: Mapping[str, Fraction], boxes: tuple[Box, Box], precision: int
) -> dict[str, Enclosure]:
    """The numbers of the only spring of an unloaded mechanism where it is proved to have its free length.

    Where it has, its force is zero, and so is the slope of the energy: with the loops' equations |d|^2 = l0^2 is a
    system whose zeros are equilibria, and one that interval Newton proves in a box that holds one equilibrium is that.

    Parameters
    ----------
    boxes : one that holds no other equilibrium, and a narrower one around the equilibrium.
    """
    if len(mechanism.springs) != 1:
        return {}
    graph = Graph()
    unknowns = {name: graph.variable(number) for number, name in enumerate(mechanism.unknowns, FIRST)}
    values = {name: graph.constant(value) for name, value in parameters.items()}
    rest = potential(replace(mechanism, springs=()), values, unknowns)
    spring = mechanism.springs[0]
    free = value_at(spring.free, parameters)
    if rest.energy.value is None or mechanism.moments or free <= 0:
        return {}
    kept = [(c.start, c.end, value_at(c.length, parameters)) for c in mechanism.closing]
    equations = []
    for start, end, length in (*kept, (spring.start, spring.end, free)):
        (x0, y0), (x1, y1) = rest.points[start], rest.points[end]
        equations.append((x1 - x0).squared() + (y1 - y0).squared() - length**2)
    whole, narrow = boxes
    with ctx.workprec(precision):
        wider = [arb(x.mid(), arb(fmpq(1, 2 ** (precision // 2)))) for x in narrow[FIRST:]]
        around = (*narrow[:FIRST], *wider)
        if not all(w.contains(x) for w, x in zip(whole[FIRST:], wider, strict=True)):
            return {}
    step = newton(system(equations, [v.variable for v in unknowns.values()]), around, precision)
    if step is None or not step[1]:
        return {}
    exact = {"length 0": free, "force 0": Fraction(0), "energy": rest.energy.value}
    return {name: Enclosure(value, value) for name, value in exact.items()}
