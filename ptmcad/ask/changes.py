"""The values at which the arrangement of a family's regions changes: by elimination, or else by
bisection.

Guarantee: with elimination every change is exact and none is missing. With bisection each change is
enclosed between members of different arrangements, and it is said that others may be missing.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from functools import partial
from itertools import pairwise
from time import perf_counter

from ptmcad.algebra.real_roots import RealRoot, algebraic_number, refine
from ptmcad.answer.arrangement import correspondence
from ptmcad.answer.family import TOLERANCE, Change, Changes
from ptmcad.ask.changewords import described
from ptmcad.ask.classification import check_count
from ptmcad.ask.members import AskedFamily, Common, in_common, in_space
from ptmcad.errors import ConfigError, HypothesisError, LimitReached
from ptmcad.exact.familyprojection import critical_values, surfaces_of
from ptmcad.exact.slicearrangement import Picture, picture_of
from ptmcad.options import DEFAULTS, Options, Progress, is_certified
from ptmcad.question.config import Family, family_from
from ptmcad.question.shipped import RecordSource
from ptmcad.text.enclosure import AlgebraicNumber, Enclosure
from ptmcad.text.flint_numbers import (
    from_fraction,
    interval_of,
    simplest_fraction,
    to_fraction,
)
from ptmcad.text.numerals import text_of
from ptmcad.text.parsing import share_for

SAMPLES = 64
"""Members beside those of the record that are compared where there is no elimination."""


def changes(
    question: RecordSource | Family,
    tolerance: Fraction | float | str = TOLERANCE,
    *,
    timeout: float | None = None,
    progress: Progress | None = None,
) -> Changes:
    """The values of a family's free parameter at which the arrangement of the members' regions
    changes.

    Parameters
    ----------
    question : the file of a record with ``free``, or a mapping like one.
    tolerance : the widest enclosure, as a share of the range, where a change is not known exactly.
    timeout : seconds after which `LimitReached` is raised.
    progress : called as progress(stage, done, total).

    Raises
    ------
    ConfigError
        For anything wrong with the record or the tolerance, and for a family that the exact engine
        does not take.
    HypothesisError
        When members are degenerate, have infinitely many equilibria, or leave the domain of the
        geometry.

    >>> import ptmcad
    >>> found = ptmcad.changes({"system": {"unknowns": {"u": "real"}, "equations": ["u^2 - c + a^2 + b^2"]},
    ...                         "axes": {"a": [-1, 1], "b": [-1, 1]}, "free": {"c": [-1, 3]}})
    >>> [(change.value.text(), change.words[0]) for change in found]  # doctest: +NORMALIZE_WHITESPACE
    [('0', 'a region of 2 solutions appears'),
     ('1', 'the region of 0 solutions splits into 4'),
     ('2', '4 regions of 0 solutions vanish')]
    >>> found.complete
    True
    """
    options = Options(timeout=timeout, progress=progress)
    asked = family_from(question)
    share = share_for("tolerance", tolerance)
    return changes_of(in_common(asked, options), share, options)


def changes_of(
    common: Common, tolerance: Fraction = TOLERANCE, options: Options = DEFAULTS
) -> Changes:
    """The changes of a family of which it is known what its members have in common.

    Raises
    ------
    ConfigError, HypothesisError, LimitReached
        As `changes` does.
    """
    asked = common.family
    certified = [
        value for value in asked.values if is_certified(asked.member(value), options.engine)
    ]
    if certified:
        raise ConfigError(
            f"where the arrangement changes is known from exact members, and that at {asked.free.name} = "
            f"{text_of(certified[0])} is of the certified engine",
            key="changes",
        )
    check_count(asked.member(asked.values[0]))
    members = Members(common, options)
    return changes_among(members, _critical(members), tolerance)


def changes_among(
    members: Members, critical: tuple[RealRoot, ...] | str, tolerance: Fraction
) -> Changes:
    """The changes among members, with all values at which the arrangement can change, or why these
    are not known.
    """
    found, between, others, reason = (
        _bisected(members, tolerance, critical)
        if isinstance(critical, str)
        else _compared(members, critical, tolerance)
    )
    return Changes(
        members.family.free,
        tuple(found),
        tuple(between),
        tuple(members.at(value).arrangement for value in between),
        tuple(others),
        _at_ends(members, tolerance),
        not isinstance(critical, str),
        reason,
        tolerance,
    )


_Found = tuple[list[Change], list[Fraction], list[AlgebraicNumber], str]
"""The changes, simple values between them, critical values without one, and how this is known."""


class Members:
    """The arrangements of a family's members, each computed once, until the time is over.

    Attributes
    ----------
    base : the axis over which windows are cut, 0 or 1; the cheaper one when None.
    """

    def __init__(self, common: Common, options: Options, base: int | None = None) -> None:
        self.common, self.options, self.base = common, options, base
        self.deadline = None if options.timeout is None else perf_counter() + options.timeout
        self._known: dict[Fraction, Picture] = {}

    @property
    def family(self) -> AskedFamily:
        return self.common.family

    def check(self) -> None:
        if self.deadline is not None and perf_counter() > self.deadline:
            raise LimitReached("the time limit was reached before all changes were found")

    def report(self, stage: str, done: int, total: int) -> None:
        self.check()
        if self.options.progress is not None:
            self.options.progress(stage, done, total)

    def at(self, value: Fraction) -> Picture:
        """The arrangement of a member.

        Raises
        ------
        HypothesisError
            When the member is degenerate, has infinitely many equilibria, or leaves the domain of
            the geometry.
        """
        if value not in self._known:
            variety = self.common.variety
            known = None if variety is None else partial(variety.at, from_fraction(value))
            try:
                self._known[value] = picture_of(
                    self.family.member(value), known, self.check, self.base
                )
            except HypothesisError as error:
                raise type(error)(
                    f"{error} (at {self.family.free.name} = {text_of(value)})"
                ) from error
        return self._known[value]

    def tried(self, value: Fraction) -> Picture | None:
        """The same; None where the member has no arrangement."""
        try:
            return self.at(value)
        except HypothesisError:
            return None


def _critical(members: Members) -> tuple[RealRoot, ...] | str:
    """All values at which the arrangement can change, or why they are out of reach."""
    variety, asked = members.common.variety, members.family
    if variety is None:
        return "the equations are not eliminated over all members in common"
    members.report("critical values", 0, 1)
    box = list(map(interval_of, (*asked.axes, asked.free)))
    return critical_values(surfaces_of(in_space(asked), variety, box), box, members.check)


def _same(a: Picture, b: Picture) -> bool:
    return correspondence(a.arrangement, b.arrangement) is not None


def _compared(members: Members, critical: Sequence[RealRoot], tolerance: Fraction) -> _Found:
    """Of all values at which the arrangement can change those at which it does."""
    free = members.family.free
    gap = tolerance * free.width
    roots = [refine(r, from_fraction(gap)) for r in critical]
    lows = [free.low, *(to_fraction(r.high) for r in roots)]
    highs = [*(to_fraction(r.low) for r in roots), free.high]
    pictures = []
    for done, span in enumerate(zip(lows, highs, strict=True)):
        members.report("arrangements", done, len(lows))
        pictures.append(_typical(members, *span)[1])
    found: list[Change] = []
    others: list[AlgebraicNumber] = []
    kept = [0]
    for k, root in enumerate(roots):
        number = algebraic_number(root)
        below = simplest_fraction(max(lows[k], highs[k] - gap), highs[k])
        above = simplest_fraction(lows[k + 1], min(highs[k + 1], lows[k + 1] + gap))
        words = _words(members, (below, above), (pictures[k], pictures[k + 1]), number.exact)
        if words:
            found.append(Change(number, words))
            kept.append(k + 1)
        else:
            others.append(number)
    between = []
    for k, m in pairwise((*kept, len(lows))):
        value, picture = _typical(members, *_middle(lows[k], highs[m - 1]))
        if not _same(picture, pictures[k]):
            raise ArithmeticError("members between two critical values have different arrangements")
        between.append(value)
    values = {0: "", 1: " but at one value"}.get(len(roots), f" but at {len(roots)} values")
    reason = f"proved by elimination: within the range nothing can change{values}"
    return found, between, others, reason


def _typical(members: Members, low: Fraction, high: Fraction) -> tuple[Fraction, Picture]:
    """A simple value between two others at which the member has an arrangement, and this.

    Raises
    ------
    HypothesisError
        When the members that were tried have none.
    """
    first = simplest_fraction(low, high)
    for value in (first, simplest_fraction(low, first), simplest_fraction(first, high)):
        picture = members.tried(value)
        if picture is not None:
            return value, picture
    return first, members.at(first)


def _middle(low: Fraction, high: Fraction) -> tuple[Fraction, Fraction]:
    """The middle third."""
    third = (high - low) / 3
    return low + third, high - third


def _at_ends(members: Members, tolerance: Fraction) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """What is otherwise at the ends of the range than beside them."""
    free = members.family.free
    gap = tolerance * free.width

    def words(end: Fraction, beside: Fraction) -> tuple[str, ...]:
        there, near = members.tried(end), members.tried(beside)
        if there is None or near is None or _same(near, there):
            return ()
        return described(near, there)

    low, high = free.low, free.high
    return (
        words(low, simplest_fraction(low, low + gap)),
        words(high, simplest_fraction(high - gap, high)),
    )


def _words(
    members: Members,
    near: tuple[Fraction, Fraction],
    sides: tuple[Picture, Picture],
    value: Fraction | None,
) -> tuple[str, ...]:
    """What changes at a critical value; nothing where the arrangement is the same on both sides
    and, if known, there.

    Parameters
    ----------
    value : the critical one where it is rational.
    """
    if not _same(*sides):
        before, after = (members.at(place) for place in near)
        if not (_same(before, sides[0]) and _same(after, sides[1])):
            raise ArithmeticError("members between two critical values have different arrangements")
        return described(before, after)
    instant = None if value is None else members.tried(value)
    if instant is None or _same(instant, sides[0]):
        return ()
    return tuple(f"at this value alone: {text}" for text in described(members.at(near[0]), instant))


def _bisected(members: Members, tolerance: Fraction, reason: str) -> _Found:
    """Changes between members that differ, enclosed."""
    free = members.family.free
    inner = {free.middle(k, SAMPLES) for k in range(SAMPLES)}
    wanted = sorted(inner | {v for v in members.family.values if free.holds(v)})
    values = []
    for number, value in enumerate(wanted):
        members.report("arrangements", number, len(wanted))
        if members.tried(value) is not None:
            values.append(value)
    if not values:
        members.at(wanted[0])  # raises, as no member has an arrangement
    found, between, place = [], [], values[0]
    for low, high in _brackets(members, values, tolerance * free.width):
        between.append(_simple_alike(members, place, low))
        found.append(Change(Enclosure(low, high), described(members.at(low), members.at(high))))
        place = high
    between.append(_simple_alike(members, place, values[-1]))
    words = f"found by sampling {len(values)} members, not proved complete: {reason}"
    return found, between, [], words


def _simple_alike(members: Members, low: Fraction, high: Fraction) -> Fraction:
    """A value of the closed interval with the arrangement that the samples in it have, the lower
    end being one.
    """
    if low < high:
        value = simplest_fraction(low, high)
        picture = members.tried(value)
        if picture is not None and _same(picture, members.at(low)):
            return value
    return low


def _brackets(
    members: Members, values: Sequence[Fraction], width: Fraction
) -> Iterator[tuple[Fraction, Fraction]]:
    """Neighbouring values of different arrangements no further apart than the width, in increasing
    order.
    """
    open_ = [pair for pair in pairwise(values) if not _same(*map(members.at, pair))][::-1]
    while open_:
        low, high = open_.pop()
        members.report("bisection", 0, 1)
        middle = None if high - low <= width else simplest_fraction(*_middle(low, high))
        if middle is None or members.tried(middle) is None:
            yield low, high
            continue
        for pair in ((middle, high), (low, middle)):
            if not _same(*map(members.at, pair)):
                open_.append(pair)
