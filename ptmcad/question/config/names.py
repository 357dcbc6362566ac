"""What the names in a record's values stand for: each parameter as a function of the axes.

Guarantee: exact; what is wrong is a `ConfigError` with file, line and key, said once where it stands.
"""

from __future__ import annotations

from collections.abc import Mapping

from ptmcad.errors import ConfigError
from ptmcad.question.config.record import Record
from ptmcad.question.config.scalars import names_in_scalar, parsed
from ptmcad.text.entry import Scalar
from ptmcad.text.expressions import Expression, constant
from ptmcad.text.syntax import did_you_mean


class Resolution:
    """Replaces names by what they stand for, depth first, refusing cycles.

    Attributes
    ----------
    done : names to what they stand for; 1 for one that could not be resolved.
    faulty : those, and what depends on them.
    misnamed : those with a name in them that stands for nothing, which has been said.
    """

    def __init__(self, record: Record, free: Mapping[str, Expression]):
        self.record = record
        self.faulty = set(record.doubtful - free.keys())
        self.done = {**dict.fromkeys(self.faulty, constant(1)), **free}
        self.misnamed: set[str] = set()
        self.parameters = record.model.parameters
        self.known = tuple(dict.fromkeys((*free, *self.parameters, *sorted(record.unread))))

    def run(self) -> dict[str, Expression]:
        for name in self.parameters:
            self.resolve(name, ())
        return {name: self.done[name] for name in self.parameters}

    def resolve(self, name: str, chain: tuple[str, ...]) -> Expression:
        if name not in self.done:
            try:
                self.done[name] = self._found(name, chain)
            except ConfigError:
                self.done[name] = constant(1)
                self.faulty.add(name)
                raise
        return self.done[name]

    def check_names(self, name: str) -> None:
        """Refuse a name in a given value that stands for nothing; without it, what depends on the value is faulty."""
        if name in self.done:
            return
        scalar = self.record.values[name]
        try:
            names = names_in_scalar(scalar)
        except ConfigError:
            return  # said where the value is resolved
        for other in names:
            if other not in self.known and other.lower() not in ("nan", "inf", "infinity"):
                self.misnamed.add(name)
                known = f"; the names are {', '.join(self.known)}" if self.known else "; no name is known here"
                hint = did_you_mean(other, self.known) or known
                raise scalar.place.error(f"unknown name '{other[:40]}'{hint}")

    def _found(self, name: str, chain: tuple[str, ...]) -> Expression:
        scalar = self.record.values.get(name)
        if scalar is None:
            scalar = Scalar(self.parameters[name].default, self.record.place_of(name))
            if not scalar.text:
                raise scalar.place.error(f"{name} has no value: give it one under 'parameters', or make it an axis")
        if name in chain:
            cycle = " -> ".join((*chain[chain.index(name) :], name))
            raise scalar.place.error(f"the definition goes round in a circle: {cycle}")
        names = {}
        for other in names_in_scalar(scalar):
            if other in self.known:
                names[other] = self.resolve(other, (*chain, name))
                if other in self.faulty:
                    self.faulty.add(name)
            elif name in self.misnamed:
                names[other] = constant(1)
                self.faulty.add(name)
            elif name in self.record.values:
                self.check_names(name)
        return constant(1) if name in self.misnamed else parsed(scalar, names)
