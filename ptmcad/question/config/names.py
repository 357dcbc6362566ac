"""What the names in a record's values stand for: each parameter as a function of the axes.

Guarantee: exact; what is wrong is a `ConfigError` with file, line and key, said once where it
stands.
"""

from __future__ import annotations

from ptmcad.errors import Faults
from ptmcad.question.config.record import Record
from ptmcad.question.config.scalars import names_in_scalar, parsed
from ptmcad.text.entry import Scalar
from ptmcad.text.expressions import Expression, Expressions, constant
from ptmcad.text.syntax import NOT_NUMBERS, did_you_mean


def resolved(
    record: Record, free: Expressions, faults: Faults
) -> tuple[dict[str, Expression], set[str]]:
    """What the parameters stand for, depth first, and the names of those that are faulty or depend
    on such a one.

    Parameters
    ----------
    free : names to what they stand for already.
    faults : where it is noted that a parameter cannot be resolved, which then is 1; a cycle is
        refused.
    """
    parameters = record.model.parameters
    faulty = set(record.doubtful - free.keys())
    done = {**dict.fromkeys(faulty, constant(1)), **free}
    known = tuple(dict.fromkeys((*free, *parameters, *sorted(record.unread))))

    def value(name: str, chain: tuple[str, ...]) -> Expression:
        if name not in done:
            with faults:
                done[name] = found(name, chain)
                return done[name]
            faulty.add(name)
            done[name] = constant(1)
        return done[name]

    def found(name: str, chain: tuple[str, ...]) -> Expression:
        scalar = record.values.get(name)
        if scalar is None:
            scalar = Scalar(parameters[name].default, record.place_of(name))
            if not scalar.text:
                raise scalar.place.error(
                    f"{name} has no value: give it one under 'parameters', or make it an axis"
                )
        if name in chain:
            cycle = " -> ".join((*chain[chain.index(name) :], name))
            raise scalar.place.error(f"the definition goes round in a circle: {cycle}")
        names = names_in_scalar(scalar)
        misnamed = [
            other for other in names if other not in known and other.lower() not in NOT_NUMBERS
        ]
        for other in misnamed[:1]:
            with faults:
                hint = did_you_mean(
                    other, known, "; the names are " if known else "; no name is known here"
                )
                raise scalar.place.error(f"unknown name '{other[:40]}'{hint}")
        values = {other: value(other, (*chain, name)) for other in names if other in known}
        if misnamed or values.keys() & faulty:
            faulty.add(name)
        return constant(1) if misnamed else parsed(scalar, values)

    return {name: value(name, ()) for name in parameters}, faulty
