"""The families whose cost is measured: each grows in one respect, given by its size, and is held fixed in the others.

Guarantee: `Family.measure` depends on size and seed alone, but for the time and memory that it takes.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from fractions import Fraction
from importlib import import_module
from typing import Any

from ptmcad.errors import PtmcadError
from ptmcad.options import Options
from ptmcad.question.slice import Count, Slice
from ptmcad.studies.bench.scaling.folds import fold, grid, regions_of_fold, regions_of_grid, window_of_fold
from ptmcad.studies.bench.scaling.measurement import Run, Stages
from ptmcad.studies.bench.scaling.slices import digits, loaded, unloaded
from ptmcad.studies.slices import ptm_slice
from ptmcad.text.flint_numbers import from_fraction

Measure = Callable[[int, int], Sequence[Run]]
DESIGNS = 150
"""Designs that are drawn for the numbers of equilibria."""
KNOWN_DESIGNS = (
    ("0.96859", "1.00609", "0.2", "-10"),
    ("1.20609", "1", "1.01487", "-10"),
    ("0.75609", "1", "1.43487", "0"),
)
"""rho, L2, l0, load: 12, 26 and 30 equilibria."""


@dataclass(frozen=True, slots=True)
class Family:
    """One family.

    Attributes
    ----------
    title : what grows, for headings.
    against : what the cost is plotted and fitted against: ``size`` or a name among what runs have found.
    axis : that in words, for pictures.
    sizes : from small to large.
    heavy : sizes that are run in the first round only.
    measure : the runs for a size and a seed, in the present process.
    certified : whether it needs the certified engine's compiled code.
    expected : what theory lets expect, for the report.
    wall : whether wall time is fitted too, which on a shared machine says less.
    """

    name: str
    title: str
    against: str
    axis: str
    sizes: tuple[int, ...]
    measure: Measure
    expected: str
    heavy: tuple[int, ...] = ()
    certified: bool = False
    wall: bool = False


def exact(size: int, slice: Slice, regions: int | None = None) -> tuple[Run]:
    """One exact map, stage by stage.

    Parameters
    ----------
    regions : how many there have to be.

    Raises
    ------
    PtmcadError
        When there are not so many.
    """
    from ptmcad.exact.engine import exact_map

    watch = Stages()
    result = exact_map(slice, Options(progress=lambda stage, done, total: watch.begin(stage)))
    used = [c.polynomial for c in result.components if not c.left_out]
    run = watch.run(
        size,
        {
            "regions": len(result.regions),
            "cells": len(result.cells),
            "critical values": len(result.critical_values),
            "degree": max(p.total_degree for p in used),
            "bits of a coefficient": max(abs(c).bit_length() for p in used for _, _, c in p.terms),
        },
    )
    if regions is not None and len(result.regions) != regions:
        raise PtmcadError(f"{slice.name} has {len(result.regions)} regions, not {regions}")
    return (run,)


def design_slice(free: str, load: str) -> Slice:
    """Equal springs of free length l0 and equal loads, over rho and L2."""
    return ptm_slice("design", {"rho": ("1/10", 2), "L2": ("1/10", 2)}, L1=1, k=100, l0=free, F3=load, F4=load)


def designs(seed: int) -> tuple[tuple[str, str, str, str], ...]:
    """rho, L2, l0 and load of the designs: the known ones, and others with bars unequal or equal in turn."""
    source = random.Random(f"designs {seed}")

    def number(low: int, high: int) -> str:
        return str(Fraction(source.randint(low, high), 1000))

    drawn = [(number(300, 1900), number(300, 1900) if k % 2 else "1", number(20, 1500), "-10") for k in range(DESIGNS)]
    return (*KNOWN_DESIGNS, *drawn)


def equilibria(size: int, seed: int) -> tuple[Run, ...]:
    """The proved equilibria of every design, each a run; a design that is not decided has no run."""
    from ptmcad.certified.plain.points import plain_counter

    runs = []
    for rho, bar, free, load in designs(seed):
        counter = plain_counter(design_slice(free, load))
        watch = Stages()
        found = counter.at(Fraction(rho), Fraction(bar), Count.TOTAL)
        if found.decided and found.total is not None:
            runs.append(watch.run(size, {"equilibria": found.total}))
    return tuple(runs)


def fibres(size: int, seed: int) -> tuple[Run, ...]:
    """The equilibria of every design without its free length, by algebra: four or six."""
    from ptmcad.algebra.polynomials import from_expression
    from ptmcad.exact.counting import equilibria as equilibria_at
    from ptmcad.exact.models import system_of
    from ptmcad.exact.stages import point_values

    slice = design_slice("0", "-10")
    system = system_of(slice.mechanism)
    parameters = {name: from_expression(slice.parameters[name]) for name in system.ring.parameters}
    runs = []
    for rho, bar, _, _ in designs(seed):
        values = point_values(parameters, (from_fraction(Fraction(rho)), from_fraction(Fraction(bar))))
        watch = Stages()
        found = equilibria_at(system, values)
        runs.append(watch.run(size, {"equilibria": found.counts.total}))
    return tuple(runs)


def certified_window() -> Slice:
    """A part of the record free02 with several regions, away from rho = 0."""
    return ptm_slice("window", {"rho": ("1/2", "3/2"), "L2": ("11/10", 2)}, L1=1, k=100, l0="1/5", F3=-10, F4=-10)


@contextmanager
def _treated_boxes() -> Iterator[list[int]]:
    """How many boxes each call of the search inside treats: the engine's own progress tells shares only."""
    refinement: Any = import_module("ptmcad.certified.refinement")
    used: list[int] = []
    search = refinement.search_curve

    def counting(*arguments: Any) -> Any:
        found = search(*arguments)
        used.append(found.used)
        return found

    refinement.search_curve = counting
    try:
        yield used
    finally:
        refinement.search_curve = search


def tolerances(size: int, seed: int) -> tuple[Run]:
    """One certified map with the tolerance 1 / size, by one thread."""
    from ptmcad.certified.engine import certified_map
    from ptmcad.certified.loading import load

    load()  # compiles, once in a process: neither its time nor its steps are the map's
    watch = Stages()
    watch.begin("map")
    with _treated_boxes() as used:
        result = certified_map(certified_window(), Options(tolerance=Fraction(1, size), jobs=1))
    if result.undetermined * size > 1:
        raise PtmcadError(f"{float(result.undetermined):.3g} is undetermined, more than 1/{size}")
    rectangles = 0 if result.cover is None else len(result.cover.rectangles)
    return (watch.run(size, {"boxes": sum(used), "rectangles of the cover": rectangles, "cells": len(result.cells)}),)


def threads(size: int, seed: int) -> tuple[Run]:
    """One certified map with ``size`` threads."""
    from ptmcad.certified.engine import certified_map

    watch = Stages()
    result = certified_map(certified_window(), Options(tolerance=Fraction(1, 400), jobs=size))
    return (watch.run(size, {"cells": len(result.cells)}),)


def _exact(make: Callable[[int, int], Slice], regions: Callable[[int], int]) -> Measure:
    return lambda size, seed: exact(size, make(size, seed), regions(size))


FAMILIES = (
    Family("degree", "Degree of the curves: no loads", "degree", "total degree of each curve",
           (2, 4, 6, 8, 12, 16, 20), _exact(unloaded, lambda n: 4),
           "at most 6; products of dense polynomials in two variables 4, resultants 5 to 6, memory 2", heavy=(20,)),
    Family("degree-loaded", "Degree of the curves: loads", "degree", "total degree of each curve", (1, 2, 3, 4),
           _exact(loaded, lambda n: 2), "as without loads", heavy=(4,)),
    Family("digits", "Height of the numbers", "size", "digits of each parameter", (5, 10, 25, 50, 100, 200, 400),
           _exact(digits, lambda n: 3),
           "2 with the schoolbook's multiplication, 1.6 with Karatsuba's, towards 1 with faster ones; memory 1",
           heavy=(200, 400)),
    Family("window", "Number of cells, the curves staying the same", "cells", "cells in the window",
           (2, 4, 8, 16, 24, 32), _exact(lambda n, seed: window_of_fold(n), regions_of_fold),
           "1: every cell costs the same"),
    Family("fold", "Number of regions: one axis folded", "regions", "regions (degree grows alike)",
           (2, 4, 8, 16, 24, 32), _exact(lambda n, seed: fold(n), regions_of_fold),
           "1 for the cells, times 1 to 2 for the degree of what is isolated for each of them"),
    Family("grid", "Number of regions: both axes folded", "regions", "regions (about n^2, at degree n)",
           (2, 3, 4, 5, 6, 8), _exact(lambda n, seed: grid(n), regions_of_grid),
           "1 for the cells, times 1/2 to 1 for the degree, which is the square root of their number", heavy=(8,)),
    Family("equilibria", "Number of equilibria at a point, with free lengths", "equilibria", "equilibria", (1,),
           equilibria, "1: every solution is enclosed, on top of the proof that there are no others", certified=True),
    Family("fibres", "Number of equilibria at a point, by algebra", "equilibria", "equilibria", (1,), fibres,
           "0: there are always six complex solutions"),
    Family("tolerance", "Tolerance of certified maps", "size", "1 / tolerance", (20, 100, 500, 2500, 12500, 62500),
           tolerances,
           "a fixed cost, the search for the curves; beyond it 1 for square boxes along them, 1/2 for flat strips",
           heavy=(12500, 62500), certified=True),
    Family("threads", "Threads of the certified engine", "size", "threads", (1, 2), threads,
           "wall time -1 where processors are idle, processor time 0", certified=True, wall=True),
)  # fmt: skip


def families_named(names: Sequence[str] = ()) -> tuple[Family, ...]:
    """The families of these names, all when there are none.

    Raises
    ------
    PtmcadError
        When there is no such family.
    """
    unknown = [name for name in names if name not in {f.name for f in FAMILIES}]
    if unknown:
        raise PtmcadError(f"no family {unknown[0]!r}; there are {', '.join(f.name for f in FAMILIES)}")
    return tuple(f for f in FAMILIES if not names or f.name in names)


def warm_up(certified: bool) -> None:
    """Load the code that families run, so that a measurement does not count it."""
    exact(2, fold(2))
    if certified:
        from ptmcad.certified.engine import certified_map
        from ptmcad.certified.plain.points import plain_counter

        plain_counter(design_slice("1/5", "-10")).at(Fraction(1), Fraction(3, 2), Count.TOTAL)
        certified_map(certified_window(), Options(tolerance=Fraction(1, 4), jobs=1))


def touch(certified: bool) -> None:
    """A small run of the same code: a forked child gets its pages one by one when it first uses them."""
    if certified:
        from ptmcad.certified.plain.points import plain_counter

        plain_counter(design_slice("1/5", "-10")).at(Fraction(1), Fraction(3, 2), Count.TOTAL)
    else:
        exact(2, fold(2))
