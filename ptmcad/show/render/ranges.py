"""Pictures of ranges: the bar of intervals along a line, the operation range over the other axis, the paths of poses.

Guarantee: labels do not overlap; what colours and lines mean is said in words; each figure's label holds a title and a
description. `ptmcad.show.render.printing.save` writes them.

Not guaranteed: anything that only the picture shows. It is drawn in floating point from the exact answer.
"""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from fractions import Fraction
from math import degrees
from typing import Any

from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle

from ptmcad.answer.counts import Counts, MorseIndex
from ptmcad.answer.intervals import CountIntervals, End, OperationSpan
from ptmcad.answer.paths import Fate, PathPoint, PosePaths
from ptmcad.answer.widths import CertifiedRange, CertifiedWidths, OperationWidths
from ptmcad.answer.words import counted, noun
from ptmcad.mechanism import Mechanism
from ptmcad.question.slice import Axis, Slice
from ptmcad.show.ranges.certified import widest_text
from ptmcad.show.ranges.numbers import end_text, width_text
from ptmcad.show.ranges.table import maximum_text, operation_name, working_text
from ptmcad.show.render.axes import scale_of, symbol
from ptmcad.show.render.colours import fill_of_counts, fill_of_index
from ptmcad.show.render.legend import INK, Entry, draw_legend, height, width
from ptmcad.show.render.printing import settings
from ptmcad.show.render.textwidth import wrapped
from ptmcad.show.units import unit, unit_of_unknown, with_unit
from ptmcad.text.enclosure import Enclosure
from ptmcad.text.numerals import shortest_text

WIDE, LEFT, RIGHT, LINE, MARGIN = 6.2, 0.85, 0.3, 0.22, 0.15
"""In inches: the bar, the space at its sides, the legend, a line of the title, the rim."""
BAR, LABELS, ROOM = 0.62, 0.42, 0.36
SIZE = 8.0
_DIGITS = 7
_COLOURS = ("#0b5394", "#b45f06", "#38761d", "#741b47")
_DASHES: tuple[Any, ...] = ("-", (0, (6, 2)), (0, (2, 2)), (0, (6, 2, 1, 2)))
_COLUMNS = 100
_TITLE = 11.0
_LOST = (Fate.VANISH, Fate.UNSTABLE, Fate.EXCLUDED)


def draw_range(slice: Slice, found: CountIntervals) -> Figure:
    """A bar of the intervals, in the colours of the region maps, with its ends labelled."""
    texts = [end_text(c.at, _DIGITS) for c in found.changes]
    upright = sum(len(t) + 2 for t in texts) * SIZE * 0.64 > WIDE * 72
    space = 0.95 if upright else LABELS
    legend = tuple(_bar_legend(found))
    fixed = ", ".join(f"{symbol(n)} = {_short(v)}" for n, v in found.at.items())
    heading = f"{slice.heading}; {fixed}"
    below = ROOM + 0.35 + space
    tall = max(below + BAR + 0.45, height(legend) + 0.2)
    with settings():
        figure = _beside(heading, width(legend), tall, _words(found))
        axes = _axes(figure, (LEFT, below, WIDE, BAR))
        scale = scale_of(found.along.low, found.along.high)
        for i in found.intervals:
            low, high = _place(i.low, found.along), _place(i.high, found.along)
            fill = fill_of_counts(i.counts)
            axes.add_patch(Rectangle((low, 0), high - low, 1, facecolor=fill.face, hatch=fill.hatch or None,
                                     edgecolor=INK, linewidth=0.6))  # fmt: skip
            if (high - low) * WIDE * 72 > 4 * SIZE:
                axes.text((low + high) / 2, 0.5, str(i.counts.working), ha="center", va="center", fontsize=SIZE + 3,
                          bbox={"facecolor": "white", "edgecolor": "none", "pad": 1.5, "alpha": 0.85})  # fmt: skip
        for span in found.operation:
            ends = [_place(end, found.along) for end in (span.low, span.high)]
            axes.plot(ends, [1.2, 1.2], color=INK, linewidth=1.6, clip_on=False, marker="|", markersize=6)
        axes.set_xlim(0, 1)
        axes.set_ylim(0, 1)
        axes.set_yticks([])
        axes.set_xticks([])
        _labels(figure, axes, [_place(c.at, found.along) for c in found.changes], texts, below, upright)
        ruler = _axes(figure, (LEFT, ROOM + 0.2, WIDE, 0.01))
        ruler.set_xlim(scale.low, scale.high)
        ruler.set_yticks([])
        for side in ("left", "right", "top"):
            ruler.spines[side].set_visible(False)
        ruler.tick_params(labelsize=SIZE + 1)
        ruler.set_xlabel(_axis_name(slice, found.along), fontsize=SIZE + 2, labelpad=1)
        draw_legend(figure, legend, LEFT + WIDE + RIGHT, tall - 0.05)
    return figure


def _bar_legend(found: CountIntervals) -> list[Entry]:
    model = found.model
    entries = [Entry((f"{'stable ' * model.tells_stability}{noun(model)}",), strong=True)]
    seen: list[Counts] = []
    for i in found.intervals:
        if i.counts not in seen:
            seen.append(i.counts)
            head = str(i.total) if i.stable is None else f"{i.stable}   of {counted(model, i.total)}"
            entries.append(Entry((head, *_unstable(i.index)), fill_of_counts(i.counts)))
    for span in found.operation:
        what = operation_name(model, found.working)
        entries.append(Entry((what, f"(bracket), width {width_text(span, _DIGITS)}")))
    if any(c.before == c.after for c in found.changes):
        entries.append(Entry(("a label within one colour:", f"{noun(model)} touch, counts unchanged")))
    return entries


def _unstable(index: MorseIndex | None) -> tuple[str, ...]:
    """The numbers of saddles and maxima in words, as far as there can be any."""
    if index is None:
        return ()
    saddles, maxima = sum(index[1:-1]), index[-1]
    between = [f"{saddles} saddles"] if len(index) > 2 else []
    return (", ".join([*between, f"{maxima} maxim{'um' if maxima == 1 else 'a'}"]),)


def _labels(
    figure: Figure, axes: Any, places: Sequence[float], texts: Sequence[str], below: float, upright: bool
) -> None:
    """Labels under the bar, side by side, each joined to its place by a line."""
    half = (SIZE * 0.75 if upright else max((len(t) for t in texts), default=0) * SIZE * 0.64 / 2 + 4) / (WIDE * 72)
    centers = spread(places, half)
    drop = 0.2 / BAR
    for place, center, text in zip(places, centers, texts, strict=True):
        axes.plot([place, place, center], [0, -0.05 / BAR, -drop], color=INK, linewidth=0.6, clip_on=False)
        figure.text(LEFT + center * WIDE, below - 0.22, text, transform=figure.dpi_scale_trans, ha="center", va="top",
                    fontsize=SIZE, rotation=90 if upright else 0)  # fmt: skip


def spread(places: Sequence[float], half: float) -> list[float]:
    """Centres near the given places in [0, 1], in their order and at least ``2 half`` apart where there is room."""
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


def draw_widths(slice: Slice, found: OperationWidths | CertifiedWidths) -> Figure:
    """The operation ranges at the tabulated values, and their width with its largest value."""
    title = textwrap.wrap(slice.heading, _COLUMNS)[:3]
    maxima = found.maxima if isinstance(found, OperationWidths) else ()
    if isinstance(found, OperationWidths):
        said = [maximum_text(m, found.over.name, _DIGITS) for m in maxima] or [
            f"there is no {operation_name(found.model, found.working)}"
        ]
        lines = [f"widest: {line}" for line in said]
    else:
        lines = [widest_text(found)]
    mark = "; diamond: the widest" if maxima else ""
    texts = [f"above: {_where(found)}; below: how wide that is at the tabulated values{mark}"]
    texts += [part for line in lines for part in textwrap.wrap(line, _COLUMNS)]
    foot = 0.55 + 0.2 * len(texts)
    tall = 2.3 + 1.9 + 0.35 + foot + 0.1
    with settings():
        figure = _figure(title, (LEFT + WIDE + RIGHT, tall), "\n".join(texts))
        upper = _axes(figure, (LEFT, foot + 2.25, WIDE, 2.3))
        lower = _axes(figure, (LEFT, foot, WIDE, 1.9))
        over, along = found.over, found.along
        scale, fibre = scale_of(over.low, over.high), scale_of(along.low, along.high)
        points = []
        for row in found.rows:
            points += [(_scaled(row.value, over), float(i.width)) for i in row.operation]
        _draw_band(upper, found)
        lower.plot([p[0] for p in points], [p[1] for p in points], "o", color=INK, markersize=2.5)
        for m in maxima:
            ends = [_scaled(v, over) for v in (m.at.low, m.at.high)]
            # a maximum at the window's edge would be cut in half
            lower.plot(ends, [float(m.width)] * 2, "-D", color="#b45f06", markersize=6, fillstyle="none", clip_on=False)
        upper.set_ylim(fibre.low, fibre.high)
        upper.set_ylabel(_axis_name(slice, along), fontsize=SIZE + 2)
        range_name = "operation range" if isinstance(found.model, Mechanism) else "range"
        known = unit(slice, slice.axis_names.index(along.name))
        lower.set_ylabel(f"width of the\n{with_unit(range_name, known)}", fontsize=SIZE + 1)
        lower.set_ylim(bottom=0)
        lower.margins(y=0.12)
        for axes in (upper, lower):
            axes.set_xlim(scale.low, scale.high)
            axes.tick_params(labelsize=SIZE)
        upper.tick_params(labelbottom=False)
        lower.set_xlabel(_axis_name(slice, over), fontsize=SIZE + 2, labelpad=2)
        for k, line in enumerate(texts):
            figure.text(LEFT, foot - 0.55 - 0.2 * k, line, transform=figure.dpi_scale_trans, fontsize=SIZE, va="center")
    return figure


def _draw_band(axes: Any, found: OperationWidths | CertifiedWidths) -> None:
    """The operation ranges as bands from row to row, as bars where a range has none in the rows beside it."""
    face = fill_of_index((2, 3, 1)).face
    rows = [(_scaled(row.value, found.over), [_ends_of(i, found.along) for i in row.operation]) for row in found.rows]
    for chain in chains(rows):
        xs, lows, highs = ([float(part[k]) for part in chain] for k in range(3))
        if len(chain) == 1:
            axes.plot(xs * 2, [lows[0], highs[0]], color=face, linewidth=3.0, solid_capstyle="butt")
        else:
            axes.fill_between(xs, lows, highs, facecolor=face, linewidth=0)
        for ends in (lows, highs):
            axes.plot(xs, ends, color=INK, linewidth=1.2, marker="_" if len(chain) == 1 else "", markersize=4)


def _ends_of(interval: OperationSpan | CertifiedRange, along: Axis) -> tuple[float, float]:
    return _scaled_end(interval.low, along), _scaled_end(interval.high, along)


Interval = tuple[float, float]


def chains(rows: Sequence[tuple[float, Sequence[Interval]]]) -> list[list[tuple[float, float, float]]]:
    """Intervals of neighbouring rows that go together, as (place of the row, low, high).

    Those of two rows that have as many go together in their order; else two that meet each other and no other ones.

    >>> chains([(0, [(0, 1), (5, 6)]), (1, [(0, 2)]), (2, [(1, 3)])])
    [[(0, 0, 1), (1, 0, 2), (2, 1, 3)], [(0, 5, 6)]]
    """
    done: list[list[tuple[float, float, float]]] = []
    before: dict[Interval, list[tuple[float, float, float]]] = {}
    last: Sequence[Interval] = ()
    for place, here in rows:
        if len(here) == len(last):
            pairs = dict(zip(here, last, strict=True))
        else:
            meeting = [(b, a) for b in here for a in last if a[0] < b[1] and b[0] < a[1]]
            pairs = {
                b: a for b, a in meeting
                if sum(other[0] == b for other in meeting) == sum(other[1] == a for other in meeting) == 1
            }  # fmt: skip
        now = {}
        for interval in here:
            chain = before[pairs[interval]] if interval in pairs else []
            if not chain:
                done.append(chain)
            chain.append((place, *interval))
            now[interval] = chain
        before, last = now, here
    return done


def _where(found: OperationWidths | CertifiedWidths) -> str:
    """What the operation range is."""
    if isinstance(found, CertifiedWidths):
        return f"where there are at least {working_text(found.model, found.working)}"
    if found.working == 2 and isinstance(found.model, Mechanism):
        return "where two equilibria are stable"
    return f"where there {'is' if found.working == 1 else 'are'} {working_text(found.model, found.working)}"


def draw_paths(slice: Slice, found: PosePaths, further: Sequence[Entry] = ()) -> Figure:
    """The unknowns of each followed pose along the axis, a panel for each; an arrow shows each snap.

    ``further`` are the legend's last entries, of what is going to be added.
    """
    fixed = ", ".join(f"{symbol(n)} = {_short(v)}" for n, v in found.at.items())
    heading = f"{slice.heading}; {fixed}"
    model = found.model
    what = "pose" if isinstance(model, Mechanism) else "solution"
    stable = "stable " * model.tells_stability
    entries = [Entry((f"{stable}{what}s",), strong=True)]
    for k, path in enumerate(found.paths):
        entries.append(
            Entry((f"{what} {path.number} at {symbol(found.along.name)} = {_short(found.start)}",), _line(k))
        )
    if any(e.fate is Fate.SNAP for p in found.paths for e in (p.low, p.high)):
        entries.append(Entry(("a pose vanishes (ring), and the", "mechanism snaps (arrow)"), _snap_mark))
    if any(e.fate is Fate.MERGE for p in found.paths for e in (p.low, p.high)):
        entries.append(Entry(("poses merge into one (square),", "without a snap"), _merge_mark))
    if any(e.fate in _LOST for p in found.paths for e in (p.low, p.high)):
        entries.append(Entry((f"a {what} ends (cross)",), _loss_mark))
    entries += further
    panel, foot = 2.0, 0.55
    names = (*model.angles, *model.reals)
    last = len(names) - 1
    tall = len(names) * panel + 0.25 * last + foot
    spare = max(0.0, height(tuple(entries)) + 0.2 - tall)
    tall += spare
    kind = "Unknowns" if model.reals else "Angles"
    words = f"{kind} of {len(found.paths)} {stable}{what}s along {found.along.name}."
    with settings():
        figure = _beside(heading, width(entries), tall, words)
        scale = scale_of(found.along.low, found.along.high)
        for number, name in enumerate(names):
            axes = _axes(figure, (LEFT, foot + spare + (last - number) * (panel + 0.25), WIDE, panel))
            for k, path in enumerate(found.paths):
                colour, dash = _COLOURS[k % len(_COLOURS)], _DASHES[k % len(_DASHES)]
                xs = [_scaled(p.value, found.along) for p in path.points]
                axes.plot(xs, [_angle(p, number) for p in path.points], color=colour, linestyle=dash, linewidth=1.6)
                for end in (path.low, path.high):
                    if end.fate in (Fate.WINDOW, Fate.UNDECIDED):
                        continue
                    x, y = _scaled(end.last.value, found.along), _angle(end.last, number)
                    marker = {Fate.SNAP: "o", Fate.MERGE: "s"}.get(end.fate, "x")
                    axes.plot([x], [y], marker, color=colour, fillstyle="none", markersize=6)
                    if end.fate is Fate.SNAP and end.target is not None:
                        tip = (_scaled(end.target.value, found.along), _angle(end.target, number))
                        axes.annotate("", tip, (x, y), arrowprops={"arrowstyle": "-|>", "color": colour, "lw": 1.0,
                                                                   "shrinkA": 4, "shrinkB": 1})  # fmt: skip
            axes.axhline(0, color=INK, linewidth=0.4)
            axes.set_xlim(scale.low, scale.high)
            axes.margins(y=0.08)
            axes.tick_params(labelsize=SIZE, labelbottom=number == last)
            axes.set_ylabel(with_unit(symbol(name), unit_of_unknown(slice, name)), fontsize=SIZE + 2)
            if number == last:
                axes.set_xlabel(_axis_name(slice, found.along), fontsize=SIZE + 2, labelpad=2)
        draw_legend(figure, tuple(entries), LEFT + WIDE + RIGHT, tall - 0.05)
    return figure


def _line(number: int) -> Any:
    def mark(figure: Any, left: float, middle: float) -> None:
        colour, dash = _COLOURS[number % len(_COLOURS)], _DASHES[number % len(_DASHES)]
        figure.add_artist(Line2D((left, left + 0.28), (middle, middle), transform=figure.dpi_scale_trans,
                                 color=colour, linestyle=dash, linewidth=1.6))  # fmt: skip

    return mark


def _snap_mark(figure: Any, left: float, middle: float) -> None:
    _marker(figure, left, middle, "o")


def _merge_mark(figure: Any, left: float, middle: float) -> None:
    _marker(figure, left, middle, "s")


def _loss_mark(figure: Any, left: float, middle: float) -> None:
    _marker(figure, left, middle, "x")


def _marker(figure: Any, left: float, middle: float, marker: str) -> None:
    figure.add_artist(Line2D((left + 0.14,), (middle,), transform=figure.dpi_scale_trans, color=INK, marker=marker,
                             fillstyle="none", markersize=6))  # fmt: skip


def _beside(heading: str, key: float, tall: float, words: str) -> Figure:
    """A figure for axes with a legend of this width beside them, under a heading in at most three lines."""
    wide = LEFT + WIDE + RIGHT + key + RIGHT
    return _figure(wrapped(heading, wide - LEFT - MARGIN, _TITLE)[:3], (wide, tall), words)


def _figure(title: Sequence[str], size: tuple[float, float], words: str) -> Figure:
    tall = size[1] + LINE * len(title) + 2 * MARGIN
    figure = Figure(figsize=(size[0], tall), facecolor="white")
    figure.set_label(f"{' '.join(title)}\n{words}")
    for k, line in enumerate(title):
        figure.text(LEFT, tall - MARGIN - LINE * (k + 0.5), line, transform=figure.dpi_scale_trans, fontsize=_TITLE,
                    va="center")  # fmt: skip
    return figure


def _axes(figure: Figure, box: tuple[float, float, float, float]) -> Any:
    wide, tall = figure.get_size_inches()
    return figure.add_axes((box[0] / wide, (box[1] + MARGIN) / tall, box[2] / wide, box[3] / tall))


def _place(end: End, along: Axis) -> float:
    """Where an end lies in the window, from 0 to 1."""
    value = end if isinstance(end, Fraction) else (end.low + end.high) / 2
    return float((value - along.low) / (along.high - along.low))


def _scaled(value: Fraction, axis: Axis) -> float:
    scale = scale_of(axis.low, axis.high)
    return float((value - scale.offset) / Fraction(10) ** scale.exponent)


def _scaled_end(end: End | Enclosure, axis: Axis) -> float:
    return _scaled(end if isinstance(end, Fraction) else (end.low + end.high) / 2, axis)


def _angle(point: PathPoint, number: int) -> float:
    if number < len(point.angles):
        return degrees(float(point.angles[number]))
    return float(point.reals[number - len(point.angles)])


def _axis_name(slice: Slice, axis: Axis) -> str:
    name = scale_of(axis.low, axis.high).name(symbol(axis.name))
    return with_unit(name, unit(slice, slice.axis_names.index(axis.name)))


def _short(value: Fraction) -> str:
    text = shortest_text(value)
    return text if len(text) <= 14 else f"{float(value):.8g}"


def _words(found: CountIntervals) -> str:
    parts = [
        f"{end_text(i.low, _DIGITS)} to {end_text(i.high, _DIGITS)}: "
        + (f"{i.total} in all" if i.stable is None else f"{i.stable} stable of {i.total}")
        for i in found.intervals
    ]
    return f"Intervals of {found.along.name}: {'; '.join(parts)}."
