"""The curves of a slice at which counts change, as systems whose solutions project to them.

Guarantee: each point of the window at which the chosen count changes lies on the projection of one of the curves.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from fractions import Fraction

import numpy as np

from ptmcad.certified.curve import Curve
from ptmcad.certified.formula import Formula, Graph, inverse_length, length
from ptmcad.certified.parameters import parameter_formulas, values_at
from ptmcad.certified.ptm.flat import FLAT, Turned, exchanged, flat_hessian, has_flat_mirror, unfolding
from ptmcad.certified.ptm.mirror import is_own_image, opening
from ptmcad.certified.ptm.statics import (
    PHI_UNIT,
    TH1,
    TH2,
    TURN,
    Angles,
    Hessian,
    Statics,
    present,
    slice_statics,
    statics,
)
from ptmcad.certified.scales import axis_weights
from ptmcad.certified.solved import quotients
from ptmcad.certified.system import system
from ptmcad.errors import DegenerateSliceError
from ptmcad.mechanism import ptm
from ptmcad.question.slice import Count, Slice

PHI = (TURN[0] / PHI_UNIT, TURN[1] / PHI_UNIT)
QUARTER = (0.0, 1.5708)
"""A little more than a quarter turn."""
SPRINGS = tuple(f"{spring.start}{spring.end}" for spring in ptm().springs)
"""The names of springs 1, 2 and 3 in words."""
SHORT_LENGTH = Fraction(1, 8)
"""Below this length of spring 3, as a part of L1, its direction is a variable of its own."""


def curves(slice: Slice, count: Count, without: frozenset[str] = frozenset()) -> tuple[Curve, ...]:
    """The curves at which ``count`` may change; docs/free-lengths-curves.md proves that no other is needed.

    Parameters
    ----------
    without : names of savings to switch off, of `ptmcad.question.savings`.
    """
    scale = np.array(axis_weights(slice, slice_statics(Graph(), slice).equilibrium))
    return tuple(
        replace(curve, weights=np.concatenate([scale, np.ones(len(curve.ranges))]))
        for curve in _CURVES[count](slice, without)
    )


def distance_from_degeneracy(slice: Slice, x: Fraction, y: Fraction) -> Fraction:
    """Small where the search takes long, which is best begun first: for small rho and bars of equal length."""
    values = values_at(slice, x, y)
    return values["rho"] + abs(values["L1"] - values["L2"])


def _stable(slice: Slice, without: frozenset[str]) -> Iterator[Curve]:
    stable = "folds-of-saddles" not in without
    if stable and "mirror-images" not in without and is_own_image(slice):
        yield from _on_the_mirror(slice, without)
        yield _off_the_mirror(slice, without)
    elif stable and "mirror-images" not in without and has_flat_mirror(slice):
        yield from _flat(slice)
        yield from _unflat(slice, without)
    else:
        yield from _folds(slice, without, stable=stable)
    if "cones-and-creases" in without:
        yield from _cone(slice, without)
        yield from _creases(slice)


def _all(slice: Slice, without: frozenset[str]) -> Iterator[Curve]:
    yield from _folds(slice, without, stable=False)
    yield from _cone(slice, without)
    yield from _creases(slice)


def _folds(slice: Slice, without: frozenset[str], *, stable: bool) -> Iterator[Curve]:
    """Where D = 0; with spring 3 short and long apart, since D and the derivatives of E1, E2 have a pole at l3 = 0."""
    name = "fold of a stable equilibrium" if stable else "fold"
    reason = "a minimum meets a saddle: det H = 0 with nonnegative diagonal" if stable else "equilibria meet: det H = 0"
    factored = "unloaded-factor" not in without
    graph = Graph()
    m = slice_statics(graph, slice, factored=factored)
    there = m.at_equilibrium
    short = SHORT_LENGTH * parameter_formulas(graph, slice)["L1"]
    # unloaded, a stable configuration with spring 3 short is distinguished from the multiples without phi
    split = m.unit is not None and not (stable and m.unloaded)
    e1, e2 = m.equilibrium
    balance, singular = m.unloaded or (e2, m.hessian.determinant)
    yield Curve(
        name,
        reason,
        system(
            [e1, balance, singular],
            (0, 1, 2, 3),
            _dependent(
                without,
                [e2, *m.dependent, *present(m.unit)],
                [there.determinant, m.turned, *([] if stable else [there.levelled])],
            ),
            [*([m.lengths[2] - short] if split else []), *(_semidefinite(m) if stable else [])],
            solved=quotients([e1, e2, balance, *m.dependent], _statical(slice)),
        ),
        (TURN, TURN),
    )
    if not split:
        return
    graph = Graph()
    m = slice_statics(graph, slice, phi=True, factored=factored)
    there = m.at_equilibrium
    short = SHORT_LENGTH * parameter_formulas(graph, slice)["L1"]
    yield Curve(
        f"{name} with spring {SPRINGS[2]} short",
        f"{reason}; l3 is at most {SHORT_LENGTH} L1",
        system(
            [*present(m.aligned), *m.equilibrium, m.hessian.determinant_times_l3],
            (0, 1, 2, 3, 4),
            _dependent(
                without,
                [*m.dependent, *present(m.unit)],
                [there.determinant_times_l3, *([m.turned] if stable else [there.levelled])],
            ),
            [m.lengths[2], short - length(*m.vectors[2]), *(_semidefinite(m) if stable else [])],
            solved=quotients([*m.equilibrium, *m.dependent], _statical(slice)),
        ),
        (TURN, TURN, PHI),
    )


def _on_the_mirror(slice: Slice, without: frozenset[str]) -> Iterator[Curve]:
    """Folds of minima with th1 = th2, where the Hessian is diagonal in s = (th1 + th2)/2 and d = (th1 - th2)/2."""
    for pitchfork in (False, True):
        graph = Graph()
        values, s = parameter_formulas(graph, slice), graph.variable(TH1)
        m = statics(values, Angles(s, s))
        balance, there, bar = m.equilibrium[0], m.at_equilibrium, values["L1"]
        # U_ss and U_dd, over 2 L
        along = m.hessian.p11 + bar * m.hessian.q
        along_there, across_there = there.p11 + bar * there.q, there.p11 - bar * there.q
        across = -opening(values, m, s, graph.constant(1)).slope
        yield Curve(
            f"{'pitchfork' if pitchfork else 'fold'} of a stable equilibrium, th1 = th2",
            "a minimum parts with two others, or meets two saddles, that are each other's mirror images"
            if pitchfork
            else "a minimum meets a saddle, and both are their own mirror images",
            system(
                [balance, across if pitchfork else along],
                (0, 1, 2),
                _dependent(without, [], [across_there, m.turn] if pitchfork else [along_there]),
                [along_there, there.p11] if pitchfork else [across, m.turn, there.p11],
                solved=quotients([balance, across] if pitchfork else [balance], _statical(slice)),
            ),
            (TURN,),
        )


def _off_the_mirror(slice: Slice, without: frozenset[str]) -> Curve:
    """Folds of minima with th1 - th2 between 0 and pi, each for its mirror image too, by the energy u(s, cos d)."""
    graph = Graph()
    values, s, d = parameter_formulas(graph, slice), graph.variable(TH1), graph.variable(TH2)
    m = statics(values, Angles(s + d, s - d))
    (e1, e2), there, bar = m.equilibrium, m.at_equilibrium, values["L1"]
    slope, curvature = opening(values, m, s, d.cos())
    mixed = graph.derivative(slope, TH1)

    def determinant(h: Hessian) -> Formula:
        """u_ss u_ww - u_sw^2; without free lengths, where u_ww = 0, the root of that."""
        along = bar * (h.p11 + h.p22 + 2 * (bar * h.q))
        return mixed if curvature.value == 0 else along * curvature - mixed.squared()

    return Curve(
        "fold of a stable equilibrium, th1 != th2",
        "a minimum meets a saddle: det H = 0 with nonnegative diagonal; so do their mirror images",
        system(
            [e1 + e2, slope, determinant(m.hessian)],
            (0, 1, 2, 3),
            _dependent(
                without,
                [e1, e2, *m.dependent, *present(m.unit)],
                [there.determinant, m.turned, determinant(there)],
            ),
            [*_semidefinite(m), curvature],
            solved=quotients([e1, e2, e1 + e2, slope, *m.dependent], _statical(slice)),
        ),
        (TURN, QUARTER),
    )


def _flat(slice: Slice) -> Iterator[Curve]:
    """Folds of minima, mostly pitchforks, in flat configurations of the unloaded mechanism: explicit curves."""
    for flat in FLAT:
        graph = Graph()
        h = flat_hessian(parameter_formulas(graph, slice), flat)
        yield Curve(
            f"pitchfork of a stable equilibrium, cos th1 = {flat.c1}, cos th2 = {flat.c2}",
            "a flat minimum parts with two others, or meets two saddles, that are each other's mirror images",
            system([h.determinant], (0, 1), nonnegative=h.diagonal),
            (),
        )


def _unflat(slice: Slice, without: frozenset[str]) -> Iterator[Curve]:
    """Folds of minima of the unloaded mechanism that are not flat, each for its mirror image too.

    The torus is four squares around the flat configurations, and each of them two charts: of the angles from there
    either that of the first bar is larger or that of the second, which is the first one with the bars exchanged.
    """
    for flat in FLAT:
        for larger in (1, 2):
            graph = Graph()
            values, one = parameter_formulas(graph, slice), graph.constant(1)
            values = values if larger == 1 else exchanged(values)
            t, r = graph.variable(TH1), graph.variable(TH2)
            m = statics(values, Angles(Turned(flat.c1, one, t), Turned(flat.c2, one, r * t)))
            u = unfolding(values, tuple(inverse_length(*d) for d in m.vectors), flat, t, r)
            there = m.at_equilibrium
            yield Curve(
                f"fold of a stable equilibrium near cos th{larger} = {flat.c1}, cos th{3 - larger} = {flat.c2}",
                "a minimum meets a saddle: det H = 0 with nonnegative diagonal; so do their mirror images",
                system(
                    [u.u_v, u.g, u.determinant()],
                    (0, 1, 2, 3),
                    _dependent(
                        without,
                        [*m.equilibrium, *m.dependent, *present(m.unit)],
                        [there.determinant, m.turned],
                    ),
                    [*_semidefinite(m), u.u_vv, u.g_r],
                    solved=quotients([u.u_v, u.g, *m.equilibrium, *m.dependent], _statical(slice)),
                ),
                ((0.0, 1.0), (-1.0, 1.0)),
            )


def _statical(slice: Slice) -> list[int]:
    """The axes that the mechanism's geometry does not depend on: loads, stiffnesses and free lengths."""
    return [k for k in (0, 1) if not any(slice.parameters[name].uses(k) for name in ("rho", "L1", "L2"))]


def _semidefinite(m: Statics) -> list[Formula]:
    """What is at least zero where the Hessian is positive semidefinite, besides D."""
    return [m.at_equilibrium.p11, m.at_equilibrium.p22, m.turn, *m.at_equilibrium.diagonal_times_l3]


def _dependent(
    without: frozenset[str], cheap: list[Formula], costly: list[Formula]
) -> tuple[list[Formula], list[Formula]]:
    """Formulas that vanish where the equations do, unless they are not to be used."""
    return ([], []) if "dependent-equations" in without else (cheap, costly)


def _cone(slice: Slice, without: frozenset[str]) -> Iterator[Curve]:
    m = slice_statics(Graph(), slice, phi=True)
    if m.unit is not None:
        yield Curve(
            f"point where spring {SPRINGS[2]} has no length",
            "an equilibrium is swallowed where l3 = 0",
            system(
                [*m.vectors[2], *m.equilibrium],
                (0, 1, 2, 3, 4),
                _dependent(without, [*m.dependent, m.unit], []),
                solved=quotients([*m.equilibrium, *m.dependent], _statical(slice)),
            ),
            (TURN, TURN, PHI),
        )


def _creases(slice: Slice) -> Iterator[Curve]:
    graph = Graph()
    values = parameter_formulas(graph, slice)
    for spring, name, bar in ((1, SPRINGS[0], "L2"), (2, SPRINGS[1], "L1")):
        if values[f"l0_{spring}"].value != 0 and values[f"k{spring}"].value != 0:
            line = values["rho"].squared() - values[bar].squared()
            if line.value == 0:
                raise DegenerateSliceError(
                    f"rho = {bar} everywhere on this slice: spring {name} has no length in a configuration at "
                    "each point, so that total counts need not be constant in regions; --count stable has an answer"
                )
            yield Curve(
                f"crease where spring {name} has no length",
                f"spring {name} has no length on a circle",
                system([line], (0, 1)),
                (),
            )


def _admissible(slice: Slice, without: frozenset[str]) -> Iterator[Curve]:
    yield from _stable(slice, without)
    m = slice_statics(Graph(), slice)
    for spring, extent, free, vector in zip(SPRINGS, m.lengths, m.free, m.vectors, strict=True):
        third, dependent = (vector[0], [vector[1]]) if free.value == 0 else (extent - free, [])
        yield Curve(
            f"point where spring {spring} has its free length",
            f"spring {spring} of a stable equilibrium has its free length",
            system(
                [*m.equilibrium, third],
                (0, 1, 2, 3),
                _dependent(without, [*m.dependent, *dependent], []),
                [*_semidefinite(m), m.at_equilibrium.determinant, m.turned],
                solved=quotients([*m.equilibrium, *m.dependent], _statical(slice)),
            ),
            (TURN, TURN),
        )


_CURVES: dict[Count, Callable[[Slice, frozenset[str]], Iterator[Curve]]] = {
    Count.STABLE: _stable,
    Count.TOTAL: _all,
    Count.INDEX: _all,
    Count.ADMISSIBLE: _admissible,
}
