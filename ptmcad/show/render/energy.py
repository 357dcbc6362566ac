"""The energy at a point as a function that can be drawn, less the work of moments where these work;
and the unknowns over which it is drawn.

Guarantee: the derivatives of what is drawn are zero at the equilibria: it is U - M u with a moment M
on an unknown u.

Not guaranteed: more digits than doubles have. Differences of energies that are smaller against the
energies themselves are lost.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import radians

import numpy as np

from ptmcad.answer.poses import Pose, Poses
from ptmcad.answer.words import moments_work
from ptmcad.errors import ConfigError
from ptmcad.formulas.instructions import MAX_CONSTANT, Doubles
from ptmcad.model import Model
from ptmcad.model.compile import compiled
from ptmcad.model.work import moments_at
from ptmcad.show.render.axes import symbol
from ptmcad.show.render.view import Floats
from ptmcad.show.units import unit_of_unknown, with_unit
from ptmcad.text.numerals import Numbers


class Energy:
    """The energy less the work of constant moments, at given parameters.

    Attributes
    ----------
    works : whether moments work.

    Raises
    ------
    ConfigError
        Where a parameter is too large for products of a few to be doubles.
    """

    def __init__(self, model: Model, parameters: Numbers) -> None:
        for name, value in parameters.items():
            if abs(value) > MAX_CONSTANT:
                raise ConfigError(f"{name} is too large for the energy to be drawn")
        system = compiled(model)
        given = {name: float(value) for name, value in parameters.items()}
        free = dict.fromkeys(model.free_lengths, 0.0) | given
        self.angles, self.works = len(model.angles), bool(moments_at(model, parameters))
        self._parts = Doubles((system.potential(), system.work), np)
        self._unknowns = system.unknowns
        self._given = {k: free[name] for k, name in enumerate(system.names) if name in free}

    def _at(self, unknowns: Sequence[Floats | float]) -> tuple[Floats, Floats]:
        """The energy and the moments' work."""
        energy, work = self._parts.at(
            self._given | dict(zip(self._unknowns, unknowns, strict=True))
        )
        return energy, work

    def __call__(self, *unknowns: Floats) -> Floats:
        """Over arrays of angles in radians, and of unknowns on the line."""
        energy, work = self._at(unknowns)
        values: Floats = np.broadcast_to(energy - work, np.broadcast(*unknowns).shape)
        return values

    def level(self, pose: Pose, place: Sequence[float]) -> float:
        """Where a pose lies: its energy less the moments' work up to a place, angles in degrees."""
        inputs = [radians(x) if k < self.angles else x for k, x in enumerate(place)]
        return float(pose.known_energy.center) - float(self._at(inputs)[1])


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


def copies(angle: float) -> tuple[float, ...]:
    """An angle in degrees, twice where it is at the edge (to what a marker's width shows)."""
    return (180.0, -180.0) if abs(angle) > 179.75 else (angle,)


@dataclass(frozen=True, slots=True)
class UnknownAxis:
    """An axis of the picture: an unknown from ``low`` to ``high``, an angle in degrees."""

    name: str
    low: float
    high: float
    is_angle: bool
    unit: str

    def sampled(self, number: int) -> tuple[Floats, Floats]:
        """So many values as they are shown, and as the energy takes them."""
        shown = np.linspace(self.low, self.high, number)
        return shown, np.radians(shown) if self.is_angle else shown

    @property
    def label(self) -> str:
        return with_unit(symbol(self.name), self.unit)

    def copies(self, value: float) -> tuple[float, ...]:
        return copies(value) if self.is_angle else (value,)


def sides_of(
    model: Model, shown: Sequence[Pose], units: Mapping[str, str]
) -> tuple[UnknownAxis, ...]:
    """The axes: angles all round, and for each unknown on the line a range that holds all
    equilibria.
    """
    found = [
        UnknownAxis(name, -180.0, 180.0, True, unit_of_unknown(model, name, units))
        for name in model.angles
    ]
    for k, name in enumerate(model.reals):
        low, high = (end(float(pose.reals[k]) for pose in shown) for end in (min, max))
        room = max((high - low) / 2, max(abs(low), abs(high)) / 4) or 1.0
        found.append(
            UnknownAxis(name, low - room, high + room, False, unit_of_unknown(model, name, units))
        )
    return tuple(found)


def place_of(pose: Pose) -> tuple[float, ...]:
    """The unknowns, angles in degrees."""
    return tuple(map(float, (*pose.degrees, *pose.reals)))
