"""What a certified map says of its problem: the equations as text, and the plan.

Guarantee: the potential is that of `ptmcad.interval.mechanism`, in the names of problem records.
"""

from __future__ import annotations

from collections.abc import Sequence

from ptmcad.interval.curves import Curve
from ptmcad.regionmap import PlanStep, System
from ptmcad.slice import FREE_LENGTHS, Slice

_VECTORS = (
    ("rho - L2*cos(th2)", "L2*sin(th2)"),
    ("rho - L1*cos(th1)", "L1*sin(th1)"),
    ("rho - L1*cos(th1) - L2*cos(th2)", "L2*sin(th2) - L1*sin(th1)"),
)


def system_text() -> System:
    """The mechanism's potential with square roots; gradient and Hessian are its derivatives by the unknowns."""
    springs = [f"1/2*k{n}*(sqrt(({x})^2 + ({y})^2) - l0_{n})^2" for n, (x, y) in enumerate(_VECTORS, 1)]
    work = "F3x*L1*cos(th1) - F3*L1*sin(th1) - F4x*(rho - L2*cos(th2)) - F4*L2*sin(th2)"
    return System(("th1", "th2"), (), " + ".join(springs) + " - " + work, (), ())


def plan_of(slice: Slice, curves: Sequence[Curve]) -> tuple[PlanStep, ...]:
    """What the certified engine does for a slice and what it leaves out."""
    absent = [name for name in FREE_LENGTHS if name not in slice.parameters or not slice.parameters[name].numerator]
    zero = [n for n, e in slice.parameters.items() if e.is_constant and e.constant() == 0 and n not in FREE_LENGTHS]
    steps = []
    if zero or absent:
        steps.append(PlanStep("terms of " + ", ".join([*zero, *absent]), False, "they are zero on this slice"))
    steps.append(PlanStep("discriminant variety", False, "its degree is out of reach when springs have free lengths"))
    for curve in curves:
        n = len(curve.system.unknowns)
        steps.append(PlanStep(curve.name, True, f"enclosed by branch and prune in {n} unknowns"))
    if slice.count.value == "stable":
        steps.append(PlanStep("folds of saddles and maxima", False, "the number of stable equilibria does not change"))
    return tuple(steps)
