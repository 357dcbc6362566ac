"""What the claims of section 5.2 on springs with a free length rest on: elimination, `ptmcad.solve`, certified maps.

Guarantee: numbers of roots by exact elimination; equilibria by the certified engine, which proves each and that there
are no others; the maps leave open what was not proved. The paper gives no values for section 5.2, so the designs are
this program's own, and each is named in the evidence.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cache

from ptmcad.algebra.msolve import program
from ptmcad.answer.poses import Poses
from ptmcad.answer.regionmap import RegionMap, Status
from ptmcad.ask.classification import classify
from ptmcad.ask.location import locate
from ptmcad.studies.paper import statements
from ptmcad.studies.paper.claim import Values
from ptmcad.studies.paper.critical import critical_free_lengths
from ptmcad.studies.paper.squaring import Design, signed_solutions, squared
from ptmcad.studies.slices import ptm_slice
from ptmcad.text.parsing import rational

ELIMINATED: Design = ("7/10", "1", "3/2", "1/5", "-1/10", "-1/10")
"""At which the squared equations are eliminated."""
ZEROS = {"l1 = 0": [16, 0, 121], "l3 = 0": [-3, 0, 32]}
"""Polynomials in t2: where A4 is at A1 at the design, and as far from A1 as A3, so that the two may meet."""
PRINTED_ROOTS = (12, 30)

MAPS: Mapping[str, tuple[Mapping[str, str], Mapping[str, tuple[str, str]]]] = {
    "l0 = 1/20": ({"l0": "1/20"}, {"rho": ("1/4", "2"), "L2": ("0", "2")}),
    "L2 = 3/2": ({"L2": "3/2"}, {"rho": ("1/4", "5/4"), "l0": ("0", "1/4")}),
}
"""The plane of fig. 4 with a free length, and the free length against the input; `ELIMINATED` is in the second."""
TOLERANCE = "1/10"
"""The undetermined share of a window at which a map is fine enough."""


def equilibria(design: Sequence[str]) -> Poses:
    """All equilibria at a design, with k = 1."""
    return statements.equilibria(**dict(zip(("rho", "L1", "L2", "l0", "F3", "F4"), design, strict=True)), k="1")


def design_text(design: Sequence[str]) -> str:
    """A design with the names of its numbers."""
    return "(rho, L1, L2, l0, F3/k, F4/k) = (" + ", ".join(design) + ")"


def numbers(design: Sequence[str]) -> tuple[int, int, int, int, int]:
    """Equilibria; stable ones; of these tense ones and those with a shorter spring; tense ones that are not stable."""
    poses = equilibria(design).equilibria
    tense = [all(s.length.low > s.free_length for s in p.springs) for p in poses]
    slack = [any(s.length.high < s.free_length for s in p.springs) for p in poses]
    stable = [p.stable is True for p in poses]
    both = sum(a and b for a, b in zip(stable, tense, strict=True))
    short = sum(a and b for a, b in zip(stable, slack, strict=True))
    return len(poses), sum(stable), both, short, sum(tense) - both


def squared_degree() -> Values:
    equations = squared(ELIMINATED).equations
    total = tuple(int(p.total_degree()) for p in equations)
    degrees = tuple(tuple(map(int, p.degrees())) for p in equations)
    return {"printed": total == (28, 28), "total degrees": total, "degrees": degrees}


def eliminated_degree() -> Values:
    system, solutions = squared(ELIMINATED), signed_solutions(ELIMINATED)
    degree, circle = system.eliminated.degree(), system.circle
    factors = tuple((p.degree(), e) for p, e in system.factors)
    simple, left = dict((e, d) for d, e in factors).get(1, 0), degree - 2 * circle
    multiple = {name: sum(e for p, e in system.factors if p.coeffs() == zero) for name, zero in ZEROS.items()}
    return {
        "printed": (degree, circle, left) == (328, 56, 272),
        "corrected": (degree, circle, left) == (400, 48, 304) and simple == 256,
        "degree": degree,
        "exponent": circle,
        "left": left,
        "factors": tuple(map(str, factors)),
        "factors listed": ", ".join(map(str, factors)),
        "multiplicity of l1 = 0": multiple["l1 = 0"],
        "multiplicity of l3 = 0": multiple["l3 = 0"],
        "simple": simple,
        "complex solutions": len(solutions.solutions),
        "real solutions": solutions.real,
        "opposed": solutions.opposed,
        "unsettled": solutions.unsettled,
    }


def spurious() -> Values:
    real, solutions, poses = squared(ELIMINATED).real_roots, signed_solutions(ELIMINATED), equilibria(ELIMINATED)
    total = len(poses.equilibria)
    return {
        "printed": total == solutions.equilibria < real,
        "real roots": real,
        "real, any signs": solutions.real,
        "equilibria": total,
        "stable": poses.stable,
    }


def at_most_six(designs: Sequence[Sequence[str]]) -> Values:
    found = {design_text(d): numbers(d) for d in designs}
    sentences = tuple(
        f"at {name} {total} equilibria, each proved to be alone in a box, and no others; "
        f"{stable} of them stable, {tense} of these with every spring longer than l0"
        for name, (total, stable, tense, _, _) in found.items()
    )
    listed = ", ".join(f"{total} at {name}" for name, (total, *_) in found.items() if total > 6)
    # no number of designs can confirm the claim
    return {
        "designs": sentences,
        **{f"rho = {d[0]}": numbers(d)[:3] for d in designs},
        "witness": f"equilibria proved: {listed}" if listed else "",
    }


def acceptable(designs: Sequence[Sequence[str]]) -> Values:
    """Whether neither of stability and springs longer than l0 follows from the other."""
    found = {design_text(d): numbers(d) for d in designs}
    sentences = tuple(
        f"at {name}, of {total} equilibria {stable} are stable, {slack} of these with a spring shorter than l0; "
        f"{loose} unstable ones have all springs longer than l0"
        for name, (total, stable, _, slack, loose) in found.items()
    )
    return {
        "printed": any(n[3] for n in found.values()) and any(n[4] for n in found.values()),
        "designs": sentences,
        **{f"rho = {d[0]}": (numbers(d)[1], *numbers(d)[3:]) for d in designs},
    }


def real_roots(designs: Sequence[Design]) -> Mapping[str, int]:
    """How many different real roots the eliminated polynomial has, by design."""
    return {f"rho = {d[0]}, F3/k = F4/k = {d[4]}": squared(tuple(d)).real_roots for d in designs}


def twelve_to_thirty(designs: Sequence[Design]) -> Values:
    found = real_roots(designs)
    inside = [n for n in found.values() if PRINTED_ROOTS[0] <= n <= PRINTED_ROOTS[1]]
    outside = {name: n for name, n in found.items() if n not in inside}
    return {
        "printed": not outside,
        "corrected": bool(inside) and bool(outside),
        "real roots": tuple(found.values()),
        "within 12 to 30": tuple(inside),
        "listed": "; ".join(f"{n} at {name}" for name, n in found.items()),
        "least": min(found.values()),
        "most": max(found.values()),
        "number": len(found),
        "inside": len(inside),
        "witness": "; ".join(f"{n} real roots at {name}" for name, n in outside.items()),
    }


@cache
def certified(name: str) -> RegionMap:
    """The certified map of one of the slices with free lengths."""
    parameters, axes = MAPS[name]
    slice = ptm_slice("free", axes, L1=1, k=100, F3=-10, F4=-10, **parameters)
    return classify(slice, tolerance=TOLERANCE, count="stable")


def difficult() -> Values:
    """Maps that are made here: a forecast of effort is refuted by a classification."""
    maps = {name: certified(name) for name in MAPS}
    counts = {name: sorted({r.stable for r in m.regions if r.stable is not None}) for name, m in maps.items()}
    fine = all(
        m.status is Status.CERTIFIED and all(r.stable is not None for r in m.regions)
        and m.undetermined <= rational(TOLERANCE)
        for m in maps.values()
    )  # fmt: skip
    sentences = [
        ", ".join(f"{axis} in [{low}, {high}]" for axis, (low, high) in MAPS[name][1].items())
        + f" with L1 = 1, {name}, F3 = F4 = -10, k = 100: the number of stable equilibria is proved to be "
        f"{' or '.join(map(str, counts[name]))} on all but {float(m.undetermined):.2g} of the window"
        for name, m in maps.items()
    ]
    if program() is not None:
        folds = [free.text(6) for free, signs in critical_free_lengths(ELIMINATED) if signs == (1, 1, 1)]
        sentences.append(f"along l0 at rho = 7/10, L2 = 3/2 elimination by msolve finds folds at {', '.join(folds)}")
    there = locate(maps["L2 = 3/2"], {"rho": ELIMINATED[0], "l0": ELIMINATED[3]}).stable
    alone, eliminated = equilibria(ELIMINATED), signed_solutions(ELIMINATED).equilibria
    agreed = there == alone.stable and len(alone.equilibria) == eliminated
    seen = sorted({n for each in counts.values() for n in each})
    return {
        "corrected": fine and agreed and seen == [1, 2],
        "maps": tuple(sentences),
        "stable counts": tuple(seen),
        "fine enough": fine,
        "at the eliminated design": (there, alone.stable, eliminated),
        "there": there,
        "share": max(float(m.undetermined) for m in maps.values()),
    }
