"""Numbers of an equilibrium that are rational because a mirror image of the mechanism there is the mechanism itself.

Guarantee: exact. An unknown is fixed only when the reflection is proved to leave the energy as it is, and the image of
the equilibrium to lie in a box that holds no other one: then the equilibrium is its own image. Or the gradient is
rational at such a point of the box, and zero.

Balls alone would never tell such a number from its neighbours.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from fractions import Fraction
from math import pi, prod
from typing import TYPE_CHECKING, NamedTuple

from flint import arb

from ptmcad.certified.plain.jets import rational_energy, rational_root
from ptmcad.errors import ExpressionError
from ptmcad.mechanism.evaluate import value_at
from ptmcad.mechanism.proofs import MirrorImage, Monomial, Polynomial, energy_is_kept, squared_length
from ptmcad.text.enclosure import Enclosure

if TYPE_CHECKING:
    from ptmcad.mechanism import Mechanism
    from ptmcad.text.tree import Tree

Point = dict[str, Fraction]
"""Rational values by name: reals, and cosines and sines as ``cos NAME`` and ``sin NAME``."""
QUARTERS = ((1, 0), (0, 1), (-1, 0), (0, -1))
"""Cosine and sine of the multiples of a quarter turn."""
HALF_TURN = (Fraction(-1), Fraction(0))


class Surds(NamedTuple):
    """Cosines and sines, by name as in `Point`, that are rational multiples of one square root, and its square."""

    multiples: Mapping[str, Fraction]
    square: Fraction


NO_SURDS = Surds({}, Fraction(1))
_ROOT = "square root"
"""As a variable of monomials; no name has a space but those of cosines and sines."""


def fixed_turns(
    mechanism: Mechanism, parameters: Mapping[str, Fraction], held: Mapping[str, arb], boxes: Mapping[str, arb]
) -> dict[str, int]:
    """The unknowns that are fixed: angles to their quarter turns, from -1 to 2, and reals, which are zero, to 0.

    Parameters
    ----------
    held : balls around the equilibrium.
    boxes : wider ones, which together hold no other solution.
    """
    turns: dict[str, int] = {}
    for name, ball in held.items():
        place = fixed_place(mechanism, name, ball)
        n = round(float(place.mid()) / (pi / 2))
        if ball.overlaps(place) and boxes[name].contains(2 * place - ball):
            turns[name] = n
    if not turns:
        return {}
    turns = {name: (n + 1) % 4 - 1 for name, n in turns.items()}
    odd = {name: HALF_TURN for name, n in turns.items() if n % 2}
    kept = is_symmetry(mechanism, parameters, turns, odd)
    return turns if kept or is_equilibrium(mechanism, parameters, point_of(mechanism, turns)) else {}


def is_symmetry(
    mechanism: Mechanism,
    parameters: Mapping[str, Fraction],
    reflected: Iterable[str],
    turned: Mapping[str, tuple[Fraction, Fraction]],
) -> bool:
    """Whether a reflection is proved to take equilibria to equilibria; see `ptmcad.mechanism.proofs.MirrorImage`."""
    try:
        return energy_is_kept(mechanism, parameters, reflected, turned)
    except ExpressionError:  # too large to be multiplied out
        return False


def is_equilibrium(mechanism: Mechanism, parameters: Mapping[str, Fraction], at: Point) -> bool:
    """Whether these are values of all unknowns that are proved to be those of an equilibrium."""
    if len(at) != len(mechanism.angles) + len(mechanism.unknowns) or mechanism.moments:
        return False
    jet = rational_energy(mechanism, parameters, at)
    return jet is not None and not any(jet.gradient)


def point_of(mechanism: Mechanism, turns: Mapping[str, int]) -> Point:
    """The values of fixed unknowns."""
    at: Point = {}
    for name, n in turns.items():
        if name in mechanism.angles:
            at |= {f"cos {name}": Fraction(QUARTERS[n % 4][0]), f"sin {name}": Fraction(QUARTERS[n % 4][1])}
        else:
            at[name] = Fraction(0)
    return at


def quarter_turns(mechanism: Mechanism, at: Point) -> dict[str, int]:
    """The angles that are quarter turns, from -1 to 2."""
    found = {}
    for name in mechanism.angles:
        if f"cos {name}" in at and (quarters := _quarters(at[f"cos {name}"], at[f"sin {name}"])) is not None:
            found[name] = quarters
    return found


def _quarters(cosine: Fraction, sine: Fraction) -> int | None:
    """The quarter turns, from -1 to 2, of a direction; None of one that is not along an axis."""
    if not cosine.denominator == sine.denominator == 1:
        return None
    return (QUARTERS.index((cosine.numerator, sine.numerator)) + 1) % 4 - 1


def rational_numbers(
    mechanism: Mechanism, parameters: Mapping[str, Fraction], at: Point, surds: Surds = NO_SURDS
) -> dict[str, Enclosure]:
    """Those numbers of an equilibrium that are rational by these fixed unknowns, by name, as exact enclosures."""
    known = _Known(parameters, at, surds)
    found = {name: value for name, value in at.items() if " " in name}
    found |= {f"real {name}": at[name] for name in mechanism.reals if name in at}
    for name, n in quarter_turns(mechanism, at).items():
        found |= {f"degrees {name}": Fraction(90 * n)} | ({name: Fraction(0)} if n == 0 else {})
    for name, pair in mechanism.points.items():
        for n, tree in enumerate(pair):
            value = known.value(tree)
            if value is not None:
                found[f"{name} {n}"] = value
    for n, spring in enumerate(mechanism.springs):
        squared = known.squared_length(mechanism, spring.start, spring.end)
        length = None if squared is None else rational_root(squared)
        if length is not None:
            stretch = length - value_at(spring.free, parameters)
            found |= {f"length {n}": length, f"force {n}": value_at(spring.stiffness, parameters) * stretch}
    for n, torsion in enumerate(mechanism.torsion):
        cosine, sine = map(known.value, torsion.deflection)
        if cosine is not None and sine is not None:
            found |= _of_torsion(n, cosine, sine, value_at(torsion.stiffness, parameters))
    if len(at) == len(mechanism.angles) + len(mechanism.unknowns):
        found |= _of_energy(mechanism, parameters, at)
    return {name: Enclosure(value, value) for name, value in found.items()}


def _of_torsion(number: int, cosine: Fraction, sine: Fraction, stiffness: Fraction) -> dict[str, Fraction]:
    """What is rational of a torsion spring, by cosine and sine of its deflection."""
    part = f"torsion %s {number}"
    found = {part % "cos": cosine, part % "sin": sine, part % "moment": stiffness * sine}
    quarters = _quarters(cosine, sine)
    if quarters is not None:
        found[part % "degrees"] = Fraction(90 * quarters)
        if not quarters:
            found[part % "deflection"] = Fraction(0)
    return found


def _of_energy(mechanism: Mechanism, parameters: Mapping[str, Fraction], at: Point) -> dict[str, Fraction]:
    """The energy, and the eigenvalues of its Hessian, as far as they are rational."""
    jet = rational_energy(mechanism, parameters, at)
    if jet is None:
        return {}
    found, hessian = {"energy": jet.value}, jet.hessian
    size = range(len(hessian))
    if len(hessian) == 2:
        (a, b), (_, d) = hessian
        root = rational_root((a - d) ** 2 + 4 * b * b)
        values = None if root is None else [(a + d - root) / 2, (a + d + root) / 2]
    else:
        diagonal = not any(hessian[i][j] for i in size for j in size if i != j)
        values = sorted(hessian[i][i] for i in size) if diagonal else None
    return found | {f"eigenvalue {n}": value for n, value in enumerate(values or ())}


class _Known(NamedTuple):
    """Values of parameters and unknowns, by which others are; None of what depends on more, or is not rational.

    Nor is a value known that is too much to be multiplied out; each is on its own, so that none is at another's cost.
    """

    parameters: Mapping[str, Fraction]
    at: Point
    surds: Surds

    def value(self, tree: Tree) -> Fraction | None:
        try:
            return self._of(MirrorImage(self.parameters).value(tree))
        except ExpressionError:
            return None

    def squared_length(self, mechanism: Mechanism, start: str, end: str) -> Fraction | None:
        try:
            return self._of(squared_length(mechanism, MirrorImage(self.parameters), start, end))
        except ExpressionError:
            return None

    def _of(self, p: Polynomial) -> Fraction | None:
        total = partly_valued(p, self.at, self.surds)
        return total.get((), Fraction(0)) if not any(total.keys() - {()}) else None


def partly_valued(p: Polynomial, at: Mapping[str, Fraction], surds: Surds = NO_SURDS) -> dict[Monomial, Fraction]:
    """The terms of a polynomial in which some variables have values; the surds' root stays as a variable."""
    total: dict[Monomial, Fraction] = {}
    values = {**at, **surds.multiples}
    for monomial, c in p.terms.items():
        rest = tuple((name, e) for name, e in monomial if name not in values)
        roots = sum(e for name, e in monomial if name in surds.multiples)
        rest += ((_ROOT, 1),) * (roots % 2)
        known = prod(values[name] ** e for name, e in monomial if name in values) * surds.square ** (roots // 2)
        total[rest] = total.get(rest, Fraction(0)) + c * known
    return {rest: c for rest, c in total.items() if c}


def fixed_place(mechanism: Mechanism, name: str, near: arb) -> arb:
    """The value of a fixed unknown about which a ball is, at the context's precision."""
    if name not in mechanism.angles:
        return arb(0)
    half = arb.pi() / 2
    return half * round(float(near.mid()) / float(half.mid()))
