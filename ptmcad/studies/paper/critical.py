"""The free lengths at which equilibria are degenerate, all other parameters fixed, by algebra:
where folds are.

Guarantee, as far as msolve's answer is right: every real l0 != 0 at which some solution with
lengths of some signs is degenerate is enclosed, with the signs; poses with a length of zero are not
among them, they are no folds.

With v_i = 1/l_i of either sign, gradient and Hessian of the potential are polynomials. Solutions
come in pairs: l0 with signs s, and -l0 with signs -s. The number of equilibria also changes where
one is swallowed by the cone l3 = 0, which is no fold.
"""

from __future__ import annotations

import sympy as sp

from ptmcad.algebra.msolve import MsolveError, real_solutions
from ptmcad.studies.paper.squaring import NAMES, Design
from ptmcad.studies.paper.statements import (
    CIRCLES,
    HORIZONTAL,
    LENGTHS,
    gradient,
    hessian,
    k,
    l0,
    squares,
)
from ptmcad.text.enclosure import Enclosure

INVERSES = sp.symbols("v1 v2 v3")
UNKNOWNS = (*INVERSES, *CIRCLES[0], *CIRCLES[1], l0)


def critical_system(design: Design) -> tuple[str, ...]:
    """Polynomials in `UNKNOWNS` as text that vanish at the degenerate solutions; l0 of the design
    is left out.
    """
    at = {name: sp.Rational(x) for name, x in zip(NAMES, design, strict=True) if name != l0} | {
        k: 1
    }
    at |= dict.fromkeys(HORIZONTAL, 0)
    at |= {length: 1 / v for length, v in zip(LENGTHS, INVERSES, strict=True)}
    g1, g2, h11, h12, h22 = (e.subs(at) for e in (*gradient(), *hessian()))
    equations = [c**2 + s**2 - 1 for c, s in CIRCLES]
    equations += [v**2 * q.subs(at) - 1 for v, q in zip(INVERSES, squares(), strict=True)]
    equations += [g1, g2, h11 * h22 - h12**2]
    polynomials = (sp.Poly(e, *UNKNOWNS).clear_denoms()[1].primitive()[1] for e in equations)
    return tuple(str(p.as_expr()).replace("**", "^").replace(" ", "") for p in polynomials)


def critical_free_lengths(
    design: Design, timeout: float | None = None
) -> tuple[tuple[Enclosure, tuple[int, ...]], ...]:
    """All critical free lengths with the signs of l1, l2 and l3, ascending; those with positive
    signs are folds.

    Raises
    ------
    MsolveError
        When msolve is not there, takes longer than ``timeout`` seconds, or finds infinitely many
        solutions, as it does without loads where two poses are degenerate along a whole interval.
    """
    found = []
    for box in real_solutions([str(u) for u in UNKNOWNS], critical_system(design), timeout):
        if any(
            low <= 0 <= high for low, high in (*box[:3], box[-1])
        ):  # at l0 = 0 the signs have no meaning
            raise MsolveError("msolve's boxes do not settle a sign")
        found.append((Enclosure(*box[-1]), tuple(1 if low > 0 else -1 for low, _ in box[:3])))
    return tuple(sorted(found, key=lambda c: c[0].center))
