"""Check of the stored equations of a certified map, as polynomials in the springs' lengths.

Guarantee: exact. The text equals the energy, or the equations, that follow from the description, as a function of all
parameters and all unknowns: both are polynomials over Q in the parameters, real unknowns, cosines, sines and lengths
l_i, modulo cos^2 + sin^2 = 1 and l_i^2 = q_i, and their normal forms are the same. A root is read only where it is a
length. An angle stands outside of cosines and sines only where a moment works on it.

Values at points would not do: what agrees at points of any number and precision may still be wrong elsewhere, be it
sqrt(F3^2) for F3, a high power of a number below one, or a product that vanishes at the points.
"""

from __future__ import annotations

import ast
import re
from functools import cached_property, lru_cache
from typing import Any

from flint import Ordering, fmpq, fmpq_mpoly, fmpq_mpoly_ctx, fmpz

from ptmcad.answer.regionmap import System
from ptmcad.model import ClosedMechanism, Mechanism, Model
from ptmcad.text.tree import names_of
from ptmcad.verification.certified.decimals import in_quotients
from ptmcad.verification.certified.waves import form_of
from ptmcad.verification.claims import Claims
from ptmcad.verification.derivation import Configuration, formulas, potential
from ptmcad.verification.loops import distances
from ptmcad.verification.report import Unchecked, Violation

_LARGE_TEXT = 100_000
"""Letters beyond which a text is not checked."""
_SIGNS = re.compile(r"[A-Za-z0-9_ ()^*/+-]*", re.ASCII)
_WRONG = re.compile(r"\*\*|(?<![A-Za-z0-9_])(?:_|[0-9]+[A-Za-z_])", re.ASCII)
"""Integers, names and signs: no comments, lines, decimals, or other things that are Python. Each takes linear time;
possessive quantifiers, which would do, are wrong in Python before 3.11.5."""
_NAME = re.compile(r"(?<![A-Za-z0-9_])[A-Za-z]", re.ASCII)
_MAX_TERMS, _MAX_DEGREE, _MAX_BITS = 2_000, 60, 2_000
"""Of what a part of the text stands for, so that no text takes long; the energy has some 30 terms of degree 5."""


class _TooLarge(Violation):
    """A part of the text has too many terms to go on with."""


def check_potential(claims: Claims) -> str:
    """The unknowns, and the potential or the equations in them."""
    system, model = claims.result.system, claims.result.slice.model
    unknowns = tuple(model.unknowns)
    if system.unknowns != unknowns:
        raise Violation(f"the unknowns are {system.unknowns}, not {unknowns}")
    bars = 0
    if (
        isinstance(model, ClosedMechanism)
        and form_of(claims.result.slice).closing
        and claims.result.slice.has_free_lengths
    ):
        bars, model = len(model.mechanism.closing), model.mechanism
    of_mechanism = isinstance(model, Mechanism)
    if bars and len(system.relations) != bars:
        raise Violation(f"there are {bars} loops that are closed, and {len(system.relations)} relations")
    if (system.relations and not bars) or system.hessian or ((model.has_potential or of_mechanism) and system.gradient):
        raise Violation("a certified map has no relations, and its gradient and Hessian follow from the potential")
    if system.moments and (model.has_potential or not of_mechanism):
        raise Violation("moments are stated beside the potential where one depends on another unknown only")
    text = _Text(model)
    if model.has_potential:
        pairs = [("potential", system.potential, _energy(model))]
    elif isinstance(model, Mechanism):
        pairs = _with_moments(text, system)
    else:
        equations = formulas(text.configuration, model).equations
        if system.potential or len(system.gradient) != len(equations):
            raise Violation(f"there are {len(equations)} equations and no potential")
        pairs = [(f"equation {k}", t, e) for k, (t, e) in enumerate(zip(system.gradient, equations, strict=True))]
    pairs += _conditions(text, system)
    if bars:
        assert isinstance(model, Mechanism)
        kept = distances(model, text.configuration.points(model), text.configuration.value)
        pairs += [(f"relation {k}", t, r) for k, (t, r) in enumerate(zip(system.relations, kept, strict=True))]
    unchecked = [reason for what, stored, true in pairs if (reason := _compared(text, what, stored, true))]
    if unchecked:
        return Unchecked(unchecked[0])
    what = "the potential" if model.has_potential else "the equations"
    what = "the potential and the moments" if system.moments else what
    return f"{what} in {len(unknowns)} unknowns and {len(model.variables)} parameters"


def _with_moments(text: _Text, system: System) -> list[tuple[str, str, fmpq_mpoly]]:
    """The stored energy and what is taken off its slopes, where a moment has no potential; each with what it has to be.

    Raises
    ------
    Violation
        When there is not one moment for each unknown.
    """
    model = text.model
    assert isinstance(model, Mechanism)
    if len(system.moments) != len(model.unknowns):
        raise Violation(f"there are moments on {len(model.unknowns)} unknowns, not {len(system.moments)}")
    true = dict.fromkeys(model.unknowns, text.ring.constant(0))
    for unknown, tree in model.moments:
        true[unknown] = true[unknown] + text.configuration.value(tree)
    named = zip(system.moments, true.items(), strict=True)
    return [
        ("potential", system.potential, _energy(model)),
        *((f"moment on {unknown}", stored, value) for stored, (unknown, value) in named),
    ]


def _conditions(text: _Text, system: System) -> list[tuple[str, str, fmpq_mpoly]]:
    """The stored inequalities and conditions for stability, with what each of them has to be.

    Raises
    ------
    Violation
        When there are not as many as in the description.
    """
    true = ((), ()) if isinstance(text.model, Mechanism) else formulas(text.configuration, text.model)[2:4]
    pairs = []
    for what, stored, values in zip(
        ("inequality", "condition for stability"), (system.inequalities, system.stability), true, strict=True
    ):
        if len(stored) != len(values):
            raise Violation(f"there are {len(values)} of the kind {what}, not {len(stored)}")
        pairs += [(f"{what} {k}", one, value) for k, (one, value) in enumerate(zip(stored, values, strict=True))]
    return pairs


def _compared(text: _Text, what: str, stored: str, true: fmpq_mpoly) -> str:
    """Why a text was not compared with what it has to be; empty when they are equal.

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
    if not (text.is_less_work(difference) if text.varying else difference.is_zero()):
        raise Violation(f"the stored {what} differs from the mechanism's by {text.shown(difference)}")
    return ""


class _Text:
    """The ring of a model's texts, and what they stand for.

    Attributes
    ----------
    outside : the names that may stand outside of cosines and sines.
    squares : the squares of the springs' lengths, each once, in normal form.
    varying : the moments that depend on their own unknown, by unknown; none where one depends on another, as
        moments are stated then.
    """

    def __init__(self, model: Model):
        self.model = model
        springs = len(model.springs) if isinstance(model, Mechanism) else 0
        kinds = [(f"cos {a}", f"sin {a}") for a in model.angles]
        names = [f"l{n}" for n in range(springs)] + [name for pair in kinds for name in pair]
        names += [f"unknown {n}" for n in model.unknowns] + [f"parameter {n}" for n in model.variables]
        # plain names for the ring: those of a description may be any
        self._shown = [re.sub(r"^(cos|sin) (.*)", r"\1(\2)", name).removeprefix("unknown ") for name in names]
        ring = tuple(f"x{k}" for k in range(len(names)))
        self.ring: fmpq_mpoly_ctx = fmpq_mpoly_ctx.get(ring, Ordering.lex)
        self._gen = {name: self.ring.gen(k) for k, name in enumerate(names)}
        circles = {a: (self._gen[f"cos {a}"], self._gen[f"sin {a}"]) for a in model.angles}
        known = {n: self._gen[f"parameter {n}"] for n in model.variables}
        self.names = known | {n: self._gen[f"unknown {n}"] for n in model.unknowns}
        self.configuration = Configuration(known | {n: self.names[n] for n in model.reals}, circles)
        moments = dict(model.moments) if isinstance(model, Mechanism) and model.has_potential else {}
        self.varying = {u: self.configuration.value(tree) for u, tree in moments.items() if u in names_of(tree)}
        moved = set(moments)
        self.outside = {*known, *model.reals, *moved}
        self.circles = [c * c + s * s - 1 for c, s in circles.values()]

    def shown(self, p: fmpq_mpoly) -> str:
        """The beginning of a polynomial's text."""
        text = re.sub(r"x([0-9]+)", lambda m: self._shown[int(m[1])].removeprefix("parameter "), str(p)[:400])
        return text[:80]

    @cached_property
    def squares(self) -> list[fmpq_mpoly]:
        found: list[fmpq_mpoly] = []
        if isinstance(self.model, Mechanism):
            points = self.configuration.points(self.model)
            for spring in self.model.springs:
                across, up = (points[spring.end][i] - points[spring.start][i] for i in (0, 1))
                square = self.on_circles(self.ring.constant(0) + across * across + up * up)
                if square not in found:
                    found.append(square)
        return found

    def length(self, square: Any) -> fmpq_mpoly:
        """The length whose square is given.

        Raises
        ------
        ValueError
            When no spring has it.
        """
        return self._gen[f"l{self.squares.index(self.reduced(square))}"]

    def on_circles(self, p: fmpq_mpoly) -> fmpq_mpoly:
        """At most the first power of each cosine."""
        for circle in self.circles:
            p = divmod(p, circle)[1]
        return p

    def reduced(self, p: Any) -> fmpq_mpoly:
        """The normal form: at most the first power of each length and of each cosine."""
        p = self.ring.constant(0) + p
        for n, square in enumerate(self.squares):
            p = divmod(p, self._gen[f"l{n}"] ** 2 - square)[1]
        return self.on_circles(p)

    def is_less_work(self, p: fmpq_mpoly) -> bool:
        """Whether a normal form is minus the work of the varying moments from where all unknowns are zero.

        That is told by its slopes; no moment is integrated.
        """
        springs = len(self.squares)
        if any(degree > 0 for degree in p.degrees()[:springs]):
            return False
        place: dict[str | int, int | fmpz | fmpq] = {str(self.names[name]): 0 for name in self.model.unknowns}
        for angle in self.model.angles:
            place |= {str(self._gen[f"cos {angle}"]): 1, str(self._gen[f"sin {angle}"]): 0}
        slopes = {
            u: self.on_circles(self._slope(p, u) + self.varying.get(u, fmpq(0))).is_zero() for u in self.model.unknowns
        }
        return all(slopes.values()) and bool(p.subs(place).is_zero())

    def _slope(self, p: fmpq_mpoly, unknown: str) -> fmpq_mpoly:
        """The derivative by an unknown, also where it stands outside of cosines and sines."""
        slope = p.derivative(str(self.names[unknown]))
        if unknown in self.model.angles:
            c, s = self._gen[f"cos {unknown}"], self._gen[f"sin {unknown}"]
            slope += c * p.derivative(str(s)) - s * p.derivative(str(c))
        return slope

    def value(self, what: str, text: str) -> fmpq_mpoly:
        """What a text stands for.

        Raises
        ------
        RecursionError
            When it has too many parts within each other.
        """
        return self._value(_parsed(what, text))

    def _value(self, node: ast.expr, inside: bool = False) -> fmpq_mpoly:
        """What sums, products, small powers, quotients by numbers, lengths, sines and cosines stand for.

        Parameters
        ----------
        inside : of a cosine or a sine, where all angles may stand.
        """
        match node:
            case ast.Constant(value=int(number)) if not isinstance(number, bool):
                return _bounded(self.ring.constant(number))
            case ast.Name(id=name) if _plain(name) in self.outside or (inside and _plain(name) in self.names):
                return self.names[_plain(name)]
            case ast.UnaryOp(op=ast.USub(), operand=inner):
                return -self._value(inner, inside)
            case ast.BinOp(left=base, op=ast.Pow(), right=ast.Constant(value=int(exponent))) if (
                0 <= exponent <= _MAX_DEGREE
            ):
                power, factor = self.ring.constant(1), self._value(base, inside)
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
                        return _product(a, self.ring.constant(1 / b.coeffs()[0]))
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
        cosine, sine = self.ring.constant(1), self.ring.constant(0)
        for angle, multiple in self._angles(inner, node).items():
            c, s = self._gen[f"cos {angle}"], self._gen[f"sin {angle}"]
            for _ in range(abs(multiple)):
                turned = s if multiple > 0 else -s
                cosine, sine = (
                    _product(cosine, c) - _product(sine, turned),
                    _product(sine, c) + _product(cosine, turned),
                )
        return cosine if name == "cos" else sine

    def _angles(self, inner: ast.expr, node: ast.expr) -> dict[str, int]:
        """The whole multiples of angles of which a text is the sum."""
        rest, found = self._value(inner, inside=True), {}
        for angle in self.model.angles:
            unknown = self.names[angle]
            c = rest.derivative(unknown.context().variable_to_index(str(unknown)))
            if not c.is_constant():
                break
            multiple = fmpq(0) if c.is_zero() else c.coeffs()[0]
            if multiple.q != 1 or abs(multiple) > _MAX_DEGREE:
                break
            found[angle] = int(multiple.p)
            rest = rest - multiple * unknown
        if not rest.is_zero():
            raise Violation(f"the stored potential has a part that is no formula: {_shown(node)}")
        return found


@lru_cache(maxsize=8)
def _energy(model: Model) -> fmpq_mpoly:
    """The potential of a system, or of a mechanism whose springs have free lengths, with the moments that have one."""
    text = _Text(model)
    if not isinstance(model, Mechanism):
        given: Any = formulas(text.configuration, model).energy
        return text.reduced(given)
    energy: Any = text.ring.constant(0) + potential(text.configuration, model, text.length)
    for unknown, tree in model.moments if model.has_potential else ():
        if unknown in text.varying:
            continue
        energy = energy - text.configuration.value(tree) * text.names[unknown]
    return text.reduced(energy)


def _plain(name: str) -> str:
    """A name without the letter before it that keeps it from being one of Python's words."""
    return name[1:]


def _parsed(what: str, text: str) -> ast.expr:
    if len(text) > _LARGE_TEXT:
        raise _TooLarge(f"the stored {what} is longer than {_LARGE_TEXT} letters")
    text = in_quotients(text)
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
        raise _TooLarge("the stored potential has a part of too many terms, too high a degree or too long numbers")
    return p
