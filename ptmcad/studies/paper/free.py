"""What the claims of section 5.2 on springs with a free length rest on: elimination,
`ptmcad.solve`, certified maps.

Guarantee: numbers of roots by exact elimination; equilibria by the certified engine, which proves
each and that there are no others; the maps leave open what was not proved. The paper gives no
values for section 5.2, so the designs are this program's own, and each is named in the evidence.
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
from ptmcad.studies.paper.claim import Facts
from ptmcad.studies.paper.critical import Design, critical_free_lengths, signed_solutions, squared
from ptmcad.text.parsing import rational

ELIMINATED: Design = ("7/10", "1", "3/2", "1/5", "-1/10", "-1/10")
"""At which the squared equations are eliminated."""
ZEROS = {"l1 = 0": [16, 0, 121], "l3 = 0": [-3, 0, 32]}
"""Polynomials in t2: where A4 is at A1 at the design, and as far from A1 as A3, so that the two may
meet.
"""

MAPS = {
    "l0 = 1/20": (
        "rho in [1/4, 2], L2 in [0, 2]",
        {"l0": "1/20"},
        {"rho": ("1/4", "2"), "L2": ("0", "2")},
    ),
    "L2 = 3/2": (
        "rho in [1/4, 5/4], l0 in [0, 1/4]",
        {"L2": "3/2"},
        {"rho": ("1/4", "5/4"), "l0": ("0", "1/4")},
    ),
}
"""The plane of fig. 4 with a free length, and the free length against the input; `ELIMINATED` is in
the second.
"""
TOLERANCE = "1/10"
"""The undetermined share of a window at which a map is fine enough."""


def equilibria(design: Sequence[str]) -> Poses:
    """All equilibria at a design, with k = 1."""
    return statements.equilibria(
        **dict(zip(("rho", "L1", "L2", "l0", "F3", "F4"), design, strict=True)), k="1"
    )


def elimination() -> Facts:
    """What elimination leaves at the design, and how many of its roots are equilibria, which takes
    no engine.
    """
    system, solutions = squared(ELIMINATED), signed_solutions(ELIMINATED)
    factors = [(p.degree(), e) for e, p in system.factors.items()]
    return {
        "total degrees": tuple(int(p.total_degree()) for p in system.equations),
        "degrees": tuple(tuple(map(int, p.degrees())) for p in system.equations),
        "degree": system.degree,
        "exponent": system.circle,
        "left": system.degree - 2 * system.circle,
        "factors": ", ".join(map(str, factors)),
        "simple": sum(degree for degree, e in factors if e == 1),
        **{
            f"multiplicity of {name}": sum(
                e for e, p in system.factors.items() if p.coeffs() == zero
            )
            for name, zero in ZEROS.items()
        },
        "complex solutions": len(solutions.solutions),
        "real solutions": solutions.real,
        "opposed": solutions.opposed,
        "unsettled": solutions.unsettled,
        "real roots": system.real_roots,
        "with positive lengths": solutions.equilibria,
    }


def spurious() -> Facts:
    """Whether there are more real roots than equilibria, which are proved one by one."""
    found, poses = elimination(), equilibria(ELIMINATED)
    number = len(poses.equilibria)
    return {
        **found,
        "some are none": number == found["with positive lengths"] < found["real roots"],
        "equilibria": number,
        "stable": poses.stable,
    }


def numbers(design: Sequence[str]) -> Mapping[str, int]:
    """How many equilibria there are: all, stable ones, and of these and of the others tense ones
    and shorter ones.
    """
    poses = equilibria(design).equilibria
    stable = [p for p in poses if p.stable is True]
    tense = sum(all(force.low > 0 for force in p.forces) for p in poses)
    # a stable one is admissible if all its springs are longer than l0
    both, short = (sum(p.admissible is good for p in stable) for good in (True, False))
    return {
        "total": len(poses),
        "stable": len(stable),
        "tense": both,
        "short": short,
        "loose": tense - both,
    }


def at_designs(designs: Sequence[Sequence[str]], sentence: str) -> Facts:
    """The numbers at designs, and a sentence about each; more than six equilibria are a witness
    against the paper.
    """
    names = [f"(rho, L1, L2, l0, F3/k, F4/k) = ({', '.join(design)})" for design in designs]
    found = [numbers(design) for design in designs]
    many = ", ".join(
        f"{n['total']} at {name}" for name, n in zip(names, found, strict=True) if n["total"] > 6
    )
    return {
        "designs": [sentence.format(at=name, **n) for name, n in zip(names, found, strict=True)],
        "numbers": [tuple(n.values()) for n in found],
        "witness": f"equilibria proved: {many}" if many else "",
        "stable and not tense": any(n["short"] for n in found),
        "tense and not stable": any(n["loose"] for n in found),
    }


def roots_within(designs: Sequence[Design], least: int, most: int) -> Facts:
    """Whether the numbers of real roots are within bounds: at all designs, at some, or at none."""
    found = [squared((*design,)).real_roots for design in designs]
    inside = [n for n in found if least <= n <= most]
    shown = [
        f"{n} at rho = {d[0]}, F3/k = F4/k = {d[4]}" for n, d in zip(found, designs, strict=False)
    ]
    return {
        "real roots": found,
        "inside": len(inside),
        "where": "all" if len(inside) == len(found) else "some" if inside else "none",
        "listed": "; ".join(shown),
        "least": min(found),
        "most": max(found),
        "number": len(found),
        "witness": "; ".join(
            text.replace("at", "real roots at", 1)
            for n, text in zip(found, shown, strict=False)
            if n not in inside
        ),
    }


@cache
def certified(name: str) -> RegionMap:
    """The certified map of one of the slices with free lengths."""
    _, free, axes = MAPS[name]
    parameters = {"L1": 1, "k": 100, "F3": -10, "F4": -10, **free}
    return classify(
        {"mechanism": "ptm", "parameters": parameters, "axes": axes},
        tolerance=TOLERANCE,
        count="stable",
    )


def difficult() -> Facts:
    """Maps that are made here: a forecast of effort is refuted by a classification."""
    maps = {name: certified(name) for name in MAPS}
    counts = {name: {r.stable for r in m.regions} for name, m in maps.items()}
    limit = rational(TOLERANCE)
    sentences = [
        f"{MAPS[name][0]} with L1 = 1, {name}, F3 = F4 = -10, k = 100: the number of stable equilibria is proved to be "
        f"{' or '.join(sorted(map(str, counts[name])))} on all but {float(m.undetermined):.2g} of the window"
        for name, m in maps.items()
    ]
    if program() is not None:
        folds = [
            free.text(6) for free, signs in critical_free_lengths(ELIMINATED) if signs == (1, 1, 1)
        ]
        sentences.append(
            f"along l0 at rho = 7/10, L2 = 3/2 elimination by msolve finds folds at {', '.join(folds)}"
        )
    there, alone = (
        locate(maps["L2 = 3/2"], {"rho": ELIMINATED[0], "l0": ELIMINATED[3]}),
        equilibria(ELIMINATED),
    )
    return {
        "maps": sentences,
        "stable counts": sorted(set().union(*counts.values()), key=str),
        "fine enough": all(
            m.status is Status.CERTIFIED and m.undetermined <= limit for m in maps.values()
        ),
        "at the eliminated design": [there.stable, alone.stable],
        "equilibria": [len(alone.equilibria), signed_solutions(ELIMINATED).equilibria],
        "there": there.stable,
        "share": max(float(m.undetermined) for m in maps.values()),
    }
