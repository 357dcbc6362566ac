"""The equilibria of a slice's mechanism as a system in th1, th2, and what decides the kind of each.

Guarantee: the solutions are the zeros of E1 and E2 (with ``minima``, those with a Hessian that is not indefinite among
them); the formulas of the Jacobian are those of the Hessian.
"""

from __future__ import annotations

from dataclasses import dataclass

from ptmcad.certified.formula import Graph
from ptmcad.certified.parameters import parameter_formulas
from ptmcad.certified.ptm.statics import TH1, TH2, Angles, present, statics
from ptmcad.certified.system import System, system
from ptmcad.certified.tape import Tape, record
from ptmcad.question.slice import Slice


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


def slice_equilibria(slice: Slice, creases: tuple[bool, bool] = (False, False)) -> Equilibria:
    """The equilibria of a slice, or of its points with rho = L2, rho = L1; see `ptmcad.certified.ptm.statics`."""
    graph = Graph()
    values = parameter_formulas(graph, slice)
    unit = values["k1"]
    if unit.value is not None:  # fewer and shorter operations
        values |= {name: values[name] / unit for name in slice.model.stiffnesses + slice.model.forces}
    m = statics(values, Angles(graph.variable(TH1), graph.variable(TH2), creases=creases))
    h, there = m.hessian, m.at_equilibrium
    jacobian = ((h.p11, values["L2"] * h.q), (values["L1"] * h.q, h.p22))
    vanishing = (*m.dependent, *present(m.pull))
    return Equilibria(
        system(m.equilibrium, (TH1, TH2), (vanishing, ()), (), jacobian),
        system(m.equilibrium, (TH1, TH2), (vanishing, ()), (there.p11, there.p22, there.determinant), jacobian),
        system(m.equilibrium, (TH1, TH2), jacobian=jacobian),
        record(
            [[h.p11, h.p22, h.determinant, *(length - free for length, free in zip(m.lengths, m.free, strict=True))]]
        ),
    )
