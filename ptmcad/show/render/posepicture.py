"""The picture of all equilibria at one point: each drawn as a mechanism, at one scale, the stable
ones strong.

Guarantee: every equilibrium has a panel, with its kind and its energy, of which every digit shown
is certified; the figure's label holds a title and a description in words.
`ptmcad.show.render.printing.save` writes it.

Not guaranteed: anything that only the picture shows. It is drawn in floating point from the exact
poses.
"""

from __future__ import annotations

import textwrap
from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction

from matplotlib.figure import Figure

from ptmcad.answer.poses import Pose, Poses
from ptmcad.answer.words import assignments, of_what, untold
from ptmcad.errors import ConfigError
from ptmcad.model import Mechanism, Model, Support
from ptmcad.model.joints import torsion_springs
from ptmcad.model.work import LoadsAt, loads_at
from ptmcad.show.drawable import no_drawing
from ptmcad.show.render.axes import symbol, with_symbols
from ptmcad.show.render.colours import INK
from ptmcad.show.render.inches import TITLE_LINE, axes_at, stroke, titled, write, write_lines
from ptmcad.show.render.labels import Position
from ptmcad.show.render.legend import Entry, Mark, Type, draw_legend
from ptmcad.show.render.mechanism import (
    PALE,
    STRONG,
    draw_sketch,
    part_mark,
)
from ptmcad.show.render.posewords import (
    describe,
    heading,
    kind,
    number_text,
    printed_number,
    value_text,
)
from ptmcad.show.render.printing import settings
from ptmcad.show.render.sketch import (
    BAR_WIDTHS,
    MANY_BARS,
    MAX_ARROW,
    MIN_ARROW,
    PanelFrame,
    Sketch,
    arrow_lengths,
    components,
    frame_of,
)
from ptmcad.show.units import energy_unit
from ptmcad.text.enclosure import Enclosure
from ptmcad.text.numerals import magnitude
from ptmcad.text.tree import to_text

MARGIN, GAP, HEAD, BELOW, KEY = 0.2, 0.14, 0.26, 0.36, 2.75
"""In inches: the rim, space between panels, a panel's lines above and two below, the legend."""


def draw_poses(poses: Poses) -> Figure:
    """All equilibria as mechanisms, small multiples at one scale, stable ones first.

    Parameters
    ----------
    poses : of a mechanism; when it has none (infinitely many equilibria), its remark is the
        picture.

    Returns
    -------
    A figure without a canvas of pyplot, to be written by `ptmcad.show.render.printing.save`.

    Raises
    ------
    ConfigError
        For a system that is no mechanism: it has no points to be drawn.
    """
    mechanism = poses.model.whole
    if mechanism is None:
        raise ConfigError(no_drawing(poses.model))
    shown = poses.in_order
    if not shown:
        return empty(poses)
    frame, arrows = frame_of(shown), arrow_lengths(poses)
    columns = 3 if len(shown) in (3, 5) or len(shown) > 5 else min(2, len(shown))
    rows = -(-len(shown) // columns)
    wide, tall = frame.width / 72, frame.height / 72
    row = HEAD + tall + BELOW + 0.16 * (len(_lines_below(poses.model, shown[0])) - 2)
    entries = tuple(legend(poses, arrows))
    below = max(rows * row + (rows - 1) * GAP, Type().height(entries) + _SCALE_ROOM)
    width = 2 * MARGIN + columns * (wide + GAP) + KEY
    title = heading(poses, round(12.4 * (width - 2 * MARGIN)))
    top = below + MARGIN
    with settings():
        size = (width, top + TITLE_LINE * len(title) + 0.08 + MARGIN)
        figure: Figure = titled(title, describe(poses), size, MARGIN, MARGIN)
        for number, pose in enumerate(shown):
            down, across = divmod(number, columns)
            corner = (MARGIN + across * (wide + GAP), top - down * (row + GAP) - HEAD - tall)
            panel(figure, frame.sketch(mechanism, pose, arrows), pose, number + 1, corner)
        left = MARGIN + columns * (wide + GAP) + 0.1
        draw_legend(figure, entries, left, top)
        scale_bar(figure, frame, (left, top - Type().height(entries) - 0.12), poses.units)
    return figure


def _lines_below(model: Model, pose: Pose) -> list[str]:
    """Energy, if there is one, and unknowns: as many of them on a line as there is room for."""
    angles = (f"{number_text(a)}°" for a in pose.degrees)
    unknowns = assignments(model, angles, map(number_text, pose.reals), symbol)
    return [
        *([] if pose.energy is None else [f"U = {number_text(pose.energy)}"]),
        *(", ".join(unknowns[k : k + 2]) for k in range(0, len(unknowns), 2)),
    ]


def panel(figure: Figure, seen: Sketch, pose: Pose, number: int, corner: Position) -> None:
    """One pose in axes at a place in inches, with its kind above and energy and angles below."""
    strong = seen.mechanism.criterion.works(pose.stable)
    draw_pose(figure, seen, corner, f"pose-{number}", strong)
    colour, weight = (INK, "bold") if strong else ("#555555", "normal")
    flat = ", flat" if pose.flat else ""
    above = (corner[0], corner[1] + seen.sides[1] / 72 + 0.12)
    write(figure, above, f"{number}  {kind(pose)}{flat}", 9, fontweight=weight, color=colour)
    lines = _lines_below(seen.mechanism, pose)
    write_lines(figure, (corner[0], corner[1] - 0.11), lines, 8, 0.16, color=colour)


def draw_pose(
    figure: Figure, seen: Sketch, corner: Position, gid: str, strong: bool, framed: bool = True
) -> None:
    """A sketch in axes of which a unit is a point, in strong colours or pale ones, and so its frame."""
    wide, tall = seen.sides
    axes = axes_at(figure, (*corner, wide / 72, tall / 72), gid)
    axes.set(xlim=(0, wide), ylim=(0, tall), xticks=[], yticks=[])
    for spine in axes.spines.values():
        dark = strong and framed
        spine.set(color=INK if dark else "#b5b5b5", linewidth=1.0 if dark else 0.6)
    draw_sketch(axes, seen, STRONG if strong else PALE, f"{gid}-")


def empty(poses: Poses) -> Figure:
    """The picture when there is nothing to draw: it says why."""
    lines = [
        *heading(poses, 80),
        "",
        *textwrap.wrap(poses.remark or "No equilibrium is known here.", 80),
    ]
    with settings():
        size = (7.0, 2 * MARGIN + TITLE_LINE * len(lines))
        figure: Figure = titled(lines, "", size, MARGIN, MARGIN)
        figure.set_label(f"{lines[0]}\n{describe(poses)}")
    return figure


def legend(poses: Poses, arrows: Mapping[str, float]) -> Iterator[Entry]:
    """What lines and colours mean."""
    mechanism = poses.model.whole
    assert mechanism is not None
    yield Entry(("Poses",), strong=True)
    if poses.known_stable is not None:
        yield Entry(("stable: strong colours, dark frame",), part_mark("bar-0"))
        yield Entry(("unstable or degenerate: pale",), part_mark("bar-0", PALE))
    else:
        yield Entry(tuple(textwrap.wrap(untold(mechanism), _KEY_COLUMNS)))
    if any(pose.energy is not None for pose in poses.equilibria):
        left_out = of_what(mechanism, poses.parameters)
        yield Entry(
            (
                f"U: energy, in {energy_unit(mechanism, poses.units)}",
                *textwrap.wrap(left_out, _KEY_COLUMNS),
            )
        )
    yield Entry(())
    yield Entry(("Parts",), strong=True)
    yield from parts_legend(mechanism)
    if arrows:
        loads = list(_load_texts(mechanism, loads_at(mechanism, poses.parameters)))
        shortened = any(abs(length) == MIN_ARROW < MAX_ARROW for length in arrows.values())
        lines = ["loads; arrows in proportion to them" if len(loads) > 1 else "load"]
        lines += ["except that short ones are lengthened"] if shortened else []
        yield Entry((*lines, *textwrap.wrap(",  ".join(loads), _KEY_COLUMNS)), part_mark("load"))
    yield Entry(())


def parts_legend(mechanism: Mechanism) -> Iterator[Entry]:
    """Bars, springs and supports, and where they are."""
    bars = ["".join(map(symbol, ends)) for ends in mechanism.bars]
    if len(bars) > len(BAR_WIDTHS):
        yield from _parts("bar", bars, part_mark("bar-0", width=MANY_BARS))
    else:
        sizes = ("wide", "narrow") if len(bars) > 1 else ("",)
        for number, (bar, size) in enumerate(zip(bars, sizes, strict=False)):
            name = f"{bar} ({size})" if size else bar
            yield from _parts("bar", [name], part_mark(f"bar-{number}", width=BAR_WIDTHS[number]))
    springs = ["".join(map(symbol, ends)) for ends in mechanism.spring_ends]
    aside = "; drawn aside where one lies on a bar or is very short"
    yield from _parts("spring", springs, part_mark("spring"), end=aside)
    torsion = [
        (with_symbols(to_text(spring.angle)), joint) for spring, joint in torsion_springs(mechanism)
    ]
    wound = [f"{angle} at {symbol(joint.point)}" for angle, joint in torsion if joint is not None]
    others = [angle for angle, joint in torsion if joint is None]
    yield from _parts("torsion spring", wound, part_mark("spiral"), " on")
    yield from _parts("torsion spring", others, None, " on", "; not drawn")
    words = {
        Support.PIN: "fixed support",
        Support.SLIDER_X: "slider",
        Support.SLIDER_Y: "vertical slider",
    }
    for support, what in words.items():
        at = [symbol(name) for name, of in mechanism.supports.items() if of is support]
        mark = part_mark("support" if support is Support.PIN else "slider")
        yield from _parts(what, at, mark, ", at")


def _parts(
    what: str, names: Sequence[str], mark: Mark | None, between: str = "", end: str = ""
) -> Iterator[Entry]:
    """Parts of a kind by their names, if there are any."""
    if names:
        listed = ", ".join(name.replace(" ", "\N{NO-BREAK SPACE}") for name in names)
        words = f"{what}{'s' * (len(names) > 1)}{between} {listed}{end}"
        yield Entry(tuple(textwrap.wrap(words, _KEY_COLUMNS)), mark)


def _load_texts(mechanism: Mechanism, acting: LoadsAt) -> Iterator[str]:
    """The components of loads that are not zero: a parameter by its name, with the points where it
    acts at several.

    What was given as a number or an expression is a force across, Fx, or up, Fy, at its point.
    """
    places: dict[tuple[str, str], list[str]] = {}
    known = components(acting)
    for load, _ in acting:
        for axis, name in zip("xy", load.names, strict=True):
            what = (
                symbol(name) if name in mechanism.parameters else f"F{axis} at {symbol(load.point)}"
            )
            if known[name]:
                places.setdefault((what, name), []).append(symbol(load.point))
    for (what, name), points in places.items():
        several = name in mechanism.parameters and len(set(points)) > 1
        at = f" at {', '.join(dict.fromkeys(points))}" if several else ""
        yield f"{what}{at} {value_text(known[name])}".replace(" ", "\N{NO-BREAK SPACE}")


_KEY_COLUMNS = 33
"""Characters of a line of the legend."""
_SCALE_ROOM = 0.3


def scale_bar(figure: Figure, frame: PanelFrame, place: Position, units: Mapping[str, str]) -> None:
    """A bar of known length, at most 60 points long, from a place in inches to the right."""
    left, middle = place
    most = Fraction(60) / frame.scale
    power = Fraction(10) ** magnitude(most)
    step = next(power * k for k in (5, 2, 1) if power * k <= most)
    length = float(step * frame.scale) / 72
    xs = (left, left, left, left + length, left + length, left + length)
    ys = (middle - 0.04, middle + 0.04, middle, middle, middle + 0.04, middle - 0.04)
    stroke(figure, xs, ys, color=INK, linewidth=0.9, gid="scale")
    text = f"length {printed_number(Enclosure(step, step).text(2))}"
    text += f" {units['length']}" if "length" in units else ""
    write(figure, (left + length + 0.1, middle), text, 8, va="center_baseline", color="#444444")
