"""Check of the stored equations of a certified map, as polynomials in the springs' lengths.

Guarantee: exact. The text equals the energy, or the equations, that follow from the description, as
a function of all parameters and all unknowns: both are polynomials over Q in the parameters, real
unknowns, cosines, sines and lengths l_i, modulo cos^2 + sin^2 = 1 and l_i^2 = q_i, and their normal
forms are the same. A root is read only where it is a length. An angle stands outside of cosines and
sines only where a moment works on it.

Values at points would not do: what agrees at points of any number and precision may still be wrong
elsewhere, be it sqrt(F3^2) for F3, a high power of a number below one, or a product that vanishes
at the points.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Mapping, Sequence

from flint import fmpq, fmpq_mpoly

from ptmcad.verification.claims import Claims
from ptmcad.verification.coordinates import CoordinateRing, turned
from ptmcad.verification.derivation import Derivation, derivation_of
from ptmcad.verification.normalform.waves import form_of
from ptmcad.verification.report import Unchecked, Violation
from ptmcad.verification.work import fault_in_work

_DECIMAL = re.compile(
    r"(?<![A-Za-z0-9_.])([0-9]{1,60})(?:\.([0-9]{1,60}))?(?:e([+-]?[0-9]{1,3}))?(?![A-Za-z0-9_.])",
    re.ASCII,
)
"""A decimal number, which a parser of Python would round."""
_LARGE_TEXT = 100_000
"""Letters beyond which a text is not checked."""
_SIGNS = re.compile(r"[A-Za-z0-9_ ()^*/+-]*", re.ASCII)
_WRONG = re.compile(r"\*\*|(?<![A-Za-z0-9_])(?:_|[0-9]+[A-Za-z_])", re.ASCII)
"""Integers, names and signs: no comments, lines, decimals, or other things that are Python. Each
takes linear time; possessive quantifiers, which would do, are wrong in Python before 3.11.5."""
_NAME = re.compile(r"(?<![A-Za-z0-9_])[A-Za-z]", re.ASCII)
_MAX_TERMS, _MAX_DEGREE, _MAX_BITS = 2_000, 60, 2_000
"""Of what a part of the text stands for, so that no text takes long; the energy has some 30 terms
of degree 5.
"""


class _TooLarge(Violation):
    """A part of the text has too many terms to go on with."""


def check_potential(claims: Claims) -> str:
    """The unknowns, and the potential or the equations in them."""
    system, slice = claims.result.system, claims.result.slice
    unknowns = tuple(slice.model.unknowns)
    if system.unknowns != unknowns:
        raise Violation(f"the unknowns are {system.unknowns}, not {unknowns}")
    true = derivation_of(slice.model)
    if len(true.equations) != len(unknowns):
        raise Violation(f"there are {len(true.equations)} equations for {len(unknowns)} unknowns")
    closed = bool(form_of(slice).closing) and slice.has_free_lengths
    if closed and len(system.relations) != len(true.closing):
        raise Violation(
            f"there are {len(true.closing)} loops that are closed, and {len(system.relations)} relations"
        )
    stated = true.energy is not None and (true.from_energy or closed)
    if (system.relations and not closed) or system.hessian or (stated and system.gradient):
        raise Violation(
            "a certified map has no relations, and its gradient and Hessian follow from the potential"
        )
    if system.moments and not (stated and true.apart):
        raise Violation(
            "moments are stated beside the potential where one depends on another unknown only"
        )
    if not stated and (system.potential or len(system.gradient) != len(true.equations)):
        raise Violation(f"there are {len(true.equations)} equations and no potential")
    text = _Text(true, stated)
    reasons = (
        [_compared(text, "potential", system.potential, text.energy, text.work)] if stated else []
    )
    moments = [true.moments[unknown] for unknown in unknowns] if stated and true.apart else []
    parts: list[tuple[str, Sequence[str], Sequence[fmpq_mpoly]]] = [
        ("equation", system.gradient, () if stated else true.equations),
        ("moment", system.moments, moments),
        ("inequality", system.inequalities, true.inequalities),
        ("condition for stability", system.stability, () if closed else true.stability),
        ("relation", system.relations, true.closing if closed else ()),
    ]
    for what, stored, polynomials in parts:
        if len(stored) != len(polynomials):
            raise Violation(f"there are {len(polynomials)} of the kind {what}, not {len(stored)}")
        named = zip(stored, polynomials, strict=True)
        reasons += [
            _compared(text, f"{what} {k}", one, text.ring.taken(p, true.ring))
            for k, (one, p) in enumerate(named)
        ]
    if any(reasons):
        return Unchecked(next(filter(None, reasons)))
    what = (
        "the equations"
        if not stated
        else "the potential and the moments"
        if true.apart
        else "the potential"
    )
    return f"{what} in {len(unknowns)} unknowns and {len(slice.model.variables)} parameters"


def _compared(
    text: _Text,
    what: str,
    stored: str,
    true: fmpq_mpoly,
    moments: Mapping[str, fmpq_mpoly] | None = None,
) -> str:
    """Why a text was not compared with what it has to be; empty when they are equal.

    Parameters
    ----------
    moments : of which the text lacks the work.

    Raises
    ------
    Violation
        When they differ.
    """
    try:
        difference = text.reduced(text.value(what, stored) - true)
    except RecursionError:
        raise Violation(f"the stored {what} has too many parts within each other") from None
    except _TooLarge as large:
        return str(large)
    if moments is None or text.has_lengths(difference):
        differs = not difference.is_zero()
    else:
        differs = bool(fault_in_work(text.ring, -difference, moments))
    if differs:
        raise Violation(
            f"the stored {what} differs from the mechanism's by {text.ring.text(difference)}"
        )
    return ""


class _Text:
    """The ring of a model's texts, and what they stand for.

    Attributes
    ----------
    ring : with a variable for each spring's length, and one for each angle outside of cosines and
        sines.
    names, outside : of parameters and unknowns what they stand for; and which may stand outside of
        cosines and sines.
    energy : with the springs' free lengths, where it is stated.
    work : the moments by the unknown on which they work, where their work is stated with the
        energy.
    squares : the squares of the springs' lengths in normal form, each once.
    """

    def __init__(self, true: Derivation, stated: bool):
        number = len(true.springs) if stated else 0
        first = tuple(f"length {n}" for n in range(number))
        self.ring = CoordinateRing((*first, *true.ring.names, *true.ring.angles), true.ring.angles)
        parameters = true.ring.names[true.coordinates :]
        self.names = {name: self.ring.elements[name] for name in (*parameters, *true.unknowns)}
        moved = true.moved and not true.apart
        self.outside = self.names.keys() - (() if moved else true.ring.angles)
        self.lengths, self.squares = (
            [self.ring.elements[name] for name in first],
            list[fmpq_mpoly](),
        )
        nothing = self.ring.context.constant(0)
        self.work = {
            u: nothing if true.apart else self.ring.taken(true.moments[u], true.ring)
            for u in true.unknowns
        }
        self.energy = (
            self.reduced(true.stretched(self.ring, self._new_length)) if stated else nothing
        )

    def _new_length(self, square: fmpq_mpoly) -> fmpq_mpoly:
        normal = self.ring.normal(square)
        if normal not in self.squares:
            self.squares.append(normal)
        return self.lengths[self.squares.index(normal)]

    def length(self, square: fmpq_mpoly) -> fmpq_mpoly:
        """The length whose square is given.

        Raises
        ------
        ValueError
            When no spring has it.
        """
        return self.lengths[self.squares.index(self.reduced(square))]

    def has_lengths(self, p: fmpq_mpoly) -> bool:
        """Whether some length is in a polynomial."""
        return any(degree > 0 for degree in p.degrees()[: len(self.lengths)])

    def reduced(self, p: fmpq_mpoly) -> fmpq_mpoly:
        """The normal form: at most the first power of each length and of each cosine."""
        for length, square in zip(self.lengths, self.squares, strict=False):
            p = divmod(p, length**2 - square)[1]
        return self.ring.normal(p)

    def value(self, what: str, text: str) -> fmpq_mpoly:
        """What a text stands for.

        Raises
        ------
        RecursionError
            When it has too many parts within each other.
        """
        return self._value(_parsed(what, text))

    def _value(self, node: ast.expr, inside: bool = False) -> fmpq_mpoly:
        """What sums, products, small powers, quotients by numbers, lengths, sines and cosines stand
        for.

        Parameters
        ----------
        inside : of a cosine or a sine, where all angles may stand.
        """
        constant = self.ring.context.constant
        match node:
            case ast.Constant(value=int(number)) if not isinstance(number, bool):
                return _bounded(constant(number))
            case ast.Name(id=name) if _plain(name) in (self.names if inside else self.outside):
                return self.names[_plain(name)]
            case ast.UnaryOp(op=ast.USub(), operand=inner):
                return -self._value(inner, inside)
            case ast.BinOp(left=base, op=ast.Pow(), right=ast.Constant(value=int(exponent))) if (
                0 <= exponent <= _MAX_DEGREE
            ):
                power, factor = constant(1), self._value(base, inside)
                for _ in range(exponent):
                    power = _product(power, factor)
                return power
            case ast.BinOp(left=one, op=operator, right=two):
                a, b = self._value(one, inside), self._value(two, inside)
                match operator:
                    case ast.Add():
                        return _bounded(a + b)
                    case ast.Sub():
                        return _bounded(a - b)
                    case ast.Mult():
                        return _product(a, b)
                    case ast.Div() if b.is_constant() and not b.is_zero():
                        return _product(a, constant(1 / b.coeffs()[0]))
            case ast.Call(func=ast.Name(id=name), args=[inner], keywords=[]):
                return self._call(_plain(name), inner, node)
        raise Violation(f"the stored potential has a part that is no formula: {_shown(node)}")

    def _call(self, name: str, inner: ast.expr, node: ast.expr) -> fmpq_mpoly:
        if name == "sqrt":
            try:
                return self.length(self._value(inner))
            except ValueError:
                raise Violation(
                    f"the stored potential has a root of what is no spring's length: {_shown(node)}"
                ) from None
        if name not in ("cos", "sin"):
            raise Violation(f"the stored potential has a part that is no formula: {_shown(node)}")
        circle = self.ring.context.constant(1), self.ring.context.constant(0)
        for angle, multiple in self._angles(inner, node).items():
            circle = turned(circle, self.ring.circles[angle], multiple, _product)
        return circle[0 if name == "cos" else 1]

    def _angles(self, inner: ast.expr, node: ast.expr) -> dict[str, int]:
        """The whole multiples of angles of which a text is the sum."""
        rest, found = self._value(inner, inside=True), {}
        for angle in self.ring.angles:
            c = rest.derivative(self.ring.names.index(angle))
            if not c.is_constant():
                break
            multiple = fmpq(0) if c.is_zero() else c.coeffs()[0]
            if multiple.q != 1 or abs(multiple) > _MAX_DEGREE:
                break
            found[angle] = int(multiple.p)
            rest = rest - multiple * self.names[angle]
        if not rest.is_zero():
            raise Violation(f"the stored potential has a part that is no formula: {_shown(node)}")
        return found


def _plain(name: str) -> str:
    """A name without the letter before it that keeps it from being one of Python's words."""
    return name[1:]


def _parsed(what: str, text: str) -> ast.expr:
    if len(text) > _LARGE_TEXT:
        raise _TooLarge(f"the stored {what} is longer than {_LARGE_TEXT} letters")
    text = _in_quotients(text)
    if _SIGNS.fullmatch(text) is None or _WRONG.search(text):
        raise Violation(f"the stored {what} is not a formula in the names of problem records")
    try:
        return ast.parse(_NAME.sub(lambda m: f"x{m[0]}", text).replace("^", "**"), mode="eval").body
    except (SyntaxError, RecursionError, MemoryError):
        raise Violation(f"the stored {what} cannot be read: {text[:60]!r}") from None


def _shown(node: ast.expr) -> str:
    return repr(re.sub(r"(?<![A-Za-z0-9_])x(?=[A-Za-z])", "", ast.unparse(node))[:60])


def _product(a: fmpq_mpoly, b: fmpq_mpoly) -> fmpq_mpoly:
    if len(a) * len(b) > _MAX_TERMS:
        raise _TooLarge(f"the stored potential has a product of more than {_MAX_TERMS} terms")
    return _bounded(a * b)


def _bounded(p: fmpq_mpoly) -> fmpq_mpoly:
    """A polynomial that is not too large to go on with."""
    bits = max((max(int(c.p).bit_length(), int(c.q).bit_length()) for c in p.coeffs()), default=0)
    if len(p) > _MAX_TERMS or p.total_degree() > _MAX_DEGREE or bits > _MAX_BITS:
        raise _TooLarge(
            "the stored potential has a part of too many terms, too high a degree or too long numbers"
        )
    return p


def _in_quotients(text: str) -> str:
    """A formula without decimal numbers.

    >>> _in_quotients("0.5*x1 + 2e-3 - 12*x")
    '(5/10)*x1 + (2/1000) - 12*x'
    """
    return _DECIMAL.sub(_quotient, text)


def _quotient(number: re.Match[str]) -> str:
    whole, behind, exponent = number.groups()
    if behind is None and exponent is None:
        return str(whole)
    shift = int(exponent or 0) - len(behind or "")
    digits = int(whole + (behind or ""))
    return f"({digits * 10**shift})" if shift >= 0 else f"({digits}/{10**-shift})"
