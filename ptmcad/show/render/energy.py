"""The energy at a point as a function that can be drawn, less the work of moments where these work.

Guarantee: the constant part is taken out exactly before anything is rounded, so that small
differences of large energies are seen. The derivatives of what is drawn are zero at the equilibria:
it is U - M u with a moment M on an unknown u.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import radians

import numpy as np

from ptmcad.answer.poses import Pose, Poses
from ptmcad.answer.words import moments_work
from ptmcad.exact.models.modelsystem import elements_of, system_from
from ptmcad.exact.models.system import polynomial_at
from ptmcad.model import Model
from ptmcad.model.compile import compiled
from ptmcad.model.evaluate import Assignment
from ptmcad.model.work import moments_at
from ptmcad.show.render.view import Floats
from ptmcad.text.flint_numbers import from_fraction, to_fraction
from ptmcad.text.numerals import Numbers, magnitude

Terms = tuple[tuple[tuple[int, ...], float], ...]


def _sum(terms: Terms, bases: Sequence[Floats], shape: tuple[int, ...]) -> Floats:
    total = np.zeros(shape)
    for powers, coefficient in terms:
        term = np.full_like(total, coefficient)
        for base, power in zip(bases, powers, strict=True):
            term = term * base**power
        total += term
    return total


@dataclass(frozen=True, slots=True)
class Energy:
    """The energy as (U - offset) / unit: terms with exponents of the coordinates, cosine and sine
    of each angle, then the unknowns on the line; and for each spring with a free length -k l0 with
    the terms of its length squared, whose root it multiplies. Of each unknown on which a moment
    works the number, and minus the moment over the unit."""

    angles: int
    offset: Fraction
    unit: Fraction
    terms: Terms
    roots: tuple[tuple[float, Terms], ...] = ()
    slopes: tuple[tuple[int, float], ...] = ()

    def __call__(self, *unknowns: Floats) -> Floats:
        """Over arrays of angles in radians, and of unknowns on the line."""
        bases = [
            function(angle) for angle in unknowns[: self.angles] for function in (np.cos, np.sin)
        ]
        bases += unknowns[self.angles :]
        shape = np.broadcast(*unknowns).shape
        total = _sum(self.terms, bases, shape)
        for factor, square in self.roots:
            total += factor * np.sqrt(np.maximum(_sum(square, bases, shape), 0.0))
        for number, slope in self.slopes:
            total += slope * unknowns[number]
        return total

    def scaled(self, value: Fraction) -> float:
        """An energy in the picture's unit."""
        return float((value - self.offset) / self.unit)

    def level(self, pose: Pose, place: Sequence[float]) -> float:
        """Where a pose lies: its energy less the moments' work up to a place, angles in degrees, in
        the unit.
        """
        inputs = [radians(x) if k < self.angles else x for k, x in enumerate(place)]
        return self.scaled(pose.known_energy.center) + sum(
            slope * inputs[k] for k, slope in self.slopes
        )


def energy_of(model: Model, parameters: Numbers) -> Energy:
    """The energy at these parameters, its constant part taken out and its size made about 1."""
    system = system_from(model)
    values = {name: from_fraction(parameters[name]) for name in system.ring.parameters}
    assert system.potential is not None
    exact = {m: to_fraction(c) for m, c in polynomial_at(system, system.potential, values).items()}
    offset = exact.pop((0,) * system.ring.width, Fraction(0))
    known = compiled(model)
    given = Assignment(dict.fromkeys(model.free_lengths, Fraction(0)) | dict(parameters), Fraction)
    moments = known.values(tuple(known.acting.values()), given)
    unit = Fraction(10) ** magnitude(
        max(map(abs, (*exact.values(), *moments)), default=Fraction(1))
    )
    roots = []
    for spring in known.springs:
        pull, collapsed = known.values((spring.pull, spring.collapsed), given)
        if pull:
            offset += collapsed
            (square,) = elements_of(model, [spring.square])
            square_terms = polynomial_at(system, square, values)
            roots.append(
                (
                    float(-pull / unit),
                    tuple((m, float(to_fraction(c))) for m, c in square_terms.items()),
                )
            )
    terms = tuple((m, float(c / unit)) for m, c in sorted(exact.items()))
    slopes = tuple(
        (k, float(-moment / unit))
        for k, moment in zip(known.acting, moments, strict=True)
        if moment
    )
    return Energy(len(model.angles), offset, unit, terms, tuple(roots), slopes)


def drawn(poses: Poses) -> str:
    """What is drawn, in words: the energy, or that less what moments do."""
    moments = moments_at(poses.model, poses.parameters)
    if not moments:
        return "Energy"
    cut = ", cut at ±180°, not periodic," if is_cut(poses) else ""
    return f"Energy less the {moments_work(poses.model, moments)}{cut}"


def is_cut(poses: Poses) -> bool:
    """Whether a moment works on an angle, so that what is drawn has another value after a turn."""
    return not moments_at(poses.model, poses.parameters).keys().isdisjoint(poses.model.angles)
