"""The programs, how each is asked, whether it has answered, and how its answer is read.

Guarantee: what is read is the answer of a run that came to the end of its script without telling an error; everything
else is an `AnswerError`, with what the program said. Singular and QEPCAD exit with status 0 after most errors and go on
with the next line, so errors are looked for in what they print.

Nothing large is imported here: the processes that are measured are started beside this module.
"""

from __future__ import annotations

import re
import shutil
import sys
import sysconfig
from enum import Enum
from importlib.util import find_spec
from pathlib import Path
from typing import NamedTuple

from ptmcad.studies.bench import qepcad
from ptmcad.studies.bench.process import Usage, run
from ptmcad.studies.bench.systems.exchange import Point

_END = "-- the script was read to its end --"
_SINGULAR_ERROR = re.compile(r"^\s*\? (.*)$", re.MULTILINE)
_QEPCAD_END = "Quitting the QEPCAD system"
_QEPCAD_STUCK = "[ 0 = 0 ].\nquit\nquit\n"
"""Read only by a session that has not understood its formula: at the end of its input it would ask again for ever."""
_QEPCAD_ERROR = re.compile(r"^.*(?:\bError\b|Failure|Reason for|expected!).*$", re.MULTILINE)
_QEPCAD_CELL = re.compile(r"Information about the cell \((\d+),(\d+)\) -+$(.*?)^-{50,}$", re.MULTILINE | re.DOTALL)
_QEPCAD_TRUE = re.compile(r"^Truth value\s*: T", re.MULTILINE)
_QEPCAD_COORDINATE = re.compile(r"^Coordinate [12] = (-?\d+(?:/\d+)?)$", re.MULTILINE)


class Tool(Enum):
    """A program and what it is asked, the JSON's keys."""

    MAP = "ptmcad map"
    SOLVE = "ptmcad points"
    CURVE = "msolve curve"
    POINTS = "msolve points"
    SINGULAR = "Singular curve"
    QEPCAD = "QEPCAD cells"
    GCAD = "gcad cells"


AT_POINTS = (Tool.SOLVE, Tool.POINTS)
"""Those that run once for each point."""
OF_CURVES = (Tool.QEPCAD, Tool.GCAD)
"""Those that need the finished curves."""


class AnswerError(Exception):
    """A program has not answered; the text says what it said instead."""


class Programs(NamedTuple):
    """Where the others are; None where one is not installed, ``gcad`` says whether it can be imported."""

    msolve: str | None
    singular: str | None
    qepcad: tuple[str, ...] | None
    gcad: bool

    def has(self, tool: Tool) -> bool:
        """Whether there is a program for a tool; ptmcad is here."""
        needed: dict[Tool, object] = {
            Tool.CURVE: self.msolve,
            Tool.POINTS: self.msolve,
            Tool.SINGULAR: self.singular,
            Tool.QEPCAD: self.qepcad,
            Tool.GCAD: self.gcad,
        }
        return bool(needed.get(tool, True))


def found() -> Programs:
    """The programs on this machine."""
    # as `ptmcad.algebra.msolve.program`, which loads FLINT: the wheel keeps its program off the PATH
    wheel = Path(sysconfig.get_path("purelib")) / "sage_wheels" / "bin" / "msolve"
    msolve = shutil.which("msolve") or (str(wheel) if wheel.is_file() else None)
    return Programs(msolve, shutil.which("Singular"), qepcad.command(), find_spec("gcad") is not None)


def versions(programs: Programs) -> dict[str, str]:
    """Those of msolve and Singular; the others' are in `ptmcad.studies.bench.harness.made_with`."""
    told = {"msolve": (programs.msolve, "-V"), "Singular": (programs.singular, "--version")}
    return {
        name: "not installed" if where is None else _version(where, option) for name, (where, option) in told.items()
    }


def _version(program: str | None, option: str) -> str:
    if program is None:
        return "not installed"
    number = re.search(r"\d+(?:\.\d+)+", run((program, option), timeout=10).output)
    return number.group(0) if number else "unknown"


def classify(record: Path, folder: Path) -> tuple[str, ...]:
    """ptmcad's whole map, into FOLDER/SLICE.json."""
    return _ptmcad("classify", str(record), "--format", "json", "--out", str(folder))


def solve(record: Path, names: tuple[str, str], point: Point, target: Path) -> tuple[str, ...]:
    """ptmcad's solutions at one point, into a file."""
    at = ",".join(f"{name}={value}" for name, value in zip(names, point, strict=True))
    return _ptmcad(
        "solve", str(record), "--at", at, "--format", "json", "--out", str(target.parent), "--name", target.stem
    )


def _ptmcad(*arguments: str) -> tuple[str, ...]:
    return str(Path(sys.executable).with_name("ptmcad")), *arguments


def msolve(program: str, question: Path, target: Path, *options: str) -> tuple[str, ...]:
    """msolve on a file, into another."""
    return program, *options, "-f", str(question), "-o", str(target)


def gcad(question: Path, target: Path) -> tuple[str, ...]:
    """gcad's decomposition by the curves of a file, into another."""
    return sys.executable, "-m", "ptmcad.studies.bench.gcad_curves", str(question), "curves", str(target)


def singular_script(system: str, unknowns: int) -> str:
    """The factors of the elimination ideal's common divisor, one on a line, for msolve's text of the system.

    A basis in the cheap order comes first: it saves most of the time. The variables are called v0, v1 and so on, in
    their order, because an axis may have the name of something else in Singular.
    """
    variables, _, *polynomials = system.splitlines()
    numbered = {name: f"v{n}" for n, name in enumerate(variables.split(","))}
    ideal = re.sub(r"[^\W\d]\w*", lambda name: numbered[name[0]], "".join(polynomials))
    names = list(numbered.values())
    return f"""ring r = 0, ({",".join(names)}), dp;
short = 0;
ideal i = {ideal};
ideal e = eliminate(std(i), {"*".join(names[:unknowns])});
poly common = 0;
for (int n = 1; n <= size(e); n++) {{ common = gcd(common, e[n]); }}
list factors = factorize(common);
for (n = 1; n <= size(factors[1]); n++) {{ if (deg(factors[1][n]) > 0) {{ print(string(factors[1][n])); }} }}
print("{_END}");
quit;
"""


def qepcad_session(text: str) -> str:
    """The session of ``ptmcad variety --format qepcad``, with an end that is reached in any case."""
    return text + _QEPCAD_STUCK


def singular_curves(usage: Usage) -> list[str]:
    """The factors that Singular has printed.

    Raises
    ------
    AnswerError
        When it told an error or did not come to the end of its script.
    """
    _refuse(_SINGULAR_ERROR, usage.output)
    before, end, _ = usage.output.partition(_END)
    if not end:
        raise AnswerError(f"stopped within its script: {_last_words(usage.output)}")
    return [line.strip() for line in before.splitlines() if line.strip()]


def msolve_curves(answer: str) -> list[str]:
    """The generators of the elimination ideal in msolve's answer.

    Raises
    ------
    AnswerError
        When it is no list of polynomials.
    """
    told = "".join(line for line in answer.splitlines() if not line.startswith("#"))
    whole = re.fullmatch(r"\[([^\[\]]+)\]:", told.strip())
    if whole is None:
        raise AnswerError(f"no list of polynomials: {_last_words(answer)}")
    return [generator.strip() for generator in whole.group(1).split(",")]


def qepcad_samples(usage: Usage) -> list[Point]:
    """The samples of the open cells of the window, in the order of QEPCAD's variables.

    Raises
    ------
    AnswerError
        When QEPCAD told an error, did not come to its end, or gave a cell no rational sample.
    """
    _refuse(_QEPCAD_ERROR, usage.output)
    if _QEPCAD_END not in usage.output:
        raise AnswerError(f"stopped within its script: {_last_words(usage.output)}")
    samples = []
    for *_, told in _QEPCAD_CELL.findall(usage.output):
        if _QEPCAD_TRUE.search(told):
            coordinates = _QEPCAD_COORDINATE.findall(told)
            if len(coordinates) != 2:
                raise AnswerError("a cell has no rational sample")
            samples.append((coordinates[0], coordinates[1]))
    if not samples:
        raise AnswerError("no cells")
    return samples


def _refuse(error: re.Pattern[str], output: str) -> None:
    told = error.search(output)
    if told is not None:
        raise AnswerError(" ".join(told.group(0).split())[:100])


def _last_words(text: str) -> str:
    return " ".join(text[-100:].split()) or "it says nothing"
