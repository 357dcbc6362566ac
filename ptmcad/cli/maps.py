"""The map that a command asks something of: a stored one where CONFIG is a result, or else that of
the record.

Guarantee: a stored map is taken as it is; an option that would change its slice is refused by name.
"""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import click

from ptmcad.answer.regionmap import RegionMap
from ptmcad.cli.drawing import share_of
from ptmcad.cli.idle import report_idle
from ptmcad.cli.limits import clock_stopped
from ptmcad.cli.slices import SliceOptions
from ptmcad.cli.stored import is_result, read_result
from ptmcad.errors import ConfigError
from ptmcad.options import Options
from ptmcad.question.slice import Slice

tolerance_option = click.option(
    "--tolerance", callback=share_of, default="1/100", show_default=True, metavar="EPS",
    help="With free lengths: the share of the window that may stay undetermined.",
)  # fmt: skip


def stored_map(asked: SliceOptions) -> RegionMap | None:
    """The map where CONFIG is a result, whose ``--tolerance`` has no effect.

    Raises
    ------
    ConfigError
        When the file is damaged, or an option would change the slice.
    """
    if asked.config is None or not is_result(asked.config):
        return None
    given = {
        "--slice": asked.axes,
        "--set": asked.sets,
        "--range": asked.ranges,
        "--mechanism": asked.mechanism,
    }
    for option, value in given.items():
        if value:
            raise ConfigError(
                "a result has its slice already: give the problem record to change it", key=option
            )
    report_idle([("tolerance", True, "the map is made already")])
    return read_result(asked.config)


def made_map(slice: Slice, options: Options, tolerance: Fraction) -> RegionMap:
    """The map of a slice; compiling the certified engine is no part of the time that it may take.

    Parameters
    ----------
    tolerance : the share of the window that may stay undetermined, with free lengths.
    """
    from ptmcad.ask.classification import prepare, region_map

    report_idle(
        [("tolerance", not slice.has_free_lengths, "the exact engine leaves nothing undetermined")]
    )
    if slice.has_free_lengths:
        options = replace(options, areas=True, tolerance=tolerance)
    with clock_stopped(options.timeout):
        prepare(slice, options)
    return region_map(slice, options)
