"""A run of stress cases: each put to ptmcad and to double precision, judged and timed; and random
cases.

Guarantee: everything in a campaign but the seconds is the same in the next run with the same
versions. A run that was stopped by a time limit says so and keeps the cases that were done. It is
shown as a table for the terminal, a page, JSON and CSV; these two hold every figure, and a number
that does not exist is null or empty, never 0.

The same seed and number give the same random case, whose right answer is known by construction: a
scaled or mirrored copy has the counts of its tame original, which come from the second method;
points beside a fold or a cusp have those of the construction.

In the plot every point that has an error is drawn; where the count of double precision is wrong it
is drawn as such, also where no error exists.
"""

from __future__ import annotations

import csv
import io
import json
import platform
import random
from collections.abc import Sequence
from fractions import Fraction
from math import inf
from statistics import median
from time import perf_counter, process_time
from typing import Any

from ptmcad.answer.poses import DIGITS
from ptmcad.extras import require
from ptmcad.model import ptm
from ptmcad.model.evaluate import value_at
from ptmcad.options import Progress
from ptmcad.show.table import aligned
from ptmcad.studies.stress.case import FEW, Case, Degenerate, Question, degenerate, free_lengths
from ptmcad.studies.stress.doubleprecision import sextic_poses
from ptmcad.studies.stress.judgement import Row, counts_text, judge
from ptmcad.studies.texts import installed, page
from ptmcad.studies.texts import markdown as table_of
from ptmcad.text.numerals import shortest_text
from ptmcad.version import __version__

PACKAGES = ("python-flint", "numpy", "numba")
KINDS = ("scaled", "mirrored", "swapped", "fold", "cusp")
MAX_EXPONENT = 30
"""Scales are 10^-30 to 10^30, distances from a fold 10^-30 to 10^-3."""
CONSTRUCTED = (
    "construction of a degenerate pose in rational numbers, and on which side of it two more exist"
)
ORIGINAL = "symmetry of the equations: counts of the tame original, by the second method"
TEN = Fraction(10)

_MECHANISM = ptm()

Values = dict[str, Fraction]

HEADINGS = ("case", "known", "ptmcad", "double", "double's error", "condition", "bits")


def campaign(
    cases: Sequence[Case],
    *,
    seed: int,
    repeats: int,
    deadline: float = inf,
    progress: Progress = lambda _name, _done, _total: None,
) -> Row:
    """Run the cases: what came out, a row for each, and what is needed to judge it.

    Parameters
    ----------
    seed : of random cases among them; recorded.
    repeats : timed runs of each case; one of slow cases.
    deadline : reading of `time.perf_counter` after which no further case is begun.
    progress : called as progress(name, done, total).

    Raises
    ------
    ConfigError
        Before the first case, when one has springs with free lengths and numba is not installed.
    """
    if any(free_lengths(case.question.parameters) for case in cases):
        require("certified")
    rows: list[Row] = []
    for k, case in enumerate(cases):
        if perf_counter() > deadline:
            break
        progress(case.name, k, len(cases))
        rows.append(run(case, 1 if case.slow else repeats))
    return {
        "kind": "ptmcad stress", "complete": len(rows) == len(cases), "seed": seed, "repeats": repeats,
        "machine": {
            "system": platform.system(), "processor": platform.machine(), "python": platform.python_version(),
        },
        "versions": {"ptmcad": __version__, **installed(PACKAGES)}, "cases": rows,
    }  # fmt: skip


def run(case: Case, repeats: int) -> Row:
    """Answer and judge a case: a row with the ``seconds`` of processor time that it takes, the
    median of its runs.
    """
    verdict = judge(case, answer(case.question, case.name))
    return {
        "name": case.name, "family": case.family, "asked": case.question.kind,
        "stiffness": shortest_text(case.stiffness), "source": case.source, **verdict,
        "seconds": median(_seconds(case.question) for _ in range(repeats)),
    }  # fmt: skip


def answer(question: Question, name: str = "case") -> Any:
    """ptmcad's answer: `Poses`, a `RegionMap` or `CountIntervals`."""
    import ptmcad

    if not question.axes:
        return ptmcad.solve(None, DIGITS, None, **question.parameters)
    record = {
        "name": name,
        "mechanism": "ptm",
        "parameters": question.parameters,
        "axes": question.axes,
    }
    slice = ptmcad.slice_from_mapping(record)
    if question.along:
        return ptmcad.intervals(slice, question.along, question.fixed)
    if question.tolerance is not None:
        return ptmcad.classify(slice, tolerance=question.tolerance, jobs=1)
    return ptmcad.classify(slice)


def _seconds(question: Question) -> float:
    started = process_time()
    answer(question)
    return process_time() - started


# --------------------------------------------------------------------------------------------------------- random cases


def random_case(seed: int, number: int) -> Case:
    """The case with this number."""
    dice = random.Random(f"{seed}/{number}")
    kind = KINDS[number % len(KINDS)]
    name, family = f"random-{seed}-{number}-{kind}", f"random {kind}"
    if kind in ("fold", "cusp"):
        at, distance = _degenerate(dice, cusp=kind == "cusp"), TEN ** -dice.randint(3, MAX_EXPONENT)
        side, (total, stable) = dice.choice([(1, at.many), (-1, FEW)])
        question, expected = Question(at.beside(side * distance)), f"{total}/{stable}"
        return Case(name, family, distance, question, CONSTRUCTED, expected)
    original, expected = tame(dice)
    scale = TEN ** (dice.choice([-1, 1]) * dice.randint(3, MAX_EXPONENT))
    question = Question(scaled(changed(original, kind), scale, TEN ** dice.randint(-9, 9)))
    return Case(name, family, scale, question, ORIGINAL, expected)


def scaled(p: Values, stiffness: Fraction, length: Fraction) -> Values:
    """Stiffnesses and lengths multiplied, and forces by both: the equilibria stay."""
    factors = dict.fromkeys(_MECHANISM.stiffnesses, stiffness) | dict.fromkeys(
        _MECHANISM.forces, stiffness * length
    )
    return {name: v * factors.get(name, length) for name, v in p.items()}


def changed(p: Values, kind: str) -> Values:
    """Vertical forces reversed (mirrored), which changes the angles' signs, or left and right
    exchanged (swapped).
    """
    symmetry = dict(zip(("swapped", "mirrored"), _MECHANISM.symmetries, strict=True)).get(kind, {})
    return {name: value_at(symmetry[name], p) if name in symmetry else v for name, v in p.items()}


def tame(dice: random.Random) -> tuple[Values, str]:
    """A random point with ordinary numbers, and its counts."""
    while True:
        p = {name: Fraction(dice.randint(5, 30), 10) for name in ("L1", "L2", "rho")}
        equal = dice.random() < 1 / 2
        springs = (
            [Fraction(100)] * 3 if equal else [Fraction(dice.randint(50, 150)) for _ in range(3)]
        )
        p |= dict(zip(_MECHANISM.stiffnesses, springs, strict=True))
        p |= {name: Fraction(dice.randint(-40, 40)) for name in ("F3", "F4")}
        sideways = dice.random() < 1 / 3
        p |= {name: Fraction(dice.randint(-40, 40) if sideways else 0) for name in ("F3x", "F4x")}
        try:
            poses = sextic_poses(p)
        except ArithmeticError:  # a degenerate point
            continue
        return p, counts_text(poses)


def _degenerate(dice: random.Random, *, cusp: bool) -> Degenerate:
    """A random fold or cusp."""
    while True:
        tangents, lengths = (
            [Fraction(dice.randint(*ends), 10) for _ in range(2)] for ends in ((-30, 30), (5, 20))
        )
        springs = [Fraction(dice.choice([50, 100, 100, 100, 150])) for _ in range(3)]
        rho = Fraction(dice.randint(2, 20), 10)
        try:
            return degenerate(tangents, cusp=cusp, lengths=lengths, rho=rho, springs=springs)
        except ValueError:
            continue


# ------------------------------------------------------------------------------------------------------------ as text


def cells(row: Row) -> tuple[str, ...]:
    """A row of the table, in the order of `HEADINGS`."""
    numbers = (
        "-" if row[name] is None else f"{row[name]:.2g}" for name in ("double_error", "condition")
    )
    found = row["found"] + (" WRONG" if not row["right"] else "")
    double = row["double"] + (" wrong" if not row["double_right"] else "")
    return row["name"], row["expected"], found, double, *numbers, str(row["bits"] or "-")


def table(campaign: Row, wanted: int) -> str:
    """The campaign as a table for a terminal, with a summary below."""
    rows = [(*cells(row), f"{1000 * row['seconds']:.3g}") for row in campaign["cases"]]
    return "\n".join([*aligned([(*HEADINGS, "ms"), *rows]), "", *summary(campaign, wanted)])


def markdown(campaign: Row) -> str:
    """The campaign as a Markdown page; times are left out, so that the same versions write the same
    page.
    """
    rows = [(row["family"], *cells(row)) for row in campaign["cases"]]
    right, double, *_ = summary(campaign, len(rows))
    written = f"Written by `ptmcad stress` with seed {campaign['seed']}. {right}; {double}."
    return page("# The stress cases, one by one", written, table_of([("family", *HEADINGS), *rows]))


def summary(campaign: Row, wanted: int) -> list[str]:
    """What the campaign says, line by line.

    Parameters
    ----------
    wanted : how many cases were to be run.
    """
    rows, number = campaign["cases"], len(campaign["cases"])
    wrong = [row for row in rows if not row["right"]]
    double = sum(not row["double_right"] for row in rows)
    return [
        f"ptmcad is right in {number - len(wrong)} of {number} cases",
        f"double precision is wrong in {double} of {number}",
        *(f"wrong: {row['name']}: {'; '.join(row['remarks'])}" for row in wrong),
        *([f"stopped: {wanted - number} cases were not run"] if wanted > number else []),
    ]


def listing(cases: Sequence[Case]) -> str:
    """Name, family, question and source of each case."""
    return "\n".join(aligned([(c.name, c.family, c.question.kind, c.source) for c in cases]))


def to_json(campaign: Row) -> str:
    """Everything about a campaign."""
    return json.dumps(campaign, indent=1, allow_nan=False) + "\n"


def to_csv(campaign: Row) -> str:
    """The same, one row for each case."""
    text = io.StringIO()
    rows = [{**row, "remarks": "; ".join(row["remarks"])} for row in campaign["cases"]]
    if rows:
        writer = csv.DictWriter(text, list(rows[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    return text.getvalue()


MIN_DRAWN_ERROR = 1e-20
"""Errors below are drawn here: enclosures of 12 digits have middles about 1e-19 off."""
NOTE = "Of poses in radians, of lines relative to the window. At 1e-20: none or less; at the top: no pose found."
NO_POSE = 10.0
"""Where it is drawn that there is none, which is as bad as can be."""
TITLE = "Error of double precision against what is extreme"
MARKS = (
    ("double precision, count right", "double_error", True, "o", "#385880"),
    ("double precision, count wrong", "double_error", False, "X", "#c1440e"),
    ("ptmcad, middle of the enclosure", "error", None, "_", "#45917d"),
)
"""What is drawn: label, number, of which rows by whether the double's count is right, mark and
colour.
"""


def draw_stress(outcomes: Sequence[Row]) -> Any:
    """One small plot for each family of points; the figure's label is its description."""
    from ptmcad.studies.picture import Curve, draw  # brings matplotlib

    points = [o for o in outcomes if o["condition"] is not None or o["error"] is not None]
    double, ours = (sum(not o[key] for o in points) for key in ("double_right", "right"))
    found = f"{len(points)} cases; the count of double precision is wrong in {double}, ptmcad's in {ours}."
    panels: dict[str, list[Curve]] = {o["family"]: [] for o in points}
    for family, curves in panels.items():
        for label, key, right, marker, color in MARKS:
            marks = []
            for o in points:
                if o["family"] == family and right in (None, o["double_right"]):
                    x = float(Fraction(o["stiffness"]))
                    y = NO_POSE if o[key] is None else max(o[key], MIN_DRAWN_ERROR)
                    marks.append((x, y, x, x, ""))
            style = {"marker": marker, "color": color, "linestyle": "none"}
            curves.append(Curve(label, style, marks))
    return draw(TITLE, "", "error", panels, (NOTE, found))
