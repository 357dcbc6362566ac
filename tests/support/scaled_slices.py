"""Random slices at any scale: windows from 1e-30 to 1e9, some about a wall of the map, far from
zero or vast, and unknowns and equations that are multiplied by powers of ten.

`scaled(seed)` is a record, the same in every run; None where the random model has no map to begin
with.
"""

from __future__ import annotations

import random
import re
from copy import deepcopy
from fractions import Fraction
from itertools import combinations, pairwise
from typing import Any

import ptmcad
from ptmcad.errors import PtmcadError
from support.random_models import random_mechanism, random_system
from support.random_slices import MODEL, NUMBERS, drawn

Record = dict[str, Any]

SIZES = ("1e-30", "1e-20", "1e-15", "1e-14", "1e-12", "1e-9", "1e-6", "1e-3")
"""Half widths of windows about a wall."""
_BISECTIONS = 220


def scaled(seed: int) -> Record | None:
    """The slice with this number."""
    dice = random.Random(f"scaled {seed}")
    base = _BASES[seed % len(_BASES)](dice)
    if "system" in base and dice.random() < 2 / 3:
        base = _other_units(base, dice)
    return dice.choice([_about_a_wall, _about_a_wall, _vast, _shifted, _units_of_axes])(base, dice)


# -------------------------------------------------------------------------------------------------------------- models


def _system(dice: random.Random) -> Record:
    return random_system(dice.randrange(10**6))


def _mechanism(dice: random.Random) -> Record:
    return random_mechanism(3 * dice.randrange(10**6) + dice.choice([0, 0, 1]))


def _paper(dice: random.Random) -> Record:
    record = drawn(dice.choice([n for n in NUMBERS if 55 <= n < 200])).record
    return {**record, "name": "paper"}


def _slider(dice: random.Random) -> Record:
    """A crank, a slider and two springs: its folds and pitchforks, where the crank points along the
    guide.
    """

    def number() -> str:
        return f"{dice.randint(-6, 6)}/{dice.randint(1, 3)}"

    sideways = dice.choice(["0", "0", number()])
    turn = f"(({dice.choice([1, 2, -2, 3])})*cos(th)"
    tip = [
        f"{turn} - ({sideways})*sin(th))",
        f"{turn.replace('cos', 'sin')} + ({sideways})*cos(th))",
    ]
    points = {
        "A": [number(), "-1"],
        "B": [number(), dice.choice(["0", number()])],
        "S": ["x", "0"],
        "P": tip,
    }
    record = {
        "name": "slider", "parameters": {"F": {"kind": "force"}, "G": {"kind": "force"}},
        "unknowns": {"th": "angle", "x": "length"}, "points": points,
        "springs": [{"between": ["P", "S"], "k": 1}, {"between": ["B", "S"], "k": dice.randint(1, 3)}],
        "loads": dice.choice([{"S": ["F", "G"], "P": ["0", "G"]}, {"S": ["F", "0"], "P": ["G", "0"]}]),
    }  # fmt: skip
    return {
        "mechanism": record,
        "axes": {"F": [-4, 4], "G": [-4, 4]},
        "count": dice.choice(["stable", "index"]),
    }


def _singularity(dice: random.Random) -> Record:
    """Pitchforks, cusps and folds in their normal forms, some with an inequality."""
    unknowns, equations, positive = dice.choice([
        (["s", "x"], ["x*s", "x + s^2 - a"], ["x + b + 2"]),
        (["x"], ["x^3 - a*x - b"], ["x + 1/3"]),
        (["x"], ["x^3 - a*x"], ["x + b"]),
        (["x", "y"], ["x^2 - y - a", "y^2 - b - x"], ["x + 1/3"]),
        (["x"], ["x^2 - a - b"], ["x"]),
        (["x", "y"], ["x^2 - a*y + b", "y^2 - x - a*b"], ["x + y"]),
        (["x", "y"], ["x^3 - y - a*x", "y - b*x"], ["2 + x - y"]),
    ])  # fmt: skip
    system: Record = {
        "name": "s",
        "unknowns": dict.fromkeys(unknowns, "real"),
        "equations": equations,
    }
    if dice.random() < 1 / 2:
        system["positive"] = positive
    return {"system": system, "axes": {"a": [-1, 2], "b": [-1, 1]}, "count": "total"}


_BASES = (_system, _mechanism, _slider, _singularity, _paper, _slider, _singularity)


def _free(dice: random.Random) -> Record:
    """The paper's mechanism on springs with free lengths."""
    loads = {name: dice.choice([0, -10, -10, 5]) for name in ("F3", "F4")}
    length = dice.choice(["1/5", "1/2", "1/10", "1/1000000000000"])
    parameters = {"L1": 1, "k": dice.choice([100, "1e12", "1e-12"]), **loads, "l0": length}
    return {
        "mechanism": "ptm",
        "parameters": parameters,
        "axes": {"rho": ["1/20", 2], "L2": ["1/10", 2]},
        "count": "stable",
    }


def _bead(dice: random.Random) -> Record:
    """A bead on a line, held by a spring above it: a pitchfork without a load, folds with one."""
    size = dice.choice(["1", "1e6", "1e-6", "1e-12"])
    record = {
        "name": "bead", "parameters": {"h": {"kind": "base"}, "F": {"kind": "force"}}, "unknowns": {"x": "length"},
        "points": {"A": [0, "h"], "S": ["x", 0]}, "loads": {"S": ["F", 0]},
        "springs": [{"between": ["A", "S"], "k": dice.choice([1, "1e12", "1e-12"]), "free": size}],
    }  # fmt: skip
    r = Fraction(size)
    return {
        "mechanism": record,
        "axes": {"h": [str(r / 3), str(2 * r)], "F": [-1, 1]},
        "count": dice.choice(["stable", "index"]),
    }


def _free_slider(dice: random.Random) -> Record:
    record = _slider(dice)
    for spring in record["mechanism"]["springs"]:
        spring["free"] = dice.choice(["1/2", "1/3", 1])
    return record


_BASES_CERTIFIED = (_free, _bead, _free_slider, _singularity, _bead, _system, _singularity)


def scaled_certified(seed: int) -> Record | None:
    """The slice with this number, for the certified engine."""
    dice = random.Random(f"certified {seed}")
    base = _BASES_CERTIFIED[seed % len(_BASES_CERTIFIED)](dice)
    if "system" in base and dice.random() < 2 / 3:
        base = _other_units(base, dice)
    return dice.choice([_about_a_change, _about_a_change, _vast, _shifted, _units_of_axes])(
        base, dice
    )


def _about_a_change(record: Record, dice: random.Random) -> Record | None:
    """A small window about a point at which the counts change, found by halving the way between two
    samples.
    """
    try:
        result = ptmcad.classify(record, engine="certified", tolerance="1/4", timeout=10)
        pairs = [
            (a, b)
            for a, b in combinations(result.cells, 2)
            if (a.total, a.stable) != (b.total, b.stable)
        ]
        if not pairs:
            return None
        one, two = dice.choice(pairs)
        low, high = list(one.sample), list(two.sample)

        def number(at: list[Fraction]) -> tuple[int, int]:
            poses = ptmcad.solve(
                record, **dict(zip(result.slice.axis_names, at, strict=True))
            ).equilibria
            return len(poses), sum(bool(pose.stable) for pose in poses)

        there = number(low)
        for _ in range(34):
            middle = [(x + y) / 2 for x, y in zip(low, high, strict=True)]
            low, high = (middle, high) if number(middle) == there else (low, middle)
    except PtmcadError:
        return None
    size = Fraction(dice.choice(["1e-2", "1e-4", "1e-6", "1e-8", "1e-10"]))
    axes = {}
    for (name, (first, last)), place in zip(_window(record).items(), low, strict=True):
        half = (last - first) * size
        axes[name] = [
            str(place - half * Fraction(dice.randint(1, 9), 10)),
            str(place + half * Fraction(dice.randint(1, 9), 10)),
        ]
    return {**record, "axes": axes}


# -------------------------------------------------------------------------------------------------------------- scales


def _other_units(record: Record, dice: random.Random) -> Record:
    """The same system for unknowns of other units, each equation times a power of ten."""
    system = deepcopy(record["system"])
    factors = {name: dice.choice(["1e13", "1e-12", "1e6", "1", "1e12"])
               for name, kind in system["unknowns"].items() if kind == "real"}  # fmt: skip

    def changed(text: str) -> str:
        return re.sub(
            r"\b[a-z]+\b(?!\()",
            lambda m: f"({factors[m[0]]}*{m[0]})" if m[0] in factors else m[0],
            text,
        )

    for key in ("equations", "positive"):
        times = [dice.choice(["1", "1e12", "1e-12"]) for _ in system.get(key, ())]
        if key in system:
            system[key] = [
                f"{by}*({changed(text)})" for by, text in zip(times, system[key], strict=True)
            ]
    if "potential" in system:
        system["potential"] = changed(system["potential"])
    return {**record, "system": system}


def _through(record: Record, maps: dict[str, tuple[str, Fraction, Fraction]]) -> Record:
    """The record whose axes go through functions of new ones: an old name to (function, low, high)
    of its new axis.
    """
    names = dict(zip(maps, ("u", "v"), strict=True))
    fixed = {
        key: _with_axes(str(value), maps, names)
        for key, value in record.get("parameters", {}).items()
    }
    # of the paper's mechanism an axis may be a name of its own, on which parameters depend
    own = record.get(
        "system", record["mechanism"] if isinstance(record.get("mechanism"), dict) else MODEL
    )
    fixed |= {
        name: function.replace("@", names[name])
        for name, (function, _, _) in maps.items()
        if re.search(rf"\b{name}\b", str(own))
    }
    axes = {names[name]: [str(low), str(high)] for name, (_, low, high) in maps.items()}
    return {**record, "parameters": fixed, "axes": axes}


def _with_axes(
    text: str, maps: dict[str, tuple[str, Fraction, Fraction]], names: dict[str, str]
) -> str:
    return re.sub(
        r"\b\w+\b",
        lambda m: f"({maps[m[0]][0].replace('@', names[m[0]])})" if m[0] in maps else m[0],
        text,
    )


def _window(record: Record) -> dict[str, tuple[Fraction, Fraction]]:
    return {name: (Fraction(low), Fraction(high)) for name, (low, high) in record["axes"].items()}


def _vast(record: Record, dice: random.Random) -> Record:
    """A window of 2e9, or of 2e6, in both directions; lengths stay positive."""
    size = Fraction(dice.choice(["1e9", "1e6"]))
    axes = {
        name: [str(-size) if low < 0 else str(low), str(size - 1)]
        for name, (low, _) in _window(record).items()
    }
    return {**record, "axes": axes}


def _shifted(record: Record, dice: random.Random) -> Record:
    """The same map over axes that begin far from zero."""
    far = Fraction(dice.choice(["1e9", "1e15", "123456789123"]))
    return _through(
        record,
        {n: (f"@ - {far}", low + far, high + far) for n, (low, high) in _window(record).items()},
    )


def _units_of_axes(record: Record, dice: random.Random) -> Record:
    """The same map over axes of other units."""
    by = {name: Fraction(dice.choice(["1e12", "1e-12", "1e30", "1e-9"])) for name in record["axes"]}
    return _through(
        record,
        {n: (f"({by[n]})*@", low / by[n], high / by[n]) for n, (low, high) in _window(record).items()},
    )  # fmt: skip


def _about_a_wall(record: Record, dice: random.Random) -> Record | None:
    """A tiny window about a point at which the counts change."""
    try:
        result = ptmcad.classify(record, area_tolerance="1/10", timeout=20)
    except PtmcadError:
        return None
    places = list(_walls(result))
    if not places:
        return None
    at = dice.choice(places)
    size = Fraction(dice.choice(SIZES))
    axes = {}
    for name, middle in zip(record["axes"], at, strict=True):
        low, high = (
            middle - size * Fraction(dice.randint(1, 9), 10),
            middle + size * Fraction(dice.randint(1, 9), 10),
        )
        axes[name] = [str(low), str(high)]
    return {**record, "axes": axes}


def _walls(result: ptmcad.RegionMap) -> Any:
    """Points, to some 60 digits, of curves between neighbouring cells of different counts."""
    names = result.slice.axis_names
    functions = [
        compile(c.polynomial.text(names).replace("^", "**"), "component", "eval")
        for c in result.components
    ]

    def value(f: Any, at: list[Fraction]) -> Fraction:
        return Fraction(eval(f, dict(zip(names, at, strict=True))))

    for one, two in pairwise(sorted(result.cells, key=lambda c: (c.stack or 0, c.level))):
        if one.stack != two.stack or (one.total, one.index) == (two.total, two.index):
            continue
        for f in functions:
            low, high = list(one.sample), list(two.sample)
            if value(f, low) * value(f, high) < 0:
                sign = value(f, low)
                for _ in range(_BISECTIONS):
                    middle = [(x + y) / 2 for x, y in zip(low, high, strict=True)]
                    if value(f, middle) * sign > 0:
                        low = middle
                    else:
                        high = middle
                yield [Fraction(round(x * 10**60), 10**60) for x in low]
                break
