"""What a certified result's plan says of savings, against the curves that were searched."""

from __future__ import annotations

from collections.abc import Iterable

import pytest
from support.shipped_records import FREE, OTHER_FREE

pytest.importorskip("numba")

from support.replacing import replace

import ptmcad
from ptmcad.answer.regionmap import PlanStep
from ptmcad.certified.plain.criticalcurves import curves
from ptmcad.certified.plain.problem import problem_of
from ptmcad.certified.plain.straight import branches
from ptmcad.certified.refinement import CriticalCurve
from ptmcad.certified.statement import plan_of
from ptmcad.question.counts import Count
from ptmcad.question.domain import proved
from ptmcad.question.savings import ALL, switched_off
from ptmcad.question.slice import Slice

SWITCHES = (
    ("folds-of-saddles",),
    ("cones-and-creases",),
    ("dependent-equations",),
    ("mirror-images",),
    ("cones-and-creases", "mirror-images"),
)
RECORDS = {path.stem: path for path in (*FREE, *OTHER_FREE)}
CASES = [
    *((name, Count.STABLE, without) for name in RECORDS for without in ((), (ALL,))),
    *(
        (name, Count.STABLE, without)
        for name in ("free02", "free02-unloaded", "four-bar-free")
        for without in SWITCHES
    ),
    *((name, Count.TOTAL, ()) for name in ("free02", "free02-unloaded", "four-bar-free")),
]


def searched(slice: Slice, without: Iterable[str]) -> tuple[CriticalCurve, ...]:
    return curves(slice, slice.count, switched_off(without, certified=True))


def of_cones(found: Iterable[CriticalCurve]) -> list[str]:
    return [
        c.name for c in found if c.name.startswith(("point where spring ", "crease where spring "))
    ]


def formulas(found: Iterable[CriticalCurve]) -> list[int]:
    """How many formulas vanish at each curve, that are tested on each box."""
    own = [curve.system.arguments for curve in found]
    return [len(s.cheap) + len(s.rest) + len(s.costly) for s in own]


def steps_of(
    slice: Slice, found: tuple[CriticalCurve, ...], without: Iterable[str]
) -> dict[str, PlanStep]:
    steps = plan_of(slice, found, switched_off(without, certified=True))
    return {step.saving: step for step in steps if step.saving}


@pytest.mark.parametrize(("name", "count", "without"), CASES, ids=str)
def test_what_is_said_to_be_left_out_is_left_out(
    name: str, count: Count, without: tuple[str, ...]
) -> None:
    """And what is left out is said to be, or there is nothing of it."""
    slice = proved(replace(ptmcad.load(RECORDS[name]), count=count))
    found = searched(slice, without)
    steps = steps_of(slice, found, without)
    left = {name for name, step in steps.items() if not step.done}
    kept = {name for name, step in steps.items() if step.done}
    assert kept <= switched_off(without, certified=True)
    assert not left & switched_off(without, certified=True)
    of_folds = [curve.name for curve in found if curve.name.startswith(("fold", "pitchfork"))]
    assert of_folds
    minima = [name for name in of_folds if "of a stable equilibrium" in name]
    assert minima == (of_folds if "folds-of-saddles" in left else [])
    springs = [b.cones for b in branches(problem_of(slice), slice.axes)]
    assert bool(of_cones(found)) == (any(springs) and "cones-and-creases" not in left)
    assert any("its own image" in n or n == "pitchfork" for n in of_folds) == (
        "mirror-images" in left
    )
    more = formulas(searched(slice, (*without, "dependent-equations")))
    assert (sum(more) < sum(formulas(found))) == ("dependent-equations" in left)


def test_the_shipped_records_have_every_case() -> None:
    """Records of which each saving is made, and others of which it is not."""
    made = {}
    for name in ("free02", "free02-unloaded", "four-bar-free"):
        slice = proved(ptmcad.load(RECORDS[name]))
        steps = steps_of(slice, searched(slice, ()), ())
        made[name] = {saving for saving, step in steps.items() if not step.done}
    assert made["free02"] >= {"folds-of-saddles", "cones-and-creases", "dependent-equations"}
    assert "mirror-images" in made["free02-unloaded"]
    assert "cones-and-creases" not in made["free02-unloaded"]
    assert made["four-bar-free"] == {"imports"}
