"""Quantities of a solution by name: its energy, an unknown, a spring's force, a point's place.

Guarantee: names, units and messages of all commands are these. Values are taken in two ways:
`of_pose` encloses them, and `ptmcad.workbench.fields.fieldvalues` computes them in floating point, for
many solutions at once.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

from ptmcad.answer.poses import Pose
from ptmcad.answer.words import listed
from ptmcad.errors import ConfigError
from ptmcad.model import Mechanism, Model
from ptmcad.question.slice import Slice
from ptmcad.text.enclosure import Enclosure
from ptmcad.text.syntax import did_you_mean

OPTION = "--quantity"
_TIMES = " × "


class QuantityKind(Enum):
    """What a quantity is of a solution; where it belongs to a part of the mechanism, the word
    before the colon.
    """

    ENERGY = "energy"
    STIFFNESS = "stiffness"
    """the least eigenvalue of the Hessian"""
    BARRIER = "barrier"
    """the energy to another stable pose: of a field only"""
    FORCE = "force"
    LENGTH = "length"
    ANGLE = "angle"
    X = "x"
    Y = "y"
    REAL = ""
    """an unknown on the line, which has no word before its name"""


OF_ENERGY = (QuantityKind.ENERGY, QuantityKind.STIFFNESS, QuantityKind.BARRIER)
OF_PARTS = (
    QuantityKind.FORCE,
    QuantityKind.LENGTH,
    QuantityKind.ANGLE,
    QuantityKind.X,
    QuantityKind.Y,
)


@dataclass(frozen=True, slots=True)
class Quantity:
    """A number that each solution has, or may have.

    Attributes
    ----------
    name : as it is shown.
    unit : in words; empty where none is known. `unit_of` has it in the units of a record.
    part : the point's name.
    number : that of the spring, or of the unknown, angles first.
    """

    name: str
    kind: QuantityKind
    unit: str
    part: str = ""
    number: int = 0


def quantity(model: Model, text: str) -> Quantity:
    """The quantity of a pose of this name: one of `quantities`, or an angle as ``angle:th1``.

    Raises
    ------
    ConfigError
        That lists what the model has.
    """
    found = named(model, text, OPTION) or unknown(model, text.strip())
    if found is None:
        known = quantities(model)
        hint = did_you_mean(text.strip(), known, "; there are " if known else "")
        raise ConfigError(f"{text[:60]!r} is no quantity of {model.name}{hint}", key=OPTION)
    if found.kind is QuantityKind.BARRIER:
        raise ConfigError(
            "a barrier is no number of a pose alone: `ptmcad map --value barrier` has it",
            key=OPTION,
        )
    return found


def named(model: Model, text: str, key: str) -> Quantity | None:
    """The quantity that ``energy``, ``stiffness``, ``barrier`` or KIND:NAME stands for; None for
    another text.

    Raises
    ------
    ConfigError
        When the model has no energy, or no such part; its key is the option that the text was given
        to.
    """
    word, colon, name = (part.strip() for part in text.partition(":"))
    if not colon:
        kind = next((kind for kind in OF_ENERGY if kind.value == word), None)
        return None if kind is None else _of_energy(model, kind, key)
    kind = next((kind for kind in OF_PARTS if kind.value == word), None)
    if kind is None:
        raise ConfigError(
            f"{word[:60]!r} is not among {listed([kind.value for kind in OF_PARTS])}", key=key
        )
    return _of_part(model, kind, name, key)


def quantities(model: Model) -> dict[str, Quantity]:
    """All numbers of a pose that change with it, by name.

    >>> from ptmcad.model import ptm
    >>> [name for name in quantities(ptm()) if not name.startswith(("x:", "y:"))]
    ['th1', 'th2', 'energy', 'stiffness', 'force:A1A4', 'force:A2A3', 'force:A3A4', 'force:k1', 'force:k2', \
'force:k3', 'length:A1A4', 'length:A2A3', 'length:A3A4', 'length:k1', 'length:k2', 'length:k3']
    """
    found = [unknown(model, name) for name in model.sorted_unknowns]
    found += [_of_energy(model, QuantityKind(kind), OPTION) for kind in model.criterion.numbers]
    mechanism = open_chain(model)
    if mechanism is not None:
        *of_springs, _, x, y = OF_PARTS
        found += [
            _of_part(model, kind, name, OPTION)
            for kind in of_springs
            for name in mechanism.spring_numbers
        ]
        found += [
            _of_part(model, kind, name, OPTION) for name in mechanism.moving for kind in (x, y)
        ]
    return {q.name: q for q in found if q is not None}


def unit_of(quantity: Quantity, slice: Slice) -> str:
    """The unit, where the record declares units in those: such as ``N·mm`` for ``force × length``."""
    words = quantity.unit.split(_TIMES)
    return ("·" if all(w in slice.units for w in words) else _TIMES).join(
        slice.units.get(w, w) for w in words
    )


def of_pose(quantity: Quantity, pose: Pose) -> Enclosure | None:
    """The value, enclosed; None where the pose has none."""
    match quantity.kind:
        case QuantityKind.ENERGY:
            return pose.energy
        case QuantityKind.STIFFNESS:
            return pose.eigenvalues[0] if pose.eigenvalues else None
        case QuantityKind.FORCE:
            return pose.springs[quantity.number].force
        case QuantityKind.LENGTH:
            return pose.springs[quantity.number].length
        case QuantityKind.ANGLE | QuantityKind.REAL:
            return (*pose.degrees, *pose.reals)[quantity.number]
        case QuantityKind.X | QuantityKind.Y:
            return pose.nodes[quantity.part][quantity.kind is QuantityKind.Y]
        case QuantityKind.BARRIER:
            return None


def unknown(model: Model, name: str) -> Quantity | None:
    """The unknown of this name, an angle in degrees; None where there is none."""
    names = model.sorted_unknowns
    if name not in names:
        return None
    kind = QuantityKind.ANGLE if name in model.angles else QuantityKind.REAL
    return Quantity(name, kind, "".join(model.unit_of(name)), number=names.index(name))


def _of_energy(model: Model, kind: QuantityKind, key: str) -> Quantity:
    if kind.value not in (*model.criterion.numbers, *model.criterion.differences):
        there = ", ".join(quantities(model))
        raise ConfigError(
            f"solutions of {model.name} have no energy{there and f'; there are {there}'}", key=key
        )
    return Quantity(kind.value, kind, f"force{_TIMES}length" if model.whole else "")


def open_chain(model: Model) -> Mechanism | None:
    """The mechanism, of whose parts quantities are known by name: none yet with closed loops or
    X-joints.
    """
    mechanism = model.whole
    return None if mechanism is None or mechanism.closing or mechanism.xjoints else mechanism


def _of_part(model: Model, kind: QuantityKind, name: str, key: str) -> Quantity:
    mechanism = open_chain(model)
    springs = {} if mechanism is None else mechanism.spring_numbers
    match kind:
        case QuantityKind.ANGLE:
            what, known, unit = "unknown angle", model.angles, "degrees"
        case QuantityKind.FORCE | QuantityKind.LENGTH:
            what, known, unit = "spring", tuple(springs), kind.value
        case _:
            what, known, unit = (
                "point",
                () if mechanism is None else tuple(mechanism.points),
                "length",
            )
    if mechanism is not model.whole and kind is not QuantityKind.ANGLE:
        raise ConfigError(
            f"of closed loops, as {model.name} has, only the unknowns are available yet", key=key
        )
    if name not in known:
        there = f": they are {', '.join(known)}" if known else ": there are none"
        raise ConfigError(
            f"{model.name} has no {what} {name[:60]!r}{did_you_mean(name, known) or there}", key=key
        )
    number = model.angles.index(name) if kind is QuantityKind.ANGLE else springs.get(name, 0)
    return Quantity(f"{kind.value}:{name}", kind, unit, part=name, number=number)
