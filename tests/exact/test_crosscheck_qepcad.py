"""Every shipped slice against QEPCAD: its decomposition of the window, and the number of equilibria
as a formula.
"""

from __future__ import annotations

from fractions import Fraction
from functools import cache

import pytest
from support.few import few
from support.maps import shipped
from support.programs import ProgramError, needs_qepcad, needs_singular, qepcad_session
from support.qepcad_cells import (
    DISPLAY,
    Decomposition,
    compare,
    decided,
    decomposition,
    exactly,
    indices,
    window_cad,
)
from support.replacing import replace
from support.sextic_question import Question, Task, Terms, question
from support.singular_slice import SHIPPED, axes, counting_formulas

from ptmcad import RegionMap
from ptmcad.answer.regionmap import CriticalValue, Kind, Stack, Status, Wall
from ptmcad.text.plane import PlanePolynomial

pytestmark = needs_qepcad

QUICK = ("fig2", "fig3", "fig4", "rods")
"""Slices that QEPCAD decomposes in about two seconds or less."""
LIFTED = ("fig2", "fig3", "forces", "rods")
"""Slices on which QEPCAD lifts over the sections of the base axis too in seconds; fig. 4 takes it
over a minute.
"""
WITH_SEXTIC = tuple(name for name in SHIPPED if name != "fig2")
"""On fig. 2 theta2 = pi is an equilibrium everywhere, which t2 = tan(theta2/2) loses: see
`support.sextic_question`.
"""


def slow_unless(names: tuple[str, ...], quick: tuple[str, ...]) -> list[object]:
    return [name if name in quick else pytest.param(name, marks=pytest.mark.slow) for name in names]


# ------------------------------------------------------------------------------------------------ the open CAD


@cache
def cad(name: str) -> Decomposition:
    return window_cad(shipped(name))


@pytest.mark.parametrize("name", slow_unless(SHIPPED, ("fig2", "fig3", "rods")))
@pytest.mark.slow_cases("rods", "fig3")
def test_open_cad_is_that_of_qepcad(name: str) -> None:
    """Critical values, walls of every stack with their components, and the number of open cells.

    That QEPCAD has no further sections in the window is a fact about these slices, not a theorem:
    see `compare`.
    """
    result = shipped(name)
    found = compare(result, cad(name))
    assert (found.qepcad_stacks, found.qepcad_cells) == (len(result.stacks), len(result.cells))


@pytest.mark.parametrize("name", slow_unless(LIFTED, ("fig2", "fig3")))
@pytest.mark.slow_cases("fig3")
def test_no_branches_meet_over_further_sections(name: str) -> None:
    """The same with stacks over the critical values, where QEPCAD can."""
    assert compare(shipped(name), window_cad(shipped(name), full=True)).lifted


def nodal_cubic() -> RegionMap:
    """(y-2)^2 = (x-2)^2 (x-1) over [0, 4]^2: a vertical tangent at x = 1, the node at x = 2, the
    edges at x = 3.47.
    """
    curve = PlanePolynomial.of(
        ((0, 2, 1), (0, 1, -4), (3, 0, -1), (2, 0, 5), (1, 0, -8), (0, 0, 8))
    )
    values = (
        CriticalValue((-1, 1), Fraction(1), Fraction(1), "vertical tangent"),
        CriticalValue((-2, 1), Fraction(2), Fraction(2), "node"),
        CriticalValue((-8, 8, -5, 1), Fraction(3), Fraction(4), "edges"),
    )
    two = (Wall(0, 0), Wall(0, 1))
    stacks = tuple(
        Stack(
            n - 1 if n else None,
            n if n < 3 else None,
            Fraction(0),
            walls,
            tuple(range(len(walls) + 1)),
        )
        for n, walls in enumerate(((), two, two, ()))
    )
    fig2 = shipped("fig2")
    return replace(
        fig2,
        base=0,
        components=(replace(fig2.components[0], polynomial=curve),),
        critical_values=values,
        stacks=stacks,
        cells=(fig2.cells * 2)[:8],
    )


@pytest.mark.parametrize("full", [False, True])
@pytest.mark.slow_cases("True")
def test_nodal_cubic(full: bool) -> None:
    """Known by construction; compared are only the numbers of cells, so that any eight will do."""
    found = compare(nodal_cubic(), window_cad(nodal_cubic(), full=full))
    assert (found.stacks, found.cells, found.lifted) == (4, 8, full)


# ------------------------------------------------------------------------------------- the counting formula


def points(name: str) -> list[tuple[Fraction, Fraction]]:
    return [(cell.sample[0], cell.sample[1]) for cell in shipped(name).cells]


@needs_singular
@pytest.mark.parametrize("name", few(SHIPPED, "fig2", "fig4", "forces", "rods"))
@pytest.mark.slow_cases("fig4", "rods", "forces")
def test_index_at_every_sample_by_singular_and_qepcad(name: str) -> None:
    """Exactly so many minima, saddles and maxima as stored; no cell is left out."""
    assert axes(name) == shipped(name).slice.axis_names
    expected = [cell.index for cell in shipped(name).cells]
    assert all(index is not None for index in expected)
    assert indices(counting_formulas(name, points(name)), expected) == [(True, True, True)] * len(
        expected
    )  # type: ignore[arg-type]


def at_point(terms: Terms, point: tuple[Fraction, Fraction]) -> str:
    """A polynomial in x, y, t over a point, as a positive multiple with whole coefficients."""
    x, y = point
    degree = max(max(i, j) for i, j, _, _ in terms)
    scale = (x.denominator * y.denominator) ** degree
    coefficients: dict[int, Fraction] = {}
    for i, j, n, c in terms:
        coefficients[n] = coefficients.get(n, Fraction(0)) + scale * c * x**i * y**j
    return " ".join(
        f"{'+' if c > 0 else '-'} {abs(c)} t^{n}" for n, c in coefficients.items() if c
    ).removeprefix("+ ")


def sextic_counts(name: str, counts: list[tuple[int, int]]) -> list[bool]:
    """For each cell whether at its sample there are exactly so many equilibria, and so many stable
    ones.
    """
    asked = question(shipped(name).slice)
    assert isinstance(asked, Question)
    problems = []
    for point, (total, stable) in zip(points(name), counts, strict=True):
        p, slope, v, w = (
            at_point(terms, point) for terms in (asked.sextic, asked.slope, asked.v, asked.w)
        )
        assert p.rstrip().endswith("t^6") or " t^6 " in p, (
            f"theta2 = pi is an equilibrium at {point}"
        )
        signs = rf"[[{v} > 0 /\ {w} > 0 /\ {slope} < 0] \/ [{v} < 0 /\ {w} < 0 /\ {slope} > 0]]"
        problems += [exactly(total, f"{p} = 0"), exactly(stable, rf"{p} = 0 /\ {signs}")]
    return decided(problems)


@pytest.mark.parametrize("name", few(WITH_SEXTIC, "fig3", "fig4", "forces", "rods"))
@pytest.mark.slow_cases("fig3", "fig4", "rods")
def test_counts_at_every_sample_by_the_sextic(name: str) -> None:
    assert all(
        sextic_counts(name, [(cell.total or 0, cell.stable or 0) for cell in shipped(name).cells])
    )


def swapped(name: str, task: Task) -> bool:
    """Whether QEPCAD gets the axes in the other order: three times faster where it matters."""
    return name == "stiffness" and task is Task.TWO_STABLE


@cache
def counted_cells(name: str, task: Task) -> Decomposition:
    """QEPCAD's own cells of the window for the quantified formula, with its truth on each open one."""
    asked = question(shipped(name).slice)
    assert isinstance(asked, Question)
    other = swapped(name, task)
    output = qepcad_session([asked.problem(task, swapped=other, then=DISPLAY)])
    return decomposition(output[0], ("y", "x", "t") if other else ("x", "y", "t"))


def check_over_the_window(
    result: RegionMap, task: Task, cells: Decomposition, *, other: bool
) -> None:
    """QEPCAD's truth at the sample of each of its open cells is what the map says there.

    On each of these cells the truth is constant, and they fill the window up to curves; and where
    the first axis is the first variable for both, each of the map's cells contains one of them:
    QEPCAD's projection has the discriminant of the sextic, in which every CRITICAL component is a
    factor, so its cells are finer.
    """
    x_axis, y_axis = result.slice.axes
    located = set()
    for index, cell in cells.cells.items():
        if len(index) < 2 or not (index[0] % 2 and index[1] % 2):
            continue
        x, y = cell.sample[::-1] if other else cell.sample
        assert x is not None and y is not None
        if not (x_axis.low < x < x_axis.high and y_axis.low < y < y_axis.high):
            continue
        at = result.locate(**{x_axis.name: x, y_axis.name: y})
        assert at.status is Status.EXACT
        located.add(at.cell)
        holds = {
            Task.SIX: at.total == 6,
            Task.FOUR: at.total == 4,
            Task.TWO_STABLE: at.stable == 2,
        }[task]
        assert cell.truth == ("T" if holds else "F"), f"{task.value} at {x}, {y}"
    assert located
    if not other:
        critical = {
            c.polynomial for c in result.components if c.kind is Kind.CRITICAL and not c.left_out
        }
        assert critical <= set(cells.factors.values()), (
            "a component that is no factor of the sextic's discriminant"
        )
        if result.base == 0:
            assert located == set(range(len(result.cells)))


def quick_tasks() -> list[object]:
    return [
        pytest.param(
            name,
            task,
            # the cells of fig4 are compared by another test; with the sextic they take as long as
            # all the others
            marks=() if task is Task.SIX and name in QUICK and name != "fig4" else pytest.mark.slow,
            id=f"{name}-{task.value}",
        )
        for name in WITH_SEXTIC
        for task in Task
    ]


@pytest.mark.parametrize(("name", "task"), quick_tasks())
@pytest.mark.slow_cases("rods-6 equilibria")
def test_counting_formula_over_the_window(name: str, task: Task) -> None:
    check_over_the_window(shipped(name), task, counted_cells(name, task), other=swapped(name, task))


@pytest.mark.parametrize(
    "problem",
    [
        "[ two variables, one declared ]\n(x)\n1\n[ x + z > 0 ].\ngo\ngo\ngo\nsolution T",
        "[ no such command ]\n(x)\n1\n[ x > 0 ].\ngo\ngo\ngo\nd-nothing",
    ],
)
def test_what_qepcad_can_not_do_is_an_error(problem: str) -> None:
    with pytest.raises(ProgramError):
        qepcad_session([problem])
