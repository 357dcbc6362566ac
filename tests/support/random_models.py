"""Records of random mechanisms and random systems; the same seed gives the same record."""

from __future__ import annotations

import random
from typing import Any


def random_system(seed: int) -> dict[str, Any]:
    """One or two unknowns, real or on the circle; sparse equations of low degree, or a potential;
    inequalities.
    """
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
        return " + ".join(
            [*(term(degree) for _ in range(source.randint(2, 3))), f"{parameters}*{term(1)}"]
        )

    record: dict[str, Any] = {"name": "s", "unknowns": unknowns}
    if source.random() < 0.35:
        powers = " + ".join(f"{n}^4" for n, kind in unknowns.items() if kind == "real")
        record["potential"] = " + ".join(filter(None, [powers, expression(3), f"b*{atoms[-1]}"]))
    else:
        record["equations"] = [
            f"{expression(3)} + {source.choice(['a', 'b', '1', 'a + b'])}" for _ in names
        ]
        if source.random() < 0.5:
            record["positive"] = [
                source.choice([atoms[0], f"{atoms[-1]} + a", f"2 - {atoms[0]} + b"])
            ]
    return {"system": record, "axes": {"a": [-2, 2], "b": [-2, 2]}, "count": "total"}


def random_mechanism(seed: int) -> dict[str, Any]:
    """A chain of one to three bars from the origin, springs to fixed points and between joints,
    loads.
    """
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
    springs: list[dict[str, Any]] = [
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
