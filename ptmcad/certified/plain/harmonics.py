"""Polynomials in real unknowns and in the cosines and sines of unknown angles, over Q(x, y).

Guarantee: exact, and in the normal form of Fourier: a sum of terms coefficient * cos(m.t) * h^e and
coefficient * sin(m.t) * h^e with different (m, e), in which cos(t)^2 + sin(t)^2 is 1. Written out
as formulas, each harmonic stands once, so that intervals lose little where a product of cosines and
sines would have lost much.

>>> ring = Harmonics(("t",), ())
>>> ring.cos("t") * ring.cos("t") + ring.sin("t") * ring.sin("t") == ring.constant(Fraction(1))
True
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

from ptmcad.errors import ExpressionError
from ptmcad.formulas.graph import Formula, Graph, direction, expression_formula
from ptmcad.text.expressions import Expression, constant

Vector = tuple["TrigonometricPolynomial", "TrigonometricPolynomial"]
Multi = tuple[int, ...]
"""One integer for each unknown: the multiple of an angle, or the power of a real unknown."""
_HALF = Fraction(1, 2)
_NOTHING = constant(0)


@dataclass(frozen=True, slots=True)
class TrigonometricPolynomial:
    """A sum of harmonics.

    Attributes
    ----------
    terms : (m, e) to the coefficients of cos(m.t) h^e and of sin(m.t) h^e; the first entry of m
        that is not zero is positive, and no term is zero.
    """

    terms: Mapping[tuple[Multi, Multi], tuple[Expression, Expression]]

    def __add__(self, other: TrigonometricPolynomial) -> TrigonometricPolynomial:
        return _collected([*self.terms.items(), *other.terms.items()])

    def __sub__(self, other: TrigonometricPolynomial) -> TrigonometricPolynomial:
        return self + -other

    def __neg__(self) -> TrigonometricPolynomial:
        return self.scaled(Fraction(-1))

    def __mul__(self, other: TrigonometricPolynomial) -> TrigonometricPolynomial:
        found = []
        for (m, e), pair in self.terms.items():
            a, b = (coefficient * _HALF for coefficient in pair)
            for (n, f), (c, d) in other.terms.items():
                power = tuple(p + q for p, q in zip(e, f, strict=True))
                above = tuple(p + q for p, q in zip(m, n, strict=True))
                below = tuple(p - q for p, q in zip(m, n, strict=True))
                ac, bd, ad, bc = a * c, b * d, a * d, b * c
                found += [
                    ((above, power), (ac - bd, ad + bc)),
                    ((below, power), (ac + bd, bc - ad)),
                ]
        return _collected(found)

    @property
    def still(self) -> TrigonometricPolynomial:
        """The part that has no unknown in it."""
        return TrigonometricPolynomial(
            {k: pair for k, pair in self.terms.items() if not any(map(any, k))}
        )

    def scaled(self, factor: Expression | Fraction) -> TrigonometricPolynomial:
        """Times a number or a function of the axes."""
        return _collected([(key, (a * factor, b * factor)) for key, (a, b) in self.terms.items()])

    def derivative(self, unknown: int) -> TrigonometricPolynomial:
        """The partial derivative by the unknown of this number, an angle or not."""
        found = []
        for (m, e), (a, b) in self.terms.items():
            if m[unknown]:
                found.append(((m, e), (b * m[unknown], a * -m[unknown])))
            if e[unknown]:
                lower = tuple(p - (k == unknown) for k, p in enumerate(e))
                found.append(((m, lower), (a * e[unknown], b * e[unknown])))
        return _collected(found)

    def substituted(self, rows: Sequence[Multi]) -> TrigonometricPolynomial:
        """With sums of whole multiples of other angles for the angles; real unknowns, whose
        multiples are 0, stay.

        Parameters
        ----------
        rows : for each unknown these multiples.
        """
        return _collected([((times(m, rows), e), pair) for (m, e), pair in self.terms.items()])

    def moved(self, images: Multi, signs: Multi, halves: Multi) -> TrigonometricPolynomial:
        """With sign_k q_image(k) + half_k pi for each unknown q_k; the images are a permutation."""
        size = range(len(images))
        places = sorted(size, key=lambda k: images[k])
        terms = []
        for (m, e), (a, b) in self.terms.items():
            odd = sum(n * h for n, h in zip(m, halves, strict=True))
            odd += sum(p for p, s in zip(e, signs, strict=True) if s < 0)
            sign = -1 if odd % 2 else 1
            key = tuple(signs[k] * m[k] for k in places), tuple(e[k] for k in places)
            terms.append((key, (a * sign, b * sign)))
        return _collected(terms)

    def formula(self, unknowns: Sequence[Unknown]) -> Formula:
        """The polynomial as a formula: by Horner's rule in each real unknown, over sums of
        harmonics.

        Parameters
        ----------
        unknowns : formulas, or of angles what sums of their multiples have a cosine and a sine of.
        """
        return _horner(unknowns, dict(self.terms), 0)


_Terms = dict[tuple[Multi, Multi], tuple[Expression, Expression]]


def _horner(unknowns: Sequence[Unknown], terms: _Terms, unknown: int) -> Formula:
    """The terms' sum without the powers of earlier unknowns."""
    graph = unknowns[0].graph
    if unknown == len(unknowns):
        total = graph.constant(0)
        for (m, _), (a, b) in sorted(terms.items(), key=lambda term: term[0]):
            parts: list[Any] = [
                multiple * angle for multiple, angle in zip(m, unknowns, strict=True) if multiple
            ]
            if not parts:  # no angle: the cosine is 1
                total = total + expression_formula(graph, a)
                continue
            angle = sum(parts[1:], start=parts[0])
            for coefficient, wave in ((a, angle.cos()), (b, angle.sin())):
                total = total + expression_formula(graph, coefficient) * wave
        return total
    by_power: dict[int, _Terms] = {}
    for (m, e), coefficients in terms.items():
        by_power.setdefault(e[unknown], {})[m, e] = coefficients
    most = max(by_power, default=0)
    total = _horner(unknowns, by_power.get(most, {}), unknown + 1)
    for power in range(most - 1, -1, -1):
        value = unknowns[unknown]
        assert isinstance(value, Formula)  # angles have no powers
        total = total * value + _horner(unknowns, by_power.get(power, {}), unknown + 1)
    return total


def _collected(
    terms: Sequence[tuple[tuple[Multi, Multi], tuple[Expression, Expression]]],
) -> TrigonometricPolynomial:
    """The sum of terms that need not be different, nor have a first multiple that is positive."""
    total: dict[tuple[Multi, Multi], tuple[Expression, Expression]] = {}
    for (m, e), (a, b) in terms:
        lead = next((multiple for multiple in m if multiple), 0)
        multiples = tuple(-multiple for multiple in m) if lead < 0 else m
        sine = _NOTHING if lead == 0 else -b if lead < 0 else b
        known = total.get((multiples, e), (_NOTHING, _NOTHING))
        total[multiples, e] = (known[0] + a, known[1] + sine)
    return TrigonometricPolynomial(
        {key: (a, b) for key, (a, b) in total.items() if a.numerator or b.numerator}
    )


def times(multiples: Multi, rows: Sequence[Multi]) -> Multi:
    """Multiples of what has these rows as multiples of others, as multiples of these."""
    columns = zip(*rows, strict=True)
    return tuple(sum(a * b for a, b in zip(multiples, column, strict=True)) for column in columns)


def waves(multiples: Multi) -> tuple[TrigonometricPolynomial, TrigonometricPolynomial]:
    """Cosine and sine of a sum of whole multiples of the angles."""
    key, one = (multiples, (0,) * len(multiples)), constant(1)
    return _collected([(key, (one, _NOTHING))]), _collected([(key, (_NOTHING, one))])


@dataclass(frozen=True, slots=True)
class Harmonics:
    """The ring of these polynomials, for `ptmcad.model.evaluate`.

    Attributes
    ----------
    unknowns : their names; multiples and powers come in this order.
    reals : those that are no angles.
    parameters : functions of the axes by name; a parameter that is missing is zero.
    """

    unknowns: tuple[str, ...]
    reals: tuple[str, ...]
    parameters: Mapping[str, Expression] = field(default_factory=dict)

    def constant(self, value: Fraction) -> TrigonometricPolynomial:
        return self._term(constant(value), _NOTHING)

    def parameter(self, name: str) -> TrigonometricPolynomial:
        if name in self.reals:
            return self._term(constant(1), _NOTHING, power=name)
        if name in self.unknowns:
            raise ExpressionError(f"{name} is an angle: it stands inside of cos or sin")
        return self._term(self.parameters.get(name, _NOTHING), _NOTHING)

    def cos(self, angle: str) -> TrigonometricPolynomial:
        return self._term(constant(1), _NOTHING, angle=self._known(angle))

    def sin(self, angle: str) -> TrigonometricPolynomial:
        return self._term(_NOTHING, constant(1), angle=self._known(angle))

    def _known(self, angle: str) -> str:
        if angle in self.reals or angle not in self.unknowns:
            raise ExpressionError(f"{angle} is not an unknown angle")
        return angle

    def _term(
        self, a: Expression, b: Expression, angle: str = "", power: str = ""
    ) -> TrigonometricPolynomial:
        multiples = tuple(int(name == angle) for name in self.unknowns)
        powers = tuple(int(name == power) for name in self.unknowns)
        return _collected([((multiples, powers), (a, b))])


@dataclass(frozen=True, slots=True)
class Angle:
    """A sum of multiples of angles, quarter turns, and angles given by the tangents of their halves.

    Attributes
    ----------
    graph : of the formulas.
    smooth : formulas of angles, with their multiples.
    quarters : the number of quarter turns.
    tangents : tan(a/2) of further angles a, with the multiples of a.
    """

    graph: Graph
    smooth: Mapping[Formula, int] = field(default_factory=dict)
    quarters: int = 0
    tangents: Mapping[Formula, int] = field(default_factory=dict)

    def __add__(self, other: Angle) -> Angle:
        return Angle(
            self.graph,
            _sum(self.smooth, other.smooth),
            self.quarters + other.quarters,
            _sum(self.tangents, other.tangents),
        )

    def __rmul__(self, multiple: int) -> Angle:
        return Angle(
            self.graph,
            {f: multiple * n for f, n in self.smooth.items()},
            multiple * self.quarters,
            {f: multiple * n for f, n in self.tangents.items()},
        )

    def cos(self) -> Formula:
        """The cosine."""
        return self._turned(0)

    def sin(self) -> Formula:
        """The sine."""
        return self._turned(-1)

    def _turned(self, quarters: int) -> Formula:
        """The cosine with quarter turns more."""
        run, rise = self._half()
        cosine, sine = (self._smooth(self.quarters + quarters + q) for q in (0, -1))
        if rise.value == 0:
            return cosine
        near, far = direction(run, rise), direction(rise, run)
        return cosine * (2 * near.squared() - 1) - sine * (2 * (near * far))

    def _smooth(self, quarters: int) -> Formula:
        """The cosine without the tangents' part, and with so many quarter turns."""
        angle = self.graph.constant(0)
        for f, n in self.smooth.items():
            angle = angle + n * f
        function, sign = ((angle.cos, 1), (angle.sin, -1), (angle.cos, -1), (angle.sin, 1))[
            quarters % 4
        ]
        if angle.value == 0:
            return self.graph.constant(sign * (1 - quarters % 2))
        return sign * function()

    def _half(self) -> tuple[Formula, Formula]:
        """Coordinates of a vector at half the tangents' angle."""
        run, rise = self.graph.constant(1), self.graph.constant(0)
        for tangent, n in self.tangents.items():
            t = tangent if n > 0 else -tangent
            for _ in range(abs(n)):
                run, rise = run - rise * t, rise + run * t
        return run, rise


def _sum(one: Mapping[Formula, int], other: Mapping[Formula, int]) -> dict[Formula, int]:
    total = {f: one.get(f, 0) + other.get(f, 0) for f in (*one, *other)}
    return {f: n for f, n in total.items() if n}


Unknown = Formula | Angle
"""What stands for an unknown in formulas."""
