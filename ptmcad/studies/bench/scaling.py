"""How cost grows: families of slices, each growing in one respect, as whole processes, with fitted exponents.

Guarantee: the numbers of regions of the slices are known from how they are made, and a run that
finds another number is a failure. The same measurements give the same fits.

A parameter p becomes p + q(x, y) with a dense polynomial q that is small enough for the picture to
stay, so that the degree of the curves grows alone; numbers get more digits; and Chebyshev polynomials
fold the window: T_n maps each of the n intervals between neighbouring points cos(i pi / n) onto
[-1, 1]. Without loads the stable count is 2 where |L2 - L1| < 2 rho < L2 + L1, and 1 elsewhere.
"""

from __future__ import annotations

import argparse
import json
import random
import tempfile
from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from functools import partial
from pathlib import Path
from statistics import median
from typing import Any, NamedTuple

import numpy as np

from ptmcad.errors import PtmcadError
from ptmcad.show.render.printing import save
from ptmcad.studies.bench.harness import PTMCAD, Job, Row
from ptmcad.studies.bench.process import Usage
from ptmcad.studies.bench.records import turns
from ptmcad.text.expressions import Expression, Term, axis, constant
from ptmcad.text.terms import signed_terms

SHIFT = Fraction(1, 100)
"""What a bend's coefficients' moduli add up to at most: the window's edge meets the same curves in the same order."""
MAX_COEFFICIENT, DIGITS = 9, 400
BEND, STRAIGHT, FLAT = 0.35, 0.9, 1.3
"""The halves' slopes differ when their difference exceeds the first; R^2 from which a line is one; a quantity whose
largest value is less than the third times its smallest does not grow."""

Record = dict[str, Any]


class Family(NamedTuple):
    """One family: what grows, its sizes, the record for a size and a seed, and its number of regions."""

    title: str
    sizes: tuple[int, ...]
    record: Callable[[int, int], Record]
    regions: Callable[[int], int]


def _record(axes: dict[str, tuple[str, str]], **parameters: Any) -> Record:
    values = {name: str(value) for name, value in parameters.items()}
    windows = {name: list(ends) for name, ends in axes.items()}
    return {"mechanism": "ptm", "parameters": {"L1": "1", "k": "100"} | values, "axes": windows}


def written(e: Expression) -> str:
    """A polynomial in the axes x and y as a record has it."""
    return " ".join(signed_terms((((i, j), c) for i, j, c in e.numerator), "xy", number=str))


def chebyshev(n: int, x: Expression) -> Expression:
    """T_n(x), by its recurrence T_(n+1) = 2 x T_n - T_(n-1)."""
    before, last = x, constant(1)  # T_(-1) = T_1
    for _ in range(n):
        before, last = last, 2 * x * last - before
    return last


def bend(n: int, seed: int) -> Expression:
    """A dense polynomial of total degree n whose coefficients' moduli add up to at most `SHIFT`."""
    source = random.Random(f"bend {n} {seed}")
    powers = [(i, j) for i in range(n + 1) for j in range(n + 1 - i)]
    scale = SHIFT / (MAX_COEFFICIENT * len(powers))
    sizes = ((i, j, source.choice((-1, 1)) * source.randint(1, MAX_COEFFICIENT)) for i, j in powers)
    terms: list[Term] = [(i, j, scale * c) for i, j, c in sizes]
    return Expression(tuple(sorted(terms)))


def unloaded(n: int, seed: int) -> Record:
    """No loads, rho = 1 + x, L2 = 1 + y + q(x, y): three curves, dense, of total degree n each; four regions."""
    ends = ("-9/10", "19/20")
    return _record({"x": ends, "y": ends}, rho="1 + x", L2=written(1 + axis(1) + bend(n, seed)))


def digits(n: int, seed: int) -> Record:
    """Equal bars and loads as in the paper's figure 3, with numbers of about n digits for L, k and F/y."""
    source = random.Random(f"digits {seed}")
    length, stiffness, force = ("".join(source.choice("1379") for _ in range(DIGITS))[:n] for _ in range(3))
    bar, load = f"1.00{length}", f"1.00{force}*F"
    axes = {"rho": ("0", "2"), "F": ("-10", "0")}
    return _record(axes, L1=bar, L2=bar, k=f"100.00{stiffness}", F3=load, F4=load)


def fold(n: int, seed: int = 0) -> Record:
    """rho = y and L2 = 1 + T_n(x)/2: n folds along x, over -1 < x < 1 and 0 < y < 2."""
    return _record({"x": ("-1", "1"), "y": ("0", "2")}, rho="y", L2=written(1 + chebyshev(n, axis(0)) / 2))


def grid(n: int, seed: int = 0) -> Record:
    """L2 = 1 + T_n(x)/2 and rho = 1/2 + T_n(y)/3: n by n copies, mirrored in turn, of one square."""
    rho, bar = Fraction(1, 2) + chebyshev(n, axis(1)) / 3, 1 + chebyshev(n, axis(0)) / 2
    return _record({"x": ("-1", "1"), "y": ("-1", "1")}, rho=written(rho), L2=written(bar))


def regions_of_grid(n: int) -> int:
    """One region of two stable poses, and one around each corner of the copies but those where L2 and rho are largest.

    In the square -1 < a, b < 1 with L2 = 1 + a/2, rho = 1/2 + b/3 the three lines cut off the corners (-1, 1), (1, -1)
    and (-1, -1), each by a triangle; copies that share a corner are mirrored there, so their triangles join.
    """
    even = n // 2 + 1
    return 1 + (n + 1) ** 2 - even**2


FAMILIES = {
    "degree": Family("Degree of the curves: no loads", (2, 4, 6, 8, 12, 16), unloaded, lambda n: 4),
    "digits": Family("Digits of each parameter", (5, 10, 25, 50, 100, 200), digits, lambda n: 3),
    # below 2 rho = |T_n|/2 one region on either side of each of the n zeros; that of two; that above
    "fold": Family("Folds along one axis", (2, 4, 8, 16, 32), fold, lambda n: n + 3),
    "grid": Family("Folds along both axes", (2, 3, 4, 5, 6), grid, regions_of_grid),
}  # fmt: skip


def measure(options: argparse.Namespace) -> list[Row]:
    """The families' rows: what each size takes, and the exponents that fit.

    Raises
    ------
    PtmcadError
        When there is no such family.
    """
    names = options.families or list(FAMILIES)
    unknown = [name for name in names if name not in FAMILIES]
    if unknown:
        raise PtmcadError(f"no family {unknown[0]!r}; there are {', '.join(FAMILIES)}")
    measured: list[tuple[str, int, Job, list[Mapping[str, float]]]] = []
    with tempfile.TemporaryDirectory() as folder:
        for name in names:
            family = FAMILIES[name]
            for n in family.sizes:
                record = Path(folder, f"{name}-{n}.json")
                data = {"name": record.stem, **family.record(n, options.seed)}
                record.write_text(json.dumps(data), encoding="utf-8")
                target = Path(folder, "out", record.name)
                command = (*PTMCAD, "classify", str(record), "--format", "json", "--out", str(target.parent))
                timings: list[Mapping[str, float]] = []
                check = partial(_checked, target, family.regions(n), timings)
                job = Job(name, family.title, str(n), ((command, ""),), target, check)
                measured.append((name, n, job, timings))
        turns([job for _, _, job, _ in measured], options)
    rows: list[Row] = []
    points: dict[tuple[str, str], list[tuple[float, float]]] = {}
    for name, n, job, timings in measured:
        row = job.row()
        for stage in timings[0] if timings else ():
            seconds = [run[stage] for run in timings]
            row[f"{stage} s"] = round(median(seconds), 5)
            points.setdefault((name, stage), []).extend((n, y) for y in seconds)
        rows.append(row)
    for (name, stage), found in points.items():
        law = fit(found)
        if law is not None:
            rows.append({"subject": name, "what": FAMILIES[name].title, "setting": f"fit: {stage}", **law})
    return rows


def _checked(target: Path, regions: int, timings: list[Mapping[str, float]], _: Usage) -> str:
    """Note the seconds of a map's stages; what is wrong with its number of regions."""
    found = json.loads(target.read_text(encoding="utf-8"))
    timings.append(found["timings"])
    number = len(found["regions"])
    return "" if number == regions else f"{number} regions"


def fit(points: Sequence[tuple[float, float]]) -> Row | None:
    """The power law y = c x^p through points, those with the same x having their median.

    Returns
    -------
    The exponent p by least squares in logarithms, the slopes over the lower and over the upper half
    of the range, of which the upper one predicts, and whether they agree. None when there are fewer
    than two different x, or something is not positive.
    """
    places = sorted({x for x, _ in points})
    heights = [median(y for x, y in points if x == place) for place in places]
    if len(places) < 2 or min(*places, *heights) <= 0:
        return None
    u, v = np.log(places), np.log(heights)
    # both halves hold the point next to the middle, so that they are joined
    joint = min(range(1, len(u) - 1), key=lambda k: abs(2 * u[k] - u[0] - u[-1]), default=len(u) - 1)
    parts = {"exponent": slice(None), "lower": slice(joint + 1), "upper": slice(joint % (len(u) - 1), None)}
    found = {name: float(np.polyfit(u[part], v[part], 1)[0]) for name, part in parts.items()}
    rise = found["upper"] - found["lower"]
    if max(heights) < FLAT * min(heights):
        verdict = "does not grow"
    elif len(places) < 4:
        verdict = "too few sizes to tell"
    elif abs(rise) > BEND:
        verdict = f"the exponent {'rises' if rise > 0 else 'falls'}"
    else:
        verdict = "power law" if np.corrcoef(u, v)[0, 1] ** 2 >= STRAIGHT else "scattered"
    return {name: float(f"{value:.4g}") for name, value in found.items()} | {"verdict": verdict}


def save_picture(rows: Sequence[Row], folder: Path) -> None:
    """Draw the seconds of the computation along all families into scaling.svg."""
    from ptmcad.studies.bench.picture import Curve, Spot, draw

    found: dict[str, list[Spot]] = {}
    for row in rows:
        if row.get("total s"):
            n, seconds = float(row["setting"]), row["total s"]
            found.setdefault(row["what"], []).append(Spot((n, n, n), (seconds, seconds)))
    if found:
        curves = [Curve(title, spots, style) for style, (title, spots) in enumerate(found.items())]
        figure = draw("How cost grows", "size", "seconds of the computation, medians", curves)
        save(figure, folder / "scaling.svg")
