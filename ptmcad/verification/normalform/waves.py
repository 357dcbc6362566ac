"""The equations of any model as sums of waves, from its description: Fourier's normal form in the
unknown angles.

Guarantee: exact; polynomials over Q in the parameters. Angles are read as exponentials, and a real
number is a sum of products of one wave, a cosine or a sine of a sum of whole multiples of angles,
with powers of the real unknowns.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache, partial
from itertools import product
from typing import NamedTuple

from flint import Ordering, fmpq, fmpq_mpoly, fmpq_mpoly_ctx

from ptmcad.model import Model
from ptmcad.question.counts import Count
from ptmcad.question.slice import Slice
from ptmcad.text.expressions import Expression, constant
from ptmcad.verification.coordinates import CoordinateRing, circle_names, evaluated
from ptmcad.verification.derivation import Derivation, SpringVector, derivation_of
from ptmcad.verification.kinds import has_margins
from ptmcad.verification.normalform.springlines import SpringLine, Vanishes, line_of

Multi = tuple[int, ...]
"""For each unknown the multiple of an angle, or the power of a real unknown."""
Key = tuple[Multi, Multi, int]
"""The multiples, the powers, and 0 for the cosine or 1 for the sine."""
Waves = Mapping[Key, fmpq_mpoly]
"""Factors of the waves, polynomials in the parameters; the first multiple that is not zero is
positive, and there is no sine of nothing."""
Vector = tuple[Waves, Waves]
Sides = Mapping[str, int]
"""1 or -1 by the name of each spring on a line: the sign of s."""


class SpringCone(NamedTuple):
    """A spring with a free length, which takes K times its vector's length off the potential.

    Attributes
    ----------
    pull : K, the stiffness times the free length.
    vector : between the spring's ends.
    weights : for each equation the vector whose product with the spring's direction, times K, it
        lacks: the vector's derivative by the unknown, but with closed loops that along them in the
        last equation, and nothing in others.
    line : along which the vector stays all over the slice, if there is one.
    """

    name: str
    pull: fmpq_mpoly
    vector: Vector
    weights: tuple[Vector, ...]
    line: SpringLine | None


class SpringMargin(NamedTuple):
    """A spring that is to be longer than its free length where a stable solution counts.

    Attributes
    ----------
    value : |vector|^2 - free^2.
    vector : between the spring's ends.
    free : its free length, a polynomial in the parameters.
    """

    value: Waves
    vector: Vector
    free: fmpq_mpoly


@dataclass(frozen=True, eq=False)
class Form:
    """What is zero at a solution, one equation for each unknown.

    Attributes
    ----------
    is_circle : of each unknown, whether it is an angle.
    is_gradient : whether the equations are the derivatives of a potential, so that the Jacobian is
        a Hessian.
    equations : without the parts of the cones; divided by powers of real unknowns that are not zero
        where a solution counts.
    inequalities, stability : positive at solutions that count, and at stable ones.
    multiples : of the equations, before they were divided.
    margins : what a kind of count asks of stable solutions besides.
    closing : with closed loops and cones the numbers of the unknowns, angles first: the first
        equations say that the loops are closed, no cone is in them, and a solution is stable where
        the determinant of the Jacobian, its columns in this order, is positive; there is no other
        condition for stability then. Empty otherwise.
    """

    unknowns: tuple[str, ...]
    is_circle: tuple[bool, ...]
    is_gradient: bool
    equations: tuple[Waves, ...]
    cones: tuple[SpringCone, ...]
    inequalities: tuple[Waves, ...] = ()
    stability: tuple[Waves, ...] = ()
    multiples: tuple[Waves, ...] = ()
    closing: tuple[int, ...] = ()
    margins: tuple[SpringMargin, ...] = ()

    @property
    def conditions_for_stability(self) -> int:
        """How many there are."""
        return 1 if self.closing else len(self.stability)

    @property
    def rigid(self) -> tuple[Waves, ...]:
        """The equations in which no cone is."""
        return self.equations[:-1] if self.closing else () if self.cones else self.equations

    @property
    def size(self) -> int:
        """The number of unknowns."""
        return len(self.unknowns)

    @property
    def is_smooth_on_a_torus(self) -> bool:
        """Whether the alternating sum of the index is zero (Poincare and Hopf; moments do not
        matter).
        """
        return self.is_gradient and all(self.is_circle) and not (self.cones or self.inequalities)


class _Exponentials:
    """Polynomials in the parameters, the real unknowns, the imaginary unit and the exponentials of
    the angles.

    Parameters
    ----------
    ring : of what is read as waves.
    """

    def __init__(self, model: Model, ring: CoordinateRing):
        self.unknowns = tuple(model.unknowns)
        parameters = tuple(model.variables) or ("no parameter",)  # a ring has a variable
        turns = [f"{way} {angle}" for angle in model.angles for way in ("exp", "inverse")]
        names = [*parameters, *model.reals, "imaginary unit", *turns]
        self.context: fmpq_mpoly_ctx = fmpq_mpoly_ctx.get(
            tuple(f"x{k}" for k in range(len(names))), Ordering.lex
        )
        places = {name: k for k, name in enumerate(names)}
        known = dict(zip(names, self.context.gens(), strict=True))
        half, i = fmpq(1, 2), known["imaginary unit"]
        self.squares = [i * i + 1]
        for angle in model.angles:
            e, f = known[f"exp {angle}"], known[f"inverse {angle}"]
            self.squares.append(e * f - 1)
            known |= dict(
                zip(circle_names(angle), ((e + f) * half, -i * (e - f) * half), strict=True)
            )
        self.images = [known[name] for name in ring.names]
        self.reals = {n: places[n] for n in model.reals}
        self.turns = {a: (places[f"exp {a}"], places[f"inverse {a}"]) for a in model.angles}
        self.unit = places["imaginary unit"]
        self.numbers: fmpq_mpoly_ctx = fmpq_mpoly_ctx.get(parameters, Ordering.lex)

    def vector(self, vector: tuple[fmpq_mpoly, fmpq_mpoly]) -> Vector:
        """Those of both coordinates."""
        return self.waves(vector[0]), self.waves(vector[1])

    def waves(self, value: fmpq_mpoly) -> Waves:
        """Those of a polynomial in coordinates and parameters."""
        p = value.compose(*self.images, ctx=self.context)
        for square in self.squares:
            p = divmod(p, square)[1]
        zero, count = (0,) * len(self.unknowns), self.numbers.nvars()
        found = []
        for exponents, c in p.terms():
            powers = [int(e) for e in exponents]
            turned, raised = list(zero), list(zero)
            for k, name in enumerate(self.unknowns):
                if name in self.reals:
                    raised[k] = powers[self.reals[name]]
                else:
                    ahead, back = self.turns[name]
                    turned[k] = powers[ahead] - powers[back]
            # the real part of the exponential of i w is cos w, and that of i times it is -sin w
            sine = powers[self.unit]
            factor = self.numbers.from_dict({(*powers[:count],): -c if sine else c})
            found.append(((tuple(turned), tuple(raised), sine), factor))
        return _collected(found)


def _collected(terms: Iterable[tuple[Key, fmpq_mpoly]]) -> Waves:
    found: dict[Key, fmpq_mpoly] = {}
    for (turned, raised, sine), c in terms:
        lead = next((m for m in turned if m), 0)
        if not lead and sine:
            continue
        key = (tuple(-m for m in turned) if lead < 0 else turned), raised, sine
        signed = -c if lead < 0 and sine else c
        found[key] = found[key] + signed if key in found else signed
    return {key: c for key, c in found.items() if not c.is_zero()}


def by(f: Waves, k: int) -> Waves:
    """The derivative by an unknown."""
    found = []
    for (turned, raised, sine), c in f.items():
        if turned[k]:
            found.append(((turned, raised, 1 - sine), c * (turned[k] if sine else -turned[k])))
        if raised[k]:
            lower = tuple(e - (k == j) for j, e in enumerate(raised))
            found.append(((turned, lower, sine), c * raised[k]))
    return _collected(found)


def form_of(slice: Slice) -> Form:
    """The form of a slice's model."""
    return _form(slice.model, tuple(slice.parameters.items()), slice.count)


@lru_cache(maxsize=8)
def _form(model: Model, values: tuple[tuple[str, Expression], ...], count: Count) -> Form:
    true = derivation_of(model)
    ring = _Exponentials(model, true.ring)
    unknowns = ring.unknowns
    known = {name: constant(0) for name in ring.numbers.names()} | dict(values)

    def on_slice(p: fmpq_mpoly) -> Expression:
        """A polynomial in the parameters as a function of the axes."""
        value: Expression = constant(0) + evaluated(p, known)
        return value

    def vanishes(p: fmpq_mpoly) -> bool:
        return not on_slice(p).numerator

    def says_something(condition: Waves) -> bool:
        """Of others nothing is stored: they are positive numbers all over the slice."""
        [*terms] = condition.items()
        if len(terms) != 1 or any(map(any, terms[0][0][:2])):
            return True
        value = on_slice(terms[0][1])
        return not (value.is_constant and value.constant() > 0)

    inequalities, stability = (
        list(filter(says_something, map(ring.waves, some)))
        for some in (true.inequalities, true.stability)
    )
    multiples: list[Waves] = []
    if true.from_energy:
        given = dict(zip(true.unknowns, true.equations, strict=True))
        equations = [ring.waves(given[unknown]) for unknown in unknowns]
    else:
        whole = list(map(ring.waves, true.equations))
        equations = [_divided(e, inequalities) for e in whole]
        multiples = [e for e, f in zip(whole, equations, strict=True) if e != f]
    cones = tuple(_cones(ring, true, vanishes))
    closing = tuple(map(unknowns.index, true.unknowns)) if cones and true.closing else ()
    if closing:
        stability = []  # the determinant of the whole Jacobian
    return Form(
        unknowns,
        tuple(name in model.angles for name in unknowns),
        true.is_gradient,
        tuple(equations),
        cones,
        tuple(inequalities),
        tuple(stability),
        tuple(multiples),
        closing,
        tuple(map(partial(_margin, ring), true.springs)) if has_margins(count) else (),
    )


def _margin(ring: _Exponentials, spring: SpringVector) -> SpringMargin:
    free = next(iter(ring.waves(spring.free).values()), ring.numbers.constant(0))
    value = ring.waves(spring.squared - spring.free**2)
    return SpringMargin(value, ring.vector(spring.vector), free)


def _divided(f: Waves, inequalities: Iterable[Waves]) -> Waves:
    """An equation without the factors h of which it is known that h = 0 makes some inequality's
    polynomial zero.
    """
    found = dict(f)
    for c in inequalities:
        for k in range(len(next(iter(c))[1]) if c else 0):
            power = min((raised[k] for _, raised, _ in found), default=0)
            if power and all(raised[k] for _, raised, _ in c):
                found = {
                    (
                        turned,
                        tuple(e - power * (j == k) for j, e in enumerate(raised)),
                        sine,
                    ): factor
                    for (turned, raised, sine), factor in found.items()
                }
    return found


def _cones(ring: _Exponentials, true: Derivation, vanishes: Vanishes) -> Iterable[SpringCone]:
    """The springs with a free length."""
    everything = range(len(ring.unknowns))
    for spring in true.pulling:
        pull, vector = ring.waves(spring.pull), ring.vector(spring.vector)
        if all(map(vanishes, pull.values())) or not any(
            by(d, k) for d in vector for k in everything
        ):
            continue
        weights = [(by(vector[0], k), by(vector[1], k)) for k in everything]
        if true.closing:
            across, up = map(true.along_loops, spring.vector)
            weights = [*[({}, {})] * (len(weights) - 1), ring.vector((across, up))]
        (strength,) = pull.values()
        yield SpringCone(spring.name, strength, vector, tuple(weights), line_of(vector, vanishes))


def sides(form: Form) -> Iterator[Sides]:
    """All choices of sides; a single empty one where no spring is on a line.

    Where d = s e with a fixed e, or one that is turned by a sum of angles, a spring's direction is
    e/|e| or -e/|e| wherever it has a length, so that solutions are those of the equations with
    either one, at which s is positive or negative. Springs without length are no solutions. Where
    half an angle is in that sum, a full turn of the angle changes sides: each side has its own part
    of any box of the angles, and one configuration is on both sides at the box's two ends.
    """
    names = [cone.name for cone in form.cones if cone.line is not None]
    for chosen in product((1, -1), repeat=len(names)):
        yield dict(zip(names, chosen, strict=True))
