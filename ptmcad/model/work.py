"""What moments do: those that depend on their own unknown alone have a constant part and the slope
of an energy.

Guarantee: exact. With M = m + w', where m is free of unknowns and w is a polynomial in the
unknown's cosine and sine, or in an unknown on the line, that is zero where the unknown is,
equilibria are those of the energy less w under the moment m. On the circle m is the mean of M,
whose work is another one after each turn; w has one value for each pose. The energy less the work
of m has many values on the circle, so that whatever is said of an energy's descent has to ask for
moments first.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from fractions import Fraction
from functools import lru_cache

from ptmcad.model.description import Mechanism, Model
from ptmcad.model.elements import Load, Moment
from ptmcad.model.evaluate import evaluate, value_at
from ptmcad.model.identities import Monomial, Polynomial, PolynomialRing
from ptmcad.model.trees import product, total
from ptmcad.text.numerals import Numbers
from ptmcad.text.tree import Call, Chain, Name, Negative, Number, Power, Step, Tree, names_of

MAX_WORK = 200_000
"""Products of terms for one moment."""
_Factors = dict[str, int]
_ITSELF: _Factors = {"": 1}


@lru_cache(maxsize=8)
def split_moments(mechanism: Model) -> tuple[tuple[Moment, ...], tuple[Tree, ...]]:
    """The moments that act besides all energies, and the energies of which the rest are slopes.

    The moments are the constant parts; all of them, as they are written, where one depends on
    another unknown than its own. A system has none of either.

    Raises
    ------
    ExpressionError
        When a moment that depends on its unknown is too large to be multiplied out.
    """
    if mechanism.coupled:
        return tuple(Moment(*each) for each in mechanism.work.items()), ()
    steady, energies = [], []
    for unknown, moment in mechanism.work.items():
        if unknown not in names_of(moment):
            steady.append(Moment(unknown, moment))
            continue
        constant, energy = _integrated(evaluate(moment, PolynomialRing(MAX_WORK)), unknown)
        if constant.terms:
            steady.append(Moment(unknown, tree_of(constant, mechanism.angles)))
        if energy.terms:
            energies.append(tree_of(energy, mechanism.angles))
    return tuple(steady), tuple(energies)


def acting(model: Model, unknowns: Iterable[str]) -> str:
    """What works on some unknowns, in words: moments on angles, forces on what is no angle."""
    names = [name for name in model.unknowns if name in set(unknowns)]
    angles = [name for name in names if name in model.angles]
    lengths = [name for name in names if name not in model.angles]
    parts = ["moments" if len(angles) > 1 else "moment"] if angles else []
    if lengths:
        parts.append(f"force{'s' * (len(lengths) > 1)} on {' and '.join(lengths)}")
    return " and the ".join(parts)


def foreign(model: Model) -> str:
    """What depends on another unknown than its own, so that there is no potential; empty where
    nothing does.
    """
    if any(name in model.angles for name in model.coupled):
        return "a moment"
    return "".join([f"the force on {name}" for name in model.unknowns if name in model.coupled][:1])


def moments_at(model: Model, parameters: Numbers) -> dict[str, Fraction]:
    """The unknowns on which a moment that is not zero works, to the moment.

    Parameters
    ----------
    model : one that has a potential: no moment depends on another unknown than its own.
    parameters : all of the model's; free lengths are zero where they are not among them.

    Raises
    ------
    ExpressionError
        When a moment depends on another unknown.
    """
    known = dict.fromkeys(model.free_lengths, Fraction(0)) | dict(parameters)
    found = {unknown: value_at(tree, known) for unknown, tree in split_moments(model)[0]}
    return {unknown: value for unknown, value in found.items() if value}


LoadsAt = tuple[tuple[Load, tuple[Fraction, Fraction]], ...]
"""Loads with their components across and up."""


def loads_at(mechanism: Mechanism, parameters: Numbers) -> LoadsAt:
    """The loads in the description's order where the parameters have values; variables that are not
    among these are zero.
    """
    known = dict.fromkeys(mechanism.variables, Fraction(0)) | dict(parameters)
    return tuple(
        (load, (value_at(load.x, known), value_at(load.y, known))) for load in mechanism.loads
    )


def _integrated(moment: Polynomial, unknown: str) -> tuple[Polynomial, Polynomial]:
    """The constant part, and the energy of the rest that is zero where the unknown is."""
    constant = energy = Polynomial(moment.ring, {})
    own = {unknown, f"cos {unknown}", f"sin {unknown}"}
    for monomial, c in moment.terms.items():
        rest = {v: e for v, e in monomial if v not in own}
        for factors, part in _antiderivative({v: e for v, e in monomial if v in own}, unknown):
            if factors == _ITSELF:
                constant += Polynomial(moment.ring, {_monomial(rest): c * part})
            else:
                energy -= Polynomial(moment.ring, {_monomial(rest | factors): c * part})
    return constant, energy


def _antiderivative(own: _Factors, unknown: str) -> Iterator[tuple[_Factors, Fraction]]:
    """That of a power of an unknown on the line, or of sin^n or sin^n cos; `_ITSELF` is that of a
    constant.
    """
    cosine, sine = f"cos {unknown}", f"sin {unknown}"
    if not own:
        yield _ITSELF, Fraction(1)
    elif unknown in own:
        yield {unknown: own[unknown] + 1}, Fraction(1, own[unknown] + 1)
    elif cosine in own:
        n = own.get(sine, 0) + 1
        yield {sine: n}, Fraction(1, n)
    elif own[sine] == 1:
        yield {}, Fraction(1)
        yield {cosine: 1}, Fraction(-1)
    else:
        n = own[sine]
        yield {cosine: 1, sine: n - 1}, Fraction(-1, n)
        lower = {sine: n - 2} if n > 2 else {}
        for factors, part in _antiderivative(lower, unknown):
            yield factors, part * Fraction(n - 1, n)


def _monomial(factors: _Factors) -> Monomial:
    return tuple(sorted(factors.items()))


def tree_of(p: Polynomial, angles: Sequence[str]) -> Tree:
    """A polynomial as a sum of products."""
    terms = [(_product(monomial, abs(c), angles), c) for monomial, c in sorted(p.terms.items())]
    return total(*(term if c > 0 else Negative(term) for term, c in terms))


def _product(monomial: Monomial, c: Fraction, angles: Sequence[str]) -> Tree:
    parts: list[Tree] = []
    for variable, e in monomial:
        function, _, angle = variable.partition(" ")
        base: Tree = Call(function, Name(angle)) if angle in angles else Name(variable)
        parts.append(base if e == 1 else Power(base, Number(Fraction(e))))
    found = product(Number(Fraction(c.numerator)), *parts)
    if c.denominator == 1:
        return found
    first, steps = (found.first, found.steps) if isinstance(found, Chain) else (found, ())
    return Chain(first, (*steps, Step("/", Number(Fraction(c.denominator)))))
