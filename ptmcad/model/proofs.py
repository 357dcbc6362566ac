"""What a description of a mechanism has to satisfy and no single entry shows: rigid bars, no loose unknown, symmetries.

Guarantee: exact; decided in Q[parameters, lengths][cos, sin], reduced by cos^2 + sin^2 = 1. A bar is accepted only when
its length was proved constant, a symmetry only when it was proved to be one; an unknown is refused only when its
equation was proved to vanish identically.

The ring is a small one of its own: readers and checkers load no algebra.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping
from fractions import Fraction

from ptmcad.errors import ConfigError, ExpressionError, Faults
from ptmcad.model.description import Mechanism
from ptmcad.model.elements import UnknownKind
from ptmcad.model.evaluate import evaluate, multiples
from ptmcad.text.tree import Call, Name, Negative, Number, Tree, names_of

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


def check_springs(mechanism: Mechanism, faults: Faults) -> None:
    """Note each spring whose length no unknown changes, and each torsion spring whose angle none does."""
    points = Points(mechanism)
    closing = {frozenset((bar.start, bar.end)) for bar in mechanism.closing}
    for n, spring in enumerate(mechanism.springs, 1):
        with faults:
            if frozenset((spring.start, spring.end)) in closing or not points.moves(spring.start, spring.end):
                raise ConfigError(
                    f"the length of {spring.start}{spring.end} is constant, so that this spring does nothing: leave it "
                    "out, or put an end where it moves",
                    key=f"springs.{n}",
                )
    for n, torsion in enumerate(mechanism.torsion, 1):
        with faults:
            if not any(multiples(torsion.angle).get(angle) for angle in (*mechanism.angles, *mechanism.followers)):
                raise ConfigError("no unknown changes its angle, so that this spring does nothing", key=f"torsion.{n}")


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
                motion = "turns" if kind is UnknownKind.ANGLE else "moves"
                raise ConfigError(
                    f"no equation holds this unknown: no spring or load feels how it {motion}",
                    key=f"unknowns.{unknown}",
                )


def _held(mechanism: Mechanism) -> set[str]:
    """The unknowns whose equations do not vanish identically."""
    points = Points(mechanism)
    ring = points.ring
    held = {moment.unknown for moment in mechanism.moments if points.value(moment.value).terms}
    for closing in mechanism.closing:
        squared = points.squared(closing.start, closing.end)
        held.update(u for u in mechanism.unknowns if squared.derivative(u).terms)
    energy = ring.constant(Fraction(0))
    for spring in mechanism.springs:
        squared = points.squared(spring.start, spring.end)
        if isinstance(spring.free, Number) and not spring.free.value:
            energy += points.value(spring.stiffness) * squared
        else:  # the root of the squared length does not cancel against the rest, but where the stiffness does
            held.update(u for u in mechanism.unknowns if squared.derivative(u).terms)
        if len(held) == len(mechanism.unknowns):
            return held
    energy += points.energy_without_springs()  # twice the energy throughout
    held |= {first for second, first in mechanism.followers.items() if energy.derivative(second).terms}
    return held | {u for u in mechanism.unknowns if energy.derivative(u).terms}


def check_symmetries(mechanism: Mechanism, faults: Faults) -> None:
    """Note each substitution that is not proved to leave the equilibria as they are."""
    for n, images in enumerate(mechanism.symmetries, 1):
        key = f"symmetries.{n}"
        with faults:
            try:
                holds = _are_the_same(mechanism, Image(Ring(), {}), Image(Ring(), images))
            except ExpressionError as error:
                raise ConfigError(
                    f"it is not proved to be a symmetry: {error.message}", key=f"symmetries.{n}"
                ) from None
            if not holds:
                raise ConfigError(
                    "this is no symmetry: with these substitutions the energy changes by something that varies with an "
                    "unknown, or the moments do other work; leave it out, or mend it",
                    key=key,
                )


class Image:
    """A ring in which names have the values of their images, in another ring; of some angles half a turn more."""

    def __init__(self, ring: Ring, images: Mapping[str, Tree], turned: Collection[str] = ()):
        self.ring, self.images, self.turned = ring, images, turned

    def constant(self, value: Fraction) -> Polynomial:
        return self.ring.constant(value)

    def parameter(self, name: str) -> Polynomial:
        return evaluate(self.images[name], self.ring) if name in self.images else self.ring.parameter(name)

    def cos(self, angle: str) -> Polynomial:
        return self._wave("cos", angle)

    def sin(self, angle: str) -> Polynomial:
        return self._wave("sin", angle)

    def _wave(self, function: str, angle: str) -> Polynomial:
        value = evaluate(Call(function, self.images.get(angle, Name(angle))), self.ring)
        return self.constant(Fraction(-1)) * value if angle in self.turned else value


def energy_is_kept(
    mechanism: Mechanism, parameters: Mapping[str, Fraction], reflected: Iterable[str], turned: Collection[str]
) -> bool:
    """Whether a reflection is proved to take equilibria at values of the parameters to equilibria.

    Parameters
    ----------
    reflected : unknowns u that become -u.
    turned : those angles of them that become pi - u instead.
    """
    numbers: dict[str, Tree] = {name: Number(value) for name, value in parameters.items()}
    images: dict[str, Tree] = {**numbers, **{name: Negative(Name(name)) for name in reflected}}
    try:
        return _are_the_same(mechanism, Image(Ring(), numbers), Image(Ring(), images, turned))
    except ExpressionError:  # too large to be multiplied out
        return False


def _are_the_same(mechanism: Mechanism, one: Image, other: Image) -> bool:
    """Whether the equilibria are those of the same energy and the same work of moments, but for numbers.

    Springs with a free length have roots in their energies: they are the same when stiffness, free length and squared
    length are.
    """
    (energy, springs, work), (energy2, springs2, work2) = (felt(mechanism, image) for image in (one, other))
    change = energy - energy2
    if springs != springs2 or any(change.derivative(u).terms for u in mechanism.unknowns):
        return False
    return work == work2


_Terms = frozenset[tuple[Monomial, Fraction]]
_Spring = tuple[_Terms, _Terms, _Terms]


def felt(mechanism: Mechanism, ring: Image) -> tuple[Polynomial, Counter[_Spring], dict[str, _Terms]]:
    """Twice the energy without springs of free length, these springs, and the moments' work along each unknown."""
    points = Points(mechanism, ring)
    energy = ring.constant(Fraction(0))
    springs: list[_Spring] = []
    for spring in mechanism.springs:
        squared, k, free = points.squared(spring.start, spring.end), *map(points.value, (spring.stiffness, spring.free))
        if free.terms:
            springs.append((_terms(k), _terms(free), _terms(squared)))
        else:
            energy += k * squared
    energy += points.energy_without_springs()
    work = {u: ring.constant(Fraction(0)) for u in mechanism.unknowns}
    for moment in mechanism.moments:
        for unknown, c in multiples(ring.images.get(moment.unknown, Name(moment.unknown))).items():
            if unknown in work:
                work[unknown] += points.value(moment.value) * ring.constant(c)
    return energy, Counter(springs), {u: _terms(w) for u, w in work.items()}


def _terms(p: Polynomial) -> _Terms:
    return frozenset(p.terms.items())


class Points:
    """The coordinates of a mechanism's points, each computed once."""

    def __init__(self, mechanism: Mechanism, ring: Ring | Image | None = None):
        self.mechanism = mechanism
        self.ring = ring or Ring()
        self.known: dict[str, tuple[Polynomial, Polynomial]] = {}

    def value(self, tree: Tree) -> Polynomial:
        return evaluate(tree, self.ring)

    def at(self, name: str) -> tuple[Polynomial, Polynomial]:
        if name not in self.known:
            x, y = self.mechanism.points[name]
            self.known[name] = self.value(x), self.value(y)
        return self.known[name]

    def moves(self, start: str, end: str) -> bool:
        """Whether a distance changes with an unknown; also where that is too much to be multiplied out."""
        unknowns = {*self.mechanism.unknowns, *self.mechanism.followers}
        if not any({*names_of(tree)} & unknowns for point in (start, end) for tree in self.mechanism.points[point]):
            return False
        try:
            squared = self.squared(start, end)
            return any(squared.derivative(u).terms for u in unknowns)
        except ExpressionError:
            return True

    def squared(self, start: str, end: str) -> Polynomial:
        """The square of a distance."""
        total = self.ring.constant(Fraction(0))
        for a, b in zip(self.at(start), self.at(end), strict=True):
            total += (b - a) * (b - a)
        return total

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

    def energy_without_springs(self) -> Polynomial:
        """Twice the energy of torsion springs, and of the dead forces, whose work it is but for the sign."""
        total = self.ring.constant(Fraction(0))
        for load in self.mechanism.loads:
            for force, place in zip((load.x, load.y), self.at(load.point), strict=True):
                total -= self.value(force) * place
        for torsion in self.mechanism.torsion:
            total += self.value(torsion.energy)
        return total + total
