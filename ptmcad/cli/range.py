"""``ptmcad range``: intervals of constant count along one axis, the operation range, and where
stable poses snap.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from functools import partial
from pathlib import Path
from typing import Any

import click
from click.core import ParameterSource

from ptmcad.cli.commonoptions import (
    Formats,
    check_output,
    compile_certified,
    format_option,
    gathered,
    limit_options,
    name_option,
    option,
    out_option,
    record_argument,
    report_deadline,
)
from ptmcad.cli.completion import names, pair_of_names, quantity_names
from ptmcad.cli.drawing import report_written, write_answer
from ptmcad.cli.locate import point_option
from ptmcad.cli.progress import ProgressBar
from ptmcad.cli.range_answers import RangeRequest, answer, is_enclosed, request_codec
from ptmcad.cli.slices import LINE, range_option, set_option
from ptmcad.errors import ConfigError
from ptmcad.model import ptm
from ptmcad.question.config import names_in_record, slice_from_options
from ptmcad.question.config.typed import Typed
from ptmcad.question.shipped import FIRST, SECOND
from ptmcad.question.slice import Slice
from ptmcad.text.parsing import number_for

FORMATS = ("json", "png", "svg", "pdf")


REQUEST = ("over", "rows", "start", "pose", "digits", "quantities")
"""The options that say what is asked of the line, by their parameters' names."""


def slice_and_line(
    asked: Typed, along: str, at: Mapping[str, str], over: str | None
) -> tuple[Slice, dict[str, str]]:
    """The slice that holds the line, and the value of its other axis.

    Every name of ``--at`` but that of the other axis fixes a parameter. The other axis is that of
    ``--over``, or the record's when ``--along`` is an axis of it, or else the first one of
    ``--at``.

    Raises
    ------
    ConfigError
        For anything wrong with the record or the options.
    """
    known: Collection[str] = ptm().parameters
    given: tuple[str, ...] = ()  # the axes before the options of the line are looked at
    if asked.config is not None:
        given, known = names_in_record(asked.config)
    if asked.slice is not None:
        given = tuple(name.strip() for name in asked.slice.split(","))
    if over is not None:
        other = over
    elif along in given:
        other = given[1 - given.index(along)]
    else:
        other = next((n for n in (*given, *at) if n in at), "")
    if not other:
        raise ConfigError(
            f"give the values at which {along} varies, as in {SECOND if along == FIRST else FIRST}=3/2",
            key="--at",
        )
    if along == other:
        raise ConfigError(f"{along} varies along the line: it has no fixed value", key="--at")
    if over is None and other not in at:
        raise ConfigError(f"the other axis, {other}, has no value: add {other}=VALUE", key="--at")
    fixed = tuple(f"{name}={value}" for name, value in at.items() if name != other)
    for name in at:
        if name != other and name not in known:
            raise ConfigError(f"'{name}' is neither an axis nor a parameter", key="--at")
    axes = asked.slice if {along, other} == set(given) else f"{along},{other}"
    try:
        slice = slice_from_options(asked.config, axes, (*asked.sets, *fixed), asked.ranges)
    except ConfigError as error:
        if asked.slice is not None or error.key != "--slice":
            raise
        # the axes were named by other options than the one that the message speaks of
        named = {"--along": along, "--over": over, "--at": other}
        wrong = next((key for key, name in named.items() if f"'{name}'" in error.message), "--at")
        raise ConfigError(error.message, key=wrong) from error
    return slice, {other: at[other]} if other in at else {}


def request_of(along: str, at: Mapping[str, str], **asked: Any) -> RangeRequest:
    """What is asked of the line, checked.

    Parameters
    ----------
    at : the value of the slice's other axis.
    asked : the options of `REQUEST`.

    Raises
    ------
    ConfigError
        For an option that needs another one.
    """
    is_over, quantities = asked["over"] is not None, tuple(dict.fromkeys(asked["quantities"]))
    for key, given in (("--path", asked["start"] is not None), ("--quantity", quantities)):
        if given and not at:
            raise ConfigError(
                f"needs the value of the other axis too, as in --at {SECOND}=3/2", key=key
            )
    request = RangeRequest(
        along=along, at=at, **{**asked, "over": is_over, "quantities": quantities}
    )
    source = click.get_current_context().get_parameter_source("rows")
    if not is_over and source is not ParameterSource.DEFAULT:
        raise ConfigError(
            "is for the table over the other axis: give --over NAME too", key="--rows"
        )
    if request.pose is not None and request.start is None:
        raise ConfigError("chooses a pose to follow: give --path VALUE too", key="--pose")
    return request


@click.command("range")
@record_argument()
@option(
    "--along", "The parameter or axis that varies.", "NAME", required=True, shell_complete=names
)
@point_option("What is fixed: the slice's other axis, any parameters.")
@option(
    "--slice",
    "The slice's two axes, where a name is no parameter.",
    "X,Y",
    shell_complete=pair_of_names,
)
@set_option
@range_option
@option("--digits", "Digits of decimals.", type=click.IntRange(1, 1000), default=10)
@out_option
@name_option("NAME-range")
@format_option(FORMATS)
@option(
    "--over",
    "The axis over which to tabulate the operation range's width.",
    "NAME",
    shell_complete=names,
)
@option("--rows", "Rows of that table.", type=click.IntRange(1, 1000), default=41)
@option(
    "--path start", "Follow stable poses from this value until they snap.", "VALUE", read=number_for
)
@option(
    "--pose",
    "Which pose, as ptmcad solve numbers them.  [default: every stable one]",
    "N",
    click.IntRange(min=1),
)
@option(
    "--quantity quantities",
    "Draw all branches, stable and unstable, of a quantity: an unknown, energy, stiffness (the least "
    "eigenvalue), force:SPRING, length:SPRING, angle:UNKNOWN, x:POINT or y:POINT. "
    "Repeatable.",
    "NAME",
    multiple=True,
    shell_complete=quantity_names,
)
@limit_options
@gathered(typed=(LINE, Typed), asked=(REQUEST, dict))
def command(
    *,
    typed: Typed,
    along: str,
    at: dict[str, str] | None,
    asked: dict[str, Any],
    out: Path,
    name: str | None,
    formats: Formats,
    timeout: float | None,
) -> None:
    """Find the intervals of constant count along one axis, and the operation range, where the most equilibria are stable.

    For the paper's mechanism, two are stable there; with free lengths, in an open chain, at least two. If the model does not
    define stability, all solutions are counted.

    Ends are exact algebraic numbers: the JSON has the polynomial and an isolating interval of each. With free lengths
    they are enclosed by interval arithmetic, and what could not be decided is reported. All digits of the
    tables are right. With --over the widest operation range is found and proved (with free lengths it is tabulated);
    with --path stable poses are followed
    until they vanish, and the pose to which the mechanism snaps is reported.

    \b
    Examples:
        ptmcad range --along rho --at L2=3/2
        ptmcad range fig4 --along rho --at L2=3/2 --path 7/10 --format json,svg
        ptmcad range --along rho --over L2 --range L2=0:2 --at F3=-10,F4=-10
        ptmcad range fig4 --along rho --at L2=3/2 --quantity th1 --format png
    """
    slice, fixed = slice_and_line(typed, along, at or {}, asked["over"])
    request = request_of(along, fixed, **asked)
    stem = name or f"{slice.name}-range"
    report_deadline(timeout)
    kinds = [kind for kind in formats if kind != "json"]
    pictures = {f"{stem}{part}.{kind}": part for part in _parts(request) for kind in kinds}
    names = (*pictures, *[f"{stem}.json"] * ("json" in formats))
    check_output(out, names)
    with ProgressBar() as progress:
        if is_enclosed(slice, request):
            compile_certified(timeout, progress)
        progress("intervals ...", 0, 1)
        text, found, makers = answer(slice, request, progress)
    click.echo(text)
    document = partial(_document, slice, request, found)
    write_answer(out, names, lambda name: makers[pictures[name]](), document)
    report_written(out, names)


def _document(slice: Slice, request: RangeRequest, parts: Mapping[str, Any]) -> str:
    """The answer as JSON."""
    from ptmcad.show.document.slicedocument import SLICE
    from ptmcad.show.ranges.rangedocument import document

    asked = {"slice": SLICE.write(slice), "request": request_codec().write(request)}
    return document(slice.name, slice.mechanism, {**parts, **asked})


def _parts(request: RangeRequest) -> list[str]:
    """What is added to the pictures' names."""
    parts = [""] * bool(request.at) + ["-over"] * request.over
    parts += ["-path"] * (request.start is not None)
    return parts + ["-branches"] * bool(request.quantities)
