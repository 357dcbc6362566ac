"""Records of random descriptions of every kind that is read; the same number gives the same one.

A mechanism is a chain of bars with what may follow it: a body, a slider, a bar that closes a loop,
or an X-joint in its place. Every point that moves is held by a spring, so that every unknown is;
stiffnesses, free lengths, rests, loads and moments are numbers, parameters and expressions in turn.
"""

from __future__ import annotations

import random
from typing import Any

KINDS = (
    "chain", "slider", "body", "free lengths", "turned springs", "moments", "moments without a potential", "loop",
    "loop of two freedoms", "x-joint", "equations", "potential",
)  # fmt: skip
RESTS: tuple[Any, ...] = (
    0,
    "pi/2",
    "pi",
    "-pi/2",
    {"cos": "3/5", "sin": "4/5"},
    {"cos": "-5/13", "sin": "12/13"},
)


def random_description(number: int) -> dict[str, Any]:
    """Under ``mechanism`` or ``system``."""
    kind = KINDS[number % len(KINDS)]
    dice = random.Random(f"description {number}")
    if kind in ("equations", "potential"):
        return {"system": _system(dice, kind)}
    return {"mechanism": _mechanism(dice, kind)}


def _system(dice: random.Random, kind: str) -> dict[str, Any]:
    unknowns = {
        name: dice.choice(["angle", "real", "length"])
        for name in ("x", "y", "z")[: dice.randint(1, 3)]
    }
    atoms: list[str] = []
    for name, domain in unknowns.items():
        many = dice.choice(["", "2*"])
        atoms += (
            [f"cos({many}{name})", f"sin({name} + pi/2)", f"sin({name})"]
            if domain == "angle"
            else [name]
        )

    def term() -> str:
        number = dice.choice(["2", "-1/3", "a", "(a - 2*b)^2", "b/3", "-c"])
        return "*".join([number, *(dice.choice(atoms) for _ in range(dice.randint(1, 3)))])

    def expression() -> str:
        return " + ".join(
            [*(term() for _ in range(dice.randint(2, 4))), dice.choice(["a", "1", "-b*c"])]
        )

    every = " + ".join(
        f"cos({n} - pi/2)" if domain == "angle" else f"{n}^4" for n, domain in unknowns.items()
    )
    if kind == "potential":
        return {
            "name": "s",
            "unknowns": unknowns,
            "potential": f"{every} + {expression()}",
            "positive": [atoms[0]],
        }
    equations = [
        f"{every} - ({expression()})",
        *(expression() + f" + {every}" for _ in list(unknowns)[1:]),
    ]
    found = {
        "name": "s",
        "unknowns": unknowns,
        "equations": equations,
        "positive": [expression(), f"2 - {atoms[-1]}"],
    }
    return found | ({"stable": [expression() for _ in unknowns]} if dice.random() < 1 / 2 else {})


def _mechanism(dice: random.Random, kind: str) -> dict[str, Any]:
    parameters: dict[str, Any] = {
        "L": {"kind": "length", "default": 1}, "k": {"kind": "stiffness", "default": 1, "alias": ["k1", "k2"]},
        "l0": {"kind": "free length"}, "F": {"kind": "force"}, "W": {"kind": "force"}, "M": {}, "b": {"kind": "base"},
    }  # fmt: skip
    unknowns: dict[str, str] = {}
    found: dict[str, Any] = {
        "name": "m", "parameters": parameters, "unknowns": unknowns, "points": {"O": [0, 0]}, "bars": [], "springs": [],
        "torsion": [], "loads": {}, "moments": {}, "bodies": {},
    }  # fmt: skip
    moving: list[str] = []
    if kind == "x-joint":
        _add_joints(dice, found, moving)
    else:
        bars = {"slider": 1, "body": 1, "loop": 2, "loop of two freedoms": 0}.get(
            kind, dice.randint(1, 3)
        )
        _add_chain(dice, found, moving, bars)
    if kind == "slider" or (kind == "free lengths" and dice.random() < 1 / 2):
        unknowns["s"] = dice.choice(["length", "real"])
        found["points"]["S"] = dice.choice(
            [["s", 0], ["b + 3/5*s", "1 + 4/5*s"], ["s^2/3 + s", "b"]]
        )
        moving.append("S")
    if kind in ("body", "loop of two freedoms") or (
        kind not in ("loop", "x-joint") and dice.random() < 1 / 4
    ):
        _add_body(dice, found, moving)
    if kind.startswith("loop"):
        found["points"]["G"] = ["b + 2", dice.choice(["0", "1/2"])]
        found["closing"] = [
            {"between": [moving[-1], "G"], "length": dice.choice(["3/2", "L", "2*L + 1/4"])}
        ]
    with_free = kind not in ("x-joint", "loop of two freedoms") and (
        kind == "free lengths" or dice.random() < 1 / 3
    )
    for n, point in enumerate(moving):
        _add_spring(dice, found, point, n, with_free)
    if len(moving) > 1 and kind != "x-joint":
        found["springs"].append({"between": ["O", moving[-1]], "k": dice.choice([1, "k2"])})
    _add_turned_springs(dice, found, 2 if kind == "turned springs" else dice.choice([0, 0, 1]))
    loaded = dice.sample(moving, dice.randint(1, min(2, len(moving))))
    for point in loaded:
        found["loads"][point] = dice.choice(
            [["F", "-W"], {"weight": "W"}, ["1/3", "F*L - W"], [0, "-2*W"]]
        )
    _add_moments(dice, found, kind)
    used = str([found[key] for key in found if key not in ("parameters", "name")])
    if "k1" not in used and "k2" not in used:
        found["springs"][0]["k"] = "k1"
    return {key: value for key, value in found.items() if value not in ([], {})}


def _add_chain(dice: random.Random, found: dict[str, Any], moving: list[str], bars: int) -> None:
    """Bars P1, P2 ... whose angles are against the ground or the bar before."""
    x, y, before = "0", "0", "O"
    direction = ""
    for k in range(1, bars + 1):
        found["unknowns"][f"th{k}"] = "angle"
        against = direction and bars != 2 and dice.random() < 2 / 3
        direction = f"{direction} {dice.choice('+-')} th{k}" if against else f"th{k}"
        if dice.random() < 1 / 4:
            direction += " + pi/2"
        length = dice.choice(["L", "1", "3/2", "(L + 1/2)"] if bars != 2 else ["4/5", "1", "3/2"])
        x, y = f"{x} + {length}*cos({direction})", f"{y} + {length}*sin({direction})"
        found["points"][f"P{k}"] = [x, y]
        found["bars"].append([before, f"P{k}"])
        before = f"P{k}"
        moving.append(before)


def _add_joints(dice: random.Random, found: dict[str, Any], moving: list[str]) -> None:
    """One X-joint, or two with numbers for lengths that stand on each other."""
    number = dice.randint(1, 2)
    found["points"]["A"] = ["b + 1" if number == 1 else 1, 0]
    joints: dict[str, Any] = {}
    base = ["O", "A"]
    for k in range(1, number + 1):
        found["unknowns"][f"th{k}"] = "angle"
        top = [f"B{k}", f"C{k}"]
        bars = dice.choice(["5/2", "1/3", "L + b + 2"][: 4 - number])
        joints[f"X{k}"] = {"base": base, "bars": bars, "angles": [f"th{k}", f"psi{k}"], "top": top}
        base = top
        moving += top
    found["x-joint"] = joints


def _add_body(dice: random.Random, found: dict[str, Any], moving: list[str]) -> None:
    at: Any = moving[-1] if moving else ""
    found["unknowns"]["phi"] = "angle"
    if not at or dice.random() < 1 / 2:
        found["unknowns"] |= {"u": "length", "v": "length"}
        at = ["u", "v - b"]
    angle = dice.choice(["phi", "phi - pi/2", "2*phi"])
    found["bodies"]["plate"] = {
        "at": at,
        "angle": angle,
        "points": {"Q": ["1/2", 0], "R": ["-1/3", "L"]},
    }
    moving += ["Q", "R"]


def _add_spring(
    dice: random.Random, found: dict[str, Any], point: str, number: int, with_free: bool
) -> None:
    """To a point of its own on the ground."""
    end = f"A{number}"
    x, y = (f"{dice.randint(-9, 9)}/{dice.randint(2, 7)}" for _ in range(2))
    found["points"][end] = [dice.choice([x, f"b + {x}"]), f"{y} + 1/11"]
    spring = {"between": [end, point], "k": dice.choice([1, "k1", "k2", "2*k1 + 1/3", "3/4"])}
    if with_free and dice.random() < 2 / 3:
        spring["free"] = dice.choice(["l0", "1/5", "2*l0 + 1/7"])
    found["springs"].append(spring)


def _add_turned_springs(dice: random.Random, found: dict[str, Any], number: int) -> None:
    angles = [name for name, kind in found["unknowns"].items() if kind == "angle"]
    for _ in range(number if angles else 0):
        angle = dice.choice(angles)
        if len(angles) > 1 and dice.random() < 1 / 2:
            angle = f"{dice.choice(['', '2*'])}{angles[0]} - {angles[1]} + pi/2"
        found["torsion"].append(
            {"angle": angle, "k": dice.choice(["1/2", "k1", "k2*L"]), "rest": dice.choice(RESTS)}
        )


def _add_moments(dice: random.Random, found: dict[str, Any], kind: str) -> None:
    names = list(found["unknowns"])
    own = names[0] if found["unknowns"][names[0]] == "angle" else names[-1]
    wave = [f"cos({own})", f"sin({own})"]
    if kind == "moments" or dice.random() < 1 / 4:
        found["moments"][own] = dice.choice(
            [
                "M",
                f"M*{wave[0]} + 1/3",
                f"M - 2*{wave[1]}^3 + {wave[0]}^2*{wave[1]}^2*L",
                f"M*sin(2*{own} + pi/2)^2",
            ]
        )
    if "s" in names and dice.random() < 1 / 2:
        found["moments"]["s"] = dice.choice(["M", "M*s^2 - s/3 + 1"])
    if kind == "moments without a potential":
        other = names[1] if len(names) > 1 else names[0]
        found["moments"][own] = (
            f"M + cos({other})" if other == own else f"M*sin({own} - {other}) + W"
        )
