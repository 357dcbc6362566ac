"""What solutions of a model satisfy, derived here once more from its description: all that the
checks know of a model.

Guarantee: exact. Nothing is taken from what the engines derive: points, springs, loads and
equations of the description are read by `coordinates`, and polynomials are differentiated here.
Springs have no free length in energy and equations; `SpringVector` says what each takes off the
energy with one.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property, lru_cache
from typing import Any, NamedTuple, TypeVar

from flint import fmpq, fmpq_mpoly

from ptmcad.model import Kind, Mechanism, Model, System
from ptmcad.text.flint_numbers import from_fraction
from ptmcad.verification.constraints import (
    CrossedBars,
    Polynomials,
    along_loops,
    crossed_conditions,
    leave_one_way,
    loop_conditions,
)
from ptmcad.verification.coordinates import CoordinateRing, circle_names
from ptmcad.verification.kinds import SignMeaning, has_moments_apart, meaning_of

T = TypeVar("T")
Vector = tuple[fmpq_mpoly, fmpq_mpoly]
Required = tuple[str, fmpq_mpoly, bool]
"""What has to be positive: in words, as a polynomial in parameters, and whether it may not vanish."""


def parameters_of(model: Model) -> tuple[str, ...]:
    """The parameters of a model's polynomials: no free lengths of springs, which would bring in
    roots.
    """
    return model.variables if model.whole is None else model.without_free_lengths


def shorthands_of(model: Model) -> tuple[str, ...]:
    """The parameters that a slice may name beside what they stand for."""
    return tuple(name for name in model.shorthands if model.kind(name) is not Kind.FREE_LENGTH)


def coordinates_of(model: Model) -> tuple[str, ...]:
    """The coordinates of the unknowns, as the exact engine names them: those of the angles come
    first.
    """
    return (
        tuple(f"{function}_{angle}" for angle in model.angles for function in ("cos", "sin"))
        + model.reals
    )


def not_positive(model: Model, values: Mapping[str, Any]) -> str | None:
    """A parameter, a number or a ball, that is not surely in its domain, such as a length or a
    stiffness that is not positive; None where all are.
    """
    for name, value in values.items():
        if (name in model.positive and not value > 0) or (
            name in model.nonnegative and not value >= 0
        ):
            return name
    return None


class SpringVector(NamedTuple):
    """A spring of the description, and what it does: all that the checks know of its law.

    Its energy is that without a free length, less pull times |vector|, and what it has without a
    length.
    """

    name: str
    stiffness: fmpq_mpoly
    free: fmpq_mpoly
    vector: Vector

    @property
    def squared(self) -> fmpq_mpoly:
        """Its squared length."""
        return squared(self.vector)

    @property
    def energy(self) -> fmpq_mpoly:
        """As if its free length were zero."""
        return self.squared * self.stiffness * fmpq(1, 2)

    @property
    def pull(self) -> fmpq_mpoly:
        """Stiffness times free length."""
        return self.stiffness * self.free

    @property
    def collapsed(self) -> fmpq_mpoly:
        """The energy where it has no length."""
        return self.pull * self.free * fmpq(1, 2)


def squared(vector: Vector) -> fmpq_mpoly:
    """The squared length of a vector."""
    return vector[0] * vector[0] + vector[1] * vector[1]


@dataclass(frozen=True)
class Derivation:
    """What solutions of a model satisfy, as polynomials in the coordinates, and in parameters
    without numbers.

    Attributes
    ----------
    unknowns : the angles first; by them all that follows is in order.
    meaning : of the signs at a solution.
    energy : of a mechanism's springs, without free lengths, and its loads, or a potential; None
        where there is none.
    moments : generalised forces by the unknown on which they work; they may depend on others
        (`apart`).
    moved : whether there is any.
    equations : each zero at a solution.
    inequalities, stability : positive at a solution that counts, and at a stable one.
    from_energy : whether the equations are the slopes of the energy less the moments: they are not
        with closed loops.
    springs : of a mechanism; with X-joints in a ring that has the second bars' coordinates as last
        variables.
    required : what has to be positive, or not negative, at all parameters, in words that say what
        it is.
    apart : whether a moment depends on another unknown than its own, so that there is no function
        of which moments are the slopes.
    closing : what bars that close loops keep zero.
    """

    ring: CoordinateRing
    unknowns: tuple[str, ...]
    meaning: SignMeaning
    energy: fmpq_mpoly | None
    moments: Mapping[str, fmpq_mpoly]
    equations: Polynomials
    inequalities: Polynomials = ()
    stability: Polynomials = ()
    from_energy: bool = False
    moved: bool = False
    apart: bool = False
    springs: tuple[SpringVector, ...] = ()
    closing: Polynomials = ()
    required: tuple[Required, ...] = ()

    @cached_property
    def jacobian(self) -> tuple[Polynomials, ...]:
        """The equations' derivatives by the unknowns; where solutions are critical points a
        Hessian.
        """
        return tuple(self.ring.gradient(e, self.unknowns) for e in self.equations)

    @property
    def hessian(self) -> tuple[Polynomials, ...]:
        """The same where it is one; else no rows."""
        return self.jacobian[: self.meaning.order]

    @property
    def is_gradient(self) -> bool:
        """Whether the equations are near each solution the slopes of one function."""
        return bool(self.meaning.order)

    @property
    def potential(self) -> fmpq_mpoly | None:
        """The energy where solutions are its critical points, less the work of moments; else None."""
        return self.energy if self.is_gradient else None

    @property
    def has_minima(self) -> bool:
        """Whether the equations are the slopes of a function on a torus, or there is one alone."""
        if (
            self.inequalities
            or (self.from_energy and self.moved)
            or len(self.ring.angles) < len(self.unknowns)
        ):
            return False
        return self.is_gradient or len(self.unknowns) == 1

    @property
    def coordinates(self) -> int:
        """The number of coordinates, which are the first variables."""
        return sum(2 if unknown in self.ring.angles else 1 for unknown in self.unknowns)

    @property
    def pulling(self) -> tuple[SpringVector, ...]:
        """The springs whose free lengths can be taken off the equations; with others none has one."""
        is_taken_off = self.from_energy or leave_one_way(self.unknowns, self.closing)
        return self.springs if is_taken_off else ()

    @property
    def decisive(self) -> range:
        """The numbers of the conditions for stability off whose zeros no solution loses it: of
        those for a matrix to be definite the last one, its determinant."""
        is_definite, number = self.energy is not None and not self.from_energy, len(self.stability)
        return range(max(number - 1, 0) if is_definite else 0, number)

    def generators(self) -> list[fmpq_mpoly]:
        """Of the ideal of all solutions."""
        return [*(e for e in self.equations if not e.is_zero()), *self.ring.relations]

    def along_loops(self, p: fmpq_mpoly) -> fmpq_mpoly:
        """The derivative along closed loops with one degree of freedom left."""
        slopes = self.ring.gradient(p, self.unknowns)
        return along_loops(self.ring, self.unknowns, self.closing, slopes)


def derivation_at(model: Model, values: Mapping[str, Fraction]) -> Derivation:
    """At rational values of the parameters; no spring has a free length there."""
    numbers = {name: from_fraction(values[name]) for name in parameters_of(model)}
    return _derived(model, dict.fromkeys(model.free_lengths, fmpq(0)) | numbers)


@lru_cache(maxsize=8)
def derivation_of(model: Model) -> Derivation:
    """In the coordinates of the unknowns, and in all parameters."""
    return _derived(model, {})


def _ring_of(model: Model, numbers: Mapping[str, fmpq]) -> CoordinateRing:
    """The coordinates of the unknowns come first, then parameters without numbers."""
    coordinates = (name for angle in model.angles for name in circle_names(angle))
    parameters = (name for name in model.variables if name not in numbers)
    return CoordinateRing((*coordinates, *model.reals, *parameters), model.angles, numbers)


def _derived(model: Model, numbers: Mapping[str, fmpq]) -> Derivation:
    ring, unknowns = _ring_of(model, numbers), model.angles + model.reals
    if (mechanism := model.whole) is not None:
        return _of_mechanism(model, mechanism, ring, unknowns)
    assert isinstance(model, System)
    energy = None if model.potential is None else ring.value(model.potential)
    equations, inequalities, stability = (
        tuple(map(ring.value, trees))
        for trees in (model.equations, model.inequalities, model.stability)
    )
    moments = dict.fromkeys(unknowns, ring.context.constant(0))
    if energy is not None:
        equations = ring.gradient(energy, unknowns)
    return Derivation(
        ring,
        unknowns,
        meaning_of(model),
        energy,
        moments,
        equations,
        inequalities,
        stability,
        energy is not None,
    )


def _of_mechanism(
    model: Model, mechanism: Mechanism, ring: CoordinateRing, unknowns: tuple[str, ...]
) -> Derivation:
    free = _unconstrained(model, mechanism, ring, unknowns)
    given, forces = replace(free, ring=ring), tuple(free.moments.values())
    assert free.energy is not None
    if mechanism.xjoints:
        joints = _joints(mechanism, ring)
        equations, distances, stability = crossed_conditions(
            ring, unknowns, joints, _degrees(model, mechanism), (free.energy, free.ring), forces
        )
        return replace(given, equations=equations, inequalities=distances, stability=stability)
    slopes = tuple(map(fmpq_mpoly.__sub__, ring.gradient(free.energy, unknowns), forces))
    if not free.closing:
        return replace(given, equations=slopes, from_energy=True)
    equations, stability = loop_conditions(ring, unknowns, free.closing, slopes)
    return replace(given, equations=equations, stability=stability)


def _unconstrained(
    model: Model, mechanism: Mechanism, base: CoordinateRing, unknowns: tuple[str, ...]
) -> Derivation:
    """The parts of the description, without equations; with the coordinates of X-joints' second bars
    as last variables.
    """
    followers = tuple(mechanism.followers)
    more = (name for angle in followers for name in circle_names(angle))
    ring = (
        CoordinateRing((*base.names, *more), base.angles + followers, base.numbers)
        if followers
        else base
    )
    points = {name: (ring.value(x), ring.value(y)) for name, (x, y) in mechanism.points.items()}

    def between(start: str, end: str) -> Vector:
        (a, b), (c, d) = points[start], points[end]
        return c - a, d - b

    springs = tuple(
        SpringVector(s.name, ring.value(s.stiffness), ring.value(s.free), between(s.start, s.end))
        for s in mechanism.springs
    )
    energy = sum((s.energy for s in springs), ring.context.constant(0))
    for point, x, y in mechanism.loads:
        energy -= points[point][0] * ring.value(x) + points[point][1] * ring.value(y)
    required: list[Required] = [
        (f"the stiffness of spring {s.name}", s.stiffness, True) for s in springs
    ]
    required += [(f"the free length of spring {s.name}", s.free, False) for s in springs]
    for number, torsion in enumerate(mechanism.torsion, 1):
        stiffness, rest = ring.value(torsion.stiffness), tuple(map(from_fraction, torsion.rest))
        cosine, sine = ring.circle(torsion.angle)
        energy += stiffness * (1 - cosine * rest[0] - sine * rest[1])
        required.append((f"the stiffness of torsion spring {number}", stiffness, True))
    closing = tuple(
        squared(between(bar.start, bar.end)) - ring.value(bar.length) ** 2
        for bar in mechanism.closing
    )
    moments = dict.fromkeys(unknowns, base.context.constant(0))
    moments |= {unknown: base.value(tree) for unknown, tree in mechanism.work.items()}
    return Derivation(
        ring,
        unknowns,
        meaning_of(model),
        energy,
        moments,
        (),
        springs=springs,
        closing=closing,
        required=tuple(required),
        moved=not all(force.is_zero() for force in moments.values()),
        apart=has_moments_apart(mechanism),
    )


def _joints(mechanism: Mechanism, ring: CoordinateRing) -> list[CrossedBars]:
    return [
        CrossedBars(j.angle, j.other, ring.value(j.length), ring.value(j.bars))
        for j in mechanism.xjoints
    ]


@lru_cache(maxsize=8)
def _degrees(model: Model, mechanism: Mechanism) -> tuple[int, ...]:
    """Of the energy in the coordinates of each second bar, whatever the parameters are."""
    ring = _ring_of(model, {})
    free = _unconstrained(model, mechanism, ring, ())
    assert free.energy is not None
    normal = free.ring.normal(free.energy)
    return tuple(
        max((sum(pair) for pair in joint.powers(free.ring, normal)), default=0)
        for joint in _joints(mechanism, ring)
    )
