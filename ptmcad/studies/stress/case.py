"""A stress case: a question with extreme numbers, and the answer with where it comes from.

Guarantee: all numbers are exact. An expected answer says what is known beforehand; what it leaves open is empty. Names
are unique. The named cases are data, ``cases.yaml``, whose head says how they are written. Their counts follow from a
theorem or a construction named in ``source``, and do not come from the program. The theorems are those of the manual:
without load two equilibria are stable, of six, exactly if |L2 - L1| < 2 rho < L1 + L2, else one of four; loads that are
small (large) enough against k rho and k L change nothing else (leave four, one of them stable); equations stay the same
when stiffnesses and forces, or lengths and force/stiffness, are scaled together. Areas are in the product of the axes'
units.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cache
from pathlib import Path
from typing import Any

import yaml

from ptmcad.errors import ConfigError, shown
from ptmcad.mechanism import ptm
from ptmcad.studies.stress.constructions import NAMED
from ptmcad.text.expressions import constant
from ptmcad.text.parsing import parse
from ptmcad.text.syntax import did_you_mean

ALL = "all"
"""The name that stands for every named case."""
DIGITS = Fraction(1234567891234567891234567891234567891234, 10**40)
NODE = Fraction("0.70710678118654752440084436210484903928483593768847403658833986899536623923105351")
TEXTS = Path(__file__).with_name("cases.yaml")

Span = tuple[Fraction, Fraction]


@dataclass(frozen=True, slots=True)
class Question:
    """What ptmcad is asked: without axes `ptmcad.solve`, with axes `ptmcad.classify` or, along one, `ptmcad.intervals`.

    Attributes
    ----------
    parameters : of the paper's mechanism; of a point all of them but free lengths that are zero.
    tolerance : the share of the window that the certified engine may leave undetermined; None for the exact engine.
    along, fixed : the axis that varies along a line, and the value of the other one.
    """

    parameters: Mapping[str, Fraction]
    axes: Mapping[str, Span] = field(default_factory=dict)
    tolerance: Fraction | None = None
    along: str = ""
    fixed: Mapping[str, Fraction] = field(default_factory=dict)

    @property
    def kind(self) -> str:
        """What is asked, in a word."""
        if not self.axes:
            return "point"
        return "line" if self.along else "map" if self.tolerance is None else "certified map"


@dataclass(frozen=True, slots=True)
class Case:
    """One stress case.

    Attributes
    ----------
    stiffness : what is extreme, as one positive number: a ratio of stiffnesses, lengths or forces, or the distance from
        a fold; the plot's horizontal axis.
    source : where the expected answer comes from.
    expected : as it is shown: 6/2 of a point (all and stable equilibria), 1 2 1 of maps and lines (stable counts, of
        regions in increasing order, of intervals in theirs); empty where a second method alone knows it.
    bounds : of a map, for the area where two equilibria are stable; of a line, for the ends between intervals of
        different counts.
    slow : whether it takes more than about a second.
    """

    name: str
    family: str
    stiffness: Fraction
    question: Question
    source: str
    expected: str = ""
    bounds: tuple[Span, ...] = ()
    slow: bool = False

    @property
    def has_free_lengths(self) -> bool:
        """Whether the question is for the certified engine."""
        return free_lengths(self.question.parameters)


def free_lengths(parameters: Mapping[str, Fraction]) -> bool:
    """Whether a spring has one."""
    return any(name.startswith("l0") and value for name, value in parameters.items())


def point(**given: Fraction | int | str) -> Question:
    """A point of the paper's mechanism: L1 = 1, L2 = 3/2, rho = 7/10, k = 100 and no load unless given."""
    values = {"L1": "1", "L2": "3/2", "rho": "7/10", "k": 100, "l0": 0, **dict.fromkeys(ptm().forces, 0), **given}
    p = {name: Fraction(value) for name, value in values.items()}
    springs, free = dict.fromkeys(ptm().stiffnesses, p.pop("k")), p.pop("l0")
    lengths = dict.fromkeys(ptm().free_lengths, free) if free else {}
    return Question(springs | lengths | p)


@cache
def named_cases() -> tuple[Case, ...]:
    """Every named case."""
    entries = yaml.safe_load(TEXTS.read_text(encoding="utf-8"))["cases"]
    return tuple(_case(entry, e) for entry in entries for e in entry["e"])


def _case(entry: Mapping[str, Any], e: int) -> Case:
    known = {"s": Fraction(10) ** e, "digits": DIGITS, "node": NODE}
    return Case(
        name=entry["name"].format(e=e),
        stiffness=known["s"],
        question=_question(entry["question"], known),
        bounds=_numbers(entry.get("bounds", []), known),
        slow=e in entry.get("slow", ()),
        **{key: entry[key] for key in ("family", "source", "expected") if key in entry},
    )


def _question(entry: Mapping[str, Any], known: Mapping[str, Fraction]) -> Question:
    base: Mapping[str, Fraction] = {}
    if "at" in entry:
        base = NAMED[entry["at"]].beside(_numbers(entry.get("beside", 0), known))
    names = ("parameters", "axes", "tolerance", "fixed")
    given = {name: _numbers(entry[name], {**known, **base}) for name in names if name in entry}
    values = {**base, **given.pop("parameters", {})}
    if "axes" not in given:
        return point(**values)
    values = {name: value for name, value in values.items() if name not in given["axes"]}
    return Question(values, along=entry.get("along", ""), **given)


def _numbers(node: Any, known: Mapping[str, Fraction]) -> Any:
    """What has expressions for numbers, with their values."""
    if isinstance(node, dict):
        return {key: _numbers(value, known) for key, value in node.items()}
    if isinstance(node, list):
        return tuple(_numbers(value, known) for value in node)
    return parse(str(node), {name: constant(value) for name, value in known.items()}).constant()


def chosen(names: Sequence[str]) -> tuple[Case, ...]:
    """The cases of these names and families; all of them for ``all`` and when none is given.

    Raises
    ------
    ConfigError
        For a name that is neither.
    """
    cases = named_cases()
    known = {ALL, *(name for case in cases for name in (case.name, case.family))}
    for name in names:
        if name not in known:
            raise ConfigError(
                f"{shown(repr(name), 60)} is no stress case and no family: ptmcad stress --list shows them"
                f"{did_you_mean(name, tuple(sorted(known)))}",
                key="NAMES",
            )
    return tuple(c for c in cases if not names or {ALL, c.name, c.family} & set(names))
