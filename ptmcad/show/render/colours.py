"""The colour of a count: the same in every picture, distinguishable to the colour-blind and on grey
prints.

Guarantee: two different counts of a torus of two unknowns (where saddles = minima + maxima) never
have the same fill, nor have others of one or two unknowns with up to three maxima. Of three
unknowns few have: hatches would be too dense. Along a row of the palette the lightness falls by at
least six units of CIE L* a step; the hues start from those of Okabe & Ito. Seen with deuteranopia
neighbours of a row are apart by at least 15 units of CIE Lab, and each colour is from what is
undetermined. So are any two of the fills for 0 to 12 solutions in all, by at least 11 units.

Not guaranteed: as many for a caller's own colours, which are taken in turn for the counts of one
map.

Reference: Okabe & Ito, Color universal design, 2008.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from ptmcad.answer.counts import Counts, MorseIndex, counted_by
from ptmcad.answer.regionmap import Region, RegionMap
from ptmcad.question.counts import Count, Shades
from ptmcad.show.style import PictureStyle
from ptmcad.show.table import count_text

STRONG, THIN, INK = 1.3, 0.5, "#111111"
"""Widths in points of walls that separate regions and of others, and the colour of both."""
RIM, CORE, RIM_INK = 0.45, 0.6, "#404040"
"""Widths in points of the line around what is undetermined, and of the least of this that is seen
within.
"""

ONE_MAXIMUM = ("#f7f6f2", "#c7e4f6", "#eda43f", "#ca8d7a", "#45917d", "#8a5e8b", "#385880")
"""Faces for 0, 1, 2, ... stable equilibria; L* = 97, 89, 73, 64, 55, 46, 37."""
TWO_MAXIMA = ("#e8eacd", "#bf78a3", "#38836d", "#5d5db1", "#874120", "#4b3e62", "#253836")
"""Faces for the same with two maxima; L* = 92, 59, 50, 43, 36, 29, 22."""
ODD_TOTALS = (*TWO_MAXIMA[:2], "#0b85be", "#6f720e", "#1252aa", "#22490b", "#4b0f2b")
"""Faces for 1, 3, 5, ... solutions in all, distinct from those for 2, 4, 6, ...; from 5 on L* = 52, 46,
36, 27, 16.
"""
HATCHES = ("////", "....", "xxxx", "oooo", "++++", "****", "\\\\\\\\", "----", "||||")
"""Beyond the palette's end and for no or many maxima; repeated more densely where these do not
suffice.
"""


@dataclass(frozen=True, slots=True)
class Fill:
    """A face colour and a matplotlib hatch, which may be empty."""

    face: str
    hatch: str = ""


UNKNOWN = Fill("#ffffff")
NONE = Fill("#ffffff", "////")
UNDETERMINED = Fill("#c4c4c4")
"""L* = 79, between the palette's steps; the only grey, and one that no colour comes near to without
red and green.
"""
GREYS = ("#ffffff", "#e2e2e2", "#bcbcbc", "#979797", "#757575", "#545454")
"""L* = 100, 90, 76, 62, 49, 36."""
UNDETERMINED_IN_GREY = Fill("#ffffff", "xxxxxxxx")


def fill_of(region: Region, count: Count) -> Fill:
    """The fill of a region, by the count that distinguishes regions; white where that count is not
    known.

    Totals are even on a torus (the Euler sum): 4 and 6 in all are coloured as 1 and 2 stable, which
    mostly go together.
    """
    number = region.number(count)
    if number is None:
        return UNKNOWN
    if isinstance(number, tuple):
        return fill_of_index(number)
    return _of_total(number) if count.kind.shades is Shades.TOTAL else _of(ONE_MAXIMUM, number, 0)


def filler(
    regions: Sequence[Region], count: Count, palette: str | tuple[str, ...]
) -> Callable[[Region], Fill]:
    """The fills of one map's regions in a palette.

    Parameters
    ----------
    palette : ``default``; ``grey`` has greys for numbers of stable equilibria, or of all, and
        hatches; or colours, for the counts of these regions in increasing order, again with hatches
        where they are too few.
    """
    if palette == "default":
        return lambda region: fill_of(region, count)
    values = sorted({counted_by(region, count) for region in regions} - {(-1,)})
    faces = GREYS if palette == "grey" else tuple(palette)
    # greys go by the count itself, so that all grey maps agree, while the palette has enough of
    # them
    few = all(len(value) == 1 and value[0] < len(GREYS) for value in values)
    steps = {
        value: value[0] if palette == "grey" and few else step for step, value in enumerate(values)
    }

    def fill(region: Region) -> Fill:
        step = steps.get(counted_by(region, count))
        return UNKNOWN if step is None else _of(faces, step, 0)

    return fill


def undetermined_fill(palette: str | tuple[str, ...]) -> Fill:
    """What is undetermined: the only grey, or among greys the only dense crosshatch on white."""
    return UNDETERMINED_IN_GREY if palette == "grey" else UNDETERMINED


def fill_of_counts(counts: Counts) -> Fill:
    """The fill for all that is known of the solutions: by index, else by the stable ones, else by
    all.
    """
    if counts.index is not None:
        return fill_of_index(counts.index)
    return _of_total(counts.total) if counts.stable is None else _of(ONE_MAXIMUM, counts.stable, 0)


def _of_total(total: int) -> Fill:
    half, odd = divmod(total, 2)
    return (
        NONE
        if total == 0
        else _of(ODD_TOTALS if odd else ONE_MAXIMUM, half if odd else half - 1, 0)
    )


def fill_of_index(index: MorseIndex) -> Fill:
    """The fill for numbers of critical points by index.

    Of one unknown as of two; of more the fewest saddles that a torus allows (strong Morse
    inequality) are without a hatch, and further saddles and maxima change it. So does what no torus
    has: fewer saddles, or a sum of indices that is not zero.
    """
    minima, maxima = index[0], index[-1]
    turns = (1, 0, 0)[maxima] if maxima < 3 else maxima - 2
    surplus = sum(index[1::2]) - sum(index[::2])
    fewest = minima + len(index) - 2
    if len(index) == 3:
        turns += 2 * _natural(surplus)
    elif len(index) > 3:
        turns += (
            index[1] - fewest
            if index[1] >= fewest and not surplus
            else 2 * (index[1] + 3 * sum(index[2:-1]))
        )
    return _of(ONE_MAXIMUM if maxima <= 1 else TWO_MAXIMA, minima, turns)


def _natural(number: int) -> int:
    """Whole numbers to natural ones: 0, -1, 1, -2, 2 ... to 0, 1, 2, 3, 4 ..."""
    return 2 * number if number >= 0 else -2 * number - 1


def _paired(one: int, other: int) -> int:
    """A number of its own for each pair of natural numbers (Cantor)."""
    return (one + other) * (one + other + 1) // 2 + other


def _of(row: tuple[str, ...], step: int, turns: int) -> Fill:
    # no two pairs (turns, rounds) share a hatch: odd numbers are for counts within the palette
    rounds = step // len(row)
    number = max(2 * turns - 1, 0) if rounds == 0 else 2 * _paired(turns, rounds - 1) + 2
    if number == 0:
        return Fill(row[step % len(row)])
    repeats, kind = divmod(number - 1, len(HATCHES))
    return Fill(row[step % len(row)], HATCHES[kind] * (repeats + 1))


@dataclass(frozen=True, slots=True)
class Paint:
    """Colours and lines; ``thin_walls`` says whether walls that separate nothing are drawn."""

    fill: Callable[[Region], Fill]
    undetermined: Fill
    strong: float = STRONG
    thin: float = THIN
    thin_lines: str = "solid"
    scale: float = 1.0
    thin_walls: bool = True


def paint_of(style: PictureStyle, *results: RegionMap) -> Paint:
    """The same for all maps that are drawn beside each other, which count the same."""
    return Paint(
        filler(
            [region for result in results for region in result.regions],
            results[0].slice.count,
            style.palette,
        ),
        undetermined_fill(style.palette),
        style.strong,
        style.strong * THIN / STRONG,
        style.thin_lines,
        style.line_scale,
    )


def fills_by_count(paint: Paint, *results: RegionMap) -> dict[str, Fill]:
    """What the counts of some maps are filled with, by their texts and in their order."""
    count = results[0].slice.count
    regions = sorted(
        (r for result in results for r in result.regions), key=lambda r: counted_by(r, count)
    )
    return {count_text(region, count): paint.fill(region) for region in regions}
