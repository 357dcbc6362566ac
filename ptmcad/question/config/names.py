"""What the names in a record's values stand for: each parameter as a function of the axes.

Guarantee: exact; what is wrong is a `ConfigError` with file, line and key, said once where it stands.
"""

from __future__ import annotations

from collections.abc import Mapping

from ptmcad.errors import Faults
from ptmcad.question.config.record import Record
from ptmcad.question.config.scalars import names_in_scalar, parsed
from ptmcad.text.entry import Scalar
from ptmcad.text.expressions import Expression, constant
from ptmcad.text.syntax import NOT_NUMBERS, did_you_mean


class Resolution:
    """Replaces names by what they stand for, depth first, refusing cycles.

    Attributes
    ----------
    done : names to what they stand for; 1 for one that could not be resolved, of which the fault is noted.
    faulty : those, and what depends on them.
    """

    def __init__(self, record: Record, free: Mapping[str, Expression], faults: Faults):
        self.record = record
        self.faults = faults
        self.faulty = set(record.doubtful - free.keys())
        self.done = {**dict.fromkeys(self.faulty, constant(1)), **free}
        self.parameters = record.model.parameters
        self.known = tuple(dict.fromkeys((*free, *self.parameters, *sorted(record.unread))))

    def run(self) -> dict[str, Expression]:
        """What the parameters stand for."""
        return {name: self._resolve(name, ()) for name in self.parameters}

    def _resolve(self, name: str, chain: tuple[str, ...]) -> Expression:
        if name not in self.done:
            with self.faults:
                self.done[name] = self._found(name, chain)
                return self.done[name]
            self.faulty.add(name)
            self.done[name] = constant(1)
        return self.done[name]

    def _found(self, name: str, chain: tuple[str, ...]) -> Expression:
        scalar = self.record.values.get(name)
        if scalar is None:
            scalar = Scalar(self.parameters[name].default, self.record.place_of(name))
            if not scalar.text:
                raise scalar.place.error(f"{name} has no value: give it one under 'parameters', or make it an axis")
        if name in chain:
            cycle = " -> ".join((*chain[chain.index(name) :], name))
            raise scalar.place.error(f"the definition goes round in a circle: {cycle}")
        names = names_in_scalar(scalar)
        misnamed = [other for other in names if other not in self.known and other.lower() not in NOT_NUMBERS]
        for other in misnamed[:1]:
            with self.faults:
                known = f"; the names are {', '.join(self.known)}" if self.known else "; no name is known here"
                raise scalar.place.error(f"unknown name '{other[:40]}'{did_you_mean(other, self.known) or known}")
        resolved = {other: self._resolve(other, (*chain, name)) for other in names if other in self.known}
        if misnamed or resolved.keys() & self.faulty:
            self.faulty.add(name)
        return constant(1) if misnamed else parsed(scalar, resolved)
