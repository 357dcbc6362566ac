"""What the programs are asked about a slice, as texts; made in a process of its own, because it loads the engine.

Guarantee: the elimination system is that of ``ptmcad variety --format msolve``, the session for QEPCAD that of
``ptmcad variety --format qepcad`` with the map's base axis first. Systems at points are its equations without the last
one, the Hessian's determinant, at these values of the axes.
"""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from random import Random

from ptmcad.answer.regionmap import RegionMap
from ptmcad.answer.slicevariety import EliminationSystem, SliceVariety, Term
from ptmcad.exact.models.elimination import elimination_system
from ptmcad.exact.slicevariety import slice_variety
from ptmcad.exact.stages import domain_limits, problem_of
from ptmcad.question.config import load
from ptmcad.question.slice import Slice
from ptmcad.show.polynomial_text import Style, symbols
from ptmcad.studies.bench import methods
from ptmcad.studies.bench.ablation import exchanged
from ptmcad.studies.bench.systems.exchange import Question
from ptmcad.text.plane import PlanePolynomial
from ptmcad.text.terms import terms_text

_DENOMINATOR = 97


def names(records: Sequence[Path]) -> tuple[str, ...]:
    """The slices' names.

    Raises
    ------
    ConfigError
        When a record cannot be read.
    """
    return tuple(load(record).name for record in records)


def question(record: Path, answer: Path | None, points: int) -> Question:
    """What is asked about a record's slice.

    Parameters
    ----------
    answer : ptmcad's map, None when it was not done in time: then nothing is known of the curves.
    points : how many, at most.

    Raises
    ------
    PtmcadError
        When the record is wrong, or its slice is degenerate.
    """
    slice = load(record)
    result = None if answer is None else RegionMap.from_json(answer.read_text(encoding="utf-8"))
    variety = None if result is None else slice_variety(slice)
    system = _system(slice) if variety is None else variety.system
    chosen = _random_points(slice, points) if result is None else _samples(result, points)
    variables = symbols((*system.unknowns, *system.axes), Style.MSOLVE)
    return Question(
        slice.name,
        slice.axis_names,
        {} if result is None else _facts(result),
        msolve_text(variables, system.texts(variables)),
        len(system.unknowns),
        tuple((str(x), str(y)) for x, y in chosen),
        tuple(at_point(system, point, variables[: len(system.unknowns)]) for point in chosen),
        "" if variety is None or result is None else _from_base(variety, result.base).text("qepcad"),
        "" if result is None else json.dumps({**json.loads(methods.question(slice, result)), "parameters": {}}),
    )


def msolve_text(variables: Sequence[str], polynomials: Sequence[str]) -> str:
    """A system over Q in msolve's form."""
    return f"{','.join(variables)}\n0\n" + ",\n".join(p.replace(" ", "") for p in polynomials) + "\n"


def at_point(system: EliminationSystem, point: tuple[Fraction, Fraction], unknowns: Sequence[str]) -> str:
    """The equations at a point as text for msolve, each multiplied to be integral."""
    equations = (_at(polynomial, point) for polynomial in system.polynomials[:-1])
    return msolve_text(unknowns, [terms_text(equation, tuple(unknowns)) for equation in equations if equation])


def _at(polynomial: Sequence[Term], point: tuple[Fraction, Fraction]) -> list[tuple[tuple[int, ...], int]]:
    found: dict[tuple[int, ...], Fraction] = {}
    for (*powers, i, j), c in polynomial:
        monomial = tuple(powers)
        found[monomial] = found.get(monomial, Fraction(0)) + c * point[0] ** i * point[1] ** j
    scale = math.lcm(*(c.denominator for c in found.values()))
    return [(monomial, int(c * scale)) for monomial, c in found.items() if c]


def _system(slice: Slice) -> EliminationSystem:
    """That of the slice's variety, without the variety: nothing that an inequality excludes is left out."""
    problem = problem_of(slice)
    limits = domain_limits(problem.system, problem.parameters)
    return elimination_system(problem.system, problem.parameters, slice.axis_names, limits, False)


def _samples(result: RegionMap, number: int) -> list[tuple[Fraction, Fraction]]:
    """Samples of cells from all over the map."""
    number = min(number, len(result.cells))
    cells = (result.cells[k * len(result.cells) // number] for k in range(number))
    return [(cell.sample[0], cell.sample[1]) for cell in cells]


def _random_points(slice: Slice, number: int) -> list[tuple[Fraction, Fraction]]:
    random = Random(slice.name)

    def between(low: Fraction, high: Fraction) -> Fraction:
        return low + (high - low) * Fraction(random.randrange(1, _DENOMINATOR), _DENOMINATOR)

    x, y = slice.axes
    return [(between(x.low, x.high), between(y.low, y.high)) for _ in range(number)]


def _from_base(variety: SliceVariety, base: int) -> SliceVariety:
    """The variety with the map's base as first axis."""
    if base == 0:
        return variety
    turned = (
        replace(c, polynomial=PlanePolynomial.of((j, i, a) for i, j, a in c.polynomial.terms))
        for c in variety.components
    )
    return replace(variety, slice=exchanged(variety.slice), components=tuple(turned))


def _facts(result: RegionMap) -> dict[str, int]:
    used = [c.polynomial.total_degree for c in result.components if not c.left_out]
    return {
        "complex solutions": result.complex_solutions,
        "curves": len(used),
        "degree": sum(used),
        "base": result.base,
        "cells": len(result.cells),
        "regions": len(result.regions),
    }
