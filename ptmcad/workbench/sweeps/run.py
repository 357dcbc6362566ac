"""A sweep from its record to its folder: what is to be computed is planned, computed in any order,
and recorded; small drawings of its maps, made from the stored results; and what it will cost.

Guarantee: when `sweep` returns, each member is done, refused, or has failed as often as it was to
be tried. Stopped in any way it leaves a folder with which the same call goes on, computing no
member again that is done. The index is the same whatever the order, the processes and the
interruptions, seconds and attempts aside. The cost is an estimate from the time that some members
take, and no bound; nothing is said of sweeps whose members take long.
"""

from __future__ import annotations

import dataclasses
import hashlib
import json
import os
from collections import Counter, deque
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from itertools import chain
from pathlib import Path
from random import Random
from time import monotonic
from typing import TYPE_CHECKING, Any

from ptmcad.answer.sweep import State, Sweep
from ptmcad.ask.classification import prepare
from ptmcad.errors import ConfigError, LimitReached, OutputError, PtmcadError
from ptmcad.extras import require
from ptmcad.options import Progress
from ptmcad.question.config.sweeps import Sweeping, sweep_from
from ptmcad.question.shipped import RecordSource
from ptmcad.question.slice import Slice
from ptmcad.text.numerals import text_of
from ptmcad.text.parsing import share_for
from ptmcad.version import __version__
from ptmcad.workbench.sweeps.index import Index, opened, read_sweep
from ptmcad.workbench.sweeps.member import Outcome, Wanted, computing, reason
from ptmcad.workbench.sweeps.pool import Cluster, Pool, answers_of

if TYPE_CHECKING:
    from ptmcad.ask.checking import CheckedSlice
    from ptmcad.show.report.atlas import Thumbnail

RETRIES = 2
"""How often a member is tried again that has failed."""
_SHARES = ("tolerance", "area_tolerance")
_AT_ONCE = 100
"""Members that are planned in one step."""


def sweep(
    config: RecordSource | Sweeping,
    folder: str | Path | None = None,
    jobs: int | None = None,
    scheduler: str | None = None,
    wanted: Wanted | Mapping[str, Any] | None = None,
    retries: int = RETRIES,
    timeout: float | None = None,
    progress: Progress | None = None,
) -> Sweep:
    """Classify every member of a record's ``sweep``, into a folder.

    Called again with the same record and folder it goes on where it was stopped.

    Parameters
    ----------
    config : the file of a record with the key ``sweep``, or a mapping like it.
    folder : where the index and the results go; ``NAME-sweep`` when None.
    jobs : number of worker processes on this machine; all processors when None.
    scheduler : address of a Dask scheduler, such as ``tcp://host:8786``, whose workers compute
        instead; with the extra ``distributed``.
    wanted : the engine's options, and the axis of operation ranges, as `Wanted` or some of its
        fields by name, such as ``{"areas": False, "along": ""}``; without ``along`` ranges are
        along the first axis.
    retries : how often a member is tried again whose process died, or which a limit stopped.
    timeout : seconds after which `LimitReached` is raised.
    progress : called as progress(stage, done, total).

    Returns
    -------
    The sweep, which can be iterated: each member with its values, counts, areas and ranges.

    Raises
    ------
    ConfigError
        For anything wrong with the record, or a folder that holds another sweep.
    OutputError
        When the folder cannot be written to, or another process works on it.
    LimitReached
        After ``timeout`` seconds; what is done stays.
    """
    question = sweep_from(config)
    wanted = wanted_of(question, wanted)
    if scheduler is not None:  # whether or not there is anything left to compute
        require("distributed", key="--scheduler")
    place = Path(f"{question.name}-sweep") if folder is None else Path(folder)
    with opened(place) as index:
        index.claim(_facts(question), _asked(question, wanted))
        index.check(question.names)
        run = _Run(question, index, retries, progress, timeout)
        try:
            run.all(partial(_workers, question, wanted, jobs, scheduler))
        except (LimitReached, OutputError) as stopped:
            done = f"{index.states().get(State.DONE, 0)} of {len(question)} members are done"
            raise type(stopped)(
                f"{stopped}; {done}, in {place}; the same command goes on"
            ) from stopped
        finally:
            index.share()
    return read_sweep(place)


def wanted_of(question: Sweeping, wanted: Wanted | Mapping[str, Any] | None) -> Wanted:
    """What is wanted of each member, if it has a meaning for these slices.

    Raises
    ------
    ConfigError
    """
    if not isinstance(wanted, Wanted):
        wanted = _by_name(wanted or {}, axes_of(question)[0])
    _ = wanted.options  # which refuses an engine that there is not
    if wanted.along and wanted.along not in axes_of(question):
        raise ConfigError(
            f"{wanted.along[:40]} is no axis: choose {' or '.join(axes_of(question))}",
            key="--along",
        )
    return wanted


def _by_name(fields: Mapping[str, Any], along: str) -> Wanted:
    known = {field.name for field in dataclasses.fields(Wanted)}
    for name in fields:
        if name not in known:
            raise ConfigError(
                f"there is no option {name[:40]!r}; the options are {', '.join(sorted(known))}",
                key="wanted",
            )
    shares = {
        name: share_for(name, fields[name]) for name in _SHARES if fields.get(name) is not None
    }
    chosen = {} if fields.get("along") is not None else {"along": along}
    return Wanted(**{**fields, **shares, **chosen})


def axes_of(question: Sweeping) -> tuple[str, ...]:
    """The names of the axes of every member."""
    return tuple(question.record.axes)


def _workers(
    question: Sweeping, wanted: Wanted, jobs: int | None, scheduler: str | None
) -> Pool | Cluster:
    """The processes that compute."""
    task = computing(question, wanted)
    if scheduler is not None:
        return Cluster(task, scheduler)
    prepare(question.slice(0), wanted.options)  # compiles once for all, where that is needed
    return Pool(task, jobs or processors(), wanted.timeout)


def processors() -> int:
    """How many this process may use."""
    affinity = getattr(os, "sched_getaffinity", None)
    return len(affinity(0)) if affinity is not None else os.cpu_count() or 1


def _facts(question: Sweeping) -> dict[str, str]:
    """What the index says of the sweep as a whole."""
    return {
        "name": question.name,
        "names": json.dumps(question.names, ensure_ascii=False),
        "members": str(len(question)),
        "version": __version__,
    }


def _asked(question: Sweeping, wanted: Wanted) -> str:
    """A digest of all that results depend on."""
    record = question.record
    first = _slice_data(question.slice(0))
    values = [
        [
            # a list of values, or a progression
            [name, ",".join(map(text_of, v))]
            if isinstance(v, tuple)
            else [name, *(text_of(x) for x in (v.first, v.step, v.number))]
            for name, v in product.items()
        ]
        for product in question.products
    ]
    texts = {name: scalar.text for name, scalar in record.values.items()}
    options = [None if value is None else str(value) for value in dataclasses.astuple(wanted)]
    return hashlib.sha256(json.dumps([first, values, texts, options]).encode()).hexdigest()


def _slice_data(slice: Slice) -> Any:
    """All of a slice as data that JSON writes."""
    from ptmcad.show.document.slicedocument import SLICE

    return SLICE.write(slice)


class _Run:
    """One run over the members that are not done."""

    def __init__(
        self,
        question: Sweeping,
        index: Index,
        retries: int,
        progress: Progress | None,
        timeout: float | None,
    ) -> None:
        self.question, self.index, self.retries = question, index, retries
        self.progress, self.timeout = progress, timeout
        self.deadline = None if timeout is None else monotonic() + timeout
        self.failures: Counter[int] = Counter()
        self.again: deque[int] = deque()
        self.total = len(question)
        self.settled = 0

    def all(self, start: Callable[[], Pool | Cluster]) -> None:
        """Compute what is to be computed.

        Raises
        ------
        LimitReached
            When the time is over.
        """
        numbers = chain(self._earlier(), self._new())

        def following() -> int | None:
            return self.again.popleft() if self.again else next(numbers, None)

        first = following()
        if first is None:
            return
        self.again.append(first)
        workers = start()
        try:
            for number, outcome in answers_of(workers, following, self._patience):
                self._settle(number, outcome)
        finally:
            workers.close()

    def _settle(self, number: int, outcome: Outcome) -> None:
        self.index.record(number, outcome)
        if outcome.state is State.FAILED and self.failures[number] < self.retries:
            self.failures[number] += 1
            self.again.append(number)
            return
        self._count()

    def _count(self) -> None:
        self.settled += 1
        if self.progress is not None:
            self.progress("members", self.settled, self.total)

    def _patience(self) -> float | None:
        if self.deadline is None:
            return None
        left = self.deadline - monotonic()
        if left <= 0:
            raise LimitReached(f"the time limit of {self.timeout:g} s was reached")
        return left

    def _earlier(self) -> Iterator[int]:
        """The members of an earlier run that are not done."""
        self.planned = self.index.planned
        waiting = self.index.count_waiting()
        self.settled = self.planned - waiting
        return self.index.waiting(self.planned)

    def _new(self) -> Iterator[int]:
        """The members that no run has come to, as they are entered into the index."""
        for low in range(self.planned, self.total, _AT_ONCE):
            self._patience()
            entered = [self._entry(k) for k in range(low, min(low + _AT_ONCE, self.total))]
            with self.index.transaction():
                fresh = [self.index.plan(*entry) for entry in entered]
            for entry, is_fresh in zip(entered, fresh, strict=True):
                if is_fresh:
                    yield entry[0]
                else:
                    self._count()

    def _entry(self, number: int) -> tuple[int, dict[str, str], bytes | None, str]:
        """A member's number, its values, a digest of its slice, and why there is no slice."""
        values = self.question.values(number)
        parameters = {name: text_of(value) for name, value in values.items()}
        try:
            data = json.dumps(_slice_data(self.question.slice(number)), sort_keys=True)
        except PtmcadError as error:
            return number, parameters, None, reason(error)
        return number, parameters, hashlib.sha256(data.encode()).digest(), ""


def _drawing(folder: Path, number: int, _check: object) -> Thumbnail:
    """That of a member of the sweep in a folder."""
    from ptmcad.show.report.atlas import sketch

    return sketch(read_sweep(folder).result(number))


def sketches(
    folder: Path, numbers: Sequence[int], jobs: int | None, progress: Progress | None = None
) -> Iterator[tuple[int, Thumbnail]]:
    """The drawings of members, in any order.

    Raises
    ------
    OutputError
        When one cannot be drawn.
    """
    pool = Pool(partial(_drawing, folder), min(jobs or processors(), max(1, len(numbers) // 4)))
    try:
        found = answers_of(pool, partial(next, iter(numbers), None), lambda: None)
        for done, (number, drawn) in enumerate(found, 1):
            if isinstance(drawn, Outcome):
                raise OutputError(f"member {number} cannot be drawn: {drawn.error}")
            if progress is not None:
                progress("drawings", done, len(numbers))
            yield number, drawn
    finally:
        pool.close()


MAX_SOLUTIONS = 8
"""Complex solutions of a member that is computed for its time: with more of them it may take
minutes.
"""
MEMBERS = 4
"""That are computed for their time, ..."""
ENOUGH = 1.0
"""... until they have taken so many seconds together."""


def sweep_text(question: Sweeping, first: CheckedSlice) -> Iterator[str]:
    """The number of members and the time that they take here, as lines of text."""
    yield f"{'sweep':<12}{len(question)} members over {', '.join(question.names)}; above is the first member"
    if (
        first.engine != "exact"
        or first.complex_solutions is None
        or first.complex_solutions > MAX_SOLUTIONS
    ):
        yield f"{'time':<12}{len(question)} times that of a member, on {_these_processors()}: see cost"
        return
    from ptmcad.ask.forecast import duration

    taken = _seconds(question)
    whole = sum(taken) / len(taken) * len(question) / processors()
    low, high = (f"{seconds:.2g}" for seconds in (min(taken), max(taken)))
    each = (
        f"a member took {high} s"
        if len(taken) == 1
        else f"{len(taken)} members took {low} to {high} s"
    )
    yield f"{'time':<12}about {duration(max(1.0, whole))} on {_these_processors()}: {each} with ranges"


def _seconds(question: Sweeping) -> list[float]:
    """What members here and there take; a sweep's middle, and its corners, are often slices that
    are easier.
    """
    compute = computing(question, Wanted(along=axes_of(question)[0]))
    taken: list[float] = []
    for number in Random(0).sample(range(len(question)), min(MEMBERS, len(question))):
        outcome = compute(number)
        # it cannot have failed: there is neither another version nor a time limit
        assert outcome.seconds is not None, outcome.error
        taken.append(outcome.seconds)
        if sum(taken) > ENOUGH:
            break
    return taken


def _these_processors() -> str:
    number = processors()
    return "one processor" if number == 1 else f"{number} processors"
