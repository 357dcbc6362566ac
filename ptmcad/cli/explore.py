"""``ptmcad explore``: a local page with a slider for each parameter and a map that follows them."""

from __future__ import annotations

import asyncio
import webbrowser
from contextlib import nullcontext
from pathlib import Path
from tempfile import TemporaryDirectory

import click

from ptmcad.cli.commonoptions import limit_options, option, out_option
from ptmcad.cli.slices import slice_options
from ptmcad.extras import require
from ptmcad.process.handover import Topic, send
from ptmcad.question.config import record_from_options
from ptmcad.question.config.typed import Typed


@click.command("explore")
@slice_options
@option("--free", "A third parameter: its slider's maps share one computation.", "NAME=LO:HI")
@option(
    "--slider sliders", "The ends of a parameter's slider. Repeatable.", "NAME=LO:HI", multiple=True
)
@option(
    "--port",
    "Port to listen on.  [default: any that is free]",
    type=click.IntRange(0, 65535),
    default=0,
)
@option("--open opened", "Open the page in the browser.")
@out_option
@limit_options
def command(
    *,
    asked: Typed,
    free: str | None,
    sliders: tuple[str, ...],
    port: int,
    opened: bool,
    out: Path,
) -> None:
    """Explore the slices of CONFIG in the browser: drag a parameter and see the exact map follow.

    Prints an address, which works once and in one browser; the page is served on this machine alone, until Ctrl-C.
    Figures that the page saves go into the folder --out. Needs the extra `explore`: pip install 'ptmcad[explore]'.

    \b
    Examples:
        ptmcad explore equal-loads
        ptmcad explore fig4 --slider k=50:200 --open
        ptmcad explore --slice rho,L2 --set F3=F --set F4=F --free F=-40:0
    """
    require("explore")
    record = record_from_options(asked._replace(free=free))
    from ptmcad.workbench.explore.panel import panel_of

    panel = panel_of(record, sliders)
    from ptmcad.workbench.explore.server import serve

    def announce(address: str) -> None:
        click.echo(f"explore   {address}\n          works once, in one browser; Ctrl-C ends it")
        if opened:
            _open(address, Path(folder))

    send(Topic.RESUMABLE, "")  # a signal is its usual end
    with TemporaryDirectory(prefix="ptmcad-explore-") if opened else nullcontext("") as folder:
        asyncio.run(serve(panel, out, port, announce))


def _open(address: str, folder: Path) -> None:
    """Have the browser open a file of this user alone that leads to the address.

    What a program is started with is seen by every user of the machine, and the address has the
    token.
    """
    path = folder / "explore.html"
    send(Topic.TEMPORARY, str(folder))
    path.touch(0o600, exist_ok=False)
    path.write_text(f'<!DOCTYPE html><meta http-equiv="refresh" content="0; url={address}">')
    if click.launch(path.as_uri()):  # there is no program of the desktop for that
        webbrowser.open(path.as_uri())
