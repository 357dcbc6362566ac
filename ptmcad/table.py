"""The five-line table of a region map for the terminal."""

from __future__ import annotations

from collections import Counter
from fractions import Fraction

from ptmcad.regionmap import Region, RegionMap
from ptmcad.slice import Count

_NAMES = {Count.STABLE: "stable", Count.TOTAL: "in all", Count.INDEX: "(minima, saddles, maxima)"}


def count_text(region: Region, count: Count) -> str:
    """The count by which regions are told apart, as text."""
    if count is Count.STABLE:
        return str(region.stable)
    if count is Count.TOTAL:
        return str(region.total)
    return "({}, {}, {})".format(*region.index) if region.index else "?"


def certified_digits(bounds: tuple[Fraction, Fraction], most: int = 10) -> str:
    """A decimal of which all digits hold: both bounds round to it, or to it give or take one in the last digit."""
    low, high = bounds
    middle = (low + high) / 2
    for digits in range(most, 0, -1):
        text = f"{float(middle):.{digits}g}"
        if "e" in text or "." not in text:
            step = Fraction(10) ** (len(str(int(middle))) - digits) if middle >= 1 else Fraction(0)
            if "e" in text:
                mantissa, exponent = text.split("e")
                step = Fraction(10) ** (int(exponent) - (len(mantissa.split(".")[1]) if "." in mantissa else 0))
        else:
            step = Fraction(1, 10 ** len(text.split(".")[1]))
        if high - Fraction(text) <= step and Fraction(text) - low <= step:
            return text
    return f"{float(low):.2g} to {float(high):.2g}"


def table(result: RegionMap) -> str:
    """Regions, counts, areas, boundary curves with degrees, time and error."""
    names = result.slice.axis_names
    count = result.slice.count
    tally = Counter(count_text(r, count) for r in result.regions)
    counts = "; ".join(f"{text} {_NAMES[count]}: {n} region{'s' * (n > 1)}" for text, n in sorted(tally.items()))
    areas = "; ".join(f"{count_text(r, count)}: {certified_digits(r.area)}" for r in result.regions)
    curves = "; ".join(
        f"{c.kind.value}, degree {c.polynomial.degrees[0]} in {names[0]} and {c.polynomial.degrees[1]} in {names[1]}, "
        f"{len(c.polynomial.terms)} terms"
        for c in result.components
        if c.separates
    )
    error = max(((r.area[1] - r.area[0]) / r.area[0] for r in result.regions if r.area[0]), default=Fraction(0))
    seconds = result.timings.get("total")
    time = "not recorded" if seconds is None else f"{seconds:.2f} s"
    undetermined = "0" if result.undetermined == 0 else f"{float(result.undetermined):.2g}"
    return "\n".join(
        [
            f"regions   {len(result.regions)} of {len(result.cells)} cells, {result.status.value}",
            f"counts    {counts}",
            f"areas     {areas}",
            f"curves    {curves or 'none separates counts'}",
            f"time      {time}; undetermined {undetermined}; area bounds within {float(error):.1e}",
        ]
    )
