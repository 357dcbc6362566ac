"""What springs and closing bars ask of the expressions that they are given, besides what each parameter has to be."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from typing import NamedTuple

from ptmcad.errors import ConfigError, Faults, shown
from ptmcad.model.closed import mechanism_in
from ptmcad.model.derivative import negative, total
from ptmcad.model.description import Model
from ptmcad.model.elements import Kind
from ptmcad.model.evaluate import value_at
from ptmcad.text.numerals import text_of as value_text
from ptmcad.text.tree import Name, Number, Power, Tree, names_of
from ptmcad.text.tree import to_text as text_of

MAX_SHOWN = 60
"""Characters of an expression."""


class Part(NamedTuple):
    """A stiffness or a length that is written where it is used.

    Attributes
    ----------
    key : where it stands in the description, such as ``springs.2.k``.
    kind : what it measures, which decides which values make sense.
    meaning : what has to hold, in place of what its kind says.
    """

    key: str
    kind: Kind
    tree: Tree
    meaning: str = ""

    @property
    def text(self) -> str:
        """As it is written, for messages."""
        return shown(text_of(self.tree), MAX_SHOWN)


def parts(model: Model) -> Iterator[Part]:
    """What has a value with a sign in a description and is no parameter of such a kind itself."""
    return (part for part in written_parts(model) if not _is_known(model, part))


def written_parts(model: Model) -> Iterator[Part]:
    """The stiffnesses and free lengths of a mechanism's springs, and the lengths of bars that close loops."""
    mechanism = mechanism_in(model)
    if mechanism is None:
        return
    for n, spring in enumerate(mechanism.springs, 1):
        yield Part(f"springs.{n}.k", Kind.STIFFNESS, spring.stiffness)
        yield Part(f"springs.{n}.free", Kind.FREE_LENGTH, spring.free)
    for n, torsion in enumerate(mechanism.torsion, 1):
        yield Part(f"torsion.{n}.k", Kind.STIFFNESS, torsion.stiffness)
    for n, closing in enumerate(mechanism.closing, 1):
        yield Part(f"closing.{n}.length", Kind.LENGTH, closing.length)
    for joint in mechanism.xjoints:
        yield Part(f"x-joint.{joint.name}.base", Kind.LENGTH, joint.length)
        key, off = f"x-joint.{joint.name}.bars", total(joint.bars, negative(joint.length))
        yield Part(key, Kind.LENGTH, joint.bars)
        yield Part(
            key,
            Kind.LENGTH,
            Power(off, Number(Fraction(2))),
            "the bars of an x-joint are longer or shorter than its base",
        )


def fault_of_number(part: Part, value: Fraction) -> str:
    """What is wrong with a number that a spring is given, in words; empty where nothing is."""
    if not part.kind.excludes(value):
        return ""
    number = value_text(value)
    is_what = number if part.text == number else f"{part.text} = {number}"
    if part.meaning:
        return f"{part.meaning}, but {part.text} = {number}"
    return f"a {part.kind.noun} is {part.kind.demand}, but this is {is_what}"


def check_numbers(model: Model, faults: Faults) -> None:
    """Note each that is a number, and one that makes no sense."""
    for part in parts(model):
        if names_of(part.tree):
            continue  # a slice tells what it is in its window
        with faults:
            if problem := fault_of_number(part, value_at(part.tree, {})):
                raise ConfigError(problem, key=part.key)


def _is_known(model: Model, part: Part) -> bool:
    """Whether it is a parameter of which as much is asked."""
    if not isinstance(part.tree, Name):
        return False
    kind = model.kind(part.tree.name)
    return kind.is_positive or (kind.may_vanish and part.kind.may_vanish)
