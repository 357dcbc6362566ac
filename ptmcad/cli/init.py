"""``ptmcad init``: a commented record to start from, which runs as it is."""

from __future__ import annotations

from pathlib import Path

import click

from ptmcad.cli.commonoptions import PATH, option
from ptmcad.cli.completion import mechanisms
from ptmcad.cli.mechanisms import known_starter
from ptmcad.errors import ConfigError, OutputError
from ptmcad.process.output import reason
from ptmcad.question.config.starters import NAMES, starter_text
from ptmcad.question.shipped import shipped_records


@click.command("init")
@click.argument("mechanism", default="pendulum", shell_complete=mechanisms)
@option(
    "--out",
    "The file to write; never one that is there. A missing folder is made.  "
    "[default: standard output]",
    "FILE",
    PATH,
)
def command(*, mechanism: str, out: Path | None) -> None:
    """Write a commented record to start from: of MECHANISM, or of a pendulum, or a shipped record of that name.

    `ptmcad mechanisms` lists what there is. The record runs as it is: `ptmcad classify FILE --out out`.

    \b
    Example:
        ptmcad init platform --out mine.yaml
    """
    record = shipped_records().get(mechanism) if mechanism not in NAMES else None
    text = (
        record.read_text("utf-8") if record else starter_text(known_starter(mechanism, "MECHANISM"))
    )
    if out is None:
        click.echo(text, nl=False)
        return
    text = text.replace("THIS-FILE", out.name)
    try:
        out.parent.mkdir(parents=True, exist_ok=True)
    except (OSError, ValueError) as error:
        raise OutputError(
            f"the folder {out.parent} cannot be made: {reason(error)}; choose another with --out"
        ) from error
    try:
        stream = out.open("x", encoding="utf-8")
    except FileExistsError as error:
        raise ConfigError(
            "is there already: choose another name, or remove it", key="--out", file=str(out)
        ) from error
    except (OSError, ValueError) as error:
        raise OutputError(f"{out} cannot be written: {reason(error)}") from error
    with stream:
        stream.write(text)
    click.echo(f"wrote {out}; next: ptmcad check {out}, then ptmcad classify {out} --out out")
