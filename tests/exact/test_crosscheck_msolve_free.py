"""A platform on one leg and two springs with free lengths, Crane's: real counts at random points
against msolve.

With v = 1/d of each spring's length d as an unknown, v^2 d^2 = 1, equilibria are the real solutions
with positive v of polynomial equations, 62 complex ones for generic lengths. The equations are
written here, from coordinates in SymPy.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from random import Random
from typing import Any

import pytest
import sympy
from support.programs import needs_msolve, real_boxes, standard_monomials

import ptmcad
from ptmcad.answer.poses import Poses
from ptmcad.answer.regionmap import Status

pytest.importorskip("numba")
pytestmark = needs_msolve

UNKNOWNS = sympy.symbols("c s C S v w")
COMPLEX = 62
POINTS = 200
LENGTHS = ("L", "ax", "ay", "bx", "by", "qx", "qy", "rx", "ry")
Values = dict[str, Fraction]


def equations(at: Mapping[str, Fraction]) -> list[str]:
    """The leg from the origin to P, the plate's Q and R beside P, on springs to A and B; all as
    text for msolve.
    """
    c, s, cosine, sine, v, w = UNKNOWNS
    value = {name: sympy.Rational(x.numerator, x.denominator) for name, x in at.items()}

    def turned(x: Any, y: Any) -> Any:
        return sympy.Matrix([cosine * x - sine * y, sine * x + cosine * y])

    leg = value["L"] * sympy.Matrix([c, s])
    first = leg + turned(value["qx"], value["qy"]) - sympy.Matrix([value["ax"], value["ay"]])
    second = leg + turned(value["rx"], value["ry"]) - sympy.Matrix([value["bx"], value["by"]])
    squares = [first.dot(first), second.dot(second)]
    forces = [value["k1"] * (1 - value["l1"] * v), value["k2"] * (1 - value["l2"] * w)]

    def moment(x: Any, y: Any) -> Any:
        return sum(
            f * (x * sympy.diff(q, y) - y * sympy.diff(q, x))
            for f, q in zip(forces, squares, strict=True)
        )

    found = [
        c**2 + s**2 - 1, cosine**2 + sine**2 - 1, v**2 * squares[0] - 1, w**2 * squares[1] - 1,
        moment(c, s), moment(cosine, sine),
    ]  # fmt: skip
    return [
        str(sympy.Poly(e, *UNKNOWNS).clear_denoms()[1].as_expr()).replace("**", "^") for e in found
    ]


def counted_by_msolve(at: Mapping[str, Fraction]) -> int:
    """Real solutions with both lengths positive; neither inverse may be zero, so that boxes tell
    its sign.
    """
    boxes = real_boxes([str(u) for u in UNKNOWNS], equations(at))
    signs = [[low > 0 for low, high in box[4:] if low > 0 or high < 0] for box in boxes]
    assert all(len(both) == 2 for both in signs)
    return sum(map(all, signs))


def random_point(random: Random) -> Values:
    def between(low: int, high: int) -> Fraction:
        return low + (high - low) * Fraction(random.randrange(1, 97), 97)

    at = {name: between(-2, 2) for name in LENGTHS[1:]}
    return at | {
        "L": between(0, 3),
        "k1": Fraction(1),
        "k2": between(0, 2),
        "l1": between(0, 2),
        "l2": between(0, 2),
    }


def solved(at: Mapping[str, Fraction]) -> Poses:
    leg = {"length": "length", "stiffness": "stiffness", "free": "free length"}
    kinds = (
        {"L": leg["length"]}
        | {k: leg["stiffness"] for k in ("k1", "k2")}
        | {n: leg["free"] for n in ("l1", "l2")}
    )
    mechanism = ptmcad.Mechanism(
        {
            "name": "crane",
            "parameters": {n: {"kind": kind, "default": str(at[n])} for n, kind in kinds.items()},
            "unknowns": {"th": "angle", "phi": "angle"},
            "points": {
                "O": [0, 0], "A": texts(at, "ax", "ay"), "B": texts(at, "bx", "by"), "P": ["L*cos(th)", "L*sin(th)"],
            },
            "bodies": {
                "plate": {"at": "P", "angle": "phi", "points": {"Q": texts(at, "qx", "qy"), "R": texts(at, "rx", "ry")}}
            },
            "bars": [["O", "P"], ["P", "Q"], ["Q", "R"], ["R", "P"]],
            "springs": [
                {"between": ["A", "Q"], "k": "k1", "free": "l1"}, {"between": ["B", "R"], "k": "k2", "free": "l2"},
            ],
        }
    )  # fmt: skip
    return ptmcad.solve(model=mechanism, **{name: at[name] for name in kinds})


def texts(at: Mapping[str, Fraction], *names: str) -> list[str]:
    return [str(at[name]) for name in names]


def compared(points: Sequence[Values]) -> tuple[list[Values], list[Values]]:
    """The points at which the counts differ, and those at which ptmcad decides nothing."""
    different, undecided = [], []
    for at in points:
        poses = solved(at)
        if poses.status is Status.UNDECIDED:
            undecided.append(at)
        elif len(poses.equilibria) != counted_by_msolve(at):
            different.append(at)
    return different, undecided


def test_there_are_62_complex_solutions() -> None:
    assert (
        standard_monomials(equations(random_point(Random(1))), [str(u) for u in UNKNOWNS])
        == COMPLEX
    )


def test_counts_at_two_points() -> None:
    random = Random(3)
    assert compared([random_point(random) for _ in range(2)]) == ([], [])


def test_a_false_count_is_noticed() -> None:
    """Of other free lengths, and of solutions with a negative length."""
    random = Random(3)
    points = [random_point(random) for _ in range(2)]
    assert len(real_boxes([str(u) for u in UNKNOWNS], equations(points[0]))) > counted_by_msolve(
        points[0]
    )
    shorter = [at | {"l1": at["l1"] / 10, "l2": at["l2"] / 10} for at in points]
    assert any(
        len(solved(other).equilibria) != counted_by_msolve(at)
        for at, other in zip(points, shorter, strict=True)
    )


@pytest.mark.slow
def test_counts_at_random_points() -> None:
    random = Random(62)
    different, undecided = compared([random_point(random) for _ in range(POINTS)])
    assert not different
    assert len(undecided) < POINTS / 50, undecided
