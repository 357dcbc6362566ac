"""Springs that are proved to have exactly their free lengths at an equilibrium, so that their forces are exactly zero.

And torsion springs that are proved to be at rest there, or half a turn from it, so that their moments are.

Guarantee: exact. Let S be some springs, T some torsion springs and R the energy of all the rest. Where |d_s|^2 = l0_s^2
for all s in S, sin(deflection) = 0 for all in T and the slopes of R vanish, all slopes of the energy do: each is that
of R plus multiples of the |d_s| - l0_s and of the sines. If these equations, without those that vanish identically and
those of springs that follow from others', are as many as the unknowns, interval Newton can prove that they have a zero
in a box; if the box holds one equilibrium only, that is the zero. An equation |d_s|^2 = l0_s^2 follows from others
where the polynomial, reduced by cos^2 + sin^2 = 1, is a linear combination of theirs, such as that of the other half of
a symmetric truss. Unknowns that a mirror symmetry of the energy fixes have their values, and their slopes vanish
whatever the others are: then there are fewer equations in fewer unknowns.

Balls alone would never tell such a force from its neighbours. The lemma is that of interval Newton as in
`ptmcad.certified.arb_isolation`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from typing import NamedTuple

from flint import arb, ctx, fmpq

from ptmcad.certified.arb_evaluation import run_arb
from ptmcad.certified.arb_isolation import Box, newton
from ptmcad.certified.formula import Formula, Graph
from ptmcad.certified.plain.combinations import independent
from ptmcad.certified.plain.problem import FIRST
from ptmcad.certified.plain.symmetric import fixed_place, partly_valued, point_of
from ptmcad.certified.potential import potential
from ptmcad.certified.system import system
from ptmcad.certified.tape import record
from ptmcad.errors import ExpressionError
from ptmcad.mechanism import Mechanism
from ptmcad.mechanism.evaluate import value_at
from ptmcad.mechanism.proofs import MirrorImage, Monomial, squared_length
from ptmcad.mechanism.work import split_moments
from ptmcad.text.enclosure import Enclosure
from ptmcad.text.tree import names_of


class Relaxed(NamedTuple):
    """The numbers, in the description, of springs and torsion springs of which it is asked whether they are relaxed."""

    springs: tuple[int, ...]
    torsion: tuple[int, ...]


def relaxed_numbers(
    mechanism: Mechanism,
    parameters: Mapping[str, Fraction],
    relaxed: Relaxed,
    boxes: tuple[Box, Box],
    precision: int,
    turns: Mapping[str, int],
) -> dict[str, Enclosure]:
    """The numbers of these springs, if all are proved to be relaxed, and the energy if it is rational then.

    Lengths and forces of springs, sines and moments of torsion springs.

    Parameters
    ----------
    boxes : one that holds no other equilibrium, and a narrower one around the equilibrium.
    precision : in bits.
    turns : the unknowns that a symmetry fixes, as `ptmcad.certified.plain.symmetric.fixed_turns` has them.

    Returns
    -------
    By name, as exact enclosures; nothing where there is no proof.
    """
    free = {n: value_at(mechanism.springs[n].free, parameters) for n in relaxed.springs}
    if (
        not (free or relaxed.torsion)
        or not all(value > 0 for value in free.values())
        or _has_steady_moment(mechanism, parameters)
    ):
        return {}
    graph = Graph()
    unknowns = {name: graph.variable(number) for number, name in enumerate(mechanism.unknowns, FIRST)}
    values = {name: graph.constant(value) for name, value in parameters.items()}
    others = tuple(spring for n, spring in enumerate(mechanism.springs) if n not in free)
    bent = tuple(torsion for n, torsion in enumerate(mechanism.torsion) if n not in relaxed.torsion)
    rest = potential(replace(mechanism, springs=others, torsion=bent), values, unknowns)
    loose = [v.variable for name, v in unknowns.items() if name not in turns]
    equations = [graph.derivative(rest.energy, k) for k in loose]
    equations = [slope for slope in equations if slope.value != 0]
    for n in _independent(mechanism, parameters, free, point_of(mechanism, turns)):
        value = free[n]
        (x0, y0), (x1, y1) = (rest.points[end] for end in (mechanism.springs[n].start, mechanism.springs[n].end))
        equations.append((x1 - x0).squared() + (y1 - y0).squared() - value**2)
    deflections = potential(mechanism, values, unknowns).deflections if relaxed.torsion else ()
    equations += [deflections[n][1] for n in relaxed.torsion]
    if not loose or len(equations) != len(loose):
        return {}
    place = around(mechanism, turns, boxes, precision)
    if place is None:
        return {}
    step = newton(system(equations, loose), place, precision)
    cosines = _cosines(relaxed, deflections, boxes[1], precision)
    if step is None or not step[1] or cosines is None:
        return {}
    found = {f"length {n}": value for n, value in free.items()} | {f"force {n}": Fraction(0) for n in free}
    for n, cosine in cosines.items():
        found |= {f"torsion cos {n}": cosine, f"torsion sin {n}": Fraction(0), f"torsion moment {n}": Fraction(0)}
    if rest.energy.value is not None:
        wound = (value_at(mechanism.torsion[n].stiffness, parameters) * (1 - c) for n, c in cosines.items())
        found["energy"] = rest.energy.value + sum(wound)
    return {name: Enclosure(value, value) for name, value in found.items()}


def _cosines(
    relaxed: Relaxed, deflections: Sequence[tuple[Formula, Formula]], place: Box, precision: int
) -> dict[int, Fraction] | None:
    """Of the torsion springs' deflections whose sines are zero, by numbers: 1 at rest, -1 half a turn from it.

    None where a ball does not tell.
    """
    if not relaxed.torsion:
        return {}
    tape = record([[deflections[n][0] for n in relaxed.torsion]])
    balls = run_arb(tape, place, precision)
    found = [balls[int(output)] for output in tape.outputs[0]]
    if any(ball.contains(0) for ball in found):
        return None
    return {n: Fraction(1 if ball > 0 else -1) for n, ball in zip(relaxed.torsion, found, strict=True)}


def around(mechanism: Mechanism, turns: Mapping[str, int], boxes: tuple[Box, Box], precision: int) -> Box | None:
    """The box for Newton's method, with fixed unknowns at their values; None where it leaves the wider one."""
    whole, narrow = boxes
    with ctx.workprec(precision):
        found = list(narrow)
        for k, name in enumerate(mechanism.unknowns, FIRST):
            if name in turns:
                found[k] = fixed_place(mechanism, name, narrow[k])
            else:
                found[k] = arb(narrow[k].mid(), arb(fmpq(1, 2 ** (precision // 2))))
            if not whole[k].contains(found[k]):
                return None
    return tuple(found)


def _independent(
    mechanism: Mechanism, parameters: Mapping[str, Fraction], free: Mapping[int, Fraction], at: Mapping[str, Fraction]
) -> list[int]:
    """Springs from whose equations |d|^2 = l0^2 those of all these springs follow, by linear combination.

    All of them, where that is too much to be multiplied out.

    Parameters
    ----------
    at : values of unknowns that are known, as `partly_valued` takes them.
    """

    def equation(n: int, value: Fraction) -> dict[Monomial, Fraction]:
        image, spring = MirrorImage(parameters), mechanism.springs[n]
        squared = squared_length(mechanism, image, spring.start, spring.end)
        return partly_valued(squared - image.constant(value**2), at)

    numbers = list(free)
    try:
        return [numbers[k] for k in independent([equation(n, value) for n, value in free.items()])]
    except ExpressionError:
        return numbers


def _has_steady_moment(mechanism: Mechanism, parameters: Mapping[str, Fraction]) -> bool:
    """Whether there is a moment, other than zero, that is no part of the energy."""
    steady = (tree for _, tree in split_moments(mechanism).steady)
    return any(not parameters.keys() >= set(names_of(tree)) or value_at(tree, parameters) != 0 for tree in steady)
