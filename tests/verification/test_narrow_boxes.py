"""Stored boxes of equilibria that are narrower than doubles tell: true ones are confirmed, false
ones refused.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from functools import cache
from typing import Any

import pytest
import yaml
from flint import Ordering, arb, ctx, fmpq, fmpq_mpoly_ctx
from support.maps import CONFIGS
from support.replacing import replace

import ptmcad
from ptmcad.answer.regionmap import RegionMap, Solution
from ptmcad.text.balls import exact as exactly
from ptmcad.text.flint_numbers import from_fraction
from ptmcad.verification.certified import narrow
from ptmcad.verification.certified.cellsamples import check_points
from ptmcad.verification.certified.coverclaims import CertifiedClaims
from ptmcad.verification.certified.narrow import NARROW, Function, Judgement, precisions
from ptmcad.verification.coordinates import ball, evaluated
from ptmcad.verification.report import Unchecked, Violation

pytest.importorskip("numba")

CHAIN: dict[str, Any] = yaml.safe_load("""
mechanism:
  name: held
  parameters: {a: {kind: base, default: 1}, W: {kind: force}}
  unknowns: {s: angle, t: angle}
  points: {O: [0, 0], A: [0, a], P: [sin(s), cos(s)], Q: [sin(s) + sin(t), cos(s) + cos(t)]}
  bars: [[O, P], [P, Q]]
  springs: [{between: [A, P], k: 1, free: 1/4}, {between: [A, Q], k: 1, free: 1/3}]
  loads: {P: [1/10, 0], Q: [0, W]}
axes: {a: [1, 2], W: [1/2, 1]}
""")
PAPER: dict[str, Any] = yaml.safe_load("""
name: small
mechanism: ptm
parameters: {L1: '1', k: '100', F3: '-10', F4: '-10', l0: 1/5}
axes: {rho: ['1', 3/2], L2: [3/4, 5/4]}
""")
LOOP = yaml.safe_load((CONFIGS / "mechanisms" / "four-bar-free.yaml").read_text(encoding="utf-8"))
LOOP.pop("reference")
RECORDS = {"ptm": PAPER, "chain": CHAIN, "loop": LOOP}
CASES = [
    (name, count)
    for name in RECORDS
    for count in ("stable", "total", "index")
    if (name, count) != ("loop", "index")
]  # fmt: skip


@cache
def map_of(name: str, count: str) -> RegionMap:
    slice = ptmcad.slice_from_mapping(RECORDS[name] | {"count": count})
    return ptmcad.classify(slice, tolerance="1/4", jobs=1)


DIGITS = 100


@cache
def places(name: str, count: str) -> tuple[int, tuple[tuple[Fraction, ...], ...]]:
    """A cell with solutions, and the middles of theirs to 100 digits, from the engine's poses at
    its sample.
    """
    found = map_of(name, count)
    number = next(n for n, cell in enumerate(found.cells) if cell.solutions)
    cell = found.cells[number]
    poses = ptmcad.solve(
        found.slice, DIGITS, **dict(zip(found.slice.axis_names, cell.sample, strict=True))
    )
    exact = []
    for s in cell.solutions:
        near = [turned(pose.angles, s.center) for pose in poses.equilibria]
        (at,) = [
            p for p in near if all(abs(x - c) <= s.radius for x, c in zip(p, s.center, strict=True))
        ]
        exact.append(at)
    return number, tuple(exact)


def turned(angles: Sequence[Any], near: Sequence[Fraction]) -> tuple[Fraction, ...]:
    """The angles' middles less the whole turns from some that are near."""
    with ctx.workprec(1000):
        turn = 2 * exactly(arb.pi().mid())
    return tuple(
        a.center + round((c - a.center) / turn) * turn for a, c in zip(angles, near, strict=True)
    )


def forged(name: str, count: str, radius: Fraction, off: Fraction) -> CertifiedClaims:
    """The map with one narrow box, whose middle is so far off the solution."""
    true, (number, exact) = map_of(name, count), places(name, count)
    cell = true.cells[number]
    first = replace(cell.solutions[0], center=tuple(x + off for x in exact[0]), radius=radius)
    cells = list(true.cells)
    cells[number] = replace(cell, solutions=(first, *cell.solutions[1:]))
    return CertifiedClaims(replace(true, cells=tuple(cells)))


@pytest.mark.parametrize(("name", "count"), CASES)
@pytest.mark.slow_cases(
    "ptm-index",
    "chain-index",
    "chain-total",
    "loop-stable",
    "loop-total",
    "ptm-total",
    "ptm-stable",
)
def test_a_narrow_box_is_decided(name: str, count: str) -> None:
    """Whether its middle is off by less than its half width, or by a little more, or by less than
    doubles tell.
    """
    radius = Fraction(1, 10**30)
    checked(forged(name, count, radius, radius * Fraction(99, 100)))
    for off in (radius * Fraction(-101, 100), Fraction(1, 10**20)):
        refused(forged(name, count, radius, off))


def checked(claims: CertifiedClaims) -> None:
    assert not isinstance(check_points(claims), Unchecked)


def refused(claims: CertifiedClaims) -> None:
    with pytest.raises(
        Violation, match=r"box 0 of the solutions, around .* has 0 equilibria, not one"
    ):
        check_points(claims)


@pytest.mark.parametrize("power", [21, 40, 100])
def test_a_solution_next_to_an_edge_is_told(power: int) -> None:
    """The root of 2, which is further from the edge than its digits, but nearer than its parabola
    bends in the box.
    """
    radius, near = Fraction(1, 2**power), Fraction(1, 2 ** (2 * power + 20))
    with ctx.workprec(2000):
        root = exactly((arb(2).sqrt()).mid())
    for off, holds in (
        (radius - near, True),
        (near - radius, True),
        (radius + near, False),
        (-radius - near, False),
    ):
        found = judged(square, Solution((root + off,), radius, ""))
        assert found is not None
        assert found.holds is holds


def judged(function: Function, solution: Solution) -> Judgement | None:
    for bits in precisions(solution):
        with ctx.workprec(bits):
            found = narrow.tested(function, solution)
        if found is not None:
            return found
    return None


def square(box: Sequence[arb]) -> tuple[list[arb], list[list[arb]]]:
    """x^2 = 2."""
    (x,) = box
    return [x * x - 2], [[2 * x]]


def test_the_edge_is_left_open_and_so_is_what_has_no_derivatives() -> None:
    """The first solution is degenerate, and the second box ends at it."""
    at_zero = Solution((Fraction(0),), Fraction(1, 10**30), "")
    assert judged(lambda box: ([box[0] * box[0]], [[2 * box[0]]]), at_zero) is None
    edge = Solution((Fraction(1, 10**30),), Fraction(1, 10**30), "")
    assert judged(lambda box: ([box[0]], [[arb(1)]]), edge) is None
    assert judged(lambda box: ([box[0]], [[arb("nan")]]), at_zero) is None
    assert judged(square, Solution((Fraction(1),), 8 * NARROW, "")) is None
    assert judged(square, Solution((Fraction(3, 2),), Fraction(1, 10**20000), "")) is None


def test_more_digits_are_taken_where_the_first_do_not_do() -> None:
    """Of a matrix that is nearly singular, and a middle next to a box's edge."""
    small, radius = Fraction(1, 2**400), Fraction(1, 10**30)

    def function(box: Sequence[arb]) -> tuple[list[arb], list[list[arb]]]:
        (x, y), tiny = box, arb(from_fraction(small))
        return [x + y, x + (1 + tiny) * y], [[arb(1), arb(1)], [arb(1), 1 + tiny]]

    def shows(off: Fraction) -> bool | None:
        found = judged(function, Solution((off, Fraction(0)), radius, ""))
        return None if found is None else found.holds

    assert shows(radius * (1 - Fraction(1, 2**100))) is True
    assert shows(radius * (1 + Fraction(1, 2**100))) is False


def test_numbers_of_a_description_are_as_exact_as_the_precision() -> None:
    """They were rounded to doubles, so that narrow boxes beside an equilibrium were confirmed."""
    a = fmpq_mpoly_ctx.get(("a",), Ordering.lex).gen(0)
    with ctx.workprec(400):
        assert ball(0 * a + fmpq(13, 30), {}).overlaps(arb(from_fraction(Fraction(13, 30))))
        assert ball(2 * a + fmpq(1, 10), {"a": arb(1)}).overlaps(
            arb(from_fraction(Fraction(21, 10)))
        )
    assert evaluated(a / 3 + fmpq(1, 10), {"a": Fraction(1)}) == Fraction(13, 30)


@pytest.mark.parametrize(
    ("off", "holds"), [(Fraction(1, 10**26), True), (Fraction(3, 10**25), False)]
)
def test_one_coordinate_narrows_another(off: Fraction, holds: bool) -> None:
    """x = 10^-14 and y = 10^26 x^2: over all of the box y varies twenty times as much as the box is high."""

    def function(at: Sequence[arb]) -> tuple[list[arb], list[list[arb]]]:
        x, y = at
        scale = arb(10) ** 26
        return [10**14 * x - 1, y - scale * x * x], [
            [arb(10) ** 14, arb(0)],
            [-2 * scale * x, arb(1)],
        ]

    exact = Fraction(1, 10**14), Fraction(1, 100)
    box = Solution((exact[0] + Fraction(1, 10**26), exact[1] + off), Fraction(1, 10**25), "")
    with ctx.workprec(precisions(box)[0]):
        found = narrow.tested(function, box)
    assert found is not None and found.holds is holds
    if holds:
        assert all(
            x.overlaps(arb(from_fraction(c))) for x, c in zip(found.within, exact, strict=True)
        )
