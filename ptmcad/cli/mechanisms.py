"""``ptmcad mechanisms``: the built-in mechanisms and the systems to start from, with parameters and
a drawing.
"""

from __future__ import annotations

from functools import partial
from pathlib import Path

import click

from ptmcad.cli.commonoptions import PATH, option
from ptmcad.cli.completion import mechanisms as known_mechanisms
from ptmcad.cli.drawing import writer
from ptmcad.errors import ConfigError, quoted
from ptmcad.model import Model
from ptmcad.process.output import check_writable, write_files
from ptmcad.question.config.modelkeys import model_of
from ptmcad.question.config.starters import NAMES, starter_text
from ptmcad.question.shipped import shipped_records
from ptmcad.show import render
from ptmcad.text.entry import plain_data
from ptmcad.text.syntax import did_you_mean
from ptmcad.text.yamltree import read_file, read_text


def starter_model(name: str) -> Model:
    """The model of a starter."""
    return model_of(read_text(starter_text(name)))


def known_starter(name: str, option: str) -> str:
    """A name that a starter has.

    Raises
    ------
    ConfigError
        When none has it.
    """
    if name not in NAMES:
        hint = did_you_mean(name, NAMES, "; there are ")
        raise ConfigError(f"{quoted(name)} is no built-in mechanism{hint}", key=option)
    return name


def description(model: Model) -> str:
    """Unknowns, parameters and, of a mechanism, a drawing."""
    unknowns = ", ".join(f"{name} ({kind.value})" for name, kind in model.unknowns.items())
    lines = [model.name, f"  unknowns    {unknowns}"]
    for n, (name, parameter) in enumerate(model.parameters.items()):
        default = f" = {parameter.default}" if parameter.default else ""
        window = (
            f", usually from {parameter.window[0]} to {parameter.window[1]}"
            if parameter.window
            else ""
        )
        lines.append(
            f"  {'' if n else 'parameters':<12}{name}{default}, {parameter.kind.noun}{window}"
        )
    if (mechanism := model.drawable) is not None:
        from ptmcad.model.joints import joints_of
        from ptmcad.show.linedrawing import approximate_text

        lines += ["", *(f"      {line}" for line in approximate_text(mechanism).splitlines())]
        wound = ", @ those with torsion springs" if any(joints_of(mechanism)) else ""
        lines += ["", f"      # bars, . springs, o points{wound}; the pose is not an equilibrium"]
    return "\n".join(lines)


@click.command("mechanisms")
@click.argument("names", nargs=-1, shell_complete=known_mechanisms)
@option("--out", "Folder for drawings, NAME.svg for each mechanism.", type=PATH)
def command(*, names: tuple[str, ...], out: Path | None) -> None:
    """List the built-in mechanisms, with parameters and a drawing, and the shipped records; or the
    mechanisms of NAMES.

    A record names one (mechanism: pendulum); `ptmcad init` writes a record of one to change.
    """
    models = [starter_model(known_starter(name, "NAMES")) for name in names or NAMES]
    click.echo("\n\n".join(description(model) for model in models))
    if not names:
        click.echo(
            "\nrecords that are shipped, and found by name wherever one is (ptmcad classify fig4):"
        )
        for name, path in shipped_records().items():
            click.echo(f"  {name:<26}{plain_data(read_file(path)).get('title', '')}".rstrip())
    if out is not None:
        mechanisms = filter(None, (model.drawable for model in models))
        drawn = {
            (name := f"{m.name}.svg"): writer(name, partial(render.draw_mechanism, m))
            for m in mechanisms
        }
        check_writable(out, tuple(drawn))
        write_files(out, drawn)
