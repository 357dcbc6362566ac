"""Four angles at a point: what a basis over Q does not count is searched for, and both agree where
both answer.
"""

from __future__ import annotations

from typing import Any

import pytest

import ptmcad
from ptmcad.answer.regionmap import Status
from ptmcad.ask import solving
from ptmcad.errors import ConfigError, LimitReached
from ptmcad.model import Model

pytest.importorskip("numba")

LENGTHS = ("1", "1/2", "1", "1/3")


def chain() -> Model:
    """Four bars in a row, each joint on a spring without free length to A, and a force at the end."""
    points: dict[str, Any] = {"O": [0, 0], "A": ["a", "1/2"]}
    x, y = "0", "0"
    for k, length in enumerate(LENGTHS):
        x, y = f"{x} + {length}*cos(th{k})", f"{y} + {length}*sin(th{k})"
        points[f"P{k}"] = [x, y]
    return ptmcad.Mechanism(
        {
            "parameters": {"a": {"default": 1}, "F": {"kind": "force"}},
            "unknowns": {f"th{k}": "angle" for k in range(4)},
            "points": points,
            "springs": [{"between": ["A", f"P{k}"], "k": 1} for k in range(4)],
            "loads": {"P3": [0, "F"]},
        }
    )


def pendulums() -> Model:
    """Four that do not feel each other, with two equilibria each."""
    return ptmcad.Mechanism(
        {
            "parameters": {"F": {"kind": "force"}},
            "unknowns": {f"th{k}": "angle" for k in range(4)},
            "points": {f"P{k}": [f"cos(th{k})", f"sin(th{k})"] for k in range(4)},
            "loads": {f"P{k}": [k, "F"] for k in range(4)},
        }
    )


@pytest.mark.slow
def test_a_chain_of_four_bars_is_counted() -> None:
    """70 complex solutions, whose basis over Q took minutes and more; Euler's sum is
    2 - 7 + 9 - 5 + 1 = 0.
    """
    found = ptmcad.counts_at(chain(), a="1/3", F="1/2")
    assert (found.total, found.stable, found.index) == (24, 2, (2, 7, 9, 5, 1))
    poses = ptmcad.solve(digits=6, model=chain(), a="1/3", F="1/2")
    assert [pose.index for pose in poses.equilibria].count(1) == 7
    assert poses.stable == 2


def test_algebra_and_search_agree(monkeypatch: pytest.MonkeyPatch) -> None:
    exact = ptmcad.counts_at(pendulums(), F="-3/2")
    assert exact.index == (1, 4, 6, 4, 1)
    monkeypatch.setattr(solving, "_MAX_WORK", (1, 1, 1, 1))
    assert ptmcad.counts_at(pendulums(), F="-3/2") == exact
    assert ptmcad.solve(model=pendulums(), F="-3/2").status is Status.CERTIFIED


def test_a_potential_of_four_angles_is_counted_in_the_same_way(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    unknowns = dict.fromkeys(("p", "q", "r", "s"), "angle")
    system = ptmcad.System(
        unknowns=unknowns, potential="cos(p) + b*cos(q) + sin(r) - 2*cos(s) + cos(p - q)/5"
    )
    exact = ptmcad.counts_at(system, b=2)
    monkeypatch.setattr(solving, "_MAX_WORK", (1, 1, 1, 1))
    assert ptmcad.counts_at(system, b=2) == exact
    assert exact.total == 16


def test_a_search_that_does_not_end_is_refused_by_name() -> None:
    with pytest.raises(LimitReached, match="stopped after 1e-09 s: give more as timeout"):
        ptmcad.counts_at(chain(), timeout=1e-9, a="1/3", F="1/2")
    with pytest.raises(ConfigError, match="'soon' is not a positive number of seconds"):
        ptmcad.counts_at(chain(), timeout="soon", a="1/3", F="1/2")  # type: ignore[arg-type]


def test_more_angles_than_are_searched_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("ptmcad.certified.plain.problem.MAX_UNKNOWNS_AT_POINTS", 3)
    monkeypatch.setattr("ptmcad.algebra.msolve.program", lambda: None)
    with pytest.raises(
        LimitReached, match=r"takes up to 3 unknowns there; .*pip install 'ptmcad\[large\]'"
    ):
        ptmcad.counts_at(chain(), a="1/3", F="1/2")
