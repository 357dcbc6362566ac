"""The quotient at a rational point, its basis computed by the means that is predicted to end: ours,
or msolve.

Guarantee: exact, whatever msolve answers. Its basis is used after a proof that it is one of the
ideal of the equations (`ptmcad.algebra.msolve`); else a `PtmcadWarning` says what was wrong, and
the basis is computed as if msolve were not there. What asks msolve is loaded when it is asked.
"""

from __future__ import annotations

import warnings
from collections.abc import Sequence

from ptmcad.algebra.fibre_algebra import (
    FibreAlgebra,
    WorkLimit,
    bezout_bound,
    own_quotient,
)
from ptmcad.algebra.membership import RationalPolynomial
from ptmcad.errors import LimitReached, PtmcadWarning

MANY = 128
"""Solutions by Bezout's theorem, from which on a basis may not end by Buchberger's algorithm."""
SMALL = WorkLimit(1_000, 120, 400, 4_000)
"""Of such a system our own basis is tried up to this size, some tenths of a second."""
SECONDS = 120.0
"""For msolve, and as many again for the proof."""
MISSING = "msolve may compute it: pip install 'ptmcad[large]'"


def is_large(equations: Sequence[RationalPolynomial]) -> bool:
    """Whether the bound for the number of solutions says that the basis may be out of our own
    algorithm's reach.
    """
    return bezout_bound(equations) >= MANY


def plan_text(bound: int) -> str:
    """Whose bases are used at points, by the bound for the number of solutions; nothing where they
    are small.
    """
    if bound < MANY:
        return ""
    from ptmcad.algebra import msolve

    then = (
        "then by msolve, each proved" if msolve.program() else f"then as far as it goes: {MISSING}"
    )
    return f"up to {bound} solutions: by ptmcad while small, {then}"


def quotient(
    equations: Sequence[RationalPolynomial], unknowns: int, most: WorkLimit | None = None
) -> FibreAlgebra | None:
    """The quotient by the given equations; None when there are infinitely many complex solutions.

    Parameters
    ----------
    most : how much work our own basis may be; msolve is asked beyond where ``most.by_msolve``
        solutions are allowed.

    Raises
    ------
    LimitReached
        When it is more work than `most`, and msolve is missing, its basis is not proved, or is too
        large.
    """
    if not is_large(equations) or (most is not None and not most.by_msolve):
        return own_quotient(equations, unknowns, most)
    try:
        return own_quotient(equations, unknowns, SMALL if most is None else most)
    except LimitReached:
        largest = None if most is None else most.by_msolve
    from ptmcad.algebra import msolve

    if msolve.program() is None:
        what = "the basis of the equations at the point grows beyond what ptmcad computes quickly"
        if most is not None:
            raise LimitReached(f"{what}; {MISSING}")
        warnings.warn(f"{what}, and may take very long; {MISSING}", PtmcadWarning, stacklevel=2)
        return own_quotient(equations, unknowns)
    try:
        return msolve.quotient_by_msolve(equations, unknowns, SECONDS, largest)
    except msolve.MsolveError as error:
        warnings.warn(f"{error}; its basis is not used", PtmcadWarning, stacklevel=2)
    if most is not None:
        raise LimitReached("the basis of the equations grows beyond what is counted at once")
    return own_quotient(equations, unknowns)
