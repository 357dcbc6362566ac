"""Checks of a family: where it changes, and its surfaces.

*Changes.* Members are classified once more, each alone and over either axis, and compared. Their
arrangement is read off these two maps: regions, counts and neighbours off both, and the order along
two sides off each, where the map's stacks begin and end. The program that finds changes counts once
for all cells that are joined, with the basis that the members have in common, and finds the order
along the other sides in another way.

*Surfaces*, cut at a random value, are the critical curves of the member there, which is classified
alone, without what the members have in common.

Guarantee, where the members' maps are true, which are the caller's and are not verified: a change
that is listed is one, within a stated distance of its value; between changes the members that were
looked at, at random values, have the arrangement that is listed. Where the
surfaces, at the random value, have other irreducible factors than the member's curves on which
solutions meet, they are not those of the family, but for finitely many values, of which a random
one is none by accident.

Not guaranteed: that no change is missing between the members that were looked at.
"""

from __future__ import annotations

import random
from collections import defaultdict
from collections.abc import Callable, Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import count, pairwise

from ptmcad.answer.arrangement import Arrangement, correspondence
from ptmcad.answer.counts import counted_by
from ptmcad.answer.family import Changes, FamilyMap, SpaceTerms
from ptmcad.answer.regionmap import Kind, Merge, RegionMap
from ptmcad.errors import HypothesisError, shown
from ptmcad.options import Progress
from ptmcad.text.enclosure import AlgebraicNumber, Enclosure
from ptmcad.text.flint_numbers import simplest_fraction
from ptmcad.text.numerals import text_of
from ptmcad.text.plane import PlanePolynomial
from ptmcad.verification.planecurves import factors, polynomial
from ptmcad.verification.report import Check, Unchecked, Violation, drawn, share
from ptmcad.verification.rootcounts import is_alone

NEAR = Fraction(1, 10**6)
"""Of the range: how far from a change at most, on both sides, members are classified."""
RANDOM = 2
"""Members at random values between two changes."""
_DIGITS = 10**3
"""Random values lie about such shares of an interval."""

Maps = tuple[RegionMap, RegionMap]
MapsAt = Callable[[Fraction], Maps]
"""The maps of a member, over the first axis and over the second one, without areas; raises
`HypothesisError` where it has none."""


def verify_changes(
    found: Changes,
    maps_at: MapsAt,
    seed: int | None = None,
    progress: Progress | None = None,
) -> tuple[Check, ...]:
    """Check where a family changes.

    Parameters
    ----------
    maps_at : classifies a member, without what the members have in common.
    seed : of the random values; a fresh one when None.
    progress : called as ``progress("changes", done, total)`` before each member; may raise to stop.
    """
    method = "the engine's maps of members alone, over either axis"
    chosen = drawn(seed)
    source = random.Random(chosen)
    try:
        detail: str = _checked(found, _fits(found, maps_at, progress), source)
        passed = None if isinstance(detail, Unchecked) else True
    except Violation as violation:
        return (Check("changes", method, False, shown(str(violation))),)
    detail = type(detail)(f"{detail}; seed {chosen}")
    missing = "that no further change lies between the members that were looked at"
    return (Check("changes", method, passed, detail), Check("changes complete", "", None, missing))


Fits = Callable[[Fraction, int], bool]
"""Whether the member at a value has the arrangement of a part between changes."""


def _fits(found: Changes, maps_at: MapsAt, progress: Progress | None) -> Fits:
    total, tried = 2 * len(found.changes) + (1 + RANDOM) * len(found.between), count()

    def fits(value: Fraction, part: int) -> bool:
        if progress is not None:
            progress("changes", next(tried), total)
        listed = found.arrangements[part]
        return all(_is_seen(listed, result, side) for side, result in enumerate(maps_at(value)))

    return fits


def _checked(found: Changes, fits: Fits, source: random.Random) -> str:
    def expect(value: Fraction, part: int, where: str) -> None:
        if not fits(value, part):
            at = f"{found.free.name} = {text_of(value)}"
            raise Violation(f"the member at {at}, {where}, has another arrangement than is listed")

    values = [change.value for change in found.changes]
    _check_numbers([*values, *found.others])
    parts = _parts(found)
    gaps = _gaps(found, [high - low for low, high in parts])
    for part, listed in enumerate(found.between):
        expect(listed, part, "listed between changes")
    for k, value in enumerate(values):
        low, high = _beside(value, gaps[k])
        name = f"the change at {value.text(8) if isinstance(value, AlgebraicNumber) else text_of(value.low)}"
        expect(low, k, f"below {name}")
        expect(high, k + 1, f"above {name}")
        if correspondence(found.arrangements[k], found.arrangements[k + 1]) is not None:
            _check_instant(fits, value, k, name)
    skipped = 0
    for part, (start, end) in enumerate(parts):
        for _ in range(RANDOM):
            chosen = source.randrange(1, _DIGITS)
            low, high = (
                start + (end - start) * Fraction(2 * chosen + k, 2 * _DIGITS) for k in (0, 1)
            )
            member = low if low == high else simplest_fraction(low, high)
            try:
                expect(member, part, "between changes")
            except HypothesisError:  # none of the kinds of members of which anything is said
                skipped += 1
    number = RANDOM * len(found.between) - skipped
    what = f"{number} random members between changes"
    if values:
        what = f"{len(values)} changes, compared with members {text_of(NEAR)} of the range away on both sides; {what}"
    return Unchecked(f"no random member has a map; {what}") if not number else what


def _check_numbers(numbers: Sequence[AlgebraicNumber | Enclosure]) -> None:
    """Each exact number is the only root of its polynomial between its bounds."""
    for number in numbers:
        if isinstance(number, AlgebraicNumber) and not is_alone(number):
            raise Violation(
                f"not one root of a value's polynomial lies between its bounds {text_of(number.low)} "
                f"and {text_of(number.high)}"
            )


def _gaps(found: Changes, rooms: Sequence[Fraction]) -> list[Fraction]:
    """How far from each change members are looked at: less where another change or an end of the
    range is near.

    Parameters
    ----------
    rooms : the widths of the intervals between changes.
    """
    sides = list(pairwise(rooms))
    # enclosures have members at their ends, and neighbouring ones may have one in common
    if min(rooms) < 0 or any(
        change.is_exact and min(s) == 0 for change, s in zip(found.changes, sides, strict=True)
    ):
        raise Violation("the changes are not in increasing order within the range")
    near = NEAR * (found.free.high - found.free.low)
    return [min(near, below / 3, above / 3) for below, above in sides]


def _beside(value: AlgebraicNumber | Enclosure, gap: Fraction) -> tuple[Fraction, Fraction]:
    """Values below and above a change; the ends of an enclosure, which are members."""
    if isinstance(value, AlgebraicNumber):
        near = value.refined(gap / 4)
        places = (
            (near.low - gap * 3 / 4, near.low - gap / 2),
            (near.high + gap / 2, near.high + gap * 3 / 4),
        )
        return simplest_fraction(*places[0]), simplest_fraction(*places[1])
    return value.low, value.high


def _check_instant(fits: Fits, value: AlgebraicNumber | Enclosure, part: int, name: str) -> None:
    """On both sides of a value the arrangement is the same: then that at the value itself is
    another one.
    """
    exact = value.exact if isinstance(value, AlgebraicNumber) else None
    if exact is None:
        raise Violation(f"{name} is none: on both sides of it the arrangement is the same")
    try:
        same = fits(exact, part)
    except HypothesisError:
        return
    if same:
        raise Violation(
            f"{name} is none: there and on both sides of it the arrangement is the same"
        )


def _parts(found: Changes) -> list[tuple[Fraction, Fraction]]:
    """The intervals between changes."""
    lows = (found.free.low, *(change.value.high for change in found.changes))
    highs = (*(change.value.low for change in found.changes), found.free.high)
    return list(zip(lows, highs, strict=True))


def _is_seen(listed: Arrangement, result: RegionMap, base: int) -> bool:
    """Whether a map over one of the axes has an arrangement, as far as it shows: of the sides the
    order along those above and below.

    Parameters
    ----------
    base : 0 when the map's first axis is the family's, 1 when its axes are exchanged.
    """
    low_x, high_x, low_y, high_y = listed.sides
    sides = ((), (), low_y, high_y) if base == 0 else (low_x, high_x, (), ())
    return correspondence(replace(listed, sides=sides), _arrangement(result, base)) is not None


def _arrangement(result: RegionMap, base: int) -> Arrangement:
    region_of = [cell.region for cell in result.cells]
    pairs = {
        (min(ends), max(ends))
        for a in result.adjacencies
        if a.merge is Merge.SEPARATED
        and len(ends := {region_of[a.first], region_of[a.second]}) == 2
    }
    below, above = (_runs([region_of[stack.cells[k]] for stack in result.stacks]) for k in (0, -1))
    sides = ((), (), below, above) if base == 0 else (below, above, (), ())
    keys = tuple(counted_by(region, result.slice.count) for region in result.regions)
    return Arrangement(keys, frozenset(pairs), sides)


def _runs(regions: Sequence[int]) -> tuple[int, ...]:
    """The regions without immediate repetitions."""
    return tuple(n for k, n in enumerate(regions) if k == 0 or regions[k - 1] != n)


_DRAWN = 10
"""Values that are tried, where members have no map."""
_SHARES = 1009
"""A prime: random values are such shares of the range."""


def verify_surfaces(
    found: FamilyMap, map_at: Callable[[Fraction], RegionMap], seed: int | None = None
) -> Check:
    """Check the polynomials of the surfaces on which solutions meet.

    Parameters
    ----------
    map_at : classifies a member, without what the members have in common; raises `HypothesisError`
        where it has no map.
    seed : of the random value; a fresh one when None.
    """
    if not found.surfaces:
        return Check("surfaces", "", None, "none are stored: those of the family are not said")
    name, method = "surfaces", "the engine's map of a member alone, factored"
    chosen = drawn(seed)
    source = random.Random(chosen)
    for _ in range(_DRAWN):
        value = found.free.low + (found.free.high - found.free.low) * share(source, _SHARES)
        try:
            alone = map_at(value)
        except HypothesisError:  # a value at which nothing is said of the family
            continue
        where = f"the member at {found.free.name} = {text_of(value)}"
        wrong = _difference(found, alone, value)
        if wrong:
            return Check(name, method, False, shown(f"{where} {wrong}"))
        number = f"{len(found.surfaces)} polynomial{'s' * (len(found.surfaces) > 1)}"
        return Check(
            name, method, True, f"{number} cut to the critical curves of {where}; seed {chosen}"
        )
    return Check(name, method, None, f"of {_DRAWN} random members none has a map")


def _difference(found: FamilyMap, alone: RegionMap, value: Fraction) -> str:
    """In what the surfaces, cut at a value, are not the member's curves there; empty when they are."""
    names = alone.slice.axis_names
    cut = {f for terms in found.surfaces for f in _cut(terms, value)}
    known = {c.polynomial for c in alone.components}
    for curve in sorted(cut - known, key=lambda p: p.terms):
        return f"has no curve {curve.text(names)[:60]} = 0, as the surfaces have"
    for c in alone.components:
        if c.kind is Kind.CRITICAL and c.polynomial not in cut:
            return (
                f"has a critical curve {c.polynomial.text(names)[:60]} = 0 that lies on no surface"
            )
    return ""


def _cut(terms: SpaceTerms, value: Fraction) -> list[PlanePolynomial]:
    """The irreducible factors of a polynomial at a value of the third variable that are not
    constant.
    """
    degree = max(powers[2] for powers, _ in terms)
    plane: dict[tuple[int, int], int] = defaultdict(int)
    for (i, j, k), c in terms:
        plane[i, j] += c * value.numerator**k * value.denominator ** (degree - k)
    cut = polynomial((*powers, c) for powers, c in plane.items())
    return [] if cut.is_constant() else factors(cut)
