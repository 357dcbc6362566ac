"""How many terms a description has once it is multiplied out, bounded before anything is: what is too much is refused.

Guarantee: the bound is one. A sum has no more terms than its parts together, a product no more than theirs multiplied,
and no polynomial of degree d in n variables more than binomial(d + n, n); cosines and sines are variables here.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from fractions import Fraction
from functools import partial
from math import comb

from ptmcad.errors import ConfigError, ExpressionError, Faults
from ptmcad.model.description import Mechanism, Model, System
from ptmcad.model.elements import Load, Spring
from ptmcad.model.evaluate import evaluate
from ptmcad.text.tree import Tree

MAX_TERMS = 50_000
"""Of one expression, and of all that a model's equations are made of; to multiply these out takes about a second."""
TOO_LARGE = f"this is too large to be multiplied out: it may have over {MAX_TERMS} terms"


class Size:
    """What is known of a polynomial: bounds of its degree and of its number of terms, and its variables."""

    __slots__ = ("degree", "terms", "variables")

    def __init__(self, degree: int, variables: frozenset[str], terms: int):
        self.degree = degree
        self.variables = variables
        self.terms = terms

    def __add__(self, other: Size) -> Size:
        return _bounded(max(self.degree, other.degree), self.variables | other.variables, self.terms + other.terms)

    __sub__ = __add__

    def __mul__(self, other: Size) -> Size:
        return _bounded(self.degree + other.degree, self.variables | other.variables, self.terms * other.terms)


def _bounded(degree: int, variables: frozenset[str], terms: int) -> Size:
    if terms > degree:  # else the binomial, a large number, is none that is smaller
        terms = min(terms, comb(degree + len(variables), degree))
    if terms > MAX_TERMS:
        raise ExpressionError(TOO_LARGE)
    return Size(degree, variables, terms)


class Sizes:
    """The ring in which trees have their sizes as values."""

    def constant(self, value: Fraction) -> Size:
        return Size(0, frozenset(), 1)

    def parameter(self, name: str) -> Size:
        return Size(1, frozenset({name}), 1)

    def cos(self, angle: str) -> Size:
        return Size(1, frozenset({f"cos {angle}"}), 1)

    def sin(self, angle: str) -> Size:
        return Size(1, frozenset({f"sin {angle}"}), 1)


def size_of(tree: Tree) -> Size:
    """The size of an expression.

    Raises
    ------
    ExpressionError
        When it may have more than `MAX_TERMS` terms.
    """
    return evaluate(tree, Sizes())


def terms_of(model: Model) -> int:
    """A bound of the number of terms of a model's equations, or of its energy."""
    return sum(size() for _, size in _sizes(model))


def check_sizes(model: Model, faults: Faults) -> None:
    """Note the first part with which a model's equations, or its energy, may have too many terms."""
    total = 0
    with faults:
        for key, size in _sizes(model):
            try:
                total += size()
            except ExpressionError as error:
                raise ConfigError(error.message, key=key) from None
            if total > MAX_TERMS:
                raise ConfigError(f"with what stands before, {TOO_LARGE}", key=key)


def _sizes(model: Model) -> Iterator[tuple[str, Callable[[], int]]]:
    """The parts of a model by their keys, each with what bounds its terms."""
    if isinstance(model, System):
        lists = {"equations": model.equations, "positive": model.inequalities, "stable": model.stability}
        for key, trees in lists.items():
            for n, tree in enumerate(trees, 1):
                yield f"{key}.{n}", partial(_terms, tree)
        if model.potential is not None:
            yield "potential", partial(_terms, model.potential)
    elif isinstance(model, Mechanism):
        for n, spring in enumerate(model.springs, 1):
            yield f"springs.{n}", partial(_of_spring, model, spring)
        for n, torsion in enumerate(model.torsion, 1):
            yield f"torsion.{n}", partial(_terms, torsion.energy)
        for load in model.loads:
            yield f"loads.{load.point}", partial(_of_load, model, load)


def _terms(tree: Tree) -> int:
    return size_of(tree).terms


def _of_spring(mechanism: Mechanism, spring: Spring) -> int:
    """Of its energy, without the root of a free length: stiffness times the square of the length."""
    total, stiffness = 0, size_of(spring.stiffness)
    for a, b in zip(mechanism.points[spring.start], mechanism.points[spring.end], strict=True):
        difference = size_of(a) - size_of(b)
        total += (stiffness * (difference * difference)).terms
    return total


def _of_load(mechanism: Mechanism, load: Load) -> int:
    parts = zip((load.x, load.y), mechanism.points[load.point], strict=True)
    return sum((size_of(force) * size_of(place)).terms for force, place in parts)
