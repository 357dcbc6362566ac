"""The runs: every program on every system as a process of its own, in turns, and what the answers say of each other.

Guarantee: a run that did not end in time, failed or has no readable answer has a reason and no figures, and is not
tried again. Peaks are the kernel's; none below that of a process that does nothing can be seen, which is recorded.

Questions are made and answers compared in another process, so that this one stays small.
"""

from __future__ import annotations

import json
import random
import tempfile
from collections.abc import Mapping, Sequence
from concurrent.futures import Executor, ProcessPoolExecutor
from dataclasses import dataclass, replace
from multiprocessing import get_context
from pathlib import Path
from typing import Any, NamedTuple

from ptmcad.errors import ConfigError
from ptmcad.studies.bench.harness import Record, made_with, progress, rounds
from ptmcad.studies.bench.process import Outcome, Usage, run
from ptmcad.studies.bench.suite import summary
from ptmcad.studies.bench.systems import programs
from ptmcad.studies.bench.systems.exchange import Answers, Check, Question
from ptmcad.studies.bench.systems.programs import AT_POINTS, OF_CURVES, AnswerError, Programs, Tool

FORMAT = "ptmcad-systems/1"


class Plan(NamedTuple):
    """How often each program runs; seconds for it; points at which solutions are asked for; the seed of the order."""

    rounds: int = 3
    timeout: float = 60.0
    points: int = 20
    seed: int = 1


@dataclass(frozen=True, slots=True)
class Job:
    """A program's processes for a system, one after the other.

    Attributes
    ----------
    text : their standard input.
    answers : the files that they write; empty where the answer is on standard output.
    """

    tool: Tool
    commands: tuple[tuple[str, ...], ...]
    text: str = ""
    answers: tuple[Path, ...] = ()


@dataclass(frozen=True, slots=True)
class System:
    """A slice with its question and all that is to be run.

    Attributes
    ----------
    answer : ptmcad's map, None when there was none in time.
    jobs : what is run, or why it is not.
    """

    record: Path
    asked: Question
    answer: Path | None
    jobs: Mapping[Tool, Job | str]


def measure(records: Sequence[Path], plan: Plan, date: str = "") -> Record:
    """All programs on some records' slices.

    Parameters
    ----------
    date : recorded as it is.

    Raises
    ------
    PtmcadError
        When a record is wrong, or two slices have the same name.
    """
    there = programs.found()
    found: Record = {"format": FORMAT, **made_with()}
    found["versions"] |= programs.versions(there)
    found |= {"date": date, **plan._asdict()}
    # a fresh process, not a copy of this one, which would be measured with each program
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as other, tempfile.TemporaryDirectory() as folder:
        _refuse_same_names(records, other)
        systems: list[System] = []
        runs: dict[tuple[int, Tool], list[Usage]] = {}
        for n, record in enumerate(records):
            place = Path(folder) / str(n)
            place.mkdir()
            system, first = _system(record, place, there, plan, other)
            systems.append(system)
            runs |= {(n, tool): [] for tool, job in system.jobs.items() if isinstance(job, Job)}
            if system.answer is None:  # it needs no second attempt
                runs[n, Tool.MAP] = [first]
        _take_turns(systems, runs, plan)
        # this process has its largest size by now
        found["floor"] = round(run(("true",)).peak_mebibytes, 1)
        found["rows"] = [
            _row(system, {tool: runs[n, tool] for tool in Tool if (n, tool) in runs}, plan, other)
            for n, system in enumerate(systems)
        ]
    return found


# These three run in the other process and load the engine there.


def _names(records: Sequence[Path]) -> tuple[str, ...]:
    from ptmcad.studies.bench.systems.questions import names

    return names(records)


def _question(record: Path, answer: Path | None, points: int) -> Question:
    from ptmcad.studies.bench.systems.questions import question

    return question(record, answer, points)


def _checks(asked: Question, answer: Path | None, given: Answers) -> Mapping[str, Check]:
    from ptmcad.studies.bench.systems.agreement import checks

    return checks(asked, answer, given)


def _refuse_same_names(records: Sequence[Path], other: Executor) -> None:
    seen: set[str] = set()
    for name in other.submit(_names, records).result():
        if name in seen:
            raise ConfigError(f"two slices are called {name}")
        seen.add(name)


def _system(record: Path, place: Path, there: Programs, plan: Plan, other: Executor) -> tuple[System, Usage]:
    """The jobs for a record, and the run of ptmcad whose map they are made of."""
    progress(f"questions: {record.stem}")
    made = run(programs.classify(record, place), timeout=plan.timeout)
    answer = None
    if made.outcome is Outcome.DONE:
        (answer,) = place.glob("*.json")
    asked = other.submit(_question, record, answer, plan.points).result()
    return System(record, asked, answer, jobs(record, asked, answer, place, there)), made


def jobs(record: Path, asked: Question, answer: Path | None, place: Path, there: Programs) -> dict[Tool, Job | str]:
    """What is run for a record, or why it is not.

    Parameters
    ----------
    answer : ptmcad's map, None when there was none in time.
    place : a folder for the programs' questions and answers.
    """
    found: dict[Tool, Job | str] = {}
    for tool in Tool:
        if not there.has(tool):
            found[tool] = "not installed"
        elif tool in OF_CURVES and answer is None:
            found[tool] = "cannot (no finished curves)"
        else:
            found[tool] = _job(tool, record, asked, place, there)
    return found


def _job(tool: Tool, record: Path, asked: Question, place: Path, there: Programs) -> Job:
    match tool:
        case Tool.MAP:
            return Job(tool, (programs.classify(record, place / "map"),))
        case Tool.SOLVE:
            targets = tuple(place / f"solve-{n}.json" for n in range(len(asked.points)))
            points = zip(asked.points, targets, strict=True)
            return Job(tool, tuple(programs.solve(record, asked.axes, *each) for each in points), answers=targets)
        case Tool.CURVE:
            question, target = _written(place / "curve", asked.system), place / "curve.answer"
            command = programs.msolve(str(there.msolve), question, target, "-e", str(asked.unknowns), "-g", "2")
            return Job(tool, (command,), answers=(target,))
        case Tool.POINTS:
            questions = [_written(place / f"point-{n}", text) for n, text in enumerate(asked.at_points)]
            targets = tuple(path.with_suffix(".answer") for path in questions)
            commands = (programs.msolve(str(there.msolve), *each) for each in zip(questions, targets, strict=True))
            return Job(tool, tuple(commands), answers=targets)
        case Tool.SINGULAR:
            command = (str(there.singular), "--quiet", "--no-rc")
            return Job(tool, (command,), programs.singular_script(asked.system, asked.unknowns))
        case Tool.QEPCAD:
            assert there.qepcad is not None
            return Job(tool, (there.qepcad,), programs.qepcad_session(asked.qepcad))
        case Tool.GCAD:
            question, target = _written(place / "gcad", asked.gcad), place / "gcad.answer"
            return Job(tool, (programs.gcad(question, target),), answers=(target,))


def _written(path: Path, text: str) -> Path:
    path.write_text(text, encoding="ascii")
    return path


def _take_turns(systems: Sequence[System], runs: dict[tuple[int, Tool], list[Usage]], plan: Plan) -> None:
    """Fill in the runs."""

    def due(_: int) -> list[tuple[int, Tool]]:
        return [key for key, done in runs.items() if all(usage.outcome is Outcome.DONE for usage in done)]

    for index, turns in enumerate(rounds(plan.rounds, due, random.Random(plan.seed))):
        for number, (n, tool) in enumerate(turns):
            job = systems[n].jobs[tool]
            assert isinstance(job, Job)
            usage = attempt(job, plan.timeout)
            runs[n, tool].append(usage)
            progress(
                f"round {index + 1}, {number + 1} of {len(turns)}: {systems[n].asked.name}, {tool.value}, "
                f"{usage.outcome.value} after {usage.seconds:.2f} s"
            )


def attempt(job: Job, timeout: float) -> Usage:
    """The job's processes as if they were one; a failure where the answer cannot be read.

    Parameters
    ----------
    timeout : seconds for all of them.
    """
    for path in job.answers:
        path.unlink(missing_ok=True)
    parts: list[Usage] = []
    for command in job.commands:
        parts.append(run(command, text=job.text, timeout=max(timeout - sum(u.seconds for u in parts), 0.01)))
        if parts[-1].outcome is not Outcome.DONE:
            break
    whole = Usage(
        outcome=parts[-1].outcome,
        seconds=sum(u.seconds for u in parts),
        processor_seconds=sum(u.processor_seconds for u in parts),
        peak_mebibytes=max(u.peak_mebibytes for u in parts),
        output=parts[-1].output,
        message=parts[-1].message,
    )
    if whole.outcome is not Outcome.DONE:
        return whole
    try:
        read(job, whole)
    except AnswerError as error:
        return replace(whole, outcome=Outcome.FAILED, message=str(error))
    return whole


def read(job: Job, usage: Usage) -> Any:
    """The answer of a job that is done, as `Answers` has it.

    Raises
    ------
    AnswerError
        When it is none.
    """
    missing = sum(not path.exists() for path in job.answers)
    if missing:
        raise AnswerError(f"{missing} of {len(job.answers)} answers missing")
    texts = tuple(path.read_text(encoding="utf-8") for path in job.answers)
    match job.tool:
        case Tool.MAP:
            return None
        case Tool.SOLVE | Tool.POINTS:
            return texts
        case Tool.CURVE:
            programs.msolve_curves(texts[0])
            return texts[0]
        case Tool.SINGULAR:
            return programs.singular_curves(usage)
        case Tool.QEPCAD:
            return programs.qepcad_samples(usage)
        case Tool.GCAD:
            return json.loads(texts[0])["open"]


_FIELDS = {
    Tool.SOLVE: "solve",
    Tool.POINTS: "points",
    Tool.CURVE: "curve",
    Tool.SINGULAR: "singular",
    Tool.QEPCAD: "qepcad",
    Tool.GCAD: "gcad",
}


def _row(system: System, runs: Mapping[Tool, Sequence[Usage]], plan: Plan, other: Executor) -> Record:
    """A system's figures; the files still hold the last answers."""
    progress(f"comparing: {system.asked.name}")
    answers: dict[str, Any] = {}
    for tool, field in _FIELDS.items():
        job = system.jobs[tool]
        if isinstance(job, Job) and all(usage.outcome is Outcome.DONE for usage in runs[tool]):
            answers[field] = read(job, runs[tool][-1])
    told = other.submit(_checks, system.asked, system.answer, Answers(**answers)).result()
    tools: Record = {}
    for tool, job in system.jobs.items():
        figures = job if isinstance(job, str) else shown(runs[tool], plan.timeout)
        tools[tool.value] = figures
        if isinstance(figures, dict) and tool in AT_POINTS:
            figures["points"] = len(system.asked.points)
    agreement = {name: check._asdict() for name, check in told.items()}
    return {"name": system.asked.name, **system.asked.facts, "tools": tools, "agreement": agreement}


def shown(runs: Sequence[Usage], timeout: float) -> dict[str, float] | str:
    """The figures of repeated runs, or why there are none."""
    for usage in runs:
        if usage.outcome is Outcome.TIMED_OUT:
            return f"not in {timeout:g} s"
        if usage.outcome is Outcome.FAILED:
            return f"failed: {usage.message.splitlines()[-1] if usage.message else 'it says nothing'}"
    return summary(runs)
