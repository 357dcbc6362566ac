"""``ptmcad map``: a continuous quantity of one equilibrium over a slice's window, as pictures and
numbers.
"""

from __future__ import annotations

import re
from fractions import Fraction
from functools import cache, partial
from pathlib import Path
from typing import Any

import click

from ptmcad.answer.boundaries import NONE
from ptmcad.answer.field import Field
from ptmcad.cli.commonoptions import (
    Formats,
    format_option,
    idle_style,
    limit_options,
    option,
    out_option,
    report_deadline,
    report_idle,
)
from ptmcad.cli.completion import poses, quantity_names
from ptmcad.cli.drawing import pixels_for, style_options, writer
from ptmcad.cli.progress import ProgressBar
from ptmcad.cli.slices import question_of, slice_options
from ptmcad.cli.storedresults import made_map, stored_in, stored_map, tolerance_option
from ptmcad.errors import ConfigError, PtmcadError, shown_path
from ptmcad.options import Options
from ptmcad.process.output import check_writable, write_files
from ptmcad.question.config import slice_from_typed
from ptmcad.question.config.typed import Typed
from ptmcad.question.slice import Slice
from ptmcad.show import render
from ptmcad.show.style import LegendPlace, PictureStyle

PICTURES, DATA = ("png", "svg", "pdf"), ("csv", "npz")
FORMATS = (*PICTURES, *DATA)
MAX_DIFFERENCE = 1e-6
"""From exact poses, as a share of the largest value: more is a fault of the continuation, which is
said.
"""


@click.command("map")
@slice_options
@option(
    "--value",
    "energy, stiffness, barrier, force:SPRING, length:SPRING, angle:UNKNOWN, x:POINT, y:POINT, or an "
    "expression in unknowns, parameters and axes.",
    "QUANTITY",
    default="energy",
    shell_complete=quantity_names,
)
@option(
    "--pose",
    "The N-th stable, unstable, saddle, maximum or pose (any), in the order of `ptmcad solve`: stable "
    "ones first, then by energy.",
    "KIND:N",
    default="stable:1",
    shell_complete=poses,
)
@option("--pixels", "Columns and rows.", "NxM", read=pixels_for, default="400x400")
@option(
    "--contours", "About so many contour lines; 0 for none.", type=click.IntRange(0, 50), default=8
)
@option(
    "--checks",
    "Random pixels that are compared with exact poses.",
    type=click.IntRange(0, 100_000),
    default=50,
)
@tolerance_option
@style_options
@out_option
@format_option(FORMATS, default="png")
@limit_options
def command(
    *,
    asked: Typed,
    value: str,
    pose: str,
    pixels: tuple[int, int],
    contours: int,
    checks: int,
    tolerance: Fraction,
    style: PictureStyle,
    dpi: int,
    out: Path,
    formats: Formats,
    timeout: float | None,
) -> None:
    """Colour the window by a quantity of one equilibrium.

    The regions are exact (or certified, with free lengths); within them all equilibria are followed in floating point,
    every pixel has as many as its region's count, and some are compared with exact poses.

    CONFIG may be a result, too, a JSON file of `ptmcad classify`: its map is not made again.

    \b
    Examples:
        ptmcad map --slice L2,rho --value stiffness --pixels 100
        ptmcad map fig4 --value barrier --pose stable:2 --pixels 60
        ptmcad map --slice L2,rho --value length:k1 --format png,csv --pixels 50
    """
    stored = stored_map(asked)
    slice = _counted(asked, value, pose) if stored is None else stored.slice
    nothing_drawn = set(formats) <= set(DATA)
    report_idle([
        *idle_style(formats),
        ("contours", nothing_drawn, "no picture is written"),
        ("thin_lines", not nothing_drawn, "the curves over a quantity are those where the count changes"),
        ("legend", not nothing_drawn and style.legend is LegendPlace.RIGHT, "beside the map is the scale"),
    ])  # fmt: skip
    stem = f"{slice.name}-{_slug(value)}-{_slug(pose)}"
    names = tuple(f"{stem}.{kind}" for kind in formats)
    check_writable(out, names)
    report_deadline(timeout)
    with ProgressBar() as progress:
        from ptmcad.show import data
        from ptmcad.workbench.fields.quantityfield import expect_somewhere, field_of, request_of

        request = request_of(
            slice, value, pose
        )  # what means nothing is refused before anything is computed
        options = Options(areas=False, progress=progress, timeout=timeout)
        result = stored or made_map(slice, options, tolerance)
        expect_somewhere(result, request[1])
        with stored_in(asked.config if stored else None):
            field = field_of(result, request, *pixels, checks=checks, progress=progress)
            _expect_values(field)
            boundaries = cache(result.boundaries)

            def make(kind: str) -> Any:
                if kind in DATA:
                    return data.field_csv(field) if kind == "csv" else data.field_npz(field)
                return render.field_figure(result, field, boundaries(), contours, dpi, style)

            files = zip(names, formats, strict=True)
            how = {"dpi": dpi, "style": style}
            written = write_files(out, {n: writer(n, partial(make, k), **how) for n, k in files})
    click.echo(question_of(slice))
    for path in written:
        click.echo(shown_path(path))
    _report(field)


def _counted(asked: Typed, value: str, pose: str) -> Slice:
    """The slice, counted so that the certified engine finds the solutions that are asked for."""
    slice = slice_from_typed(asked)
    further = value.strip() == "barrier" or not pose.strip().startswith("stable")
    if slice.has_free_lengths and further:
        return slice_from_typed(asked._replace(counting="index"))
    return slice


def _report(field: Field) -> None:
    """Say what was found, and what is not to be trusted."""
    click.echo(_summary(field))
    if field.beyond:
        many = f"{field.beyond} pixels are" if field.beyond > 1 else "1 pixel is"
        click.echo(
            f"warning: {many} left empty, where {field.quantity} or a part of it is beyond doubles: larger than "
            "1.8e308 or nearer to zero than 2.2e-308",
            err=True,
        )
    if field.checked and not field.difference <= MAX_DIFFERENCE:
        raise PtmcadError(
            f"{field.checked} pixels were compared with exact poses, and one differs by {field.difference:.2g} of the "
            "largest value: do not trust this map"
        )


def _slug(text: str) -> str:
    """A text as a part of a file's name."""
    return re.sub(r"[^A-Za-z0-9]+", "-", text).strip("-")[:60] or "value"


def _expect_values(field: Field) -> None:
    """Refuse a field of which nothing is to be seen, unless it has values that are beyond doubles
    or were not found.
    """

    if not field.known.size and not field.beyond and not field.missed:
        raise ConfigError(
            f"no pixel has {field.pose}, or {field.quantity} has no value where it is: there is nothing to show"
            + ("; some pixels are undetermined" if (field.region == NONE).any() else ""),
            key="--pose",
        )


def _summary(field: Field) -> str:
    known = field.known
    if not known.size and field.beyond:
        return f"{field.quantity} of {field.pose} is beyond doubles wherever it has a value"
    if not known.size:
        return f"at no pixel was {field.pose} found"
    unit = f" {field.unit}" if field.unit else ""
    lines = [
        f"{field.quantity} of {field.pose}: {known.min():.6g} to {known.max():.6g}{unit}, {field.shares}"
    ]
    if field.jumps is not None and (jumps := sum(int(jump.sum()) for jump in field.jumps)):
        lines.append(
            f"its branch changes between {jumps} pairs of neighbouring pixels of one region"
        )
    if field.missed:
        lines.append(f"{field.missed} pixels are empty because their equilibria were not found")
    if field.checked:
        lines.append(
            f"{field.checked} random pixels agree with exact poses to {field.difference:.1g} of the largest value"
        )
    return "\n".join(lines)
