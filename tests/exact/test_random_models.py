"""Random mechanisms and random systems: counts at random points against Newton's method from many starts.

The oracle (`tests/support/newton.py`) shares no code with the package, and proves each of its solutions.
"""

from __future__ import annotations

import random
from fractions import Fraction
from typing import Any

import pytest
from support.newton import Found, model_of, solutions

import ptmcad
from ptmcad.algebra.polynomials import from_fraction
from ptmcad.answer.counts import Counts
from ptmcad.errors import HypothesisError
from ptmcad.exact.counting import count_by_isolation, count_by_signature
from ptmcad.exact.models import system_from

POINTS = 200
STARTS = 400
ROUNDS = 6
"""Each with four times as many starts as the one before, while the oracle has found fewer solutions than there are."""


def random_system(seed: int) -> dict[str, Any]:
    """One or two unknowns, real or on the circle; sparse equations of low degree, or a potential; inequalities."""
    source = random.Random(f"system {seed}")
    names = ["x", "y"][: 1 + seed % 2]
    unknowns = {name: source.choice(["real", "real", "angle"]) for name in names}
    atoms = [f"cos({n})" if kind == "angle" else n for n, kind in unknowns.items()]
    atoms += [f"sin({n})" for n, kind in unknowns.items() if kind == "angle"]

    def term(degree: int) -> str:
        factors = [source.choice(atoms) for _ in range(source.randint(1, degree))]
        return "*".join([f"({source.choice([-3, -2, -1, 1, 2, 3])})", *factors])

    def expression(degree: int) -> str:
        parameters = source.choice(["a", "b", "a - b", "a*b", "(2*a + 1)"])
        return " + ".join([*(term(degree) for _ in range(source.randint(2, 3))), f"{parameters}*{term(1)}"])

    record: dict[str, Any] = {"name": "s", "unknowns": unknowns}
    if source.random() < 0.35:
        powers = " + ".join(f"{n}^4" for n, kind in unknowns.items() if kind == "real")
        record["potential"] = " + ".join(filter(None, [powers, expression(3), f"b*{atoms[-1]}"]))
    else:
        record["equations"] = [f"{expression(3)} + {source.choice(['a', 'b', '1', 'a + b'])}" for _ in names]
        if source.random() < 0.5:
            record["positive"] = [source.choice([atoms[0], f"{atoms[-1]} + a", f"2 - {atoms[0]} + b"])]
    return {"system": record, "axes": {"a": [-2, 2], "b": [-2, 2]}, "count": "total"}


def random_mechanism(seed: int) -> dict[str, Any]:
    """A chain of one to three bars from the origin, springs to fixed points and between joints, loads."""
    source = random.Random(f"mechanism {seed}")
    bars = 1 + seed % 3

    def number() -> str:
        return f"{source.randint(-8, 8)}/{source.randint(2, 6)}"

    points: dict[str, Any] = {"O": [0, 0]}
    x, y = "0", "0"
    for k in range(1, bars + 1):
        length = f"{source.randint(2, 6)}/{source.randint(2, 5)}"
        turn = source.choice([f"th{k}", f"th{k} - th{k - 1}" if k > 1 else f"th{k}"])
        x, y = f"{x} + {length}*cos({turn})", f"{y} + {length}*sin({turn})"
        points[f"P{k}"] = [x, y]
    fixed = source.randint(1, 2)
    for k in range(fixed):
        points[f"A{k}"] = [source.choice(["a", number()]), number()]
    springs = [
        {"between": [f"A{source.randrange(fixed)}", f"P{k}"], "k": f"{source.randint(1, 5)}/2"}
        for k in range(1, bars + 1)
    ]
    if bars > 1 and source.random() < 0.5:
        springs.append({"between": ["O", f"P{bars}"], "k": source.randint(1, 3)})
    record = {
        "name": "m",
        "parameters": {"a": {"kind": "number", "default": 1}, "W": {"kind": "force", "default": 0}},
        "unknowns": {f"th{k}": "angle" for k in range(1, bars + 1)},
        "points": points,
        "springs": springs,
        "loads": {f"P{bars}": [number(), "W"]},
    }
    if all("a" not in str(points[f"A{k}"][0]) for k in range(fixed)):
        points["A0"][0] = "a"
        springs[0]["between"] = ["A0", springs[0]["between"][1]]
    return {"mechanism": record, "axes": {"a": [-2, 2], "W": [-3, 3]}, "count": "index"}


def agree(record: dict[str, Any], number: int, seed: int, by_signature: bool = False) -> int:
    """Compare at so many random points; the number that were not degenerate or on the slice's boundary."""
    slice = ptmcad.slice_from_mapping(record)
    system = system_from(slice.model)
    oracle = model_of(record)
    source = random.Random(seed)
    compared = 0
    for _ in range(number):
        axes = {a.name: a.low + (a.high - a.low) * Fraction(source.randint(1, 9972), 9973) for a in slice.axes}
        values = {name: e.evaluate(*axes.values()) for name, e in slice.parameters.items()}
        exact = {name: from_fraction(v) for name, v in values.items() if name in system.ring.parameters}
        try:
            counts = count_by_isolation(system, exact)
        except HypothesisError:
            continue
        if by_signature:
            assert count_by_signature(system, exact) == counts
        starts = STARTS
        for k in range(ROUNDS):
            found = solutions(oracle, values, starts, seed + k)
            if sum(f.counts for f in found) >= counts.total:
                break
            starts *= 4
        assert tally(found, counts) == counts, (record, axes, [tuple(map(float, f.at)) for f in found])
        compared += 1
    return compared


def tally(found: list[Found], counts: Counts) -> Counts:
    """The oracle's counts, of the same kinds."""
    counted = [f for f in found if f.counts]
    if counts.index is None:
        return Counts(len(counted), None, None)
    index = tuple(sum(f.negative == k for f in counted) for k in range(len(counts.index)))
    return Counts(len(counted), index[0], index)


@pytest.mark.parametrize("seed", range(6))
def test_random_systems_by_two_methods(seed: int) -> None:
    agree(random_system(seed), 2, seed, by_signature=True)


@pytest.mark.parametrize("seed", range(3))
def test_random_mechanisms_by_two_methods(seed: int) -> None:
    assert agree(random_mechanism(seed), 1, seed, by_signature=seed < 2)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(30))
def test_counts_of_random_systems(seed: int) -> None:
    agree(random_system(seed), POINTS, seed)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(30))
def test_counts_of_random_mechanisms(seed: int) -> None:
    assert agree(random_mechanism(seed), POINTS, seed)
