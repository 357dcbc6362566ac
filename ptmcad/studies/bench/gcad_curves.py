"""gcad's open decomposition of the window by the finished curves: what it does of the work, the curves being given.

Guarantee: none of its own; cells are gcad's. It runs as ``python -m ptmcad.studies.bench.gcad_curves QUESTION curves
RESULT``.

gcad takes inequalities, so the product of the curves is asked to be positive, and then negative, in the window. It
knows neither counts nor which cells are neighbours.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from time import perf_counter
from typing import Any

import sympy


def cells(question: dict[str, Any]) -> dict[str, int]:
    """The number of cells over the window, in stacks over the question's base: all, and once they are merged."""
    import gcad  # an optional package

    symbols = sympy.symbols("x y")
    product = sympy.prod(
        sum(sympy.Integer(c) * symbols[0] ** i * symbols[1] ** j for i, j, c in terms) for terms in question["curves"]
    )
    window = [
        relation
        for s, (low, high) in zip(symbols, question["rational_window"], strict=True)
        for relation in (s - sympy.Rational(low) > 0, sympy.Rational(high) - s > 0)
    ]
    order = list(symbols) if question["base"] == 0 else list(symbols)[::-1]
    sides = [gcad.GCAD([*window, side], order) for side in (product > 0, product < 0)]
    return {"open": sum(map(len, sides)), "cells": sum(len(gcad.merge(side)) for side in sides)}


def main(arguments: list[str]) -> None:
    """Read the question, decompose, write the number of cells and print the seconds that it took."""
    question = json.loads(Path(arguments[0]).read_text(encoding="utf-8"))
    start = perf_counter()
    found = cells(question)
    seconds = perf_counter() - start
    Path(arguments[2]).write_text(json.dumps(found), encoding="utf-8")
    print(json.dumps({"computing": seconds}))


if __name__ == "__main__":
    main(sys.argv[1:])
