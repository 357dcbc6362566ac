"""How many terms a description has once it is multiplied out, bounded before anything is: what is
too much is refused, and so are names that have no meaning where they stand.

Guarantee: the bound is one. A sum has no more terms than its parts together, a product no more than
theirs multiplied, and no polynomial of degree d in n variables more than binomial(d + n, n);
cosines and sines are variables here.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from fractions import Fraction
from math import comb

from ptmcad.errors import ConfigError, ExpressionError, Faults
from ptmcad.model.description import Model
from ptmcad.model.evaluate import Named, evaluate
from ptmcad.model.trees import PI
from ptmcad.text.syntax import did_you_mean

MAX_TERMS = 50_000
"""Of one expression, and of all that a model's equations are made of; to multiply these out takes
about a second.
"""
TOO_LARGE = f"this is too large to be multiplied out: it may have over {MAX_TERMS} terms"


class _Size:
    """What is known of a polynomial: bounds of its degree and of its number of terms, and its
    variables.
    """

    __slots__ = ("degree", "terms", "variables")

    def __init__(self, degree: int, variables: frozenset[str], terms: int):
        self.degree = degree
        self.variables = variables
        self.terms = terms

    def __add__(self, other: _Size) -> _Size:
        return _bounded(
            max(self.degree, other.degree),
            self.variables | other.variables,
            self.terms + other.terms,
        )

    __sub__ = __add__

    def __neg__(self) -> _Size:
        return self

    def __mul__(self, other: _Size) -> _Size:
        return _bounded(
            self.degree + other.degree, self.variables | other.variables, self.terms * other.terms
        )


def _bounded(degree: int, variables: frozenset[str], terms: int) -> _Size:
    if terms > degree:  # else the binomial, a large number, is none that is smaller
        terms = min(terms, comb(degree + len(variables), degree))
    if terms > MAX_TERMS:
        raise ExpressionError(TOO_LARGE)
    return _Size(degree, variables, terms)


class Sizes:
    """The ring in which trees have their sizes as values."""

    def constant(self, value: Fraction) -> _Size:
        return _Size(0, frozenset(), 1)

    def parameter(self, name: str) -> _Size:
        return _Size(1, frozenset({name}), 1)

    def cos(self, angle: str) -> _Size:
        return _Size(1, frozenset({f"cos {angle}"}), 1)

    def sin(self, angle: str) -> _Size:
        return _Size(1, frozenset({f"sin {angle}"}), 1)


class KnownNames(Sizes):
    """The ring of sizes, in which names are refused that have no meaning: of angles when their
    cosine is asked for.

    Parameters
    ----------
    constants : parameters, and unknowns on the line where they may stand.
    angles : that may stand in cosines and sines.
    excluded, doubtful : unknowns that may not occur, and those of which nothing more is said.
    """

    def __init__(
        self,
        constants: Iterable[str],
        angles: Iterable[str],
        excluded: Iterable[str],
        doubtful: frozenset[str],
    ):
        # dictionaries for their order and for fast look-up: a hostile record has thousands of names
        self.constants, self.angles, self.excluded = map(
            dict.fromkeys, (constants, angles, excluded)
        )
        self.doubtful = doubtful

    def parameter(self, name: str) -> _Size:
        if name in self.angles and name not in self.doubtful:
            raise ExpressionError(f"{name} is an angle: it stands inside of cos or sin")
        self._check(name, self.constants)
        return super().parameter(name)

    def cos(self, angle: str) -> _Size:
        if angle in self.constants and angle not in self.doubtful:
            # of a rational angle neither is rational, so that no axis could be one
            raise ExpressionError(
                f"{angle} is not an unknown angle: for the cosine and sine of a fixed one use two parameters, given as "
                "(1 - t^2)/(1 + t^2) and 2*t/(1 + t^2), t the tangent of its half"
            )
        self._check(angle, self.angles)
        return super().cos(angle)

    def _check(self, name: str, known: Mapping[str, None]) -> None:
        if name in self.doubtful:
            return
        if name in self.excluded:
            raise ExpressionError(f"{name} is an unknown: only points may depend on it")
        if name == PI:
            raise ExpressionError(
                f"pi is no rational number: name a parameter in its place{did_you_mean(name, ())}"
            )
        if name not in known:
            hint = did_you_mean(name, self.constants | self.angles) or (
                f"; the names are {', '.join(known)}" if known else "; no name is known here"
            )
            raise ExpressionError(f"unknown name '{name[:40]}'{hint}")


def check_sizes(model: Model, faults: Faults) -> None:
    """Note the first part with which a model's equations, or its energy, may have too many terms."""
    ring, total = Named(Sizes(), model.coordinates), 0
    with faults:
        for key, trees in model.polynomials.items():
            try:
                total += sum(evaluate(tree, ring).terms for tree in trees)
            except ExpressionError as error:
                raise ConfigError(error.message, key=key) from None
            if total > MAX_TERMS:
                raise ConfigError(f"with what stands before, {TOO_LARGE}", key=key)
