"""Enclosures of real numbers, and real algebraic numbers: what certified answers are made of.

Guarantee: an `Enclosure` contains the number it stands for, and each digit of its `text` is right:
the text is the number rounded to nearest, or a middle and a bound of what the number differs from
it. An `AlgebraicNumber` is exact.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from ptmcad.text.numerals import decimal_places, integer_text, magnitude, pointed, text_of

DIGITS = 10
"""Significant digits of a text unless another number is asked for."""
_MAX_PLAIN_ZEROS = 6
"""Zeros after the point, or places before it beyond the digits, from which the form with an
exponent is used.
"""


@dataclass(frozen=True, slots=True)
class Enclosure:
    """A closed interval with rational ends; the number is exact when they are equal."""

    low: Fraction
    high: Fraction

    def __repr__(self) -> str:
        if self.exact is not None:
            return f"<Enclosure of {exact_text(self.low):.60}, exact>"
        if self.settles():
            return f"<Enclosure of {self.text()}>"
        ends = [Enclosure(end, end).text(DIGITS) for end in (self.low, self.high)]
        return f"<Enclosure from {ends[0]} to {ends[1]}>"

    @property
    def exact(self) -> Fraction | None:
        """The number itself when it is known exactly."""
        return self.low if self.low == self.high else None

    @property
    def center(self) -> Fraction:
        """The middle."""
        return (self.low + self.high) / 2

    @property
    def radius(self) -> Fraction:
        """Half the width; 0 for a number that is known exactly."""
        return (self.high - self.low) / 2

    def __float__(self) -> float:
        """The middle, rounded: for pictures, never for decisions."""
        return float(self.center)

    def settles(self, digits: int = DIGITS) -> bool:
        """Whether the enclosure determines its number rounded to ``digits`` significant digits.

        It does when it is exact, or when it contains neither zero nor a number that lies halfway
        between two texts of so many digits. A number that is not exactly known must therefore not
        be one, as no irrational number is.

        >>> near = Fraction(1, 10**30)
        >>> around = Enclosure(Fraction(5, 2) - near, Fraction(5, 2) + near)
        >>> around.settles(), around.settles(2), around.settles(1)
        (True, True, False)
        """
        if self.low == self.high:
            return True
        if self.low <= 0 <= self.high:
            return False
        near, far = (self.low, self.high) if self.low > 0 else (-self.high, -self.low)
        half = Fraction(10) ** (magnitude(near) + 1 - digits) / 2
        first, last = -(-near // half), far // half
        # an even multiple of half a unit is a text itself, and not halfway between two
        return first > last or (first == last and first % 2 == 0)

    def settled_text(self, most: int, least: int = 1) -> str | None:
        """As many digits as are settled, at most so many; None where it does not settle ``least``."""
        digits = range(most, least - 1, -1)
        return next((self.text(n) for n in digits if self.settles(n)), None)

    def told_digits(self, digits: int = DIGITS) -> int | None:
        """The fewest digits, from so many on, that the enclosure settles: what `text` writes; None
        of a wider one.

        A number halfway between two texts of so many digits, which is known closely and not
        exactly, has one more.
        """
        return next((n for n in range(digits, digits + DIGITS) if self.settles(n)), None)

    def text(self, digits: int = DIGITS) -> str:
        """The number rounded to nearest, with ``digits`` significant digits.

        Of an enclosure that does not determine so few, with the fewest more that it does: of what
        may be 2.5 and is not known exactly, no single digit is nearest. Zeros at the end are left
        out only where the text is the number exactly; an exact number halfway between two texts
        goes to the even one. Exact zero is ``0``; very small and very large numbers are written as
        ``1.5e-7``. An enclosure that settles no digits, as of what may be zero, is written as a
        middle and a bound of the difference.

        >>> Enclosure(Fraction(1, 3), Fraction(1, 3)).text(4), Enclosure(Fraction(1, 4), Fraction(1, 4)).text()
        ('0.3333', '0.25')
        >>> Enclosure(Fraction(2499999, 10**6), Fraction(2500001, 10**6)).text(1)
        '2.5'
        >>> Enclosure(Fraction(-1, 10**30), Fraction(1, 10**30)).text(), Enclosure(Fraction(1), Fraction(2)).text()
        ('0 ± 1e-30', '1.5 ± 0.5')
        """
        if (settled := self.told_digits(digits)) is None:
            return self._with_error()
        digits = settled
        if self.low == self.high == 0:
            return "0"
        value = self.center
        mantissa, exponent = _rounded(abs(value), digits)
        exact = self.low == self.high and abs(value) == mantissa * Fraction(10) ** exponent
        return ("-" if value < 0 else "") + _decimal(mantissa, exponent, digits, exact)

    def _with_error(self) -> str:
        """A middle, to the place of the radius' first digit, and what the number differs from it at
        most.
        """
        unit = Fraction(10) ** magnitude(self.radius)
        middle = round(self.center / unit) * unit
        error = -(-max(self.high - middle, middle - self.low) // unit) * unit
        return f"{exact_text(middle)} ± {exact_text(error)}"


def exact_text(value: Fraction) -> str:
    """An exact number as a decimal where it is one, else as a fraction.

    >>> exact_text(Fraction(-3, 2)), exact_text(Fraction(10) ** 30), exact_text(Fraction(1, 3))
    ('-1.5', '1e30', '1/3')
    """
    places = decimal_places(value)
    if places is None:
        return text_of(value)
    digits = integer_text(abs(value.numerator) * 10**places // value.denominator).rstrip("0")
    return Enclosure(value, value).text(max(1, len(digits)))


def _rounded(value: Fraction, digits: int) -> tuple[int, int]:
    """The pair (m, e) of which m 10^e is the positive value rounded to nearest, m having so many
    digits.
    """
    exponent = magnitude(value) + 1 - digits
    mantissa = round(value / Fraction(10) ** exponent)
    return (mantissa // 10, exponent + 1) if mantissa == 10**digits else (mantissa, exponent)


def _decimal(mantissa: int, exponent: int, digits: int, shorten: bool) -> str:
    """m 10^e as text, m having so many digits; zeros at the end of the decimals are dropped when
    asked for.
    """
    written = integer_text(mantissa)
    point = digits + exponent  # where the point comes, counted from the first digit
    most = digits + _MAX_PLAIN_ZEROS if shorten else digits
    plain = -_MAX_PLAIN_ZEROS < point <= most
    text = pointed(written, exponent if plain else 1 - digits)
    if shorten and "." in text:
        text = text.rstrip("0").rstrip(".")
    return text if plain else f"{text}e{point - 1}"


_SHOWN_BITS = 64
"""To which a number is enclosed for its `repr`."""


@dataclass(frozen=True, slots=True)
class AlgebraicNumber:
    """The only real root of ``polynomial`` in [low, high].

    Attributes
    ----------
    polynomial : in Z[T], irreducible, primitive, leading coefficient positive; constant term first.
    """

    polynomial: tuple[int, ...]
    low: Fraction
    high: Fraction

    @classmethod
    def of(cls, value: Fraction | AlgebraicNumber) -> AlgebraicNumber:
        """A rational number as a root of its polynomial; another number as it is."""
        if not isinstance(value, Fraction):
            return value
        return cls((-value.numerator, value.denominator), value, value)

    def __repr__(self) -> str:
        # by so many bisections and no more: of a number that is read from a damaged file nothing
        # has been proved yet
        number = self.refined(max(abs(self.low), abs(self.high)) / 2**_SHOWN_BITS)
        found = Enclosure(number.low, number.high)
        shown = found.text(DIGITS) if found.settles(DIGITS) else "not settled by its interval"
        return f"<AlgebraicNumber {shown}, of degree {self.degree}>"

    @property
    def degree(self) -> int:
        """The degree over the rationals."""
        return len(self.polynomial) - 1

    @property
    def exact(self) -> Fraction | None:
        """The number itself when it is rational."""
        return Fraction(-self.polynomial[0], self.polynomial[1]) if self.degree == 1 else None

    def __float__(self) -> float:
        """The middle, rounded: for pictures, never for decisions."""
        return float((self.low + self.high) / 2)

    def compare(self, value: Fraction) -> int:
        """The sign of the number minus a rational one."""
        if (exact := self.exact) is not None:
            return (exact > value) - (exact < value)
        if not self.low <= value <= self.high:
            return 1 if value < self.low else -1
        return 1 if self._sign(value) == self._sign(self.low) else -1

    def refined(self, width: Fraction) -> AlgebraicNumber:
        """The same number in an interval no wider than ``width``, by bisection."""
        if (exact := self.exact) is not None:
            return AlgebraicNumber(self.polynomial, exact, exact)
        low, high = self.low, self.high
        at_low = self._sign(
            low
        )  # not zero: an irreducible polynomial of higher degree has no rational root
        while high - low > width:
            middle = _dyadic_between(low, high)
            if self._sign(middle) == at_low:
                low = middle
            else:
                high = middle
        return AlgebraicNumber(self.polynomial, low, high)

    def enclosure(self, digits: int = DIGITS) -> Enclosure:
        """An enclosure that settles ``digits`` digits."""
        number = self.refined(self.high - self.low)
        while not (found := Enclosure(number.low, number.high)).settles(digits):
            number = number.refined((number.high - number.low) / 16)
        return found

    def text(self, digits: int = DIGITS) -> str:
        """The number rounded to nearest, as `Enclosure.text` writes it."""
        return self.enclosure(digits).text(digits)

    def _sign(self, at: Fraction) -> int:
        """The sign of the polynomial at a rational number."""
        numerator, denominator = at.numerator, at.denominator
        total, power = 0, 1
        for coefficient in reversed(self.polynomial):
            total = total * numerator + coefficient * power
            power *= denominator
        return (total > 0) - (total < 0)


def _dyadic_between(low: Fraction, high: Fraction) -> Fraction:
    """A number in the middle third of the interval with a short binary expansion, so that bisection
    stays cheap.
    """
    width = high - low
    bits = max(0, width.denominator.bit_length() - width.numerator.bit_length() + 3)
    return Fraction(round((low + high) / 2 * 2**bits), 2**bits)
