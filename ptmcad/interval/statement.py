"""What a certified map says of its problem: the equations as text, and the plan.

Guarantee: the potential is that of `ptmcad.interval.mechanism`, in the names of problem records.
"""

from __future__ import annotations

from collections.abc import Sequence

from ptmcad.interval.curves import Curve
from ptmcad.interval.plan import beforehand
from ptmcad.regionmap import PlanStep, System
from ptmcad.slice import Slice

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


def plan_of(slice: Slice, curves: Sequence[Curve], keep: frozenset[str] = frozenset()) -> tuple[PlanStep, ...]:
    """What the certified engine does for a slice and what it leaves out.

    Parameters
    ----------
    keep : savings that were switched off.
    """
    return (
        *beforehand(slice, keep),
        *(
            PlanStep(curve.name, True, f"enclosed by branch and prune in {len(curve.system.unknowns)} unknowns")
            for curve in curves
        ),
    )
