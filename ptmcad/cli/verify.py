"""``ptmcad verify``: an independent check of a stored result."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING

import click

from ptmcad.answer.family import FamilyMap
from ptmcad.answer.regionmap import RegionMap
from ptmcad.cli.families import each_member, is_family, read_family_file
from ptmcad.cli.idle import Idle, report_idle
from ptmcad.cli.limits import Limits, held, limit_options
from ptmcad.cli.progress import ProgressBar
from ptmcad.cli.stored import is_design, read_design_file, read_result
from ptmcad.cli.values import files
from ptmcad.options import Options
from ptmcad.question.config import member_like

if TYPE_CHECKING:
    from ptmcad.verification.report import VerifyReport


@click.command("verify")
@click.argument("result", type=click.Path(path_type=Path), shell_complete=files(".json"))
@click.option("--seed", type=click.IntRange(min=0), metavar="N",
              help="Seed of the random points and of the random boxes.  [default: a hash of the claims]")  # fmt: skip
@click.option("--boxes", type=click.IntRange(0, 100_000), metavar="N",
              help="Random boxes of the free area of a certified map.  [default: 16]")  # fmt: skip
@click.option("--effort", type=click.IntRange(0, 10), metavar="N",
              help="How much of a certified map's free area is to be proved free of critical curves: 0 nothing, each "
                   "number more four times the work, 10 all of it.  [default: 2]")  # fmt: skip
@limit_options
def command(*, result: Path, seed: int | None, boxes: int | None, effort: int | None, limits: Limits) -> int:
    """Check RESULT, a JSON file of `ptmcad classify` or `design`, without the code that made it.

    Of a family each member is checked, and the changes between them by further members, each classified alone and over
    either axis; of a design (`ptmcad design`) the cover by boxes, and samples of its value and bound. Prints what was
    checked, and how. The exit status is 0 when every check passed, 1 when one failed (the first violated claim is
    printed with a witness), 2 when the file cannot be read, 3 when a limit was reached before that.

    \b
    Example:
        ptmcad classify --slice L2,rho --format json
        ptmcad verify slice-L2-rho.json
    """
    with held(limits):
        if is_design(result):
            report_idle([Idle("boxes", boxes is not None, "the boxes of a design are all checked"),
                         Idle("effort", effort is not None, "the boxes of a design are all checked")])  # fmt: skip
            from ptmcad.verification import verify_design

            with ProgressBar() as progress:
                report = verify_design(read_design_file(result), seed, progress)
            return _report(report)
        if is_family(result):
            family = read_family_file(result, whole=False)
            status = int(max(each_member(family, lambda member: _verified(member, seed, boxes, effort))))
            return max(status, _verified_family(family, seed))
        return _verified(read_result(result, whole=False), seed, boxes, effort)


def _verified_family(family: FamilyMap, seed: int | None) -> int:
    """The exit status for what a family's members have in common, and where their arrangement changes."""
    from ptmcad.ask.classification import region_map
    from ptmcad.verification import VerifyReport, verify_changes, verify_surfaces

    over_the_first = Options(engine="exact", areas=False, without=frozenset(("axis-order",)))

    def map_at(value: Fraction, turned: bool = False) -> RegionMap:
        slice = member_like(family.members[0].slice, family.text, family.free.name, value, turned)
        return region_map(slice, over_the_first)

    def maps_at(value: Fraction) -> tuple[RegionMap, RegionMap]:
        return map_at(value), map_at(value, True)

    checks = [verify_surfaces(family, map_at, seed)]
    if family.changes is not None and all(c.passed is not False for c in checks):
        with ProgressBar() as progress:
            checks += verify_changes(family.changes, maps_at, seed, progress)
    click.echo(f"what the members have in common over {family.free.name}")
    return _report(VerifyReport(tuple(checks)))


def _verified(stored: RegionMap, seed: int | None, boxes: int | None, effort: int | None) -> int:
    """The exit status for a map, after what was checked has been printed."""
    report_idle([Idle(name, stored.cover is None, "an exact map is checked whole") for name in ("boxes", "effort")])
    from ptmcad.verification import verify

    with ProgressBar() as progress:
        report = verify(stored, seed=seed, boxes=boxes, progress=progress, effort=effort)
    return _report(report)


def _report(report: VerifyReport) -> int:
    """The exit status, after the table of a report has been printed."""
    click.echo(report.table())
    if report.ok:
        return 0
    click.echo(f"violated: {report.violation}", err=True)
    return 1
