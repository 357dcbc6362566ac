"""A shipped slice as Singular sees it: the potential from the nodes' coordinates, and ideals in
cosines and sines.

Guarantee: nothing of ptmcad's engine, model or parser of expressions takes part. The record is read
as YAML, the parameters go into Singular's script as they are written there, and Singular
differentiates the potential itself: along theta the derivative of c is -s and that of s is c.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from pathlib import Path

import yaml

from ptmcad.text.plane import PlanePolynomial
from support.programs import Monomials, ProgramError, monomials, singular
from support.shipped_records import EXACT

CONFIGS = Path(__file__).resolve().parents[2] / "configs"
SHIPPED = tuple(path.stem for path in EXACT)
SOLUTIONS = 6
"""Complex solutions at a generic point of every shipped slice."""

_DEFAULTS = {"L1": 1, "L2": 1, "k": 100, "F3": 0, "F4": 0, "F3x": 0, "F4x": 0}
_PARAMETERS = ("L1", "L2", "rho", "k1", "k2", "k3", "F3", "F4", "F3x", "F4x")

_MECHANISM = """
proc along(poly p, int i) {
  if (i == 1) { return(-s1*diff(p, c1) + c1*diff(p, s1)); }
  return(-s2*diff(p, c2) + c2*diff(p, s2));
}
poly x3 = L1*c1; poly y3 = L1*s1;
poly x4 = rho - L2*c2; poly y4 = L2*s2;
poly U = 1/2*(k1*(x4^2 + y4^2) + k2*((x3 - rho)^2 + y3^2) + k3*((x3 - x4)^2 + (y3 - y4)^2))
         - F3*y3 - F4*y4 - F3x*x3 - F4x*x4;
poly E1 = along(U, 1); poly E2 = along(U, 2);
poly H11 = along(E1, 1); poly H = H11*along(E2, 2) - along(E1, 2)^2;
ideal circles = c1^2 + s1^2 - 1, c2^2 + s2^2 - 1;
ideal equilibria = circles, E1, E2;
"""

_FACTORS = """
list factors = factorize(common);
for (int n = 1; n <= size(factors[1]); n++) { if (deg(factors[1][n]) > 0) { print(string(factors[1][n])); } }
"""


@cache
def axes(name: str) -> tuple[str, str]:
    """The two axes of a slice."""
    first, second = _record(name)["axes"]
    return first, second


def _record(name: str) -> dict[str, dict[str, object]]:
    record: dict[str, dict[str, object]] = yaml.safe_load(
        (CONFIGS / f"{name}.yaml").read_text(encoding="utf-8")
    )
    return record


def parameters(name: str) -> dict[str, str]:
    """Each parameter as the record has it; an axis stands for itself."""
    values = {**_DEFAULTS, **_record(name)["parameters"], **{axis: axis for axis in axes(name)}}
    for spring in ("k1", "k2", "k3"):
        values.setdefault(spring, values["k"])
    return {p: str(values[p]) for p in _PARAMETERS}


def _preamble(name: str, order: str = "dp") -> str:
    """A ring R with the slice's `equilibria`, its H11 and H = det of the Hessian."""
    fixed = "\n".join(
        f"poly {p} = {value};" for p, value in parameters(name).items() if p not in axes(name)
    )
    return f"ring R = 0, (c1, s1, c2, s2, {', '.join(axes(name))}), {order};\n{fixed}\n{_MECHANISM}"


def _curves(name: str, output: str) -> frozenset[PlanePolynomial]:
    return frozenset(
        PlanePolynomial.of((i, j, c) for (i, j), c in integral(monomials(line, axes(name))).items())
        for line in output.splitlines()
        if line.strip()
    )


@cache
def critical_curves(name: str) -> frozenset[PlanePolynomial]:
    """The irreducible curves over Q of the elimination ideal of <E1, E2, circles, det H> in Q[x,
    y].

    In characteristic 0, all at once. A basis in the cheap order before the elimination saves most
    of the time (on the slices of fig. 5 it takes one second, without it more than 90).
    """
    return _curves(
        name,
        singular(
            _preamble(name)
            + "ideal singular_ones = equilibria, H; singular_ones = std(singular_ones);\n"
            + "ideal plane = eliminate(singular_ones, c1*s1*c2*s2);\n"
            # a curve lies in the zeros of the ideal exactly if it divides all generators
            + "poly common = 0; for (int i = 1; i <= size(plane); i++) { common = gcd(common, plane[i]); }\n"
            + _FACTORS
        ),
    )


@cache
def improper_curves(name: str) -> frozenset[PlanePolynomial]:
    """The irreducible curves over which some complex solution is at infinity, or over which there
    are infinitely many.

    A Groebner basis in a block order that first compares degrees in the unknowns, made homogeneous
    in the unknowns with a new one h, generates the ideal of the closure of {(solution, parameters)}
    in P^4 x A^2. Its points with h = 0 are found in the four charts; projecting along P^4 is a
    closed map, so nothing is lost by the elimination.
    """
    charts = "\n".join(
        f"L = K, {v} - 1; L = std(L); J = eliminate(L, c1*s1*c2*s2); common = 0;\n"
        "for (i = 1; i <= size(J); i++) { common = gcd(common, J[i]); } product = product*common;"
        for v in ("c1", "s1", "c2", "s2")
    )
    return _curves(
        name,
        singular(
            _preamble(name, "(dp(4), dp(2))")
            + """
ideal basis = std(equilibria);
intvec unknowns = 1, 1, 1, 1, 0, 0;
ideal K; int i; int j; poly leading;
// with h = 0 only the part of highest degree in the unknowns is left of each element
for (i = 1; i <= ncols(basis); i++) {
  leading = 0;
  for (j = 1; j <= size(basis[i]); j++) {
    if (deg(basis[i][j], unknowns) == deg(basis[i], unknowns)) { leading = leading + basis[i][j]; }
  }
  K[i] = leading;
}
ideal L; ideal J; poly common; poly product = 1;
"""
            + charts
            + "\ncommon = product;\n"
            + _FACTORS
        ),
    )


def solutions_over(name: str, curve: PlanePolynomial, at: Fraction) -> Fraction | None:
    """Mean number of complex solutions, with multiplicity, over the curve's points on a line x = at
    or y = at.

    None when there are infinitely many. The line is across the axis that the curve depends on.
    """
    along = 0 if curve.degrees[0] else 1
    free, fixed = axes(name)[along], axes(name)[1 - along]
    cut: Counter[int] = Counter()
    for *exponents, c in curve.terms:
        cut[exponents[along]] += int(
            c * at ** exponents[1 - along] * at.denominator ** max(curve.degrees)
        )
    degree = max(e for e, c in cut.items() if c)
    assert degree > 0, f"{fixed} = {at} is a special line of the curve"
    relation = " + ".join(f"({c})*{free}^{e}" for e, c in cut.items())
    output = singular(
        f"{_preamble(name)}\nideal fibre = equilibria, {fixed} - ({at}), {relation};\n"
        "fibre = std(fibre); print(vdim(fibre));\n"
    )
    number = int(output)
    return None if number < 0 else Fraction(number, degree)


@dataclass(frozen=True, slots=True)
class CountingFormula:
    """The equilibria at a rational point in one unknown w = c1 + 2 s1 + 3 c2 + 5 s2; coefficients,
    constant first.

    Attributes
    ----------
    roots : polynomial whose real roots are, one to one, the real equilibria.
    h : its sign at a root is that of det of the Hessian there.
    h11 : its sign at a root is that of the Hessian's first entry.
    """

    roots: tuple[int, ...]
    h: tuple[int, ...]
    h11: tuple[int, ...]


def counting_formulas(
    name: str, points: Sequence[tuple[Fraction, Fraction]]
) -> list[CountingFormula]:
    """The formula at each point, from a lexicographic Groebner basis.

    Raises
    ------
    ProgramError
        When w does not separate the solutions of a point, or one of them is multiple.
    """
    script = [
        _preamble(name),
        "ring P = 0, (c1, s1, c2, s2, w), dp; ring S = 0, (c1, s1, c2, s2, w), lp; option(redSB); ideal J;",
        "proc show(poly p) { print(string(p)); }",
    ]
    for n, (x, y) in enumerate(points):
        script.append(
            f"setring P; map at{n} = R, c1, s1, c2, s2, {x}, {y};\n"
            f"ideal I{n} = at{n}(equilibria), w - c1 - 2*s1 - 3*c2 - 5*s2; I{n} = std(I{n});\n"
            f"poly h{n} = at{n}(H); poly d{n} = at{n}(H11);\n"
            f"setring S; J = fglm(P, I{n}); print(size(J)); for (int i{n} = 1; i{n} <= size(J); i{n}++)"
            f" {{ print(string(lead(J[i{n}]))); }}\n"
            f"print(string(J[1])); show(reduce(imap(P, h{n}), J)); show(reduce(imap(P, d{n}), J));"
        )
    lines = iter(singular("\n".join(script)).split())
    return [_formula(lines, name) for _ in points]


def _formula(lines: Iterator[str], name: str) -> CountingFormula:
    leads = [monomials(next(lines), ("c1", "s1", "c2", "s2", "w")) for _ in range(int(next(lines)))]
    exponents = sorted(exponents for lead in leads for exponents in lead)
    units = [tuple(int(i == j) for j in range(5)) for i in range(4)]
    if exponents != sorted([(0, 0, 0, 0, SOLUTIONS), *units]):
        raise ProgramError(f"w does not separate the solutions at a point of {name}")
    return CountingFormula(*(_univariate(monomials(next(lines), ("w",))) for _ in range(3)))


def _univariate(p: Monomials) -> tuple[int, ...]:
    whole = integral(p)
    return tuple(whole.get((n,), 0) for n in range(max(n for (n,) in whole) + 1)) if whole else (0,)


def integral(p: Monomials) -> dict[tuple[int, ...], int]:
    """The positive multiple with whole coefficients without a common factor."""
    scale = math.lcm(*(c.denominator for c in p.values()))
    whole = {e: int(c * scale) for e, c in p.items()}
    content = math.gcd(*whole.values())
    return {e: c // content for e, c in whole.items()}
