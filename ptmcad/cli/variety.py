"""``ptmcad variety``: the discriminant variety of a slice, as text or for another program."""

from __future__ import annotations

from pathlib import Path

import click

from ptmcad.cli.commonoptions import PATH, limit_options, option
from ptmcad.cli.progress import ProgressBar
from ptmcad.cli.slices import slice_options
from ptmcad.errors import shown_path
from ptmcad.process.output import check_writable, text_writer, write_files
from ptmcad.question.config import portable_file, slice_from_typed
from ptmcad.question.config.typed import Typed
from ptmcad.show.varietytext import FORMATS


@click.command("variety")
@slice_options
@option(
    "--format", "The language to write it in.", type=click.Choice(list(FORMATS)), default="text"
)
@option("--out", "Write to a file, not to the terminal.", "FILE", PATH)
@limit_options
def command(
    *,
    asked: Typed,
    format: str,
    out: Path | None,
) -> None:
    """Compute the curves off which the number of equilibria, or solutions, is locally constant.

    CONFIG is a problem record, by file or name; options override it. Each curve is irreducible and has a kind: critical
    (an equilibrium is singular there), infinity (a complex solution leaves every bounded set) or boundary (the slice's
    equations lose their meaning, or an inequality or condition of a system becomes zero at a solution).

    sympy, maple and mathematica are programs that define the list "variety". qepcad is a session that decomposes the
    window by the curves. msolve is the system from which they follow: "msolve -e 5 -g 2 -f FILE" eliminates its
    first five unknowns (all but the two axes), and the critical curves are the factors of what is left. Some of them
    may be inverses, which leave out solutions that do not count.

    \b
    Examples:
        ptmcad variety --slice L2,rho
        ptmcad variety --slice L2,rho --format maple --out unloaded.mpl
        ptmcad variety --slice rho,L2 --set F3=-10 --set F4=-10 --format qepcad
    """
    slice = slice_from_typed(asked)
    if out is not None:
        portable_file(out.name, "--out")
        check_writable(out.parent, (out.name,))
    with ProgressBar():
        from ptmcad.exact.eliminationsystem import slice_variety

        text = slice_variety(slice).text(format)
    if out is None:
        click.echo(text, nl=False)
    else:
        write_files(out.parent, {out.name: text_writer(text)})
        click.echo(f"written   {shown_path(out)}")
