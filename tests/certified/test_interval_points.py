"""Counts at a rational point, proved by intervals: known answers, the exact engine, and an
independent dense search.
"""

from __future__ import annotations

import random
from fractions import Fraction as Q

import pytest
from support.dense_search import dense_search

from ptmcad.certified.peaks import peaks
from ptmcad.certified.plain.pointcounts import BranchCounter, plain_counter
from ptmcad.certified.plain.zeros import PointCount
from ptmcad.model import ptm
from ptmcad.question.slice import Axis, Count, Slice
from ptmcad.text.expressions import axis, values_at

UNIT = {"L1": Q(1), "k1": Q(1), "k2": Q(1), "k3": Q(1), "F3x": Q(0), "F4x": Q(0)}


def counter(**values: Q) -> BranchCounter:
    """Counts in the plane of rho and L2; every other parameter is a number."""
    given = UNIT | values
    parameters = {name: axis(0) * 0 + value for name, value in given.items()} | {
        "rho": axis(0),
        "L2": axis(1),
    }
    return plain_counter(
        Slice("test", ptm(), (Axis("rho", Q(0), Q(2)), Axis("L2", Q(0), Q(2))), parameters)
    )


def equal_springs(free: Q, force: Q, **more: Q) -> BranchCounter:
    return counter(F3=force, F4=force, l0_1=free, l0_2=free, l0_3=free, **more)


@pytest.mark.parametrize(
    ("rho", "l2", "free", "force", "total", "stable"),
    [
        pytest.param("0.96859", "1.00609", "0.2", "-0.1", 12, 2, id="REFERENCE, more than 6: 12"),
        pytest.param("1.20609", "1", "1.01487", "-0.1", 26, 8, id="REFERENCE: 26 with 8 stable"),
        pytest.param("0.75609", "1", "1.43487", "0", 30, 10, id="issue: 30 with 10 stable"),
        pytest.param(
            "0.7", "1.5", "0.2", "-0.1", 6, 2, id="REFERENCE, reproduction of 5.2: 6 with 2 stable"
        ),
    ],
)
@pytest.mark.slow_cases("REFERENCE, more than 6: 12", "REFERENCE: 26 with 8 stable")
def test_known_counts(rho: str, l2: str, free: str, force: str, total: int, stable: int) -> None:
    counts = equal_springs(Q(free), Q(force))
    found = counts.at(Q(rho), Q(l2), Count.TOTAL)
    assert found.decided and (found.total, found.stable, len(found.solutions)) == (
        total,
        stable,
        total,
    )
    assert (
        found.index is not None
        and found.index[0] - found.index[1] + found.index[2] + found.cones == 0
    )
    assert counts.at(Q(rho), Q(l2), Count.STABLE).stable == stable


def random_case(generator: random.Random) -> tuple[BranchCounter, Q, Q]:
    def number(low: float, high: float) -> Q:
        return Q(generator.randint(int(low * 1000), int(high * 1000)), 1000)

    if generator.random() < 0.5:
        counts = equal_springs(number(0.05, 1), Q(-1, 10))
    else:
        free = [number(0, 1) if generator.random() < 0.8 else Q(0) for _ in range(3)]
        counts = counter(
            L1=number(0.3, 1.5), F3=number(-0.5, 0.5), F4=number(-0.5, 0.5), F3x=number(-0.3, 0.3),
            F4x=number(-0.3, 0.3), **{f"k{i}": number(0.3, 2) for i in (1, 2, 3)},
            **{f"l0_{i}": free[i - 1] for i in (1, 2, 3)},
        )  # fmt: skip
    return counts, number(0.01, 2), number(0.01, 2)


def compare_with_dense_search(seed: int, points: int) -> None:
    generator = random.Random(seed)
    for _ in range(points):
        counts, x, y = random_case(generator)
        found, admissible = counts.at(x, y, Count.INDEX), counts.at(x, y, Count.ADMISSIBLE)
        slice = counts.branches[0].slice
        absent = dict.fromkeys(slice.model.variables, Q(0))
        values = absent | values_at(slice.parameters, x, y)
        assert found.decided and admissible.decided, values
        for grid in (
            40,
            80,
            300,
        ):  # the search may miss some, so a difference has to stay with more starts
            seen = dense_search({name: float(value) for name, value in values.items()}, grid)
            if seen["index"] == found.index and seen["admissible"] == admissible.admissible:
                break
        assert (seen["index"], seen["admissible"]) == (found.index, admissible.admissible), values
        assert admissible.stable == found.stable == counts.at(x, y, Count.STABLE).stable


def test_agrees_with_a_dense_search() -> None:
    compare_with_dense_search(seed=5, points=6)


def test_near_and_on_a_fold() -> None:
    # unloaded without free lengths: the count changes at 2 rho = L2 + 1
    counts = equal_springs(Q(0), Q(0))
    on = counts.at(Q(5, 4), Q(3, 2), Count.TOTAL)
    assert on == PointCount()
    assert counts.at(Q(5, 4) - Q(1, 10**5), Q(3, 2), Count.TOTAL).total == 6
    assert counts.at(Q(5, 4) + Q(1, 10**5), Q(3, 2), Count.TOTAL).total == 4


@pytest.mark.parametrize(
    ("free", "l1", "rho", "l2", "index"),
    [
        # rho = L1 = L2 is a double point: two springs have no length in a flat pose, where all its
        # poses are narrow
        pytest.param(
            (Q(23, 5 * 10**10), Q(23, 5 * 10**10), Q(0)), Q(3, 4), Q(2337421877420497, 3116562500000000),
            Q(1168710937170709, 1558281250000000), (2, 3, 1), id="within 2 l0 of rho = L1 = L2",
        ),
        pytest.param(
            (Q(17, 5 * 10**12),) * 3, Q(5, 4), (Q(5, 4) + Q(1371287499984524271, 2493250000000000000)) / 2
            + Q(18256, 10**4) / 2 * Q(17, 5 * 10**12), Q(1371287499984524271, 2493250000000000000), (1, 2, 1),
            id="within 2 l0 of 2 rho = L1 + L2", marks=pytest.mark.slow,
        ),
        pytest.param(
            (Q(77, 200000),) * 3, Q(27, 20), Q(1121961703421063, 2493250000000000),
            Q(4487852344664553, 4986500000000000), (2, 4, 2),
            id="within 2 l0^2 of rho = L1 - L2", marks=pytest.mark.slow,
        ),
    ],
)  # fmt: skip
def test_points_within_a_few_free_lengths_of_singular_lines(
    free: tuple[Q, Q, Q], l1: Q, rho: Q, l2: Q, index: tuple[int, int, int]
) -> None:
    """Indices by an independent search in doubles with lengths written as differences from the
    line.
    """
    counts = counter(L1=l1, F3=Q(0), F4=Q(0), **{f"l0_{k}": free[k - 1] for k in (1, 2, 3)})
    assert counts.at(rho, l2, Count.INDEX).index == index


@pytest.mark.parametrize("free", [Q(0), Q(1, 5)])
def test_a_circle_of_equilibria_is_undecided(free: Q) -> None:
    # unloaded with rho = 0 the mechanism turns freely about A1 = A2
    assert equal_springs(free, Q(0)).at(Q(0), Q(3, 2), Count.TOTAL) == PointCount()


def test_a_cone_appears_at_its_exact_place() -> None:
    # unloaded, L1 = L2 = 1, rho = 1/2: |g| s12 = rho^2 H (1 - l0) and l0 s12 = l0 rho H, equal at
    # l0 = 1/3
    given = UNIT | {"L2": Q(1), "rho": Q(1, 2), "F3": Q(0), "F4": Q(0)}
    for free, count, regular in ((Q(33, 100), 0, True), (Q(1, 3), 0, False), (Q(34, 100), 2, True)):
        found = peaks(given | {f"l0_{i}": free for i in (1, 2, 3)})
        assert found == (count, regular)


def test_without_a_free_length_of_spring_3_there_is_no_cone() -> None:
    given = UNIT | {
        "L2": Q(1),
        "rho": Q(1, 2),
        "F3": Q(0),
        "F4": Q(0),
        "l0_1": Q(1),
        "l0_2": Q(1),
        "l0_3": Q(0),
    }
    assert peaks(given)[0] == 0
