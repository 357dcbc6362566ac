"""Pictures of ranges: the bar of intervals along a line, and the operation range over the other
axis.

Guarantee: labels do not overlap; what colours and lines mean is said in words; each figure's label
holds a title and a description. `ptmcad.show.render.printing.save` writes them.

Not guaranteed: anything that only the picture shows. It is drawn in floating point from the exact
answer.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from ptmcad.answer.counts import Counts, MorseIndex
from ptmcad.answer.intervals import CountIntervals, Event, lower, upper
from ptmcad.answer.widths import OperationWidths
from ptmcad.answer.words import counted, noun, several, sought
from ptmcad.question.slice import Slice
from ptmcad.show.ranges.endtext import end_text, width_text
from ptmcad.show.ranges.linetable import (
    maximum_text,
    operation_name,
    place_text,
    widest_text,
    working_text,
)
from ptmcad.show.render.axes import heading_of, symbol
from ptmcad.show.render.colours import INK, UNKNOWN, fill_of_counts, fill_of_index
from ptmcad.show.render.legend import Entry
from ptmcad.show.render.panels import (
    SIZE,
    WIDE,
    heading,
    panels,
    scaled,
    scaled_axis,
    unit_along,
)
from ptmcad.show.render.printing import settings
from ptmcad.show.render.view import Floats
from ptmcad.show.units import with_unit

BAR, HEADROOM = 0.9, 1.5
"""Inches of the bar with what is above it, and this height against that of the bar."""
RULER = 0.01
LABELS, UPRIGHT = 0.6, 1.15
"""Inches for labels below the bar, and for labels that are turned."""
LETTER = 0.64
"""Width of a digit, against the size of its type."""
MAX_BAR, SHARE_OF_ROW = 6.0, 0.6
"""Of a row's bar: points at most, and how much of the way to the next row."""
_DIGITS = 7


def draw_range(slice: Slice, found: CountIntervals) -> Figure:
    """A bar of the intervals, in the colours of the region maps, with its ends labelled."""
    along, texts = found.along, [place_text(c.at, _DIGITS) for c in found.changes]
    wide = [(len(text) + 2) * SIZE * LETTER / 72 for text in texts]
    upright = sum(wide) > WIDE
    with settings():
        figure, (bar, ruler) = panels(
            heading(slice, found.at),
            _words(found),
            along,
            unit_along(slice, along),
            (BAR, RULER),
            UPRIGHT if upright else LABELS,
            list(_bar_legend(found)),
        )
        ruler.set(yticks=[])
        ruler.spines[["left", "right", "top"]].set_visible(False)
        ruler.tick_params(labelsize=SIZE + 1)
        bar.set(ylim=(0, HEADROOM))
        bar.set_axis_off()
        left, right = bar.get_xlim()
        inch = (right - left) / WIDE
        for i in found.intervals:
            low, high = scaled(upper(i.low), along), scaled(lower(i.high), along)
            fill = UNKNOWN if i.counts is None else fill_of_counts(i.counts)
            bar.axvspan(low, high, 0, 1 / HEADROOM, facecolor=fill.face, hatch=fill.hatch or None,
                        edgecolor=INK, linewidth=0.6, clip_on=False)  # fmt: skip
            if high - low > 4 * SIZE / 72 * inch:
                number = "?" if i.working is None else str(i.working)
                bar.text((low + high) / 2, 0.5, number, ha="center", va="center", fontsize=SIZE + 3,
                         bbox={"facecolor": "white", "edgecolor": "none", "pad": 1.5, "alpha": 0.85})  # fmt: skip
        for span in found.operation:
            ends = [scaled(end, along) for end in (span.low, span.high)]
            bar.plot(ends, [1.2, 1.2], "|-", color=INK, linewidth=1.6, clip_on=False)
        places = [scaled(c.at, along) for c in found.changes]
        step = (1.5 * SIZE / 72 if upright else max(wide, default=0.0)) * inch
        for place, center, text in zip(
            places, spread(places, step, (left, right)), texts, strict=True
        ):
            bar.annotate(
                text, (place, 0), (center, -0.35), ha="center", va="top", fontsize=SIZE, rotation=90 * upright,
                annotation_clip=False,
                arrowprops={"arrowstyle": "-", "linewidth": 0.6, "relpos": (0.5, 1), "shrinkA": 0, "shrinkB": 0},
            )  # fmt: skip
    return figure


def spread(places: Sequence[float], step: float, ends: tuple[float, float]) -> Floats:
    """Centres near the given places between two ends, in their order and so far apart where there is
    room.
    """
    step = min(step, (ends[1] - ends[0]) / max(1, len(places)))
    before = step * np.arange(len(places))
    pushed = np.maximum.accumulate(np.maximum(places, ends[0] + step / 2) - before)
    centers: Floats = np.minimum(pushed, ends[1] - step * (len(places) - 0.5)) + before
    return centers


def _bar_legend(found: CountIntervals) -> Iterator[Entry]:
    model = found.model
    yield Entry((sought(model),), strong=True)
    for counts in dict.fromkeys(i.counts for i in found.intervals):
        if counts is None:
            yield Entry(("counts undecided",), UNKNOWN)
            continue
        total, stable = counts.total, counts.stable
        head = str(total) if stable is None else f"{stable}   of {counted(model, total)}"
        yield Entry((head, *_unstable(counts.index)), fill_of_counts(counts))
    for span in found.operation:
        what = operation_name(model, found.working)
        yield Entry((what, f"(bracket), width {width_text(span, _DIGITS)}"))
    if not all(c.proved for c in found.changes):
        yield Entry(("a gap:", "not decided whether counts change"))
    if any(c.event is Event.UNCHANGED and c.proved for c in found.changes):
        touching = "" if found.enclosed else f"{noun(model)} touch, "
        yield Entry(("a label within one colour:", f"{touching}counts unchanged"))


def _unstable(index: MorseIndex | None) -> tuple[str, ...]:
    """The numbers of saddles and maxima in words, as far as there can be any."""
    if index is None:
        return ()
    saddles, maxima = sum(index[1:-1]), index[-1]
    between = [several(saddles, "saddle")] if len(index) > 2 else []
    return (", ".join([*between, f"{maxima} maxim{'um' if maxima == 1 else 'a'}"]),)


_WIDEST = "#b45f06"


def draw_widths(slice: Slice, found: OperationWidths) -> Figure:
    """The operation ranges at the tabulated values, and their width with its largest value."""
    over, along, name = found.over, found.along, operation_name(found.model, found.working)
    said = [f"widest: {maximum_text(m, over.name, _DIGITS)}" for m in found.maxima]
    if found.enclosed:
        said = [widest_text(found)]
    mark = "; diamond: the widest, filled where it is attained" if found.maxima else ""
    notes = [
        f"bars: {_where(found)}, at the tabulated values of {symbol(over.name)}",
        "(between the bars nothing is drawn, as it is not tabulated there)",
        f"below: how wide that is at the same values{mark}",
        *(said or [f"widest: there is no {name}"]),
    ]
    with settings():
        figure, (bars, widths) = panels(
            heading_of(slice),
            "\n".join(notes),
            over,
            unit_along(slice, over),
            (2.3, 1.9),
            notes=notes,
        )
        _draw_bars(bars, found)
        scaled_axis(bars.yaxis, along, unit_along(slice, along))
        points = [(scaled(r.value, over), float(i.width)) for r in found.rows for i in r.operation]
        widths.plot(*np.reshape(points, (-1, 2)).T, "o", color=INK, markersize=2.5)
        for m in found.maxima:
            width, look = float(m.width), {"color": _WIDEST, "clip_on": False}
            ends = [scaled(v, over) for v in (m.at.low, m.at.high)]
            hollow = [scaled(v, over) for v in (*m.exceptions, *m.doubtful)]
            widths.plot(ends, [width] * 2, **look)
            for at in {*ends, *hollow}:
                face = _WIDEST if m.attained and at not in hollow else "white"
                widths.plot(at, width, "D", markerfacecolor=face, zorder=3, **look)
        unit = unit_along(slice, along)
        label = f"width of the\n{with_unit(found.model.nouns.range, unit)}"
        widths.set_ylabel(label, fontsize=SIZE + 1)
        widths.set_ylim(bottom=0)
        widths.margins(y=0.12)
    return figure


def _draw_bars(axes: Any, found: OperationWidths) -> None:
    """A bar for each operation range at its row; nothing between the rows, where nothing is
    computed.
    """
    thick = min(MAX_BAR, SHARE_OF_ROW * WIDE * 72 / (len(found.rows) + 1))
    bars = [
        (scaled(row.value, found.over), *(scaled(end, found.along) for end in (one.low, one.high)))
        for row in found.rows
        for one in row.operation
    ]
    places, lows, highs = np.reshape(bars, (-1, 3)).T
    axes.vlines(places, lows, highs, fill_of_index((2, 3, 1)).face, linewidth=thick, gid="bars")
    for ends in (lows, highs):
        axes.plot(places, ends, "_", color=INK, markersize=thick, markeredgewidth=1.2, gid="ends")


def _where(found: OperationWidths) -> str:
    """What the operation range is."""
    if found.enclosed:
        return f"where there are at least {working_text(found.model, found.working)}"
    if found.working == found.model.nouns.usual:
        return "where two equilibria are stable"
    return f"where there {'is' if found.working == 1 else 'are'} {working_text(found.model, found.working)}"


def _number(counts: Counts | None) -> str:
    if counts is None:
        return "undecided"
    if counts.stable is None:
        return f"{counts.total} in all"
    return f"{counts.stable} stable of {counts.total}"


def _words(found: CountIntervals) -> str:
    parts = [
        f"{end_text(i.low, _DIGITS)} to {end_text(i.high, _DIGITS)}: {_number(i.counts)}"
        for i in found.intervals
    ]
    return f"Intervals of {found.along.name}: {'; '.join(parts)}."
