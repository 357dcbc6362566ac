"""Checks of the best design: that boxes cover the bounds, and ranges of the designs that were
evaluated.

Guarantee: what passes as "boxes" and "values" holds. Of the bound samples are checked: no range is
longer than the bound of the design's box at a random design of each box.

Not guaranteed: the bound of designs that were not drawn, and values of aims but a range.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from itertools import combinations

from ptmcad.answer.design import BestDesign, BoundedBox
from ptmcad.answer.intervals import AnyEnd, Span, lower, upper
from ptmcad.errors import ExpressionError
from ptmcad.options import Progress
from ptmcad.question.slice import Axis
from ptmcad.text.enclosure import Enclosure
from ptmcad.text.expressions import Expression, axis, constant
from ptmcad.text.flint_numbers import from_fraction
from ptmcad.text.numerals import shortest_text
from ptmcad.text.parsing import parse
from ptmcad.text.syntax import names_in
from ptmcad.verification.derivation import parameters_of
from ptmcad.verification.parameterclaims import explained, named_in
from ptmcad.verification.parameterlines import ParameterLine, SliceLines, check_maxima
from ptmcad.verification.report import (
    Check,
    CheckProgress,
    NotKnown,
    Unchecked,
    VerifyReport,
    Violation,
    Within,
    checked,
    drawn,
    share,
)
from ptmcad.verification.windowsigns import Sign, is_in_domain

DESIGNS = 12
"""Random designs of which a line is looked at at least; one of each box."""
_HALVINGS = 16
"""Of a part of the bounds that no box holds, until a condition is seen to fail all over it."""
Ranges = tuple[tuple[Fraction, Fraction], ...]
_NOTHING = Enclosure(Fraction(0), Fraction(0))


@dataclass(frozen=True, slots=True)
class _DesignLines:
    """A stored design, with the ranges of any one; their random points follow from the seed."""

    found: BestDesign
    seed: str

    def ranges(self, design: Mapping[str, Fraction]) -> list[Span]:
        """All ranges with the wanted count, by their own ends; none where the conditions are not
        satisfied.

        Raises
        ------
        NotKnown
        """
        along = self.found.along
        assert along is not None
        if not self.holds(design):
            return []
        known = {name: constant(at) for name, at in design.items()} | {along.name: axis(0)}
        return self.line(known, along).ranges(self.found.working)

    def line(self, known: dict[str, Expression], along: Axis) -> ParameterLine:
        """The line along an axis, by what the other parameters are on it."""
        return ParameterLine(
            self.found.model, self._parameters(known), along.low, along.high, self.seed
        )

    def _parameters(self, known: dict[str, Expression]) -> dict[str, Expression]:
        """The model's parameters, by what the document and the model say of them."""
        model = self.found.model
        said = {name: parameter.default for name, parameter in model.parameters.items()}
        said |= {name: text for name, text in self.found.parameters.items() if text}
        texts, waiting = dict[str, str](), [*parameters_of(model)]
        while waiting:
            name = waiting.pop()
            if name in known or name in texts:
                continue
            if not said.get(name):
                raise Violation(f"nothing says what {name[:40]!r} is")
            texts[name] = said[name]
            waiting += named_in(name, said[name])
        values = known | explained(texts, known)
        return {name: values[name] for name in parameters_of(model)}

    def excesses(self, design: Mapping[str, Expression]) -> list[Expression]:
        """What is not positive where the conditions are satisfied, as they are written.

        Raises
        ------
        Violation
        """
        fixed = {n: parse(t, {}) for n, t in self.found.parameters.items() if not names_in(t)}
        found = []
        for text in self.found.conditions:
            sign = "<=" if "<=" in text else ">="
            try:
                low, high = (parse(side.strip(), {**fixed, **design}) for side in text.split(sign))
            except (ExpressionError, ValueError) as error:
                raise Violation(f"{text!r} is no condition: {error}") from error
            found.append(low - high if sign == "<=" else high - low)
        return found

    def holds(self, design: Mapping[str, Fraction]) -> bool:
        """Whether a design satisfies the conditions."""
        return all(
            e.constant() <= 0
            for e in self.excesses({name: constant(at) for name, at in design.items()})
        )

    def named(self, at: Sequence[Fraction]) -> dict[str, Fraction]:
        """A design by its numbers."""
        return dict(zip((axis.name for axis in self.found.over), at, strict=True))


def verify_design(
    found: BestDesign, seed: int | None = None, progress: Progress | None = None
) -> VerifyReport:
    """Check a stored design without the code that made it.

    Parameters
    ----------
    seed : of the random designs; a fresh one when None.
    """
    bar = CheckProgress(progress)
    steps: tuple[tuple[str, str, Callable[[_DesignLines], str]], ...] = (
        ("form", "comparison", _check_form),
        ("boxes", "disjoint; what is left, halved", _check_boxes),
        (
            "values",
            "ranges of each design by itself",
            partial(_check_values, within=bar.within),
        ),
        ("bound", "ranges of random designs", _check_bound),
        ("extremes", "ranges on the lines themselves", _check_extremes),
    )
    checks = checked(_DesignLines(found, drawn(seed)), steps, (), bar)
    checks.append(
        Check(
            "bound of every design",
            "",
            None,
            "that no design exceeds its box's bound, beyond samples",
        )
    )
    return VerifyReport(tuple(checks))


def _check_form(lines: _DesignLines) -> str:
    """What entries say of one another."""
    found = lines.found
    of_range = found.maximise == "range"
    if of_range != (found.along is not None) or (found.maximise == "area") != (
        len(found.fixed) == 2
    ):
        raise Violation(f"the aim {found.maximise[:40]!r} does not go with the window")
    if (found.span is not None) != (of_range and found.value is not None and found.value.high > 0):
        raise Violation("a span is of a range that there is, and of no other aim")
    names = [axis.name for axis in (*found.over, *found.fixed, *filter(None, [found.along]))]
    if len({*names}) < len(names) and found.along is not None:
        raise Violation("two axes have one name")
    if len({point.at for point in found.points}) < len(found.points):
        raise Violation("a design is listed twice among those that were evaluated")
    number = f"{len(found.boxes)} boxes" if len(found.boxes) > 1 else "one box"
    reasons = (
        f"by branch and bound, {how} {number} of designs"
        for how in ("over", "which was stopped at")
    )
    if found.boxes and found.reason not in reasons:
        raise Violation(f"the reason names another number of boxes than {len(found.boxes)}")
    best = None if found.value is None else found.value.high
    for point in found.points:
        if len(point.at) != len(found.over):
            raise Violation("a design has not as many numbers as there are parameters")
        design = lines.named(point.at)
        where = f"the design {_named(design)}"
        if not _is_in(_bounds(found), point.at):
            raise Violation(f"{where} is not within the bounds")
        if design == found.best and point.value != found.value:
            raise Violation("the best design is listed with another value")
        if point.value is None:
            continue
        bounds = [box.bound for box in found.boxes if _is_in(box.ranges, point.at)]
        bounds += [] if found.bound is None else [found.bound]
        if best is None or point.value.low > best:
            raise Violation(f"{where} is listed with more than the best one has")
        if any(point.value.low > bound for bound in bounds):
            raise Violation(f"{where} is listed with more than the bound")
    return f"{len(found.points)} designs, {len(found.boxes)} boxes"


def _check_boxes(lines: _DesignLines) -> str:
    found = lines.found
    if not found.boxes:
        return Unchecked("there are no boxes")
    for box in found.boxes:
        inside = zip(found.over, box.ranges, strict=True)
        if not all(axis.low <= low < high <= axis.high for axis, (low, high) in inside):
            raise Violation(f"{_text(box)} is not within the bounds")
    for a, b in combinations(found.boxes, 2):
        if _overlap(a.ranges, b.ranges):
            raise Violation(f"{_text(a)} and {_text(b)} overlap")
    open_ = 0
    whole = _bounds(found)
    waiting = [(whole, found.boxes, 0)]
    while waiting:
        part, boxes, halvings = waiting.pop()
        met = tuple(box for box in boxes if _overlap(part, box.ranges))
        cuts = (
            (k, cut)
            for box in met
            for k, ends in enumerate(box.ranges)
            for cut in ends
            if part[k][0] < cut < part[k][1]
        )
        k, cut = next(cuts, (-1, Fraction(0)))
        if k < 0:
            if met or _fails_all_over(lines, part):
                continue
            if halvings == _HALVINGS:
                open_ += 1
                continue
            shares = [(b - a) / (d - c) for (a, b), (c, d) in zip(part, whole, strict=True)]
            k = shares.index(max(shares))
            cut, halvings = sum(part[k], Fraction(0)) / 2, halvings + 1
        for ends in ((part[k][0], cut), (cut, part[k][1])):
            waiting.append(((*part[:k], ends, *part[k + 1 :]), met, halvings))
    if open_:
        return Unchecked(
            f"it was not decided whether a condition fails all over {open_} parts that no box holds"
        )
    return f"{len(found.boxes)} boxes cover the bounds" + (
        ", where the conditions hold" if found.conditions else ""
    )


def _bounds(found: BestDesign) -> Ranges:
    return tuple((axis.low, axis.high) for axis in found.over)


def _overlap(one: Ranges, other: Ranges) -> bool:
    """Whether two boxes have inner points in common."""
    return all(max(a, c) < min(b, d) for (a, b), (c, d) in zip(one, other, strict=True))


def _fails_all_over(lines: _DesignLines, part: Ranges) -> bool:
    """Whether one condition is seen to fail in all of a part of the bounds that no box holds.

    Raises
    ------
    Violation
        When its middle satisfies all conditions.
    """
    middle = lines.named([sum(ends, Fraction(0)) / 2 for ends in part])
    if lines.holds(middle):
        raise Violation(f"no box holds the design {_named(middle)}, which satisfies the conditions")
    if len(part) > 2:
        return False
    ends = [(from_fraction(low), from_fraction(high)) for low, high in part]
    window = (ends[0], ends[-1])
    axes = {axis_.name: axis(k) for k, axis_ in enumerate(lines.found.over)}
    return any(is_in_domain(e, window, strict=True) is Sign.PROVED for e in lines.excesses(axes))


def _check_values(lines: _DesignLines, within: Within) -> str:
    found = lines.found
    if found.along is None:
        return Unchecked("they are of another aim than a range")
    unknown = 0
    for done, point in enumerate(found.points):
        within(done, len(found.points))
        design = lines.named(point.at)
        try:
            ranges = lines.ranges(design)
        except NotKnown:
            unknown += 1
            continue
        widths = [_NOTHING, *(span.width for span in ranges)]
        longest = max(widths, key=lambda width: width.low)
        if (point.value is None) == lines.holds(design):
            raise Violation(
                f"the design {_named(design)} has {'no' if point.value is None else 'a'} value, but "
                "conditions are satisfied at those that have one"
            )
        if point.value is not None and not _meet(longest, point.value):
            raise Violation(
                f"the longest range of the design {_named(design)} is {float(longest):.10g}, not "
                f"{float(point.value):.10g}"
            )
        if design == found.best and found.span is not None:
            low, high = found.span
            if not any(
                _meet(_enclosed(r.low), low) and _meet(_enclosed(r.high), high) for r in ranges
            ):
                raise Violation("the best design has no range with the ends of its span")
            if found.value is None or not _meet(
                found.value, Enclosure(high.low - low.high, high.high - low.low)
            ):
                raise Violation("the value is not the distance of the range's two ends")
    text = f"{len(found.points) - unknown} designs"
    return Unchecked(f"{text}; of {unknown} more nothing was found out") if unknown else text


def _check_bound(lines: _DesignLines) -> str:
    found, seed = lines.found, lines.seed
    if found.bound is None or found.along is None:
        return Unchecked("nothing is claimed, or not of a range")
    if found.value is not None and found.bound < found.value.low:
        raise Violation("the best design has more than the bound")
    source = random.Random(f"{seed} lines")
    everywhere = BoundedBox(_bounds(found), found.bound)
    boxes = [
        *found.boxes,
        *source.choices(found.boxes or [everywhere], k=max(0, DESIGNS - len(found.boxes))),
    ]
    settled = 0
    for box in boxes:
        if box.bound > found.bound:
            raise Violation(f"{_text(box)} has a larger bound than all of them")
        design = lines.named([low + (high - low) * share(source) for low, high in box.ranges])
        try:
            ranges = lines.ranges(design)
        except NotKnown:
            continue
        settled += 1
        if any(span.width.low > box.bound for span in ranges):
            raise Violation(
                f"the design {_named(design)} has a range longer than the bound of its box"
            )
    if not settled:
        return Unchecked(f"of {len(boxes)} random designs nothing was found out")
    text = f"at {settled} random designs no range is longer than the bound of their box"
    if settled < len(boxes):
        return Unchecked(
            f"{text}; of {len(boxes) - settled} more nothing was found out; seed {seed}"
        )
    return f"{text}; seed {seed}"


def _check_extremes(lines: _DesignLines) -> str:
    found = lines.found
    if not found.maxima or found.along is None:
        in_words = found.reason.startswith("by exact critical values")
        return Unchecked(
            "what the reason alone says of critical values" if in_words else "none is claimed"
        )
    along, over = found.along, found.over[0]
    words = "; ".join(m.words(over.name) for m in found.maxima)
    if (
        found.reason != f"by exact critical values: {words}"
        or len(found.over) > 1
        or found.conditions
    ):
        raise Violation("the reason does not say what the extremes do")
    if found.bound != max(m.width.high for m in found.maxima):
        raise Violation("the bound is not the largest of the extremes")
    both = SliceLines(
        lambda value: lines.line({over.name: constant(value), along.name: axis(0)}, along),
        lambda value: lines.line({along.name: constant(value), over.name: axis(0)}, over),
        along,
        over,
        found.working,
        lines.seed,
    )
    return check_maxima(both, found.maxima)


def _enclosed(end: AnyEnd) -> Enclosure:
    return Enclosure(lower(end), upper(end))


def _meet(one: Enclosure, other: Enclosure) -> bool:
    return one.low <= other.high and other.low <= one.high


def _is_in(ranges: Ranges, at: tuple[Fraction, ...]) -> bool:
    return all(low <= x <= high for x, (low, high) in zip(at, ranges, strict=True))


def _text(box: BoundedBox) -> str:
    return "the box " + " x ".join(
        f"[{shortest_text(low)}, {shortest_text(high)}]" for low, high in box.ranges
    )


def _named(design: Mapping[str, Fraction]) -> str:
    return ", ".join(f"{name} = {shortest_text(value)}" for name, value in design.items())
