"""``ptmcad classify``: the region map of a slice, as JSON and pictures."""

from __future__ import annotations

import time
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from typing import Any

import click

from ptmcad.answer.plan import own_steps
from ptmcad.answer.regionmap import with_compilation
from ptmcad.answer.words import several
from ptmcad.cli.commonoptions import (
    Idle,
    clock_stopped,
    file_option,
    gathered,
    idle_drawing,
    limit_options,
    option,
    out_option,
    report_deadline,
    report_idle,
)
from ptmcad.cli.drawing import (
    DATA,
    MESHES,
    PICTURES,
    Output,
    drawing_options,
    names_of,
    report_written,
    write_result,
)
from ptmcad.cli.progress import ProgressBar
from ptmcad.cli.slices import (
    Third,
    engine_option,
    question_asked,
    question_in,
    question_of,
    slice_options,
)
from ptmcad.errors import ConfigError, LimitReached, blamed
from ptmcad.model import ptm
from ptmcad.options import Options, is_certified
from ptmcad.process.handover import Topic, send, watched
from ptmcad.process.output import check_writable, how_to_go_on, save_stopped
from ptmcad.question.config import Family
from ptmcad.question.config.typed import Typed
from ptmcad.question.counts import Count
from ptmcad.question.savings import check_names, switched_off
from ptmcad.question.slice import Slice
from ptmcad.text.numerals import percent
from ptmcad.text.parsing import share_for

FORMATS = ("json", *PICTURES, *DATA, *MESHES)
MIN_SECONDS = 0.01
"""Seconds that are left in any case, so that the result from which to go on is handed on."""


ENGINE = ("engine", "jobs", "tolerance", "area_tolerance", "without", "keep", "no_areas")
"""The options of the computation, by their parameters' names."""


def _wanted(
    *, without: tuple[str, ...], keep: tuple[str, ...], no_areas: bool, **named: Any
) -> Options:
    return Options(**named, without=frozenset((*without, *keep)), areas=not no_areas)


def classify_to_files(slice: Slice, options: Options, output: Output, spent: float = 0.0) -> Any:
    """Classify the slice, write the files asked for, and return the `RegionMap`.

    Guarantee: the folder has been proved writable before the computation starts; files are written
    all or none.

    Parameters
    ----------
    spent : the part of the options' ``timeout``, in seconds, that was needed to read and check the
        map from which to go on.

    Raises
    ------
    LimitReached
        After what there is of the result has been saved, by `save_stopped`.
    PtmcadError
        Any other of its kinds, with nothing written.
    """
    check_writable(output.out, names_of(slice.name, output.formats))

    def handed_over(result: Any) -> None:
        _hand_over(result, slice.name, output)

    with ProgressBar() as progress:
        options = replace(options, progress=progress, partial=handed_over if watched() else None)
        # the time that the import takes is not the computation's
        with clock_stopped(options.timeout, spent):
            from ptmcad.ask.classification import prepare, region_map

            _report_why_none(
                slice, options, output, "the engine was still being loaded or compiled"
            )
            compiling = prepare(slice, options)
        earlier = options.resume
        reason = "the first level of the search was not done"
        if earlier is not None:
            reason = f"no less than {percent(earlier.undetermined)} was undetermined"
        _report_why_none(slice, options, output, reason)
        left = None if options.timeout is None else max(options.timeout - spent, MIN_SECONDS)
        try:
            result = with_compilation(region_map(slice, replace(options, timeout=left)), compiling)
        except LimitReached as stopped:
            if stopped.partial is None or "json" not in output.formats:
                raise
            # first: if this process is ended now, the other one has it
            text = _hand_over(stopped.partial, slice.name, output)
            beside = names_of(slice.name, output.drawn)
            place, why = save_stopped(output.out / f"{slice.name}.json", text, beside=beside)
            where = f"partial map{_open_share(stopped.partial)} saved to {place}{why}"
            further = "" if getattr(stopped.partial, "cover", None) is None else how_to_go_on(place)
            raise LimitReached(f"{stopped}; {where}{further}") from stopped
        _save(result, slice.name, output)
    return result


def _report_why_none(slice: Slice, options: Options, output: Output, reason: str) -> None:
    """Say why there is no map yet to the process that watches, when maps of this engine can be gone
    on from.
    """
    if "json" in output.formats and is_certified(slice, options.engine):
        kept = "; the map to go on from is as it was" if options.resume is not None else ""
        send(Topic.RESUMABLE, "there was no partial map to save yet", f"{reason}{kept}")


def _hand_over(result: Any, name: str, output: Output) -> str:
    """Give the result so far to the process that watches, which saves it if this one has to be
    stopped; its text.
    """
    text = output.text(result)
    if "json" in output.formats:
        state = "partial" if result.status.value == "partial" else "complete"
        place, beside = str(output.out / f"{name}.json"), names_of(name, output.drawn)
        send(Topic.RESULT, state, text, _open_share(result), place, *beside)
    return text


def _open_share(result: Any) -> str:
    """How much of a certified map is undetermined, in brackets."""
    return "" if result.cover is None else f" ({percent(result.undetermined)} undetermined)"


def _save(result: Any, name: str, output: Output) -> None:
    """Write the pictures and tables and, last, the JSON."""
    # first: drawing may take longer than there is time
    file = f"{name}.json" if "json" in output.formats else ""
    text = _hand_over(result, name, output) if file else ""
    write_result(output.out, output.drawing.writers(result, name, output.drawn), file, text)


def explanation(steps: Iterable[Any]) -> str:
    """The slice's own steps of a plan as text, one a line."""
    return "\n".join(map(str, own_steps(steps)))


def announced(slice: Slice, options: Options) -> tuple[Any, ...]:
    """Print what is known of the plan before anything is computed, and return these steps.

    Raises
    ------
    ConfigError
        For a name that no saving of the engine has.
    """
    from ptmcad.exact import exactplan

    certified = is_certified(slice, options.engine)
    off = switched_off(options.without, certified)
    if certified:
        from ptmcad.certified.statement import beforehand

        steps = beforehand(slice, off)
    else:
        steps = exactplan.beforehand(slice, off, options.areas)
    click.echo(
        f"plan of {slice.name}, {'certified' if certified else 'exact'} engine, before it starts:"
    )
    click.echo(explanation(steps))
    if not certified:
        from ptmcad.ask.checking import predictions

        click.echo("\n".join(f"predicted: {text}" for text in predictions(slice)))
    later = () if certified else tuple(name for name in exactplan.LATER if name not in off)
    if later:
        click.echo(f"to be decided on the way: {', '.join(later)}")
    return steps


def warn(slice: Slice, options: Options) -> None:
    """Say at once where the exact engine will take long."""
    if is_certified(slice, options.engine) or slice.has_free_lengths or slice.model == ptm():
        return
    from ptmcad.ask.checking import warning

    if text := warning(slice):
        click.echo(f"note: {text}", err=True)


def _names_of_savings(key: str, names: tuple[str, ...]) -> tuple[str, ...]:
    with blamed(key):
        check_names(names)
    return names


def _one(key: str, given: tuple[str, ...]) -> str | None:
    """An option that is given once, where it is; of more than one the last would count
    without a warning.
    """
    if len(given) > 1:
        raise ConfigError(
            "a family has one free parameter: `ptmcad sweep` goes through several", key=key
        )
    return given[0] if given else None


def _idle(slice: Slice, options: Options) -> tuple[Idle, ...]:
    """The options that the slice's engine does not need."""
    certified = is_certified(slice, options.engine)
    return (
        ("no_areas", certified, "this engine gets areas at no extra cost"),
        ("tolerance", not certified, "the exact engine leaves nothing undetermined"),
        ("jobs", not certified, "the exact engine uses one thread"),
    )


def _resumed(slice: Slice, path: Path) -> Any:
    """The stored map from which to go on."""
    from ptmcad.ask.classification import check_resumable
    from ptmcad.cli.storedresults import read_result

    earlier = read_result(path, whole=False)  # of which its cover alone is taken
    with blamed("--resume", path):
        check_resumable(slice, earlier)
    # what lies outside its cover is taken as decided: a file that contradicts itself must not be
    from ptmcad.verification.certified.certificate import contradiction

    found = contradiction(earlier)
    if found:
        raise ConfigError(f"this map contradicts itself: {found}", key="--resume", file=str(path))
    return earlier


def _going_on(
    slice: Slice, options: Options, output: Output, resume: Path | None
) -> tuple[Options, float]:
    """The options with the map from which to go on, and the seconds that it took to check it: of many
    rectangles that is a while, which is part of the limit.
    """
    if resume is None:
        return options, 0.0
    if "json" in output.formats:
        send(Topic.RESUMABLE, "the map to go on from was still being checked; it is as it was")
    begun = time.monotonic()
    earlier = _resumed(slice, resume)
    return replace(options, resume=earlier), time.monotonic() - begun


def _classify_family(
    family: Family, third: Third, options: Options, output: Output, resume: Path | None
) -> None:
    """Classify and draw the members of a family."""
    # with what stores and draws families, which a slice does without
    from ptmcad.cli.familyfiles import family_to_files, names_of_family

    report_idle((
        ("resume", resume is not None, "the members of a family are classified anew"),
        ("explain", output.explain, "a family has a plan for each of its members: give one with --set"),
        ("surface", third.surface and not output.among((*PICTURES, *MESHES)),
             "no picture and no mesh is written, see --format"),
        *idle_drawing(output.formats),
    ))  # fmt: skip
    result, surface = family_to_files(family, options, output, third)
    click.echo(f"{question_in(family.record, family.name)}\n{result.table()}")
    if surface is not None:
        click.echo(f"boundary surface: {surface.words()}")
    report_written(output.out, names_of_family(family.name, output.formats))
    single = [kind for kind in output.formats if kind not in (*PICTURES, *MESHES)]
    files = sum(len(names_of("", (kind,))) for kind in single) * len(result.values)
    if files:
        more = " and so on" if files > 1 else ""
        click.echo(
            f"          and {several(files, 'file')} of the members, {result.members[0].slice.name}{more}"
        )


@click.command("classify")
@slice_options
@option("--free", "A third parameter: a map for each member of a family.", "NAME=LO:HI",
        read=_one, multiple=True)  # fmt: skip
@option("--members", "Values of the free parameter, how many, or one between each two neighbouring changes.  "
        "[default: the record's, or 9]", "VALUE,..|N|between")  # fmt: skip
@option(
    "--changes",
    "Find the values of the free parameter at which regions appear, split, join, reach a side or vanish.",
)
@option(
    "--surface",
    "Draw NAME-3d as the surface between regions of different counts, with --changes so that it bridges none.",
)
@option("--count", "What distinguishes two regions.", type=click.Choice([c.value for c in Count]))
@engine_option
@out_option
@option("--explain", "Print what is computed, what is left out, and why.")
@option("--without", "For the ablation study.", "NAME",
        read=_names_of_savings, multiple=True, hidden=True)  # fmt: skip
@option("--keep", "The older name of --without.", "NAME",
        read=_names_of_savings, multiple=True, hidden=True)  # fmt: skip
@option("--jobs", "Number of threads of the certified engine.  [default: all processors]", "N",
        click.IntRange(min=1))  # fmt: skip
@limit_options
@option("--tolerance", "Stop when this share of the window is undetermined (certified engine); with --changes, the "
        "width of enclosures as a share of the range.", "EPS", read=share_for)  # fmt: skip
@file_option("--resume", ".json", "RESULT", "Go on from a stored certified map of the same slice.")
@option("--area-tolerance", "Relative width of the areas' bounds (exact engine).", "EPS",
        read=share_for)  # fmt: skip
@option("--no-areas", "Leave the regions' areas out, often half of the work (exact engine).")
@option("--no-timings", "Leave run times out of the JSON, so that it is the same every time.")
@drawing_options(FORMATS, "json,png,svg", "Files to write")
@gathered(options=(ENGINE, _wanted), output=Output, third=Third)
def command(
    *, asked: Typed, third: Third, count: str | None, options: Options, output: Output, timeout: float | None,
    resume: Path | None,
) -> None:  # fmt: skip
    """Map the regions of a slice by their number of equilibria.

    CONFIG is a problem record: a YAML file, or the name of a shipped one (`ptmcad mechanisms` lists them); options
    override it. Writes NAME.json and NAME.png, NAME.svg, and prints a table. Without a record, parameters that are
    neither axes nor --set have their defaults: L1 = L2 = rho = 1, k = 100, no load.

    With a third parameter (--free, or `free:` in the record) there is a map for each of its --members, computed from
    what they have in common: NAME.png shows them side by side, NAME-3d.png one above the other, and NAME.json names the
    files of the members' own maps. --changes says at which values the arrangement of the regions changes: exactly and
    with proof if elimination is feasible, otherwise by enclosures. --surface draws the surface between regions of different
    counts, from exact members between which it is interpolated; --format obj,ply writes it as a mesh.

    Springs with a free length (--set l0=1/5) need the certified engine. It leaves a part of the window undetermined,
    which shrinks with time. Stopped by Ctrl-C or --timeout, it saves the best map so far, from the first level of the
    search on, and says how much of it is undetermined; --resume goes on from there. In its first run on a machine it
    compiles its inner loops, up to a minute that --timeout does not count; `ptmcad warm-up` does so beforehand.

    \b
    Examples:
        ptmcad classify fig4
        ptmcad classify --slice L2,rho
        ptmcad classify --slice rho,L2 --set F3=-10 --set F4=-10 --out loaded
        ptmcad classify --slice rho,F --range F=-10:0 --set F3=F --set F4=F
        ptmcad classify fig4 --set F3=F --set F4=F --free F=-40:0 --members 5
        ptmcad classify fig4 --set F3=F --set F4=2*F --free F=-40:0 --changes
        ptmcad classify equal-loads --surface --format json,png,ply
        ptmcad classify free02 --tolerance 1/50
    """
    slice = question_asked(asked, count, third)
    options = replace(options, timeout=timeout)
    report_deadline(timeout)
    if isinstance(slice, Family):
        _classify_family(slice, third, options, output, resume)
        return
    if meshes := output.among(MESHES):
        raise ConfigError(
            f"{meshes[0]} is for the boundary surface of a family: add --free NAME=LO:HI",
            key="--format",
        )
    report_idle((
        *_idle(slice, options),
        ("changes", third.changes, "no parameter is free: add --free NAME=LO:HI"),
        ("surface", third.surface, "no parameter is free: add --free NAME=LO:HI"),
        *idle_drawing(output.formats),
    ))  # fmt: skip
    options, spent = _going_on(slice, options, output, resume)
    if output.explain:
        click.echo(question_of(slice))
    steps = announced(slice, options) if output.explain else ()
    warn(slice, options)
    result = classify_to_files(slice, options, output, spent)
    further = [step for step in own_steps(result.plan) if step not in steps]
    if output.explain and further:
        click.echo(f"decided on the way:\n{explanation(further)}")
    click.echo(result.table() if output.explain else f"{question_of(slice)}\n{result.table()}")
    report_written(output.out, names_of(slice.name, output.formats))
