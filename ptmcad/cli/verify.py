"""``ptmcad verify``: an independent check of a stored result."""

from __future__ import annotations

import json
import os
import signal
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from fractions import Fraction
from functools import partial
from pathlib import Path
from threading import Timer
from types import FrameType
from typing import TYPE_CHECKING, Any

import click

from ptmcad.answer.design import BestDesign
from ptmcad.answer.family import FamilyMap
from ptmcad.answer.poses import Poses
from ptmcad.answer.regionmap import RegionMap, Status
from ptmcad.answer.sweep import Bounds, Member, Summary
from ptmcad.cli.commonoptions import (
    gathered,
    limit_options,
    option,
    report_deadline,
    report_idle,
    result_argument,
)
from ptmcad.cli.familyfiles import read_family_file
from ptmcad.cli.progress import ProgressBar
from ptmcad.cli.storedresults import MAX_BYTES, is_record, kind_of, read_other, read_result
from ptmcad.errors import ConfigError, LimitReached
from ptmcad.options import Options, Progress
from ptmcad.question.config import member_like
from ptmcad.text.node import opened
from ptmcad.text.numerals import fraction_of, text_of
from ptmcad.version import __version__

if TYPE_CHECKING:
    from ptmcad.verification.report import Check, VerifyReport

Verify = Callable[[Progress], "VerifyReport"]
_READ = (
    "this is no result that can be verified: those are the JSON files of `ptmcad classify`, `solve`, `range` and "
    "`design`, also of a family, and the folder of a sweep"
)
_MORE_DIGITS = 10
"""With so many digits more, enclosures of a line are far narrower than those that are stored."""


HOW = ("seed", "boxes", "effort")
"""The options of `ptmcad.verify`, by their parameters' names."""


@click.command("verify")
@result_argument
@option("--seed", "Seed of the random points and of the random boxes.  [default: a fresh one, printed]",
        "N", click.IntRange(min=0))  # fmt: skip
@option("--boxes", "Random boxes of the free area (outside the cover) of a certified map.  [default: 16]",
        "N", click.IntRange(0, 100_000))  # fmt: skip
@option("--effort", "How much of the free area (outside the cover) of a certified map is to be proved free of critical "
                    "curves: 0 none; each step quadruples the work; 10 all.  [default: 2]",
        "N", click.IntRange(0, 10))  # fmt: skip
@limit_options
@gathered(how=(HOW, dict))
def command(*, result: Path, how: Mapping[str, Any], timeout: float | None) -> int:
    """Check RESULT, a JSON file of `ptmcad classify`, `solve`, `range` or `design`, or the folder of a sweep.

    The claim of a row is proved by the method that the row names, without the engine's code; all other entries are
    computed again and compared. Each member of a family or sweep is checked. The last line is the verdict. The exit
    status is 0 when no check failed, 1 when one did (the first violated claim is printed with a witness), 2 when the
    file cannot be read, 3 when a limit was reached before that; the table then names what was checked so far.

    \b
    Example:
        ptmcad classify --slice L2,rho --format json
        ptmcad verify slice-L2-rho.json
    """
    report_deadline(timeout)
    with _clock(timeout) as over:
        from ptmcad.verification.report import VerifyReport

        checks: list[Check] = []
        for title, check in _reports(result, how):
            if title:
                click.echo(title)
            checks += _shown(check).checks
            if over:
                break
        whole = VerifyReport(tuple(checks))
        if title:
            click.echo(f"in all: {whole.verdict}")
        if over:
            click.echo(f"stopped: the time limit of {timeout:g} s was reached", err=True)
        return 1 if not whole.ok else 3 if over else 0


def _shown(check: Verify) -> VerifyReport:
    """The report, of which each row is printed as soon as it is known: the process may be ended in
    the next check.
    """
    from ptmcad.verification.report import FINISHED, Check, VerifyReport, heading

    rows: list[Check] = []

    def show(row: Check) -> None:
        if not rows:
            ProgressBar.say(heading())
        rows.append(row)
        ProgressBar.say(row.row())

    token = FINISHED.set(show)
    try:
        with ProgressBar() as progress:
            report = check(progress)
    except LimitReached as limit:
        report = VerifyReport((*rows, Check("all others", "", None, f"not reached: {limit}")))
    finally:
        FINISHED.reset(token)
    for row in report.checks[len(rows) :]:
        show(row)
    click.echo(report.verdict)
    if report.violation is not None:
        click.echo(f"violated: {report.violation}", err=True)
    return report


@contextmanager
def _clock(seconds: float | None) -> Iterator[list[int]]:
    """Raise `LimitReached` in what runs inside when the time is over, once; gives a list that is
    empty until then.
    """
    over: list[int] = []
    if seconds is None:
        yield over
        return

    def ring(number: int, _frame: FrameType | None) -> None:
        over.append(number)
        raise LimitReached(f"the time limit of {seconds:g} s was reached")

    # an alarm would be taken for one from outside, which ends the program
    timer = Timer(seconds, os.kill, (os.getpid(), signal.SIGVTALRM))
    timer.daemon = True
    before = signal.signal(signal.SIGVTALRM, ring)
    timer.start()
    try:
        yield over
    finally:
        timer.cancel()
        signal.signal(signal.SIGVTALRM, before)


def _reports(path: Path, how: Mapping[str, Any]) -> Iterator[tuple[str, Verify]]:
    """What there is to check in a file, each with a heading where there are several."""
    if path.is_dir():
        yield "", partial(_verified_sweep, path, how)
        return
    kind = kind_of(path)
    if kind in _WHOLE:
        report_idle([(name, True, "all that is stored is checked") for name in ("boxes", "effort")])
        yield "", partial(_WHOLE[kind], path, how["seed"])
    elif kind == "family":
        family = read_family_file(path, whole=False)
        for value, member in family:
            yield f"{family.free.name} = {text_of(value)}", _of_map(member, how)
        common = f"what the members have in common over {family.free.name}"
        yield common, partial(_verified_family, family, how["seed"])
    else:
        yield "", _of_map(_map_in(path, kind), how)


def _of_map(stored: RegionMap, how: Mapping[str, Any]) -> Verify:
    from ptmcad.verification import verify

    exact = stored.cover is None
    report_idle([(name, exact, "an exact map is checked whole") for name in ("boxes", "effort")])
    return lambda progress: verify(stored, progress=progress, **how)


def _map_in(path: Path, kind: str) -> RegionMap:
    """The map in a file that is no other document; of JSON that is none, it is said what is read."""
    try:
        return read_result(path, whole=False)
    except ConfigError as error:
        is_document = path.suffix.lower() == ".json" and not kind.startswith("region-map")
        if is_document and not is_record(path):
            raise ConfigError(_READ, file=str(path)) from error
        raise


def _meet(one: Bounds | None, other: Bounds | None) -> bool:
    """Whether bounds of a width may be of the same one."""
    if one is None or other is None:
        return one == other
    lows, highs = (map(Fraction, ends) for ends in zip(one, other, strict=True))
    return max(lows) <= min(highs)


def _verified_sweep(folder: Path, how: Mapping[str, Any], progress: Progress) -> VerifyReport:
    """Each member's map, and what the index holds of it."""
    from ptmcad.answer.widths import Attainment
    from ptmcad.verification import VerifyReport, verify
    from ptmcad.verification.report import CheckProgress, Unchecked, Violation, checked
    from ptmcad.workbench.sweeps.index import member_map, members, read_sweep
    from ptmcad.workbench.sweeps.member import Wanted, summary_of

    sweep = read_sweep(folder)
    found = list(members(sweep))
    widths = (m.summary and m.summary.widest for m in found)
    along = next((widest.along for widest in widths if widest), "")

    def check(member: Member) -> str:
        summary = member.summary
        if summary is None:
            return Unchecked(f"it is {member.state.value}: {member.error}")
        stored = member_map(sweep, member)
        for name, text in member.parameters.items():
            own = stored.slice.parameters.get(name)
            if own is not None and not (own.is_constant and own.constant() == fraction_of(text)):
                raise Violation(f"the map is not that of {name} = {text}")
        unknown = ", ".join(member.parameters.keys() - stored.slice.parameters.keys())
        if member.same_as is not None:
            first = found[member.same_as]
            if (first.file, first.summary) != (member.file, summary):
                raise Violation(f"it has not what member {member.same_as} has, as is said")
            return f"as member {member.same_as}"
        areas = any(area.area != ("", "") for area in summary.areas)
        true = summary_of(stored, Wanted(areas=areas, along=along))
        widest, doubt = summary.widest, ""
        if widest is not None and widest.proof == Attainment.UNDECIDED.value:
            doubt = "; where a width is attained"
            if true.widest is not None and _meet(widest.width, true.widest.width):
                # an earlier version found it, with bounds of its own
                true = replace(true, widest=widest)
        wrong = [p for p in Summary.__match_args__ if getattr(true, p) != getattr(summary, p)]
        if wrong:
            raise Violation(f"the index has another value than its map: {', '.join(wrong)}")
        report = verify(stored, **how)
        if report.violation is not None:
            raise Violation(report.violation)
        doubt += f"; which value {unknown} has" * bool(unknown)
        return Unchecked(f"{report.verdict}{doubt}") if doubt else report.verdict

    def numbers(_claims: object) -> str:
        if [member.number for member in found] != list(range(min(len(found), len(sweep)))):
            raise Violation("the members are not those of the sweep, numbered in their order")
        if len(found) < len(sweep):
            return Unchecked(f"{len(found)} of {len(sweep)} members have been entered")
        return f"{len(found)} members"

    steps = [("index", "comparison", numbers)]
    steps += [
        (f"member {m.number}", "its map, and the index", partial(lambda m, _: check(m), m))
        for m in found
    ]
    return VerifyReport(tuple(checked(None, steps, (), CheckProgress(progress))))


def _and(report: VerifyReport, check: Check) -> VerifyReport:
    return replace(report, checks=(*report.checks, check))


def _versions_in(path: Path) -> Any:
    """Of what wrote a document that can be read; None where it does not say."""
    return json.loads(path.read_text(encoding="utf-8")).get("versions")


def _verified_design(path: Path, seed: int | None, progress: Progress) -> VerifyReport:
    """The best design, and where ranges are longest by exact critical values."""
    from ptmcad.question.config.designkey import design_from
    from ptmcad.show.document.designdocument import extremes_codec
    from ptmcad.verification import check_anew, verify_design
    from ptmcad.workbench.designs.designbounds import exact_maximum

    found = read_other(path, BestDesign.from_json, "ptmcad-design/1")
    report = verify_design(found, seed, progress)
    if not report.ok or not found.maxima:
        return report
    data = json.loads(found.to_json())
    axes = {axis["name"]: [axis["low"], axis["high"]] for axis in (data["along"], *data["over"])}
    question = data["model"] if isinstance(data["model"], dict) else {"mechanism": data["model"]}
    question |= {"parameters": data["parameters"], "axes": axes}
    over = {axis.name: axes[axis.name] for axis in found.over}
    asked = design_from(question, maximise="range", along=data["along"]["name"], over=over,
                        where={"stable": found.working})  # fmt: skip
    anew = extremes_codec(found.over[0].name).write(exact_maximum(asked) or ())
    stored = {"extremes": data["extremes"], "versions": _versions_in(path)}
    compared = check_anew(stored, {"extremes": anew, "versions": data["versions"]})
    return _and(report, replace(compared, name="all of the extremes"))


def _verified_poses(path: Path, _seed: int | None, progress: Progress) -> VerifyReport:
    """The poses at a point, and all that is said of each."""
    from ptmcad.ask.solving import FEW, poses_at
    from ptmcad.verification import check_anew, verify_poses
    from ptmcad.verification.poseclaims import RIGHTLY, in_same_order

    stored = read_other(path, Poses.from_json, "ptmcad-poses/1")
    report = verify_poses(stored, progress)
    if not report.ok:
        return report
    anew = replace(poses_at(stored.model, stored.parameters, stored.digits), units=stored.units)
    versions, rightly, left = _versions_in(path), RIGHTLY, 0
    if versions != json.loads(anew.to_json())["versions"]:
        # an open answer may be decided now, and with many unknowns another engine may answer
        is_open = Status.UNDECIDED in (stored.status, anew.status)
        if is_open or len(stored.model.unknowns) > FEW:
            rightly |= {"status"}
        stored, anew, left = in_same_order(stored, anew)
    written = json.loads(stored.to_json()) | {"versions": versions}
    compared = check_anew(written, json.loads(anew.to_json()), rightly=rightly)
    if left and compared.passed:
        compared = replace(compared, passed=None, detail=f"all but {left} poses")
    return _and(report, compared)


def _verified_range(path: Path, seed: int | None, progress: Progress) -> VerifyReport:
    """The counts along a line, and all that is said of it."""
    from ptmcad.ask.classification import load_certified
    from ptmcad.cli.range_answers import answer, is_enclosed, request_codec
    from ptmcad.show.document.designdocument import maximum
    from ptmcad.show.document.slicedocument import SLICE
    from ptmcad.show.ranges.rangedocument import bands_codec, document, enclosed_codec
    from ptmcad.text.node import Node
    from ptmcad.verification import Check, VerifyReport, check_anew, verify_range

    form = "ptmcad-range/1"
    found = read_other(path, lambda text: opened(text, form, MAX_BYTES, "ptmcad range"), form)
    data = {"format": form, **found.value}
    if "slice" not in data or "request" not in data:
        return VerifyReport(
            (Check("range", "", None, "an earlier version made it: of what is not said"),)
        )
    try:
        slice = SLICE.read(Node(data["slice"], "slice"))
        request = request_codec().read(Node(data["request"], "request"))
        over = Node(data.get("over", {"maxima": []}), "over")
        maxima = over.entry("maxima").each(
            lambda node: maximum(over.value["over"]["name"], request.digits).read(node)
        )
        for key, codec in (("enclosed", enclosed_codec), ("bands", bands_codec)):
            if key in data:
                codec(request.digits).read(Node(data[key], key))
        report = verify_range(data, slice, progress, maxima, seed)
    except (ValueError, KeyError, TypeError, AttributeError, IndexError) as error:
        raise ConfigError(f"is damaged or not a {form} file: {error}", file=str(path)) from error
    if not report.ok or "critical" in data:  # which an earlier version answered
        return report
    if is_enclosed(slice, request):
        load_certified(progress)

    def anew(digits: int) -> Any:
        _, parts, _ = answer(slice, replace(request, digits=digits), progress)
        asked = {"slice": data["slice"], "request": data["request"]}
        return json.loads(document(slice.name, slice.mechanism, {**parts, **asked}))

    finer = partial(anew, request.digits + _MORE_DIGITS)
    return _and(report, check_anew(data, anew(request.digits), finer))


_WHOLE = {"design": _verified_design, "poses": _verified_poses, "range": _verified_range}
"""By kinds of documents: what checks all of one."""


def _verified_family(family: FamilyMap, seed: int | None, progress: Progress) -> VerifyReport:
    """What a family's members have in common, and where their arrangement changes."""
    from ptmcad.ask.changes import changes_of
    from ptmcad.ask.classification import region_map
    from ptmcad.ask.members import in_common, restored
    from ptmcad.show.document.familydocument import changes_codec
    from ptmcad.verification import VerifyReport, check_anew, verify_changes, verify_surfaces

    over_the_first = Options(engine="exact", areas=False, without=frozenset(("axis-order",)))

    def map_at(value: Fraction, turned: bool = False) -> RegionMap:
        slice = member_like(family.members[0].slice, family.text, family.free.name, value, turned)
        return region_map(slice, over_the_first)

    def maps_at(value: Fraction) -> tuple[RegionMap, RegionMap]:
        return map_at(value), map_at(value, True)

    checks = [verify_surfaces(family, map_at, seed)]
    found, options = family.changes, Options(progress=progress)
    if found is not None and all(c.passed is not False for c in checks):
        checks += verify_changes(found, maps_at, seed, progress)
    common = in_common(restored(family), options)
    stored = {"versions": family.members[0].versions.get("ptmcad"), "surfaces": family.surfaces}
    anew = {"versions": __version__, "surfaces": common.surfaces}
    if found is not None and all(c.passed is not False for c in checks):
        codec = changes_codec(family.free)
        stored |= codec.write(found)
        anew |= codec.write(changes_of(common, found.tolerance, options))
    checks.append(check_anew(stored, anew))
    return VerifyReport(tuple(checks))
