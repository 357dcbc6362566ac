"""Quantities of a pose by name: an unknown, the energy, the least eigenvalue, a spring's force, a point's place."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from ptmcad.answer.poses import Pose
from ptmcad.errors import ConfigError
from ptmcad.mechanism import Mechanism, Model
from ptmcad.text.enclosure import Enclosure
from ptmcad.text.syntax import did_you_mean

OPTION = "--quantity"


@dataclass(frozen=True, slots=True)
class Quantity:
    """A number that each pose has, or may have.

    Attributes
    ----------
    unit : in words; empty where the record's own units decide.
    """

    name: str
    unit: str
    of: Callable[[Pose], Enclosure | None]


def quantity(model: Model, name: str) -> Quantity:
    """The quantity of a name.

    Raises
    ------
    ConfigError
        That lists what the model has.
    """
    known = quantities(model)
    if name not in known:
        hint = did_you_mean(name, known) or f"; there are {', '.join(known)}"
        raise ConfigError(f"{name[:60]!r} is no quantity of {model.name}{hint}", key=OPTION)
    return known[name]


def quantities(model: Model) -> dict[str, Quantity]:
    """All that can be asked for, by name.

    >>> from ptmcad.mechanism import ptm
    >>> [name for name in quantities(ptm()) if not name.startswith(("x:", "y:"))]
    ['th1', 'th2', 'energy', 'stiffness', 'force:A1A4', 'force:A2A3', 'force:A3A4', 'force:k1', 'force:k2', \
'force:k3', 'length:A1A4', 'length:A2A3', 'length:A3A4', 'length:k1', 'length:k2', 'length:k3']
    """
    found = [Quantity(name, "degrees", _degrees(k)) for k, name in enumerate(model.angles)]
    found += [Quantity(name, "", _real(k)) for k, name in enumerate(model.reals)]
    if model.has_potential:
        found.append(Quantity("energy", "", lambda pose: pose.energy))
        found.append(Quantity("stiffness", "", lambda pose: pose.eigenvalues[0] if pose.eigenvalues else None))
    if isinstance(model, Mechanism):
        springs = model.spring_numbers
        found += [Quantity(f"force:{name}", "", _force(k)) for name, k in springs.items()]
        found += [Quantity(f"length:{name}", "", _length(k)) for name, k in springs.items()]
        found += [Quantity(f"{'xy'[n]}:{name}", "", _place(name, n)) for name in model.moving for n in (0, 1)]
    return {q.name: q for q in found}


def _degrees(number: int) -> Callable[[Pose], Enclosure | None]:
    return lambda pose: pose.degrees[number]


def _real(number: int) -> Callable[[Pose], Enclosure | None]:
    return lambda pose: pose.reals[number]


def _force(number: int) -> Callable[[Pose], Enclosure | None]:
    return lambda pose: pose.springs[number].force


def _length(number: int) -> Callable[[Pose], Enclosure | None]:
    return lambda pose: pose.springs[number].length


def _place(name: str, number: int) -> Callable[[Pose], Enclosure | None]:
    return lambda pose: pose.nodes[name][number]
