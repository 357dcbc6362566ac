"""The five-line table of a region map for the terminal."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from fractions import Fraction

from ptmcad.answer.regionmap import COMPILATION, Region, RegionMap, Status
from ptmcad.answer.words import index_words, noun
from ptmcad.cover.rectangles import Cover
from ptmcad.mechanism import Mechanism, Model
from ptmcad.question.slice import Count
from ptmcad.show.units import area_unit
from ptmcad.text.numerals import decimal, magnitude

_NAMES = {
    Count.STABLE: "stable",
    Count.TOTAL: "in all",
    Count.ADMISSIBLE: "stable and admissible",
}


def _count_name(result: RegionMap, region: Region) -> str:
    """What is counted, as it follows the number."""
    count, model = result.slice.count, result.slice.model
    if count is Count.INDEX:
        return index_heading(model)
    if count is Count.TOTAL and not isinstance(model, Mechanism):
        return noun(model, region.total or 0)
    return _NAMES[count]


def index_heading(model: Model) -> str:
    """What the entries of an index stand for, in brackets as they are."""
    return f"({', '.join(index_words(len(model.unknowns) + 1).split('-'))})"


def count_text(region: Region, count: Count) -> str:
    """The count by which regions are distinguished, as text."""
    if count is Count.STABLE:
        return str(region.stable)
    if count is Count.TOTAL:
        return str(region.total)
    if count is Count.ADMISSIBLE:
        return str(region.admissible)
    return f"({', '.join(map(str, region.index))})" if region.index else "?"


def certified_digits(bounds: tuple[Fraction, Fraction], most: int = 10) -> str:
    """The longest decimal, of at most ``most`` digits, that is within one unit of its last digit of both bounds.

    Two decimals, joined by "to", when not even two digits are certain (or the one that is asked for).
    """
    low, high = bounds
    middle = (low + high) / 2
    if high == 0:
        return "0"
    top = magnitude(middle)
    for exponent in range(top - most, top + (most == 1)):
        unit = Fraction(10) ** exponent
        digits = round(middle / unit)
        if len(str(digits)) <= most and digits > 0 and high - digits * unit <= unit and digits * unit - low <= unit:
            return decimal(digits * unit, up=False, digits=most)
    return f"{decimal(low, up=False, digits=2)} to {decimal(high, up=True, digits=2)}"


def area_text(result: RegionMap, bounds: tuple[Fraction, Fraction]) -> str:
    """An area as it is printed everywhere: one number of an exact map, both bounds of a certified one, and its unit."""
    text = certified_digits(bounds) if result.cover is None else interval_text(bounds)
    known = area_unit(result.slice)
    return f"{text} {known}" if known else text


def area_by_count(result: RegionMap) -> dict[str, tuple[Fraction, Fraction]]:
    """Bounds of the area of all points with each count, by the count's text.

    Of a certified map with all that is undetermined, in which there may be more regions.
    """
    bounds = [(count_text(r, result.slice.count), r.area) for r in result.regions]
    if result.cover is not None:
        return dict(_by_count(bounds, result))
    return {
        text: (
            sum((a[0] for t, a in bounds if t == text), Fraction(0)),
            sum((a[1] for t, a in bounds if t == text), Fraction(0)),
        )
        for text in dict(bounds)
    }


def interval_text(bounds: tuple[Fraction, Fraction]) -> str:
    """Both bounds, rounded outwards by a hundredth of their distance at most.

    >>> interval_text((Fraction("1.69822"), Fraction("1.75450"))), interval_text((Fraction(0), Fraction(2)))
    ('1.6982 to 1.7545', '0 to 2')
    """
    low, high = bounds
    if low >= high:
        return certified_digits(bounds)
    digits = max(2, magnitude(high) - magnitude(high - low) + 3)
    return f"{_down_to(low, digits, high)} to {decimal(high, up=True, digits=digits)}"


def _down_to(value: Fraction, digits: int, largest: Fraction) -> str:
    """The value rounded down to the decimal place that ``digits`` digits of the largest end in."""
    unit = Fraction(10) ** (magnitude(largest) + 1 - digits)
    return decimal(value // unit * unit, up=False)


def _short(value: Fraction) -> str:
    """A number, not negative, in two digits, of any size."""
    return (
        "0.0e+00" if value == 0 else f"{float(value):.1e}" if abs(magnitude(value)) < 300 else f"1e{magnitude(value)}"
    )


def _curves(result: RegionMap) -> str:
    names = result.slice.axis_names
    alike = Counter(
        (c.kind.value, c.polynomial.degrees, len(c.polynomial.terms)) for c in result.components if c.separates
    )
    curves = "; ".join(
        f"{n} {kind} of degree {degrees[0]} in {names[0]}, {degrees[1]} in {names[1]} "
        f"({terms} term{'s' * (terms != 1)})"
        for (kind, degrees, terms), n in alike.items()
    )
    return f"curves    {curves or 'no curve changes the count'}"


def _covered(cover: Cover) -> str:
    n = len(cover.rectangles)
    return f"cover     {n} rectangle{'s' * (n != 1)} around the curves where counts change"


_Bounds = tuple[str, tuple[Fraction, Fraction]]


def _by_count(bounds: Sequence[_Bounds], result: RegionMap) -> list[_Bounds]:
    """The area of all points with one count: at least that of its cells, and with all that is undetermined at most.

    A certified map may have many small regions; this is also what they leave out.
    """
    first, second = result.slice.axes
    undetermined = result.undetermined * (first.high - first.low) * (second.high - second.low)
    found: list[_Bounds] = []
    for text in sorted({text for text, _ in bounds}):
        low = sum((area[0] for other, area in bounds if other == text), Fraction(0))
        found.append((text, (low, low + undetermined)))
    return found


def _time(result: RegionMap) -> str:
    """How long it took; what a machine does once, in its first run, is told apart."""
    seconds, once = result.timings.get("total"), result.timings.get(COMPILATION, 0.0)
    if seconds is None:
        return "not recorded"
    total = f"{seconds + once:.2f} s" if seconds + once < 10 else f"{seconds + once:.1f} s"
    return f"{total}, of which {once:.0f} s compilation (once)" if once else total


def table(result: RegionMap) -> str:
    """Regions, counts, areas, boundary curves with degrees (or the cover), time and error."""
    count = result.slice.count
    tally = Counter(f"{count_text(r, count)} {_count_name(result, r)}" for r in result.regions)
    counts = "; ".join(f"{text}: {n} region{'s' * (n > 1)}" for text, n in sorted(tally.items()))
    bounds = [(count_text(r, count), r.area) for r in result.regions]
    if result.cover is not None:
        bounds = _by_count(bounds, result)
    areas = "; ".join(f"{text}: {area_text(result, area)}" for text, area in bounds)
    if result.status is Status.EXACT and len(bounds) > 1 and not any(low for _, (low, _) in bounds):
        areas = "not computed"
    widths = [(high - low) / low for _, (low, high) in bounds if low]
    known = widths and len(widths) == len(bounds) and min(widths) >= 0  # a damaged file may say anything
    error = _short(max(widths)) if known else "unknown"
    bound = "no area bounds" if areas == "not computed" else f"area bounds within {error}"
    if result.cover is not None and bounds:
        # relative to a region that is hardly larger than its border a width says nothing
        bound = f"area bounds at most {_short(max(high - low for _, (low, high) in bounds))} apart"
    share = float(100 * result.undetermined)  # nothing is misclassified by either engine, see docs/error.md
    wrong = "nothing undetermined" if share == 0 else f"{share:.2g} % undetermined"
    return "\n".join(
        [
            f"regions   {len(result.regions)} of {len(result.cells)} cells, {result.status.value}",
            f"counts    {counts or 'none yet'}",
            f"areas     {areas or 'none yet'}",
            *(f"stable    {words}" for words in [stability_in_words(result)] if words),
            _curves(result) if result.cover is None else _covered(result.cover),
            *_vanishing(result),
            f"time      {_time(result)}; {wrong}; {bound}",
        ]
    )


def stability_in_words(result: RegionMap) -> str:
    """Of how many solutions are stable where a certified map does not say it of its cells; empty where there is none.

    Where all solutions are counted, no curve is enclosed across which one of them loses its stability.
    """
    model = result.slice.model
    if result.slice.count is not Count.TOTAL or not model.tells_stability or model.has_potential or not result.cells:
        return ""
    if result.cover is None:
        return ""
    found = []
    for cell in result.cells:
        if cell.solutions and all(solution.signs for solution in cell.solutions):
            stable = sum(not solution.signs.strip("+") for solution in cell.solutions)
            found.append(f"{stable} of {len(cell.solutions)}")
    at = f"at the samples {', '.join(sorted(set(found)))}; " if found else ""
    return f"{at}it may change within a region, see --count stable"


def _vanishing(result: RegionMap) -> list[str]:
    """Where a condition for stability is zero all over a cell, as a solution is not stable there."""
    if result.slice.model.has_potential:
        return []
    cells = sum(any("0" in e.signs for e in cell.solutions) for cell in result.cells)
    if not cells:
        return []
    where = f"{cells} cell{'s' * (cells > 1)}"
    return [f"zero      in {where} a condition for stability is 0 at a solution, which counts as unstable"]
