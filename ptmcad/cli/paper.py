"""``ptmcad paper``: the whole paper of Wenger and Chablat computed anew, with a verdict on every
claim.
"""

from __future__ import annotations

from pathlib import Path

import click

from ptmcad.cli.commonoptions import (
    PATH,
    limit_options,
    option,
    report_deadline,
)
from ptmcad.cli.progress import ProgressBar
from ptmcad.errors import shown_path
from ptmcad.process.output import check_writable


@click.command("paper")
@option("--out", "Folder for the files.", type=PATH, default=Path("paper"))
@limit_options
def command(*, out: Path, timeout: float | None) -> int:
    """Reproduce the paper: equations, figures 2 to 5, and every claim confirmed, corrected or refuted.

    Writes index.html, claims.html, claims.md, claims.json, equations.md, equations.tex, and for every figure the region
    map and the poses at its point (PNG, SVG) and the result (JSON). Prints what is not as printed. The exit status is 1
    when a claim stayed undecided.

    \b
    Example:
        ptmcad paper --out paper
    """
    check_writable(out)  # before the libraries are loaded, which takes a second
    from ptmcad.studies.paper.claim import Verdict
    from ptmcad.studies.paper.pages import reproduce, table

    report_deadline(timeout)  # anew: the time that the import took is not the computation's
    with ProgressBar() as progress:
        claims, seconds = reproduce(out, progress)
    click.echo(table(claims, seconds))
    click.echo(f"written to {shown_path(out)}: begin with {shown_path(out / 'index.html')}")
    return int(any(claim.verdict is Verdict.UNDECIDED for claim in claims))
