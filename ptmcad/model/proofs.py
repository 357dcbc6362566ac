"""What a description of a mechanism has to satisfy and no single entry shows: rigid bars, no loose unknown, symmetries.

Guarantee: exact; decided in Q[parameters, lengths][cos, sin], reduced by cos^2 + sin^2 = 1. A bar is accepted only when
its length was proved constant, a symmetry only when it was proved to be one; an unknown is refused only when its
equation was proved to vanish identically.

The ring is a small one of its own: readers and checkers load no algebra.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from fractions import Fraction
from typing import NamedTuple

from ptmcad.errors import ConfigError, ExpressionError, Faults
from ptmcad.model.description import Mechanism, Model
from ptmcad.model.elements import NAMES, squared_distance
from ptmcad.model.evaluate import Named, evaluated, multiples, value_at
from ptmcad.model.trees import ZERO
from ptmcad.text.tree import Name, Tree, names_of, replaced

MAX_WORK = 12_000
"""Products of terms for one question, a fraction of a second; two bars and a spring take some hundred."""

Monomial = tuple[tuple[str, int], ...]
"""Variables with their exponents, in order; the cosine of an angle is ``cos NAME``, its exponent at most 1."""


class Polynomial:
    """An element of the ring; it changes only while it is made."""

    __slots__ = ("ring", "terms")

    def __init__(self, ring: Ring, terms: dict[Monomial, Fraction]):
        self.ring = ring
        self.terms = terms

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Polynomial) and self.terms == other.terms

    def __hash__(self) -> int:
        return hash(frozenset(self.terms.items()))

    def __add__(self, other: Polynomial) -> Polynomial:
        return self._plus(other, 1)

    def __sub__(self, other: Polynomial) -> Polynomial:
        return self._plus(other, -1)

    def _plus(self, other: Polynomial, sign: int) -> Polynomial:
        terms = dict(self.terms)
        for monomial, c in other.terms.items():
            total = terms.get(monomial, 0) + sign * c
            if total:
                terms[monomial] = Fraction(total)
            else:
                terms.pop(monomial, None)
        return Polynomial(self.ring, terms)

    def __mul__(self, other: Polynomial) -> Polynomial:
        self.ring.spend(len(self.terms) * len(other.terms))
        terms: dict[Monomial, Fraction] = {}
        for one, a in self.terms.items():
            for two, b in other.terms.items():
                for monomial, sign in _product(one, two):
                    terms[monomial] = terms.get(monomial, Fraction(0)) + sign * a * b
        return Polynomial(self.ring, {m: c for m, c in terms.items() if c})

    def derivative(self, unknown: str) -> Polynomial:
        """By an unknown, on the line or on the circle."""
        cosine, sine = f"cos {unknown}", f"sin {unknown}"
        total = Polynomial(self.ring, {})
        for monomial, c in self.terms.items():
            for variable, e in monomial:
                if variable not in (unknown, cosine, sine):
                    continue
                rest = Polynomial(self.ring, {_with(monomial, variable, e - 1): e * c})
                if variable == cosine:
                    total -= rest * self.ring.variable(sine)
                else:
                    total += rest if variable == unknown else rest * self.ring.variable(cosine)
        return total


class Ring:
    """Q[parameters, lengths][cos, sin], as a ring in which trees have values; it stops after so much work."""

    def __init__(self, most: int = MAX_WORK) -> None:
        self.work = 0
        self.most = most

    def spend(self, work: int) -> None:
        """Note work.

        Raises
        ------
        ExpressionError
            When it is too much.
        """
        self.work += work
        if self.work > self.most:
            raise ExpressionError("the expressions are too large to be multiplied out")

    def constant(self, value: Fraction) -> Polynomial:
        return Polynomial(self, {(): value} if value else {})

    def variable(self, name: str) -> Polynomial:
        return Polynomial(self, {((name, 1),): Fraction(1)})

    parameter = variable

    def cos(self, angle: str) -> Polynomial:
        return self.variable(f"cos {angle}")

    def sin(self, angle: str) -> Polynomial:
        return self.variable(f"sin {angle}")


def _with(monomial: Monomial, variable: str, exponent: int) -> Monomial:
    """The monomial with another exponent of a variable that it has."""
    return tuple((v, exponent if v == variable else e) for v, e in monomial if v != variable or exponent)


def _product(one: Monomial, two: Monomial) -> Iterator[tuple[Monomial, int]]:
    """The product of two monomials, as terms with cosines to the power of at most 1."""
    exponents = dict(one)
    for variable, e in two:
        exponents[variable] = exponents.get(variable, 0) + e
    found: list[tuple[dict[str, int], int]] = [(exponents, 1)]
    for cosine in [v for v, e in exponents.items() if e > 1 and v.startswith("cos ")]:
        sine = f"sin {cosine[4:]}"
        split = []
        for powers, sign in found:  # cos^2 = 1 - sin^2
            rest = {v: e for v, e in powers.items() if v != cosine}
            split += [(rest, sign), ({**rest, sine: rest.get(sine, 0) + 2}, -sign)]
        found = split
    for powers, sign in found:
        yield tuple(sorted(powers.items())), sign


def check_bars(mechanism: Mechanism, faults: Faults) -> None:
    """Note each bar whose length varies, or is too large an expression."""
    points = Points(mechanism)
    rigid = {bar for joint in mechanism.xjoints for bar in joint.rigid}
    for n, (start, end) in enumerate(mechanism.bars, 1):
        key = f"bars.{n}"
        if (start, end) in rigid:
            continue  # by the joint's own formulas
        with faults:
            try:
                squared = points.squared(start, end)
                loose = [u for u in (*mechanism.unknowns, *mechanism.followers) if squared.derivative(u).terms]
            except ExpressionError as error:
                raise ConfigError(f"it is not proved that its length is constant: {error.message}", key=key) from None
            if loose:
                raise ConfigError(
                    f"the length of {start}{end} is not constant, it varies with {' and '.join(loose)}: a bar is "
                    "rigid; leave it out, or make it a spring",
                    key=key,
                )


def check_elements(mechanism: Mechanism, faults: Faults) -> None:
    """Note each spring whose length or angle no unknown changes."""
    points = Points(mechanism)
    closing = [frozenset(names_of(squared_distance(NAMES, bar.start, bar.end))) for bar in mechanism.closing]
    for key, element in mechanism.elements.items():
        varying = element.varying
        if varying is not None and frozenset(names_of(varying)) not in closing and points.varies(varying):
            continue
        with faults:
            if element.idle:
                raise ConfigError(element.idle, key=key)


def check_numbers(model: Model, faults: Faults) -> None:
    """Note each stiffness or length that is a number, and one that makes no sense."""
    for part in model.parts:
        if names_of(part.tree):
            continue  # a slice tells what it is in its window
        with faults:
            if problem := part.fault(value_at(part.tree, {})):
                raise ConfigError(problem, key=part.key)


def check_unknowns(mechanism: Mechanism, faults: Faults) -> None:
    """Note each unknown whose equation vanishes identically: nothing holds it."""
    held: set[str] = set()
    try:
        held = _held(mechanism)
    except ExpressionError:
        return  # the engines find out
    for unknown, kind in mechanism.unknowns.items():
        with faults:
            if unknown not in held:
                motion = "turns" if kind.turns else "moves"
                raise ConfigError(
                    f"no equation holds this unknown: no spring or load feels how it {motion}",
                    key=f"unknowns.{unknown}",
                )


def _held(mechanism: Mechanism) -> set[str]:
    """The unknowns whose equations do not vanish identically."""
    points = Points(mechanism)
    energy, roots, work = felt(points)
    held = {unknown for unknown, moment in work.items() if moment.terms}
    # a root does not cancel against the rest
    lengths = [squared for _, squared in roots]
    lengths += [points.squared(bar.start, bar.end) for bar in mechanism.closing]
    held.update(u for u in mechanism.unknowns for p in (energy, *lengths) if p.derivative(u).terms)
    return held | {first for second, first in mechanism.followers.items() if energy.derivative(second).terms}


def check_symmetries(mechanism: Mechanism, faults: Faults) -> None:
    """Note each substitution that is not proved to leave the equilibria as they are."""
    for n, images in enumerate(mechanism.symmetries, 1):
        key = f"symmetries.{n}"
        with faults:
            try:
                here, there = felt(Points(mechanism)), felt(Points(mechanism, images=images))
                change = here.energy - there.energy
                holds = here[1:] == there[1:] and not any(change.derivative(u).terms for u in mechanism.unknowns)
            except ExpressionError as error:
                raise ConfigError(f"it is not proved to be a symmetry: {error.message}", key=key) from None
            if not holds:
                raise ConfigError(
                    "this is no symmetry: with these substitutions the energy changes by something that varies with an "
                    "unknown, or the moments do other work; leave it out, or mend it",
                    key=key,
                )


class Felt(NamedTuple):
    """What unknowns feel: the energy's polynomial part, its roots (pull, squared length), and the moments' work along
    each unknown. Equilibria are the same where these are, but for numbers in the energy."""

    energy: Polynomial
    roots: Counter[tuple[Polynomial, Polynomial]]
    work: dict[str, Polynomial]


def felt(points: Points) -> Felt:
    """What unknowns feel in a mechanism."""
    mechanism, zero = points.mechanism, points.ring.constant(Fraction(0))
    energy, roots = zero, Counter[tuple[Polynomial, Polynomial]]()
    for element in mechanism.elements.values():
        *energies, pull, squared = points.values((*element.energies, *(element.root or (ZERO, ZERO))))
        energy = sum(energies, energy)
        if pull.terms:
            roots[pull, squared] += 1
    work = dict.fromkeys(mechanism.unknowns, zero)
    for own, value in mechanism.work.items():
        for unknown, c in multiples(points.images.get(own, Name(own))).items():
            if unknown in work:
                work[unknown] += points.value(value) * points.ring.constant(c)
    return Felt(energy, roots, work)


class Points:
    """The coordinates of a mechanism's points, each computed once, and what is made of them.

    Parameters
    ----------
    images : trees in place of names.
    """

    def __init__(self, mechanism: Mechanism, ring: Ring | None = None, images: Mapping[str, Tree] | None = None):
        self.mechanism = mechanism
        self.ring = ring or Ring()
        self.images = images or {}
        self.placed = Named(
            self.ring, {name: replaced(tree, self.images) for name, tree in mechanism.coordinates.items()}
        )

    def value(self, tree: Tree) -> Polynomial:
        """Of an expression, in which coordinates are names ``P.x``."""
        return self.values((tree,))[0]

    def values(self, trees: Iterable[Tree]) -> tuple[Polynomial, ...]:
        """The same of several ones, of which parts that they share are evaluated once."""
        return evaluated([replaced(tree, self.images) for tree in trees], self.placed)

    def at(self, name: str) -> tuple[Polynomial, Polynomial]:
        return self.placed.parameter(f"{name}.x"), self.placed.parameter(f"{name}.y")

    def squared(self, start: str, end: str) -> Polynomial:
        """The square of a distance."""
        return self.value(squared_distance(NAMES, start, end))

    def varies(self, tree: Tree) -> bool:
        """Whether an expression changes with an unknown; also where that is too much to be multiplied out."""
        unknowns = {*self.mechanism.unknowns, *self.mechanism.followers}
        names = {name for part in names_of(tree) for name in names_of(self.placed.trees.get(part, Name(part)))}
        if not names & unknowns:
            return False
        try:
            value = self.value(tree)
            return any(value.derivative(u).terms for u in unknowns)
        except ExpressionError:
            return True

    def turning(self, start: str, end: str) -> dict[str, Fraction] | None:
        """By how much the way from one point to another, (x, y), turns with each unknown u, in turns of u: n, where
        dx/du = -n y and dy/du = n x; None where it is no rigid one, or no way at all."""
        (x0, y0), (x1, y1) = self.at(start), self.at(end)
        x, y = x1 - x0, y1 - y0
        if not (x.terms or y.terms):
            return None
        term, c = next(iter((x.terms or y.terms).items()))
        found = {}
        for unknown in (*self.mechanism.unknowns, *self.mechanism.followers):
            dx, dy = x.derivative(unknown), y.derivative(unknown)
            n = dy.terms.get(term, Fraction(0)) / c if x.terms else -dx.terms.get(term, Fraction(0)) / c
            times = self.ring.constant(n)
            if (dy - times * x).terms or (dx + times * y).terms:
                return None
            found[unknown] = n
        return found
