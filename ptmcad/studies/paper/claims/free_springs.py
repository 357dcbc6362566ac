"""The claims of section 5.2 that single designs and certified maps decide: (17), real roots, tense springs, effort.

Guarantee: (17) by identities in all parameters; numbers of real roots by exact elimination; poses by boxes of ball
arithmetic with one equilibrium each; the maps' counts by the certified engine, which leaves open what it cannot prove.

The paper gives no values for section 5.2, so the designs are this program's own, and each is named in the evidence.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from functools import lru_cache
from importlib import import_module

import sympy as sp

from ptmcad.algebra.elimination import eliminate
from ptmcad.algebra.squared import squared_equations
from ptmcad.answer.regionmap import RegionMap, Status
from ptmcad.ask.classification import classify
from ptmcad.ask.location import locate
from ptmcad.errors import ConfigError
from ptmcad.question.config import slice_from_mapping
from ptmcad.studies.paper import printed
from ptmcad.studies.paper.claim import Claim, Outcome, judge, unchecked
from ptmcad.studies.paper.claims.extensions import (
    AT_ELIMINATED,
    ELIMINATED,
    TWELVE,
    TWENTY_SIX,
    elimination,
    equilibria_with,
    signed_solutions_with,
)
from ptmcad.studies.paper.free_potential import LENGTHS, derivative, engine_gradient, l0, squared_lengths
from ptmcad.studies.paper.symbolic import F3, F4, VERTICAL, Expr, coordinates, equal, potential, vanishes

LOADED = tuple(Fraction(x) for x in ("1/4", "2"))
"""rho, beside that of `ELIMINATED`, for which its other values are eliminated too."""
WITHOUT_LOADS = tuple(Fraction(x) for x in ("1/2", "5/4", "2"))
"""rho for which the same design is eliminated without loads."""
PRINTED_ROOTS = (12, 30)

_FIXED: Mapping[str, str | int] = {"L1": 1, "k": 100, "F3": -10, "F4": -10}
_MAPS: Mapping[str, tuple[Mapping[str, str | int], Mapping[str, list[str]]]] = {
    "l0 = 1/20": ({"l0": "1/20"}, {"rho": ["1/4", "2"], "L2": ["0", "2"]}),
    "L2 = 3/2": ({"L2": "3/2"}, {"rho": ["1/4", "5/4"], "l0": ["0", "1/4"]}),
}
"""The plane of fig. 4 with a free length, and the free length against the input; `ELIMINATED` is in the second."""
TOLERANCE = Fraction(1, 10)
"""The undetermined share of a window at which a map is fine enough."""


def _work() -> Expr:
    at = coordinates()
    return F3 * at["A3"][1] + F4 * at["A4"][1]


def potential_17() -> Outcome:
    whole = printed.potential_17(LENGTHS, l0, _work())
    roots = {length: sp.sqrt(square) for length, square in zip(LENGTHS, squared_lengths(), strict=True)}
    without = equal(sp.expand(whole.subs(l0, 0)).subs(roots), potential().subs(VERTICAL))
    clear = LENGTHS[0] * LENGTHS[1] * LENGTHS[2]
    follows = tuple(
        vanishes(sp.expand((derivative(whole, n) - g.subs(VERTICAL)) * clear))
        for n, g in enumerate(engine_gradient(), 1)
    )
    odd = sp.Poly(whole, *LENGTHS).coeff_monomial(LENGTHS[0])
    return judge(
        without and all(follows),
        (
            "with l0 = 0 (17) is the potential of the model without free lengths",
            "its derivatives by th1 and th2 are, for all parameters, the equations that the certified engine solves; "
            "these were translated from the formulas that it evaluates",
            f"the odd powers of the lengths, which keep the square roots, are {odd} times l1 + l2 + l3: none for "
            "l0 = 0",
        ),
        {"(1) for l0 = 0": without, "derivatives": tuple(map(int, follows)), "coefficient of l1": str(odd)},
    )


@lru_cache(maxsize=1)
def real_roots() -> Mapping[str, int]:
    """How many different real roots the eliminated polynomial has, by design."""
    rho, _, _, loads = ELIMINATED
    found = {f"rho = {rho}, F3/k = F4/k = {loads[0]}": elimination().real_roots}
    for base in LOADED:
        found[f"rho = {base}, F3/k = F4/k = {loads[0]}"] = _roots_at(base, loads)
    for base in WITHOUT_LOADS:
        found[f"rho = {base}, F3 = F4 = 0"] = _roots_at(base, (Fraction(0), Fraction(0)))
    return found


def _roots_at(base: Fraction, loads: tuple[Fraction, Fraction]) -> int:
    _, rods, free, _ = ELIMINATED
    return eliminate(*squared_equations(base, rods, free, loads)).real_roots


def twelve_to_thirty() -> Outcome:
    found = real_roots()
    low, high = PRINTED_ROOTS
    inside = {name: n for name, n in found.items() if low <= n <= high}
    outside = {name: n for name, n in found.items() if not low <= n <= high}
    listed = "; ".join(f"{n} at {name}" for name, n in found.items())
    least, most = min(found.values()), max(found.values())
    return judge(
        not outside,
        (
            f"exactly, with L1 = 1, L2 = 3/2, l0 = 1/5, different real roots: {listed}",
            "the paper does not give the values at which it saw 12 to 30 real solutions, so what it saw is not "
            "contradicted: such numbers occur, but they are no bounds",
        ),
        {"real roots": tuple(found.values()), "within 12 to 30": tuple(inside.values())},
        corrected=bool(inside) and bool(outside),
        right=f"the number depends on the design: from {least} to {most} at the {len(found)} designs computed, within "
        f"12 to 30 at {len(inside)} of them",
        witness="; ".join(f"{n} real roots at {name}" for name, n in outside.items()),
    )


def acceptable() -> Outcome:
    evidence, facts = [], {}
    slack = loose = 0
    for design in (AT_ELIMINATED, TWELVE, TWENTY_SIX):
        poses = equilibria_with(design)
        stable = [e for e in poses if e.stable]
        stable_slack = sum(e.tense is False for e in stable)
        unstable_tense = sum(e.tense is True and not e.stable for e in poses)
        slack, loose = slack + stable_slack, loose + unstable_tense
        text = ", ".join(design)
        evidence.append(
            f"at (rho, L1, L2, l0, F3/k, F4/k) = ({text}), of {len(poses)} equilibria {len(stable)} are stable, "
            f"{stable_slack} of these with a spring shorter than l0; {unstable_tense} unstable ones have all springs "
            "longer than l0"
        )
        facts[f"rho = {design[0]}"] = (len(stable), stable_slack, unstable_tense)
    return judge(
        slack > 0 and loose > 0,
        (*evidence, "so neither of the two conditions follows from the other, and both have to be verified"),
        facts,
    )


@lru_cache(maxsize=len(_MAPS))
def certified(name: str) -> RegionMap:
    """The certified map of one of the slices with free lengths."""
    parameters, axes = _MAPS[name]
    record = {"name": "free", "mechanism": "ptm", "parameters": {**_FIXED, **parameters}, "axes": axes,
              "count": "stable"}  # fmt: skip
    return classify(slice_from_mapping(record), tolerance=TOLERANCE)


def difficult() -> Outcome:
    try:
        import_module("ptmcad.certified.compiled")
    except ConfigError as missing:
        return unchecked(f"the map that decides it cannot be computed here: {missing}")()
    evidence, shares, counts = [], [], []
    whole = True
    for name, (_, axes) in _MAPS.items():
        found = certified(name)
        share = found.undetermined
        stable = tuple(sorted({r.stable for r in found.regions if r.stable is not None}))
        proved = found.status is Status.CERTIFIED and all(r.stable is not None for r in found.regions)
        whole = whole and proved and share <= TOLERANCE
        shares.append(share)
        counts.append(stable)
        window = ", ".join(f"{axis} in [{low}, {high}]" for axis, (low, high) in axes.items())
        evidence.append(
            f"{window} with L1 = 1, {name}, F3 = F4 = -10, k = 100: the number of stable equilibria is proved to be "
            f"{' or '.join(map(str, stable))} on all but {float(share):.2g} of the window"
        )
    rho, _, free, _ = ELIMINATED
    there = locate(certified("L2 = 3/2"), {"rho": rho, "l0": free}).stable
    solutions, poses = signed_solutions_with(AT_ELIMINATED), equilibria_with(AT_ELIMINATED)
    # all equilibria are among the proved ones, so the number of stable ones is exact
    alone = sum(e.stable for e in poses) if solutions.equilibria == len(poses) else -1
    evidence.append(
        f"at rho = {rho}, l0 = {free} the second map says {there} stable, and elimination finds {alone}: two ways "
        "that share no code"
    )
    seen = sorted({s for each in counts for s in each})
    return judge(
        False,  # a forecast of effort is refuted by a classification; no number of failures would confirm it
        tuple(evidence),
        {
            "maps": len(_MAPS), "stable counts": tuple(seen), "fine enough": whole, "at the eliminated design":
            (there if there is not None else -1, alone),
        },
        corrected=whole and there == alone and seen == [1, 2],
        right="branch and prune in interval arithmetic classifies such slices within this run, with proved counts on "
        f"all but {float(max(shares)):.2g} of each window; it encloses the curves and does not compute them",
    )  # fmt: skip


CLAIMS = (
    Claim("5.2-eq17", "5.2", "Eq. (1) becomes", "Equation (17), the potential with free lengths.", potential_17),
    Claim("5.2-real", "5.2", "12 to 30 real solutions", "The eliminated polynomial has 12 to 30 real roots.",
          twelve_to_thirty),
    Claim("5.2-acceptable", "5.2", "verified to be greater than l0",
          "Whether all springs are longer than l0 has to be verified in addition to stability.", acceptable),
    Claim("5.2-difficult", "5.2", "a classification study as in the case l0 = 0 will be difficult",
          "A classification with free lengths takes long.", difficult),
)  # fmt: skip
