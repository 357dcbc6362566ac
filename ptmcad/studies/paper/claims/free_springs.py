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
from ptmcad.answer.regionmap import RegionMap, Status
from ptmcad.ask.classification import classify
from ptmcad.ask.location import locate
from ptmcad.errors import ConfigError
from ptmcad.studies.paper import printed
from ptmcad.studies.paper.claim import Fact, Finding
from ptmcad.studies.paper.claims.extensions import (
    AT_ELIMINATED,
    ELIMINATED,
    TWELVE,
    TWENTY_SIX,
    design_text,
    elimination,
    equilibria_with,
    signed_solutions_with,
)
from ptmcad.studies.paper.free_potential import LENGTHS, derivative, engine_gradient, l0, squared_lengths
from ptmcad.studies.paper.squaring.equations import squared_equations
from ptmcad.studies.paper.symbolic import F3, F4, VERTICAL, Expr, coordinates, equal, potential, vanishes
from ptmcad.studies.slices import ptm_slice

LOADED = tuple(Fraction(x) for x in ("1/4", "2"))
"""rho, beside that of `ELIMINATED`, for which its other values are eliminated too."""
WITHOUT_LOADS = tuple(Fraction(x) for x in ("1/2", "5/4", "2"))
"""rho for which the same design is eliminated without loads."""
PRINTED_ROOTS = (12, 30)

_MAPS: Mapping[str, tuple[Mapping[str, str], Mapping[str, tuple[str, str]]]] = {
    "l0 = 1/20": ({"l0": "1/20"}, {"rho": ("1/4", "2"), "L2": ("0", "2")}),
    "L2 = 3/2": ({"L2": "3/2"}, {"rho": ("1/4", "5/4"), "l0": ("0", "1/4")}),
}
"""The plane of fig. 4 with a free length, and the free length against the input; `ELIMINATED` is in the second."""
TOLERANCE = Fraction(1, 10)
"""The undetermined share of a window at which a map is fine enough."""


def _work() -> Expr:
    at = coordinates()
    return F3 * at["A3"][1] + F4 * at["A4"][1]


def potential_17() -> Finding:
    whole = printed.potential_17(LENGTHS, l0, _work())
    roots = {length: sp.sqrt(square) for length, square in zip(LENGTHS, squared_lengths(), strict=True)}
    without = equal(sp.expand(whole.subs(l0, 0)).subs(roots), potential().subs(VERTICAL))
    clear = LENGTHS[0] * LENGTHS[1] * LENGTHS[2]
    follows = tuple(
        vanishes(sp.expand((derivative(whole, n) - g.subs(VERTICAL)) * clear))
        for n, g in enumerate(engine_gradient(), 1)
    )
    odd = sp.Poly(whole, *LENGTHS).coeff_monomial(LENGTHS[0])
    return Finding(
        without and all(follows),
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


def twelve_to_thirty() -> Finding:
    found = real_roots()
    low, high = PRINTED_ROOTS
    inside = {name: n for name, n in found.items() if low <= n <= high}
    outside = {name: n for name, n in found.items() if not low <= n <= high}
    listed = "; ".join(f"{n} at {name}" for name, n in found.items())
    least, most = min(found.values()), max(found.values())
    return Finding(
        not outside,
        {"real roots": tuple(found.values()), "within 12 to 30": tuple(inside.values())},
        corrected=bool(inside) and bool(outside),
        said={
            "listed": listed,
            "least": least,
            "most": most,
            "number": len(found),
            "inside": len(inside),
            "witness": "; ".join(f"{n} real roots at {name}" for name, n in outside.items()),
        },
    )


def acceptable() -> Finding:
    sentences, facts = [], dict[str, Fact]()
    slack = loose = 0
    for design in (AT_ELIMINATED, TWELVE, TWENTY_SIX):
        poses = equilibria_with(design)
        stable = [e for e in poses if e.stable]
        stable_slack = sum(e.tense is False for e in stable)
        unstable_tense = sum(e.tense is True and not e.stable for e in poses)
        slack, loose = slack + stable_slack, loose + unstable_tense
        sentences.append(
            f"at {design_text(design)}, of {len(poses)} equilibria {len(stable)} are stable, "
            f"{stable_slack} of these with a spring shorter than l0; {unstable_tense} unstable ones have all springs "
            "longer than l0"
        )
        facts[f"rho = {design[0]}"] = (len(stable), stable_slack, unstable_tense)
    return Finding(slack > 0 and loose > 0, facts, said={"designs": tuple(sentences)})


@lru_cache(maxsize=len(_MAPS))
def certified(name: str) -> RegionMap:
    """The certified map of one of the slices with free lengths."""
    parameters, axes = _MAPS[name]
    slice = ptm_slice("free", axes, L1=1, k=100, F3=-10, F4=-10, **parameters)
    return classify(slice, tolerance=TOLERANCE, count="stable")


def difficult() -> Finding:
    try:
        import_module("ptmcad.certified.compiled")
    except ConfigError as missing:
        return Finding(False, {}, missing=f"the map that decides it cannot be computed here: {missing}")
    sentences, shares, counts = [], [], []
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
        sentences.append(
            f"{window} with L1 = 1, {name}, F3 = F4 = -10, k = 100: the number of stable equilibria is proved to be "
            f"{' or '.join(map(str, stable))} on all but {float(share):.2g} of the window"
        )
    rho, _, free, _ = ELIMINATED
    there = locate(certified("L2 = 3/2"), {"rho": rho, "l0": free}).stable
    solutions, poses = signed_solutions_with(AT_ELIMINATED), equilibria_with(AT_ELIMINATED)
    # all equilibria are among the proved ones, so the number of stable ones is exact
    alone = sum(e.stable for e in poses) if solutions.equilibria == len(poses) else -1
    seen = sorted({s for each in counts for s in each})
    facts: dict[str, Fact] = {
        "maps": len(_MAPS), "stable counts": tuple(seen), "fine enough": whole,
        "at the eliminated design": (-1 if there is None else there, alone),
    }  # fmt: skip
    # a forecast of effort is refuted by a classification; no number of failures would confirm it
    said = {"windows": tuple(sentences), "there": there, "alone": alone, "rho": rho, "free": free,
            "share": float(max(shares))}  # fmt: skip
    return Finding(False, facts, corrected=whole and there == alone and seen == [1, 2], said=said)
