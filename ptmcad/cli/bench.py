"""``ptmcad bench``: error against run time of several methods, side by side; and two such studies
compared.
"""

from __future__ import annotations

from pathlib import Path

import click

from ptmcad.cli.commonoptions import PATH, option, out_option, seconds_of
from ptmcad.cli.completion import files
from ptmcad.cli.drawing import report_written
from ptmcad.cli.progress import ProgressBar
from ptmcad.errors import ConfigError
from ptmcad.extras import require
from ptmcad.process.output import check_writable
from ptmcad.question.config import load
from ptmcad.question.shipped import record_file
from ptmcad.question.slice import Slice

METHODS = ("exact", "certified", "companion", "multistart", "qepcad", "singular", "msolve", "gcad")
DEFAULT = "fig4"


@click.command("bench")
@click.argument(
    "configs", nargs=-1, type=PATH, shell_complete=files(".yaml", ".yml"), metavar="[CONFIG]..."
)
@option(
    "--compare",
    "Compare two JSON files of earlier runs; measure nothing.",
    "OLD NEW",
    PATH,
    nargs=2,
)
@out_option
@option(
    "--method methods",
    f"Measure this method only, of {', '.join(METHODS)}; may be repeated.  "
    "[default: all that are installed]",
    "NAME",
    click.Choice(METHODS),
    multiple=True,
)
@option(
    "--rounds",
    "Runs of each job that takes less than 2 seconds; others are run once.",
    type=click.IntRange(1, 1000),
    default=3,
)
@option("--seed", "Of the order of the methods.", type=click.IntRange(0, 2**31), default=1)
@option(
    "--time-limit",
    "Seconds for each method on each slice; what does not fit is left out, and reported.",
    "S",
    float,
    read=seconds_of,
    default=60.0,
)
@option("--quick", "Fewer and coarser settings.")
@option("--page", "Write error-time.md too, a page of all studies in the folder.")
def command(
    *,
    configs: tuple[Path, ...],
    compare: tuple[Path, Path] | None,
    out: Path,
    methods: tuple[str, ...],
    rounds: int,
    seed: int,
    time_limit: float,
    quick: bool,
    page: bool,
) -> int:
    """Error against run time of several methods on the slice of each CONFIG, side by side.

    Without CONFIG: fig4, which is shipped. Methods are the exact engine at several area
    tolerances, the certified engine at falling tolerances, grids of companion matrices and of Newton's method,
    and QEPCAD, Singular, msolve and gcad where they are installed, on the parts that are theirs. Each runs as a process
    of its own; methods take turns. Errors are measured exactly against the exact map.

    Writes NAME.bench.json, .csv, .svg and .png, and NAME.error-time.json for `ptmcad report`, and prints a table. With
    --compare the exit status is 1 when something became slower or worse beyond noise.

    \b
    Examples:
        ptmcad bench fig4 --quick --out out
        ptmcad bench --method exact --method companion --rounds 5
        ptmcad bench --compare docs/benchmarks/fig4.bench.json out/fig4.bench.json
    """
    if compare is not None:
        if configs:
            raise ConfigError("measures nothing, so it takes no CONFIG", key="--compare")
        return _compare(*compare)
    slices = _slices(configs)
    for extra in ("bench", "data"):
        require(extra, key="bench")
    from ptmcad.studies.bench.study import RIVALS, measure
    from ptmcad.studies.bench.studyreport import PAGE, SUFFIXES, save, save_page, terminal
    from ptmcad.verification import verify

    check_writable(
        out, (*(f"{slice.name}.{suffix}" for slice, _ in slices for suffix in SUFFIXES), PAGE)
    )
    for number, (slice, path) in enumerate(slices):
        with ProgressBar() as progress:

            def report(stage: str, shown: ProgressBar = progress) -> None:
                shown(f"{stage} ...", 0, 1)

            study = measure(
                slice, path, lambda m: verify(m).ok, methods=methods or tuple(RIVALS), rounds=rounds, seed=seed,
                time_limit=time_limit, quick=quick, warm_up=number == 0, report=report,
            )  # fmt: skip
            save(study, out)
        click.echo(f"{slice.name}: {slice.heading}\n{terminal(study)}")
        report_written(out, (f"{slice.name}.{suffix}" for suffix in SUFFIXES))
        click.echo()
    if page:
        report_written(out, (save_page(out).name,))
    return 0


def _slices(configs: tuple[Path, ...]) -> list[tuple[Slice, Path]]:
    """The slices of the records, whose names differ, or that of `DEFAULT`."""
    slices = [(load(path), record_file(path)) for path in configs or (Path(DEFAULT),)]
    names = [slice.name for slice, _ in slices]
    if len(set(names)) < len(names):
        raise ConfigError(
            f"two records have the name {next(n for n in names if names.count(n) > 1)}",
            key="CONFIG",
        )
    return slices


def _compare(old: Path, new: Path) -> int:
    require("data", key="bench")
    from ptmcad.studies.bench.stored import BAD, compare, comparison_table, read_study

    changes = compare(read_study(old), read_study(new))
    click.echo(comparison_table(changes))
    return 1 if any(c["verdict"] in BAD for c in changes) else 0
