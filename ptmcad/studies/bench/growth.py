"""How cost grows: families of slices, each growing in one respect, as whole processes, with a
fitted exponent.

Guarantee: the numbers of regions of the slices are known from how they are made, and a run that
finds another number is a failure. The same measurements give the same fits.

A parameter p becomes p + q(x, y) with a dense polynomial q that is small enough for the picture to
stay, so that the degree of the curves grows alone; and Chebyshev polynomials fold the window: T_n
maps each of the n intervals between neighbouring points cos(i pi / n) onto [-1, 1]. Without loads
the stable count is 2 where
|L2 - L1| < 2 rho < L2 + L1, and 1 elsewhere.
"""

from __future__ import annotations

import argparse
import json
import random
import tempfile
from collections.abc import Callable, Sequence
from fractions import Fraction
from functools import partial
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np
import pandas as pd

from ptmcad.errors import PtmcadError
from ptmcad.show.render.printing import save
from ptmcad.studies.bench.harness import Job, Row, classification, summary, turns
from ptmcad.studies.bench.process import Usage
from ptmcad.studies.picture import STYLES, Curve, draw

SHIFT = Fraction(1, 100)
"""What a bend's coefficients' moduli add up to at most: the window's edge meets the same curves in
the same order.
"""
MAX_COEFFICIENT = 9


def _record(axes: dict[str, Sequence[Any]], **parameters: Any) -> Row:
    return {"mechanism": "ptm", "parameters": {"L1": 1, "k": 100, **parameters}, "axes": axes}


def unloaded(n: int, seed: int) -> Row:
    """No loads, rho = 1 + x, L2 = 1 + y + q(x, y): three curves, dense, of total degree n each;
    four regions.
    """
    source = random.Random(f"bend {n} {seed}")
    rows = [range(n + 1 - i) for i in range(n + 1)]  # of the powers of y, for each power of x
    scale = SHIFT / (MAX_COEFFICIENT * sum(map(len, rows)))
    sizes = (
        [source.choice((-1, 1)) * source.randint(1, MAX_COEFFICIENT) for _ in row] for row in rows
    )
    terms = (
        f"x^{i}*({' + '.join(f'({c * scale})*y^{j}' for j, c in enumerate(row))})"
        for i, row in enumerate(sizes)
    )
    ends = ["-9/10", "19/20"]
    return _record({"x": ends, "y": ends}, rho="1 + x", L2=" + ".join(["1 + y", *terms]))


def fold(n: int, seed: int = 0) -> Row:
    """rho = y and L2 = 1 + T_n(x)/2: n folds along x, over -1 < x < 1 and 0 < y < 2; n is at most
    40.
    """
    powers = enumerate(
        np.polynomial.chebyshev.cheb2poly([0] * n + [1])
    )  # in doubles, and whole up to n = 40
    terms = " + ".join(f"({c:.0f})*x^{k}" for k, c in powers if c)
    return _record({"x": [-1, 1], "y": [0, 2]}, rho="y", L2=f"1 + ({terms})/2")


FAMILIES: dict[
    str, tuple[str, tuple[int, ...], Callable[[int, int], Row], Callable[[int], int]]
] = {
    "degree": ("Degree of the curves: no loads", (2, 4, 6, 8, 12, 16), unloaded, lambda n: 4),
    # below 2 rho = |T_n|/2 one region on either side of each of the n zeros; that of two; that
    # above
    "fold": ("Folds along one axis", (2, 4, 8, 16, 32), fold, lambda n: n + 3),
}  # fmt: skip
"""Of each family what grows, its sizes, the record for a size and a seed, and its number of
regions.
"""


def measure(options: argparse.Namespace) -> pd.DataFrame:
    """The families' rows: what each size takes, the computation alone too, and the exponent that
    fits it.

    Raises
    ------
    PtmcadError
        When there is no such family.
    """
    names = options.names or list(FAMILIES)
    unknown = [name for name in names if name not in FAMILIES]
    if unknown:
        raise PtmcadError(f"no family {unknown[0]!r}; there are {', '.join(FAMILIES)}")
    jobs = []
    with tempfile.TemporaryDirectory() as folder:
        for name, (title, sizes, record, regions) in ((n, FAMILIES[n]) for n in names):
            for n in sizes:
                path = Path(folder, f"{name}-{n}.yaml")
                text = json.dumps({"name": path.stem, **record(n, options.seed)})
                path.write_text(text, encoding="utf-8")
                asked = classification(path, path.stem, Path(folder), "--format", "json")
                check = partial(_unlike, regions(n))
                jobs.append(Job(name, title, str(n), **asked, check=check))
        turns(jobs, options)
    taken = [[json.loads(usage.output)["timings"]["total"] for usage in job.usages] for job in jobs]
    rows = summary(jobs).assign(
        computing=pd.Series([median(s) if s else None for s in taken], dtype=float).round(5)
    )
    known = rows.dropna(subset="computing").astype({"setting": int})
    laws = [
        {"subject": name, "what": what, "setting": "fit", "exponent": exponent(own)}
        for (name, what), own in known.groupby(["subject", "what"], sort=False)
    ]
    return pd.concat([rows, pd.DataFrame(laws)], ignore_index=True)


def _unlike(regions: int, usage: Usage) -> str:
    """What is wrong with a map's number of regions."""
    found = len(json.loads(usage.output)["regions"])
    return "" if found == regions else f"{found} regions"


def exponent(rows: pd.DataFrame) -> float | None:
    """The p of the power law y = c x^p through sizes and positive seconds, by least squares in
    logarithms.

    None when there are fewer than two.
    """
    if len(rows) < 2:
        return None
    return float(f"{np.polyfit(np.log(rows['setting']), np.log(rows['computing']), 1)[0]:.4g}")


def save_picture(rows: pd.DataFrame, folder: Path) -> None:
    """Draw the seconds of the computation along all families into scaling.svg."""
    known = rows.dropna(subset="computing").groupby("what", sort=False)
    curves = [
        Curve(
            str(title),
            style,
            [
                (n, s, n, n, "")
                for n, s in zip(own["setting"].astype(float), own["computing"], strict=True)
            ],
        )
        for style, (title, own) in zip(STYLES, known, strict=False)
    ]
    if curves:
        figure = draw("How cost grows", "size", "seconds of the computation, medians", {"": curves})
        save(figure, folder / "scaling.svg")
