"""Options that were given and have no effect on what was asked for.

Guarantee: one line on standard error for each such option, and none for an option that was not
typed; the computation goes on as without it.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable

import click
from click.core import ParameterSource

STYLE = (
    "style", "size", "font_size", "font_family", "palette", "title", "legend", "line_width", "thin_lines",
)  # fmt: skip
"""The options that make a picture's style, by their parameters' names."""


Idle = tuple[str, bool, str]
"""An option by its parameter's name, whether it is without effect, and why it would be."""


def report_idle(cases: Iterable[Idle]) -> None:
    """Say which of the options that were typed have no effect here, and why."""
    context = click.get_current_context()
    flags = {p.name: p.opts[0] for p in context.command.params if isinstance(p, click.Option)}
    for parameter, idle, why in cases:
        if idle and context.get_parameter_source(parameter) is ParameterSource.COMMANDLINE:
            click.echo(f"note: {flags[parameter]} has no effect here: {why}", err=True)


def _has_picture(formats: Iterable[str]) -> bool:
    return bool(set(formats) - {"json", "csv", "npz", "table", "obj", "ply"})


def idle_output(files: Collection[str]) -> tuple[Idle, ...]:
    """The options that say where files go and what they are called, where there are none."""
    return tuple((name, not files, "no file is written, see --format") for name in ("out", "name"))


def idle_style(formats: Iterable[str]) -> tuple[Idle, ...]:
    """The options of a picture's style where none of these formats is a picture."""
    return tuple(
        (name, not _has_picture(formats), "no picture is written") for name in (*STYLE, "dpi")
    )


def idle_drawing(formats: Iterable[str]) -> tuple[Idle, ...]:
    """The options of `ptmcad.cli.drawing` that none of these formats heeds."""
    chosen = set(formats)
    return (
        *idle_style(formats),
        ("samples", not _has_picture(formats), "no picture is written"),
        ("pixels", "npz" not in chosen, "only NPZ has a grid, see --format"),
        (
            "boundary_tolerance",
            not chosen & {"csv", "npz"},
            "only CSV and NPZ have boundaries, see --format",
        ),
    )
