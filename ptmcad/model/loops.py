"""Closed loops, as equations: each loop is cut at a bar, which keeps its length. With one degree of freedom left:

Guarantee: off the places where a loop folds flat the solutions are the equilibria, and the stable ones are the strict
minima of the energy under the loops' conditions.

Let g_1 .. g_m be squared distances less squared lengths, in m + 1 unknowns, and T the vector of the maximal minors of
their derivatives, with signs: it is tangent to g = 0 and vanishes only where these derivatives are dependent, where a
loop folds flat. Along the curve g = 0, run through with velocity T, the energy has the derivative E = T . grad U, and
where that is zero the second derivative T . grad E: which is the determinant of the derivatives of g_1 .. g_m and E. So
an equilibrium is a zero of g and E, simple where the determinant is not zero, and stable where it is positive. Where T
vanishes E does, and the determinant: such places are on the curves at which solutions meet.

A spring with a free length takes K |d| off the energy, K its stiffness times that length and d between its ends, which
takes K (T . grad) |d| off E: a root, so that it is in no tree. The equations here are those without it, which exact
algebra solves where no spring has a free length; `ptmcad.certified.plain.problem` takes it off.

Source: elementary (Lagrange's condition in one dimension); no multiplier is among the unknowns. Where more degrees of
freedom are left there is no such vector, and `ptmcad.model.multipliers` has the equations.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from fractions import Fraction

from ptmcad.errors import ConfigError, ExpressionError, Faults
from ptmcad.model.closed import ClosedMechanism
from ptmcad.model.crossed import without_xjoints
from ptmcad.model.derivative import cofactors, derivative, determinant, negative, product, total
from ptmcad.model.description import Mechanism, Model
from ptmcad.model.elements import Closing, UnknownKind
from ptmcad.model.multipliers import stationary, tensions
from ptmcad.model.proofs import Points
from ptmcad.model.sizes import check_sizes
from ptmcad.model.work import split_moments
from ptmcad.text.tree import Number, Power, Tree

_TWO: Tree = Number(Fraction(2))
_HALF: Tree = Number(Fraction(1, 2))


def check_loops(mechanism: Mechanism, faults: Faults) -> None:
    """Note what is not computed with closed loops, by its key."""
    if not mechanism.closing:
        return
    free = len(mechanism.unknowns) - len(mechanism.closing)
    with faults:
        if free < 1:
            raise ConfigError("no degree of freedom is left: there have to be more unknowns than closing bars",
                              key="closing")  # fmt: skip
        if free > 1 and not mechanism.has_potential:
            raise ConfigError(
                "a moment depends on another unknown than its own: then closed loops are computed where they leave one "
                f"degree of freedom, not {free}",
                key="moments",
            )
    for n, spring in enumerate(mechanism.springs if free > 1 else (), 1):
        with faults:
            if not (isinstance(spring.free, Number) and spring.free.value == 0):
                raise ConfigError(
                    f"free lengths in closed loops are computed where these leave one degree of freedom, not {free}",
                    key=f"springs.{n}.free",
                )
    with faults:
        if mechanism.symmetries:
            raise ConfigError("symmetries are not used in closed loops: leave them out", key="symmetries")


def check_closing(mechanism: Mechanism, faults: Faults) -> None:
    """Note each closing bar between points whose distance no unknown changes, and one that is listed twice."""
    points = Points(mechanism)
    known: dict[frozenset[str], int] = {}
    for n, closing in enumerate(mechanism.closing, 1):
        with faults:
            first = known.setdefault(frozenset((closing.start, closing.end)), n)
            if first < n:
                raise ConfigError(f"number {first} is a bar between the same points", key=f"closing.{n}.between")
            if not points.moves(closing.start, closing.end):
                raise ConfigError(
                    f"the distance of {closing.start} and {closing.end} is constant, so that a bar between them closes "
                    "no loop",
                    key=f"closing.{n}.between",
                )


def equations_of_loops(model: Mechanism) -> Model:
    """The equations of the equilibria of a mechanism with closed loops or X-joints.

    Raises
    ------
    ConfigError
        When these may have too many terms.
    """
    if model.xjoints:
        return without_xjoints(model)
    conditions = [_condition(model, closing) for closing in model.closing]
    names = (*model.angles, *model.reals)
    forces = _forces(model, names)
    further: dict[str, UnknownKind] = {}
    tangent: tuple[Tree, ...] = ()
    if len(names) > len(conditions) + 1:
        further = tensions(model)
        equations, stability = stationary(forces, conditions, names, tuple(further))
    else:
        rows = [[derivative(g, name) for name in names] for g in conditions]
        tangent = cofactors(rows)
        slope = total(*(product(t, f) for t, f in zip(tangent, forces, strict=True)))
        equations = (*conditions, slope)
        stability = (determinant([*rows, [derivative(slope, name) for name in names]]),)
    found = ClosedMechanism(
        model.name, model.parameters, {**model.unknowns, **further}, equations, stability=stability, mechanism=model,
        tangent=tangent, multipliers=tuple(further), source=model.source, title=model.title,
    )  # fmt: skip
    sizes = Faults()
    try:
        check_sizes(replace(found, stability=()) if further else found, sizes)
        sizes.check()
    except (ConfigError, ExpressionError) as error:
        raise ConfigError(f"with their loops closed {error.message}", key="closing") from error
    return found


def _condition(mechanism: Mechanism, closing: Closing) -> Tree:
    """Zero where the bar has its length."""
    return total(_squared(mechanism, closing.start, closing.end), negative(Power(closing.length, _TWO)))


def _squared(mechanism: Mechanism, start: str, end: str) -> Tree:
    return total(
        *(
            Power(total(b, negative(a)), _TWO)
            for a, b in zip(mechanism.points[start], mechanism.points[end], strict=True)
        )
    )


def _forces(mechanism: Mechanism, names: Sequence[str]) -> list[Tree]:
    """The energy's derivatives by the unknowns, less the moments that are in no energy."""
    parts = [
        *(product(_HALF, s.stiffness, _squared(mechanism, s.start, s.end)) for s in mechanism.springs),
        *(t.energy for t in mechanism.torsion),
        *(
            negative(product(force, place))
            for load in mechanism.loads
            for force, place in zip((load.x, load.y), mechanism.points[load.point], strict=True)
        ),
        *split_moments(mechanism).energies,
    ]
    energy = total(*parts)
    steady: Mapping[str, Tree] = {m.unknown: m.value for m in split_moments(mechanism).steady}
    return [total(derivative(energy, name), *([negative(steady[name])] if name in steady else ())) for name in names]
