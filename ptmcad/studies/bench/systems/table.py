"""The page: times, memory, whether answers agree, and what each program leaves to its user."""

from __future__ import annotations

from collections.abc import Callable

from ptmcad.studies.bench.harness import Record
from ptmcad.studies.bench.systems.programs import Tool
from ptmcad.studies.tables import markdown, measured_with, page

TITLES = {
    Tool.MAP: "ptmcad, whole map",
    Tool.CURVE: "msolve, critical curve",
    Tool.SINGULAR: "Singular, critical curve",
    Tool.QEPCAD: "QEPCAD, cells of the curves",
    Tool.GCAD: "gcad, cells of the curves",
    Tool.SOLVE: "ptmcad, one point",
    Tool.POINTS: "msolve, one point",
}
"""The columns, in their order."""
CHECKED = tuple(tool for tool in TITLES if tool is not Tool.MAP)

_INTRODUCTION = """
What other programs do of the same work. Only ptmcad is asked for all of it: curves, cells, counts with stability,
neighbours, regions, areas. The others are asked for the part that is theirs, and are given what they need for it:
msolve and Singular the system that `ptmcad variety --format msolve` writes, QEPCAD and gcad the finished curves, with
the axis first that ptmcad has chosen. So the columns are not rivals at one task; read each with [what it leaves to
the user](#what-each-leaves-to-the-user).
"""
_TIMES = """
Seconds of whole processes, start-up included: wall time, and processor time in brackets; medians. Where points are
asked for, each process solves at one point and the figure is the mean for a point. The last column counts the
programs whose answers were compared with ptmcad's and are the same.
"""
_AGREEMENT = """
The curves of msolve and Singular are compared with the map's as sets of irreducible polynomials, the real solutions
by their number at each point, and QEPCAD's cells by their samples: every one of the map's cells has to contain one.
gcad gives no samples, so only the number of its cells can be compared. Where there is no map, msolve's numbers are
compared with those of `ptmcad solve`.
"""
_LEFT = """
**ptmcad** leaves the choice of the two parameters and of their window. It derives equations, Jacobian and stability
from the mechanism's description. Where the curve is too large, as that of the five-bar, it has no exact map within
the limit and counts at points only.

**msolve** is asked for the critical curve, and for real solutions at points. It leaves the system to write:
equations, the determinant that makes solutions singular, and inverses of what must not vanish. It leaves the curves
over which solutions go to infinity, which are not in that ideal; the factors of the curve; the choice of a point in
each cell, and so the decomposition of the plane; inequalities and stability, which are signs at the boxes that it
gives; neighbours, regions and areas. Its bases over Q are lifted from bases modulo primes and are not proved.

**Singular** is asked for the critical curve and its factors, over Q and without primes. It leaves the same as msolve,
and the strategy too: without a basis in degree reverse lexicographic order before the elimination, [it takes far
longer](../crosschecks.md#the-variety). The inverse in the system is expensive: without it stiffness takes a tenth of
the time, but such an elimination may have further lines, over which a bar has no length. Its libraries for real roots
were not measured.

**QEPCAD** is asked for the open cells of the window with a rational sample in each. It leaves the curves, which are
the work of the programs before it; the order of the axes; a bound on its memory, which has to be set before it starts
(here 20 million of its memory cells, so that the peak says little); the counts at its samples; which cells are
neighbours, and areas. It counts as well when the unknowns are first reduced to one by hand: [error against run
time](error-time.md) has that for the paper's slices.

**gcad** is asked for the same cells, as strict inequalities in pure Python. It leaves the curves, the order of the
axes, samples (a cell is a list of bounds by roots of polynomials), counts, neighbours and areas.
"""
_AGAIN = """
`make systems`, which is `python -m ptmcad.studies.bench.systems --out docs/benchmarks`; there are `--rounds`,
`--timeout`, `--points`, and any records may be named. Of a program that is not installed the column says so: msolve
comes with `pip install 'ptmcad[large]'`, gcad with `pip install gcad`, QEPCAD and Singular with `apt-get install
qepcad singular`. The exit status is 1 when two answers differ.
"""


def to_markdown(found: Record) -> str:
    """The record as a page."""
    date = f", {found['date']}" if found["date"] else ""
    rows, floor = found["rows"], found["floor"]
    titles = tuple(TITLES.values())
    times = [(row["name"], *_each(row, _time), _verdict(row)) for row in rows]
    peaks = [(row["name"], *_each(row, lambda figures: _peak(figures, floor))) for row in rows]
    compared = [(row["name"], _map(row), *(_found(row, tool) for tool in CHECKED)) for row in rows]
    return page(
        "# Systems side by side",
        _INTRODUCTION,
        "## Times",
        _TIMES,
        markdown(("system", *titles, "answers agree"), times),
        f"Rounds: {found['rounds']}, seed {found['seed']}, limit {found['timeout']:g} s for a program and system, "
        f"at most {found['points']} points{date}.",
        "## Memory",
        f"Largest resident set in MiB. Less than {floor:.0f}, that of a process that does nothing, cannot be seen.",
        markdown(("system", *titles), peaks),
        "## What was compared",
        _AGREEMENT,
        markdown(("system", "map", *(TITLES[tool] for tool in CHECKED)), compared),
        "## What each leaves to the user",
        _LEFT,
        "## How to run it again",
        _AGAIN,
        *measured_with(found),
    )


def _each(row: Record, shown: Callable[[Record], str]) -> list[str]:
    """A row's cells: figures as they are shown, or the reason why there are none."""
    cells = []
    for tool in TITLES:
        figures = row["tools"][tool.value]
        cells.append(figures if isinstance(figures, str) else shown(figures))
    return cells


def _time(figures: Record) -> str:
    number = figures.get("points", 1)
    return f"{_seconds(figures['median'] / number)} ({_seconds(figures['processor'] / number)})"


def _seconds(value: float) -> str:
    return f"{value:.3f}" if value < 0.1 else f"{value:.2f}" if value < 10 else f"{value:.0f}"


def _peak(figures: Record, floor: float) -> str:
    return f"{figures['peak']:.0f}" if figures["peak"] > floor + 1 else f"under {floor + 1:.0f}"


def _verdict(row: Record) -> str:
    told = [check["agrees"] for check in row["agreement"].values()]
    if False in told:
        return "no"
    return f"yes ({told.count(True)})" if True in told else "-"


def _map(row: Record) -> str:
    if "cells" not in row:
        return "-"
    curves = "1 curve" if row["curves"] == 1 else f"{row['curves']} curves"
    return f"{row['complex solutions']} solutions, {curves} of degree {row['degree']} in all, {row['cells']} cells"


def _found(row: Record, tool: Tool) -> str:
    check = row["agreement"].get(tool.value)
    if check is None:
        return "-" if isinstance(row["tools"][tool.value], str) else "nothing to compare with"
    words = {True: "", False: "**differs**: ", None: "not told: "}
    return words[check["agrees"]] + str(check["found"])
