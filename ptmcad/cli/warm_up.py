"""``ptmcad warm-up``: the certified engine compiled now, so that no later run has to wait for it."""

from __future__ import annotations

import click

from ptmcad.cli.commonoptions import held
from ptmcad.cli.progress import ProgressBar


@click.command("warm-up")
def command() -> None:
    """Compile the certified engine, which the first run on a machine does otherwise.

    What is compiled is kept on disk: beside the program where that may be written, else in the user's cache, or in the
    folder that the variable NUMBA_CACHE_DIR names. A new version of ptmcad, numba or Python compiles anew.

    \b
    Example:
        ptmcad warm-up
    """
    with held(None, None), ProgressBar() as progress:
        from ptmcad.ask.classification import load_certified

        seconds = load_certified(progress)
    if seconds:
        click.echo(f"the certified engine is compiled ({seconds:.1f} s)")
    else:
        click.echo("the certified engine was compiled already")
