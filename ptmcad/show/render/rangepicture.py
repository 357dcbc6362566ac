"""Pictures of ranges: the bar of intervals along a line, and the operation range over the other
axis; and what these have in common with pictures of paths and branches: sizes, a heading, axes in
inches and their names.

Guarantee: labels do not overlap; what colours and lines mean is said in words; each figure's label
holds a title and a description. `ptmcad.show.render.printing.save` writes them.

Not guaranteed: anything that only the picture shows. It is drawn in floating point from the exact
answer.
"""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from fractions import Fraction
from itertools import pairwise
from typing import Any

from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from ptmcad.answer.counts import Counts, MorseIndex
from ptmcad.answer.intervals import AnyEnd, CountIntervals, End, Event, lower, upper
from ptmcad.answer.paths import Branches, PosePaths
from ptmcad.answer.widths import OperationWidths
from ptmcad.answer.words import counted, noun, several, sought
from ptmcad.question.slice import Axis, Slice
from ptmcad.show.ranges.endtext import end_text, width_text
from ptmcad.show.ranges.linetable import (
    maximum_text,
    operation_name,
    place_text,
    widest_text,
    working_text,
)
from ptmcad.show.render.axes import heading_of, scale_of, symbol
from ptmcad.show.render.colours import INK, UNKNOWN, fill_of_counts, fill_of_index
from ptmcad.show.render.inches import (
    TITLE_LINE,
    Box,
    axes_at,
    titled,
    wrapped,
    write,
    write_lines,
)
from ptmcad.show.render.legend import Entry, Type, draw_legend
from ptmcad.show.render.printing import settings
from ptmcad.show.style import Size
from ptmcad.show.units import unit, with_unit
from ptmcad.text.enclosure import Enclosure
from ptmcad.text.numerals import Numbers, shortest_text

WIDE, LEFT, RIGHT, MARGIN = 6.2, 0.85, 0.3, 0.15
"""In inches: the axes, the space at their sides, the rim."""
PANEL, GAP, FOOT = 2.0, 0.25, 0.55
"""Of a panel of several, the space between two, and that below the last."""
SIZE = 8.0
TITLE = 11.0
"""In points: text, and a title's."""
LOOKS: dict[str, dict[str, Any]] = {
    "stable": {"color": "#0b5394", "linewidth": 2.0, "linestyle": "-"},
    "saddle": {"color": "#b45f06", "linewidth": 1.2, "linestyle": (0, (5, 2))},
    "unstable": {"color": "#b45f06", "linewidth": 1.2, "linestyle": (0, (5, 2))},
    "maximum": {"color": "#666666", "linewidth": 1.2, "linestyle": (0, (1, 1.5))},
}
"""Lines of solutions, by what these are called: stable ones are solid, and no others are."""
EACH = ("#0b5394", "#2a9d8f", "#741b47", "#7d9be0", "#274e13", "#c27ba0")
"""Of solutions of one kind that are distinguished from each other; no other kind has one of these colours.
"""


def beside(heading: str, key: float, tall: float, words: str) -> Figure:
    """A figure for axes with a legend of this width beside them, under a heading in at most three
    lines.
    """
    wide = LEFT + WIDE + RIGHT + key + RIGHT
    return figure_of(wrapped(heading, wide - LEFT - MARGIN, TITLE)[:3], (wide, tall), words)


def figure_of(title: Sequence[str], size: Size, words: str) -> Figure:
    """A figure under a title of these lines, its size in inches that of what is below it."""
    tall = size[1] + TITLE_LINE * len(title) + 2 * MARGIN
    figure: Figure = titled(title, words, (size[0], tall), LEFT, MARGIN)
    return figure


def heading(slice: Slice, at: Numbers) -> str:
    """Of what is shown along a line of a slice."""
    return f"{heading_of(slice)}; {', '.join(f'{symbol(name)} = {short(value)}' for name, value in at.items())}"


def panelled(
    slice: Slice,
    found: PosePaths | Branches,
    names: Sequence[str],
    entries: Sequence[Entry],
    words: str,
) -> tuple[Figure, list[Any]]:
    """A figure with a legend beside panels one below the other, for what has these names; and the
    panels' axes.
    """
    last = len(names) - 1
    tall = max((last + 1) * PANEL + last * GAP + FOOT, Type().height(entries) + 0.2)
    figure = beside(heading(slice, found.at), Type().width(entries), tall, words)
    panels = []
    for number, name in enumerate(names):
        axes = axes_in(figure, (LEFT, tall - (number + 1) * PANEL - number * GAP, WIDE, PANEL))
        axes.margins(y=0.08)
        axes.tick_params(labelsize=SIZE, labelbottom=number == last)
        axes.set_ylabel(name, fontsize=SIZE + 2)
        known = unit_along(slice, found.along) if number == last else None
        scaled_axis(axes.xaxis, found.along, known, 2)
        panels.append(axes)
    draw_legend(figure, entries, LEFT + WIDE + RIGHT, tall - 0.05)
    return figure, panels


def axes_in(figure: Figure, box: Box) -> Any:
    """Axes in a box, above the rim."""
    return axes_at(figure, (box[0], box[1] + MARGIN, box[2], box[3]))


def scaled(value: Fraction, axis: Axis) -> float:
    """Where a value stands on an axis whose numbers are scaled as `scale_of` says."""
    scale = scale_of(axis.low, axis.high)
    return float((value - scale.offset) / Fraction(10) ** scale.exponent)


def middle_of(end: End | Enclosure) -> Fraction:
    """A number on or near an end."""
    return end if isinstance(end, Fraction) else (end.low + end.high) / 2


def scaled_axis(shown: Any, axis: Axis, unit: str | None, pad: float = 4) -> None:
    """Limits of one of matplotlib's axes and, unless the unit is None, its name with scale and unit."""
    scale = scale_of(axis.low, axis.high)
    shown.axes.set(**{f"{shown.axis_name}lim": (scale.low, scale.high)})
    if unit is not None:
        shown.set_label_text(with_unit(scale.name(symbol(axis.name)), unit), fontsize=SIZE + 2)
        shown.labelpad = pad


def unit_along(slice: Slice, axis: Axis) -> str:
    """The unit of one of a slice's axes."""
    return unit(slice, slice.axis_names.index(axis.name))


def short(value: Fraction) -> str:
    """A fixed value in a heading."""
    text = shortest_text(value)
    return text if len(text) <= 14 else f"{float(value):.8g}"


BAR, LABELS, ROOM = 0.62, 0.42, 0.36
MAX_BAR, SHARE_OF_ROW = 6.0, 0.6
"""Of a row's bar: points at most, and how much of the way to the next row."""
_DIGITS = 7
_COLUMNS = 100


def draw_range(slice: Slice, found: CountIntervals) -> Figure:
    """A bar of the intervals, in the colours of the region maps, with its ends labelled."""
    texts = [place_text(c.at, _DIGITS) for c in found.changes]
    upright = sum(len(t) + 2 for t in texts) * SIZE * 0.64 > WIDE * 72
    space = 0.95 if upright else LABELS
    legend = tuple(_bar_legend(found))
    below = ROOM + 0.35 + space
    tall = max(below + BAR + 0.45, Type().height(legend) + 0.2)
    with settings():
        figure = beside(heading(slice, found.at), Type().width(legend), tall, _words(found))
        axes = axes_in(figure, (LEFT, below, WIDE, BAR))
        for i in found.intervals:
            low, high = (float(found.along.share(x)) for x in (upper(i.low), lower(i.high)))
            fill = UNKNOWN if i.counts is None else fill_of_counts(i.counts)
            axes.add_patch(Rectangle((low, 0), high - low, 1, facecolor=fill.face, hatch=fill.hatch or None,
                                     edgecolor=INK, linewidth=0.6))  # fmt: skip
            if (high - low) * WIDE * 72 > 4 * SIZE:
                number = "?" if i.working is None else str(i.working)
                axes.text((low + high) / 2, 0.5, number, ha="center", va="center", fontsize=SIZE + 3,
                          bbox={"facecolor": "white", "edgecolor": "none", "pad": 1.5, "alpha": 0.85})  # fmt: skip
        for span in found.operation:
            ends = [_place(end, found.along) for end in (span.low, span.high)]
            axes.plot(
                ends, [1.2, 1.2], color=INK, linewidth=1.6, clip_on=False, marker="|", markersize=6
            )
        axes.set(xlim=(0, 1), ylim=(0, 1), xticks=[], yticks=[])
        _labels(
            figure, axes, [_place(c.at, found.along) for c in found.changes], texts, below, upright
        )
        ruler = axes_in(figure, (LEFT, ROOM + 0.2, WIDE, 0.01))
        ruler.set(yticks=[])
        ruler.spines[["left", "right", "top"]].set_visible(False)
        ruler.tick_params(labelsize=SIZE + 1)
        scaled_axis(ruler.xaxis, found.along, unit_along(slice, found.along), 1)
        draw_legend(figure, legend, LEFT + WIDE + RIGHT, tall - 0.05)
    return figure


def _bar_legend(found: CountIntervals) -> list[Entry]:
    model = found.model
    entries = [Entry((sought(model),), strong=True)]
    for counts in dict.fromkeys(i.counts for i in found.intervals):
        if counts is None:
            entries.append(Entry(("counts undecided",), UNKNOWN))
            continue
        total, stable = counts.total, counts.stable
        head = str(total) if stable is None else f"{stable}   of {counted(model, total)}"
        entries.append(Entry((head, *_unstable(counts.index)), fill_of_counts(counts)))
    for span in found.operation:
        what = operation_name(model, found.working)
        entries.append(Entry((what, f"(bracket), width {width_text(span, _DIGITS)}")))
    if not all(c.proved for c in found.changes):
        entries.append(Entry(("a gap:", "not decided whether counts change")))
    if any(c.event is Event.UNCHANGED and c.proved for c in found.changes):
        touching = "" if found.enclosed else f"{noun(model)} touch, "
        entries.append(Entry(("a label within one colour:", f"{touching}counts unchanged")))
    return entries


def _unstable(index: MorseIndex | None) -> tuple[str, ...]:
    """The numbers of saddles and maxima in words, as far as there can be any."""
    if index is None:
        return ()
    saddles, maxima = sum(index[1:-1]), index[-1]
    between = [several(saddles, "saddle")] if len(index) > 2 else []
    return (", ".join([*between, f"{maxima} maxim{'um' if maxima == 1 else 'a'}"]),)


def _labels(
    figure: Figure,
    axes: Any,
    places: Sequence[float],
    texts: Sequence[str],
    below: float,
    upright: bool,
) -> None:
    """Labels under the bar, side by side, each joined to its place by a line."""
    half = (
        SIZE * 0.75 if upright else max((len(t) for t in texts), default=0) * SIZE * 0.64 / 2 + 4
    ) / (WIDE * 72)
    centers = spread(places, half)
    drop = 0.2 / BAR
    for place, center, text in zip(places, centers, texts, strict=True):
        axes.plot(
            [place, place, center], [0, -0.05 / BAR, -drop], color=INK, linewidth=0.6, clip_on=False
        )
        at = (LEFT + center * WIDE, below - 0.22)
        write(figure, at, text, SIZE, ha="center", va="top", rotation=90 if upright else 0)


def spread(places: Sequence[float], half: float) -> list[float]:
    """Centres near the given places in [0, 1], in their order and at least ``2 half`` apart where
    there is room.
    """
    if not places:
        return []
    step = min(2 * half, 1 / len(places))
    centers: list[float] = []
    for place in places:
        centers.append(max(place, centers[-1] + step) if centers else max(place, step / 2))
    over = centers[-1] - (1 - step / 2)
    if over > 0:
        limit = 1 - step / 2
        for k in range(len(centers) - 1, -1, -1):
            centers[k] = min(centers[k], limit)
            limit = centers[k] - step
    return centers


_WIDEST = "#b45f06"


def draw_widths(slice: Slice, found: OperationWidths) -> Figure:
    """The operation ranges at the tabulated values, and their width with its largest value."""
    title = textwrap.wrap(heading_of(slice), _COLUMNS)[:3]
    maxima = found.maxima
    if found.enclosed:
        lines = [widest_text(found)]
    else:
        said = [maximum_text(m, found.over.name, _DIGITS) for m in maxima] or [
            f"there is no {operation_name(found.model, found.working)}"
        ]
        lines = [f"widest: {line}" for line in said]
    mark = "; diamond: the widest, filled where it is attained" if maxima else ""
    texts = [
        f"bars: {_where(found)}, at the tabulated values of {symbol(found.over.name)}",
        "(between the bars nothing is drawn, as it is not tabulated there)",
        f"below: how wide that is at the same values{mark}",
    ]
    texts += [part for line in lines for part in textwrap.wrap(line, _COLUMNS)]
    foot = 0.55 + 0.2 * len(texts)
    tall = 2.3 + 1.9 + 0.35 + foot + 0.1
    with settings():
        figure = figure_of(title, (LEFT + WIDE + RIGHT, tall), "\n".join(texts))
        upper = axes_in(figure, (LEFT, foot + 2.25, WIDE, 2.3))
        lower = axes_in(figure, (LEFT, foot, WIDE, 1.9))
        over, along = found.over, found.along
        _draw_bars(upper, found)
        points = [(scaled(r.value, over), float(i.width)) for r in found.rows for i in r.operation]
        lower.plot([x for x, _ in points], [w for _, w in points], "o", color=INK, markersize=2.5)
        for m in maxima:
            ends = [scaled(v, over) for v in (m.at.low, m.at.high)]
            lower.plot(ends, [float(m.width)] * 2, "-", color=_WIDEST, clip_on=False)
            hollow = {float(v) for v in (*m.exceptions, *m.doubtful)}
            for at in sorted({float(m.at.low), float(m.at.high), *hollow}):
                face = _WIDEST if m.attained and at not in hollow else "white"
                # a maximum at the window's edge would be cut in half
                lower.plot([scaled(Fraction(at), over)], [float(m.width)], "D", color=_WIDEST, markerfacecolor=face,
                           markersize=6, clip_on=False, zorder=3)  # fmt: skip
        known = unit_along(slice, along)
        scaled_axis(upper.yaxis, along, known)
        lower.set_ylabel(
            f"width of the\n{with_unit(found.model.nouns.range, known)}", fontsize=SIZE + 1
        )
        lower.set_ylim(bottom=0)
        lower.margins(y=0.12)
        for axes in (upper, lower):
            scaled_axis(axes.xaxis, over, unit_along(slice, over) if axes is lower else None, 2)
            axes.tick_params(labelsize=SIZE)
        upper.tick_params(labelbottom=False)
        write_lines(figure, (LEFT, foot - 0.55), texts, SIZE, 0.2)
    return figure


def _draw_bars(axes: Any, found: OperationWidths) -> None:
    """A bar for each operation range at its row; nothing between the rows, where nothing is
    computed.
    """
    rows = [scaled(row.value, found.over) for row in found.rows]
    scale = scale_of(found.over.low, found.over.high)
    nearest = min((b - a for a, b in pairwise(sorted(rows))), default=scale.high - scale.low)
    thick = min(MAX_BAR, SHARE_OF_ROW * nearest / (scale.high - scale.low) * WIDE * 72)
    bars: list[tuple[float, float, float]] = []
    for row in found.rows:
        for one in row.operation:
            low, high = (scaled(middle_of(end), found.along) for end in (one.low, one.high))
            bars.append((scaled(row.value, found.over), low, high))
    places, lows, highs = ([bar[k] for bar in bars] for k in range(3))
    axes.vlines(
        places,
        lows,
        highs,
        color=fill_of_index((2, 3, 1)).face,
        linewidth=thick,
        capstyle="butt",
        gid="bars",
    )
    for ends in (lows, highs):
        axes.plot(places, ends, "_", color=INK, markersize=thick, markeredgewidth=1.2, gid="ends")


def _where(found: OperationWidths) -> str:
    """What the operation range is."""
    if found.enclosed:
        return f"where there are at least {working_text(found.model, found.working)}"
    if found.working == found.model.nouns.usual:
        return "where two equilibria are stable"
    return f"where there {'is' if found.working == 1 else 'are'} {working_text(found.model, found.working)}"


def _place(end: AnyEnd, along: Axis) -> float:
    """Where an end lies in the window, from 0 to 1."""
    return float(along.share(middle_of(end)))


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
