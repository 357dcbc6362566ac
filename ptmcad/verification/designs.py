"""Checks of the best design: that boxes cover the bounds, and counts at points of lines, by signatures of trace forms.

Guarantee: what passes as "boxes" holds. Of the value and of the bound samples are checked: counts where the best
design's range begins and ends, and, at random designs, points with another count so near together that no range is
longer than the bound of the design's box.

Not guaranteed: anything of designs that were not drawn, and of aims but a range.
"""

from __future__ import annotations

import random
from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from hashlib import sha256
from itertools import combinations, pairwise
from math import prod

from ptmcad.answer.design import BestDesign, BoundedBox
from ptmcad.errors import ExpressionError
from ptmcad.options import Progress
from ptmcad.text.expressions import Expression, constant
from ptmcad.text.numerals import shortest_text
from ptmcad.text.parsing import names_in, parse
from ptmcad.verification.algebra import NotFinite
from ptmcad.verification.derivation import parameters_of
from ptmcad.verification.fibre import fibre
from ptmcad.verification.report import Check, Headway, Unchecked, VerifyReport, Violation, checked

DESIGNS = 12
"""Random designs of which a line is looked at."""
DRAWN = 400
"""Random designs of which it is only looked whether a box holds them."""
INSIDE = 9
_NEAR = Fraction(1, 10**6)
"""How far from an end of a range counts are taken, as a share of its length."""
_ROUNDS = 60
_SHARES = 2**20


@dataclass(frozen=True, slots=True)
class _Lines:
    """A stored design, with counts at points."""

    found: BestDesign

    def working(self, value: Fraction, design: Mapping[str, Fraction]) -> bool | None:
        """Whether there is the wanted count at a point of a design's line; None where a solution is degenerate."""
        found = self.found
        assert found.along is not None
        known = {name: constant(at) for name, at in {**design, found.along.name: value}.items()}
        try:
            counts = fibre(found.model, self._parameters(known)).counts()
        except NotFinite:
            return None
        if counts is None:
            return None
        return (counts.total if counts.stable is None else counts.stable) == found.working

    def _parameters(self, known: dict[str, Expression]) -> dict[str, Fraction]:
        """The model's parameters, by what the document and the model say of them."""
        model, texts = self.found.model, self.found.parameters

        def value_of(name: str, chain: tuple[str, ...] = ()) -> Expression:
            if name not in known:
                text = texts.get(name) or (model.parameters[name].default if name in model.parameters else "")
                if not text or name in chain:
                    raise Violation(f"nothing says what {name[:40]!r} is")
                try:
                    known[name] = parse(text, {n: value_of(n, (*chain, name)) for n in names_in(text)})
                except ExpressionError as error:
                    raise Violation(f"the text kept for {name[:40]!r} is no expression: {error}") from error
            return known[name]

        return {name: value_of(name).constant() for name in parameters_of(model)}

    def holds(self, design: Mapping[str, Fraction]) -> bool:
        """Whether a design satisfies the conditions, as they are written."""
        known = {name: constant(at) for name, at in design.items()}
        fixed = {n: parse(t, {}) for n, t in self.found.parameters.items() if not names_in(t)}
        for text in self.found.conditions:
            sign = "<=" if "<=" in text else ">="
            left, _, right = text.partition(sign)
            low, high = (parse(side.strip(), {**fixed, **known}).constant() for side in (left, right))
            if low != high and (low < high) != (sign == "<="):
                return False
        return True


def verify_design(found: BestDesign, seed: int | None = None, progress: Progress | None = None) -> VerifyReport:
    """Check a stored design without the code that made it.

    Parameters
    ----------
    seed : of the random designs; from a hash of the claims when None.
    """
    claims = f"{found.name} {found.best} {found.bound} {[box.bound for box in found.boxes]}"
    drawn = sha256(claims.encode()).hexdigest()[:16] if seed is None else str(seed)
    steps = (
        ("boxes", "disjoint, volumes; random designs", partial(_check_boxes, seed=drawn)),
        ("value", "signatures beside the range's ends", _check_value),
        ("bound", "signatures on random lines", partial(_check_bound, seed=drawn)),
    )
    checks = checked(_Lines(found), steps, (), Headway(progress))
    checks.append(Check("bound of every design", "", None, "that no design exceeds its box's bound, beyond samples"))
    return VerifyReport(tuple(checks))


def _check_boxes(lines: _Lines, seed: str) -> str:
    found = lines.found
    if not found.boxes:
        return Unchecked("there are no boxes")
    for box in found.boxes:
        inside = zip(found.over, box.ranges, strict=True)
        if not all(axis.low <= low < high <= axis.high for axis, (low, high) in inside):
            raise Violation(f"{_text(box)} is not within the bounds")
    for a, b in combinations(found.boxes, 2):
        if all(max(p[0], q[0]) < min(p[1], q[1]) for p, q in zip(a.ranges, b.ranges, strict=True)):
            raise Violation(f"{_text(a)} and {_text(b)} overlap")
    whole = prod(axis.high - axis.low for axis in found.over)
    volume = sum(prod(high - low for low, high in box.ranges) for box in found.boxes)
    if not found.conditions:
        if volume != whole:
            raise Violation(f"the boxes have {float(volume / whole):.6g} of the bounds' volume, not all of it")
        return f"{len(found.boxes)} boxes cover the bounds"
    source, seen = random.Random(f"{seed} boxes"), 0
    for _ in range(DRAWN):
        design = {axis.name: axis.low + (axis.high - axis.low) * _share(source) for axis in found.over}
        if lines.holds(design):
            seen += 1
            if not any(_is_in(box, tuple(design.values())) for box in found.boxes):
                raise Violation(f"no box holds the design {_named(design)}, which satisfies the conditions")
    return f"{len(found.boxes)} boxes are disjoint; they hold {seen} random designs that satisfy the conditions"


def _check_value(lines: _Lines) -> str:
    found = lines.found
    if found.best is None or found.value is None or found.span is None or found.along is None:
        return Unchecked("the best design has no range")
    if not lines.holds(found.best):
        raise Violation("the best design does not satisfy the conditions")
    low, high = found.span
    if high.low - low.high > found.value.high or high.high - low.low < found.value.low:
        raise Violation("the value is not the distance of the range's two ends")
    length = high.low - low.high
    if length <= 0:
        return Unchecked("the range has no length")
    near = length * _NEAR
    inner = [
        low.high + near,
        *(low.high + length * Fraction(k, INSIDE + 1) for k in range(1, INSIDE + 1)),
        high.low - near,
    ]
    outer = [at for at in (low.low - near, high.high + near) if found.along.low < at < found.along.high]
    for points, wanted in ((inner, True), (outer, False)):
        for at in points:
            if lines.working(at, found.best) is (not wanted):
                other = "another count" if wanted else "the wanted count"
                raise Violation(f"at {found.along.name} = {shortest_text(at)} the best design has {other}")
    return f"{len(inner)} points of the range, {len(outer)} beside it"


def _check_bound(lines: _Lines, seed: str) -> str:
    found = lines.found
    if found.bound is None or found.along is None:
        return Unchecked("nothing is claimed, or not of a range")
    if found.value is not None and found.bound < found.value.low:
        raise Violation("the best design has more than the bound")
    source = random.Random(f"{seed} lines")
    everywhere = BoundedBox(tuple((axis.low, axis.high) for axis in found.over), found.bound)
    settled = seen = 0
    while seen < DESIGNS:
        seen += 1
        box = source.choice(found.boxes) if found.boxes else everywhere
        if box.bound > found.bound:
            raise Violation(f"{_text(box)} has a larger bound than all of them")
        at = tuple(low + (high - low) * _share(source) for low, high in box.ranges)
        design = dict(zip((axis.name for axis in found.over), at, strict=True))
        settled += lines.holds(design) and _is_short(lines, design, box.bound)
    if not settled:
        return Unchecked(f"at none of {seen} random designs was it seen that no range is longer")
    return f"at {settled} of {seen} random designs no range is longer than the bound of their box"


def _is_short(lines: _Lines, design: Mapping[str, Fraction], bound: Fraction) -> bool:
    """Whether points with another count are found that leave no room for a longer range.

    Raises
    ------
    Violation
        When all points that were looked at between two that are further apart than the bound have the wanted count.
    """
    along = lines.found.along
    assert along is not None
    others = [along.low, along.high]  # ends of the window, and points with another count
    with_count: list[Fraction] = []
    for _ in range(_ROUNDS):
        wide = max(pairwise(others), key=lambda pair: pair[1] - pair[0])
        if wide[1] - wide[0] <= bound:
            return True
        inside = [wide[0], *(at for at in sorted(with_count) if wide[0] < at < wide[1]), wide[1]]
        # between the end of the gap and the first point with the count, or where nothing is known
        gaps = [
            pair for pair in pairwise(inside) if pair[0] == wide[0] or pair[1] == wide[1] or len(inside) < 2 + INSIDE
        ]
        low, high = max(gaps, key=lambda pair: pair[1] - pair[0])
        at = low + (high - low) * Fraction(7, 15)
        there = lines.working(at, design)
        if there is False:
            others = sorted([*others, at])
        elif there is True:
            with_count.append(at)
        else:
            return False
    low, high = max(pairwise(others), key=lambda pair: pair[1] - pair[0])
    known = sorted(at for at in with_count if low < at < high)
    if known and known[-1] - known[0] > bound:
        raise Violation(
            f"the design {_named(design)} has the wanted count at {len(known)} points from {along.name} = "
            f"{shortest_text(known[0])} to {shortest_text(known[-1])}, further apart than the bound, and no point "
            "between is known to have another one"
        )
    return False


def _share(source: random.Random) -> Fraction:
    return Fraction(2 * source.randrange(_SHARES) + 1, 2 * _SHARES)


def _is_in(box: BoundedBox, at: tuple[Fraction, ...]) -> bool:
    return all(low <= x <= high for x, (low, high) in zip(at, box.ranges, strict=True))


def _text(box: BoundedBox) -> str:
    return "the box " + " x ".join(f"[{shortest_text(low)}, {shortest_text(high)}]" for low, high in box.ranges)


def _named(design: Mapping[str, Fraction]) -> str:
    return ", ".join(f"{name} = {shortest_text(value)}" for name, value in design.items())
