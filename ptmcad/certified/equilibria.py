"""The equilibria of a slice's mechanism as a system in th1, th2, and what decides the kind of each.

Guarantee: the solutions are the zeros of E1 and E2 (with ``minima``, those with a Hessian that is not indefinite among
them); the formulas of the Jacobian are those of the Hessian.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from ptmcad.certified.formula import Formula, Graph
from ptmcad.certified.mechanism import Mechanism, cross, dot, mechanism
from ptmcad.certified.parameters import parameter_formulas
from ptmcad.certified.system import System, system
from ptmcad.certified.tape import Tape, record
from ptmcad.mechanism import ptm
from ptmcad.question.slice import Slice

TH1, TH2 = 2, 3
"""Numbers of the angles' variables."""
_STIFFNESS_AND_LOADS = ptm().stiffnesses + ptm().forces


@dataclass(frozen=True, slots=True, eq=False)
class Equilibria:
    """Systems and tapes for the equilibria at points of one slice; variables x, y, th1, th2.

    Attributes
    ----------
    all, minima : the systems that a search prunes with.
    equations : E1 = E2 = 0 alone.
    decisive : a tape of one stage with outputs P11, P22, D, l1 - l0_1, l2 - l0_2, l3 - l0_3.
    """

    all: System
    minima: System
    equations: System
    decisive: Tape


def unit_stiffness(values: Mapping[str, Formula]) -> dict[str, Formula]:
    """Stiffness and loads divided by k1, where that is a number: fewer and shorter operations."""
    unit = values["k1"]
    if unit.value is None:
        return dict(values)
    return {name: value / unit if name in _STIFFNESS_AND_LOADS else value for name, value in values.items()}


def slice_equilibria(slice: Slice, creases: tuple[bool, bool] = (False, False)) -> Equilibria:
    """The equilibria of a slice, or of its points with rho = L2, rho = L1; see `ptmcad.certified.mechanism`."""
    graph = Graph()
    values = unit_stiffness(parameter_formulas(graph, slice))
    m = mechanism(graph, values, graph.variable(TH1), graph.variable(TH2), creases=creases)
    h, there = m.hessian, m.at_equilibrium
    jacobian = ((h.p11, values["L2"] * h.q), (values["L1"] * h.q, h.p22))
    vanishing = (*m.dependent, *cone_test(m, values["k3"] * values["l0_3"]))
    return Equilibria(
        system(m.equilibrium, (TH1, TH2), (vanishing, ()), (), jacobian),
        system(m.equilibrium, (TH1, TH2), (vanishing, ()), (there.p11, there.p22, there.determinant), jacobian),
        system(m.equilibrium, (TH1, TH2), jacobian=jacobian),
        record(
            [[h.p11, h.p22, h.determinant, *(length - free for length, free in zip(m.lengths, m.free, strict=True))]]
        ),
    )


def cone_test(m: Mechanism, pull: Formula) -> tuple[Formula, ...]:
    """A smooth formula that vanishes at equilibria: that spring 3 pulls by no more and no less than ``pull`` = k3 l0_3.

    E1 = r1 - g.t1 and E2 = r2 - g.t2 with a vector g of this length. Solved for g: |g|^2 s12^2 = r1^2 + r2^2 + 2 r1 r2
    c12 = (r1 + c12 r2)^2 + s12^2 r2^2. Where spring 3 is short its direction is not known, but |g| is.
    """
    if pull.value == 0:
        return ()
    (r1, r2), (t1, t2) = m.residual, m.tangents
    c12, s12 = -dot(t1, t2), cross(t1, t2)
    return ((r1 + c12 * r2).squared() + s12.squared() * (r2.squared() - pull.squared()),)
