"""From a slice to its region map by one of two engines: the exact one by algebra, the certified one
by intervals.

Guarantee: bad options are refused before anything is computed. No engine gives a wrong count: the
exact one leaves nothing open, the certified one says what it leaves open.

Only the engine that is used is loaded.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterable
from dataclasses import replace
from fractions import Fraction
from importlib import import_module
from time import perf_counter
from typing import TYPE_CHECKING

from ptmcad.answer.regionmap import RegionMap, Status, with_compilation
from ptmcad.errors import ConfigError, LimitReached, expect, quoted
from ptmcad.model import ptm
from ptmcad.model.description import looped
from ptmcad.options import Options, Progress, is_certified
from ptmcad.process.memory import loading
from ptmcad.question.config import slice_from
from ptmcad.question.counts import Count
from ptmcad.question.savings import load_all, switched_off
from ptmcad.question.shipped import RecordSource
from ptmcad.question.slice import Slice, count_fault, without_free_lengths
from ptmcad.text.parsing import share_for

if TYPE_CHECKING:
    from ptmcad.exact.discriminant_variety import Known


def classify(
    slice: Slice | RecordSource,
    engine: str = "auto",
    count: Count | str | None = None,
    timeout: float | None = None,
    tolerance: Fraction | float | str | None = None,
    area_tolerance: Fraction | float | str | None = None,
    jobs: int | None = None,
    progress: Progress | None = None,
    without: Iterable[str] = (),
    partial: Callable[[RegionMap], None] | None = None,
    resume: RegionMap | None = None,
    areas: bool = True,
    *,
    keep: Iterable[str] | None = None,
) -> RegionMap:
    """The region map of a slice.

    Parameters
    ----------
    slice : a slice, the file of a record or the name of a shipped one, or a mapping like a record.
    engine : ``"exact"``, ``"certified"``, or ``"auto"``: certified where springs have a free
        length, else exact.
    count : which count distinguishes regions; the slice's own when None.
    timeout : seconds after which `LimitReached` is raised; loading the certified engine, and
        compiling it in the first run on a machine, is no part of them.
    tolerance : the certified engine stops when at most this share of the window's area is
        undetermined; the exact engine leaves none.
    area_tolerance : largest relative width of each region's area bounds, 1e-4 when None; for the
        exact engine.
    jobs : number of threads of the certified engine, all processors when None; the exact engine
        uses one.
    progress : called as progress(stage, done, total).
    partial : called with the map after each stage that improves it.
    resume : a certified map of the same slice and count, stopped or not, from which to go on. Its
        cover is taken as it stands: what `ptmcad.verify` says of the result rests on it.
    areas : False leaves the regions' areas out: of each is then known that it is at most the
        window's. The certified engine gets them at no extra cost, and gives them in any case.

    Raises
    ------
    ConfigError
        For an unknown engine or count, a tolerance out of range, an option that the engine does not
        have, a slice that the engine does not take, or a map to go on from that is not of this
        slice.
    HypothesisError
        When the slice is degenerate, has infinitely many equilibria, or leaves the domain of the
        geometry.
    LimitReached
        After ``timeout`` seconds, with what there is of the map as ``partial``.
    """
    expect(engine, str, "engine", "the name of an engine")
    options = Options(
        engine=engine,
        timeout=timeout,
        tolerance=None if tolerance is None else share_for("tolerance", tolerance),
        area_tolerance=None
        if area_tolerance is None
        else share_for("area_tolerance", area_tolerance),
        jobs=jobs,
        progress=progress,
        without=_names(without, keep),
        partial=partial,
        resume=resume,
        areas=areas,
    )
    return region_map(_counted(slice_from(slice), count), options)


def _counted(slice: Slice, count: Count | str | None) -> Slice:
    """The slice with another count, where one is given."""
    try:
        return slice if count is None else replace(slice, count=Count(count))
    except ValueError as error:
        expect(count, str, "count", "the name of a count")
        known = ", ".join(member.value for member in Count)
        raise ConfigError(f"{quoted(count)} is none of {known}", key="count") from error


def _names(without: Iterable[str], keep: Iterable[str] | None) -> frozenset[str]:
    """The savings to do without, which may be given under the option's older name."""
    if keep is not None:
        if without:
            raise ConfigError("this is the older name of without: give one of them", key="keep")
        warnings.warn("keep has a new name: without", DeprecationWarning, stacklevel=3)
        without = keep
    return frozenset((without,) if isinstance(without, str) else without)


def region_map(slice: Slice, options: Options, known: Known | None = None) -> RegionMap:
    """The region map of a slice as `classify` gives it.

    Parameters
    ----------
    options : whose ``deadline`` is set here, from ``timeout``, once the engine is loaded.
    known : what the exact engine knows of the equations from a family that the slice is of.

    Raises
    ------
    ConfigError, HypothesisError, LimitReached
        As `classify` does.
    """
    check_count(slice)
    certified = is_certified(slice, options.engine)
    if not options.areas and options.area_tolerance is not None:
        raise ConfigError(
            "areas are not asked for, but a tolerance for them is given: leave one out", key="areas"
        )
    options = replace(options, without=switched_off(options.without, certified))
    if certified:
        _check_certified(slice, options)
        check_taken(slice)
        compiling = prepare(slice, options)
    started = perf_counter()
    options = replace(
        options, deadline=None if options.timeout is None else started + options.timeout
    )
    if certified:
        result = _certified(slice, options)
        timed = replace(result, timings={**result.timings, "total": perf_counter() - started})
        return with_compilation(timed, compiling)
    try:
        without_free_lengths(slice.model, slice.parameters, "an exact map is")
    except ConfigError as error:
        raise ConfigError(f"{error.message}: choose certified or auto", key="engine") from error
    if options.resume is not None:
        raise ConfigError("only the certified engine can go on from an earlier map", key="resume")
    if "imports" in options.without:
        load_all()
    from ptmcad.exact.exactmap import exact_map

    return exact_map(slice, options, known)


def prepare(slice: Slice, options: Options) -> float:
    """Load what an engine needs, and compile it where this machine has not done so: no part of any
    time limit.

    Returns
    -------
    The seconds that compiling took.

    Raises
    ------
    ConfigError
        Where the certified engine is wanted and numba is missing, or the memory limit leaves it no
        room.
    """
    if is_certified(slice, options.engine):
        if "imports" in options.without:
            with loading("all that there is"):
                load_all()
        return load_certified(options.progress)
    return 0.0


def load_certified(progress: Progress | None = None) -> float:
    """Load the certified engine, and compile it where this machine has not done so; the seconds
    that this took.

    Raises
    ------
    ConfigError
        Where numba is missing, or the memory limit leaves no room.
    """
    with loading("the certified engine"):
        import_module("ptmcad.formulas.compilation")  # first: where numba is missing, it says so
        from ptmcad.certified.loading import load
    return load(progress)


def _check_certified(slice: Slice, options: Options) -> None:
    if options.area_tolerance is not None:
        raise ConfigError(
            "the certified engine bounds areas by what it leaves undetermined: give tolerance instead",
            key="area_tolerance",
        )
    if options.resume is not None:
        check_resumable(slice, options.resume)


def check_taken(slice: Slice) -> None:
    """Refuse what the certified engine does not take, before it is loaded, let alone compiled.

    Raises
    ------
    ConfigError, DegenerateSliceError
        As the engine does.
    """
    if slice.model != ptm():
        from ptmcad.certified.plain.problem import problem_of

        problem_of(slice)


def _certified(slice: Slice, options: Options) -> RegionMap:
    from ptmcad.certified.engine import certified_map

    earlier, partial = options.resume, options.partial

    def improved(found: RegionMap) -> None:
        """What is handed on is never less than the map from which the computation went on."""
        if partial is not None and (earlier is None or found.undetermined < earlier.undetermined):
            partial(found)

    try:
        return certified_map(slice, replace(options, partial=None if partial is None else improved))
    except LimitReached as stop:
        found = stop.partial
        if flat := flat_loops(slice):
            stop = LimitReached(f"{stop}; {flat}", found)
        if earlier is None or (
            isinstance(found, RegionMap) and found.undetermined < earlier.undetermined
        ):
            raise stop
        kept_map = replace(earlier, status=Status.PARTIAL)
        raise LimitReached(
            f"{stop}; the map to go on from has no more, and is kept", partial=kept_map
        ) from stop


def flat_loops(slice: Slice) -> str:
    """What to say of loops that leave parts of a certified map undecided; empty where nothing is
    known of any.
    """
    mechanism = looped(slice.model)
    if mechanism is None:
        return ""
    from ptmcad.model.fourbars import may_be_flat

    return may_be_flat(mechanism, slice.parameters)


def check_flat_loops(slice: Slice) -> None:
    """Refuse loops that can fold flat at all points of the window, before anything that takes long.

    Raises
    ------
    DegenerateSliceError
    """
    if looped(slice.model) is not None:
        from ptmcad.certified.plain.problem import check_loops

        check_loops(slice)


def check_resumable(slice: Slice, earlier: RegionMap) -> None:
    """Refuse to go on from a map that is not certified, or is of another slice or count.

    Raises
    ------
    ConfigError
        That says what differs.
    """
    if earlier.cover is None:
        raise ConfigError(
            "this is no certified map: only one that the certified engine made can be gone on from",
            key="resume",
        )
    other = earlier.slice
    parts = {"mechanism": "model", "axes": "axes", "count": "count"}
    different = [
        name for name, part in parts.items() if getattr(other, part) != getattr(slice, part)
    ]
    different += [
        n
        for n in dict.fromkeys((*slice.parameters, *other.parameters))
        if slice.parameters.get(n) != other.parameters.get(n)
    ]
    if different:
        raise ConfigError(
            f"this map is of another slice: {', '.join(different)} {'differs' if len(different) == 1 else 'differ'}",
            key="resume",
        )


def check_count(slice: Slice) -> None:
    """Refuse a count that makes no sense for the model.

    Raises
    ------
    ConfigError
    """
    if problem := count_fault(slice.count, slice.model, slice.parameters):
        raise ConfigError(problem, key="count")
