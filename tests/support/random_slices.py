"""Random slices of the mechanism, the same in every run: any two parameters as axes, linked, loaded
sideways, ugly.

`drawn(number, attempt)` is a problem record. The numbers have fixed roles, so that every unordered
pair of the model's parameters occurs; the rest of a record comes from a generator with the seed
(number, attempt). Attempts that the engine has to refuse (the whole slice inside the variety, a
length that is not positive) stand in `REFUSED` with the exception's name, and the next attempt
takes their place.

Left out, because they take minutes: more than four slices with three different springs and four
loads; formulas of a degree above 2 in the axes; and windows narrower than a tenth around a cusp,
which `test_degenerate_geometry` has.

Points of the variety that are rational come from the equations: at an equilibrium with the angles
th1, th2

    H11 = L1 (a1 - k3 L2 c2) / c1,   H22 = L2 (a2 - k3 L1 c1) / c2,   H12 = -k3 L1 L2 c12,

with a1 = (k2 + k3) rho + F3x and a2 = (k1 + k3) rho - F4x, so that det H = 0 is linear in a2. The
third derivative along the kernel (v1, v2) is 3 k3 L1 L2 s12 v1 v2 (v1 + v2) there, which vanishes,
for a cusp, when H11 = H12 = H22.
"""

from __future__ import annotations

import random
from dataclasses import dataclass, field
from fractions import Fraction
from itertools import combinations
from typing import Any

LENGTHS, SPRINGS, FORCES = ("L1", "L2", "rho"), ("k1", "k2", "k3", "k"), ("F3", "F4", "F3x", "F4x")
MODEL = LENGTHS + SPRINGS + FORCES
PAIRS = tuple(combinations(MODEL, 2))

Record = dict[str, Any]


@dataclass(frozen=True)
class Draw:
    """A problem record, and a rational point of its window that is known to lie on the variety, if
    there is one.
    """

    record: Record
    role: str
    anchor: dict[str, Fraction] = field(default_factory=dict)

    @property
    def axes(self) -> tuple[str, ...]:
        return tuple(self.record["axes"])


def drawn(number: int, attempt: int = 0) -> Draw:
    """The slice with this number."""
    dice = random.Random(f"{number}/{attempt}")
    role = ROLES[number]
    make = {
        "pair": _pair, "link": _link, "paper": _paper, "unloaded": _unloaded, "formula": _formula, "fold": _fold,
        "cusp": _cusp, "general": _general, "tiny": _tiny, "flat": _flat,
    }[role]  # fmt: skip
    draw = make(dice, number)
    if dice.random() < 1 / 4:
        draw.record["axes"] = dict(reversed(draw.record["axes"].items()))
    draw.record["count"] = dice.choice(["stable", "total", "index", "index"])
    draw.record["name"] = f"random-{number:03d}"
    return draw


# ------------------------------------------------------------------------------------------------------------- numbers


def _number(dice: random.Random, *simple: str) -> Fraction:
    """One of the simple numbers; in one of six cases changed a little, to a number with a long
    denominator.
    """
    value = Fraction(dice.choice(simple))
    style = dice.random()
    if style < 1 / 12:
        return value + Fraction(dice.randint(-99, 99), 997)
    if style < 2 / 12:
        return value + Fraction(dice.randint(-(10**7), 10**7), 10**9)
    return value


def _value(dice: random.Random, name: str) -> Fraction:
    """A value for a parameter that is fixed."""
    if name in ("L1", "L2"):
        return _number(dice, "1", "1", "3/2", "2/3", "7/5", "1/2")
    if name == "rho":
        return _number(dice, "1/2", "3/4", "1", "2/5")
    if name in SPRINGS:
        return _number(dice, "100", "100", "60", "150")
    if name in ("F3", "F4"):
        return _number(dice, "-10", "-10", "-30", "20", "5", "-70", "0")
    return _number(dice, "0", "0", "5", "-8", "25")


def _window(dice: random.Random, name: str) -> tuple[Fraction, Fraction]:
    """A range: ordinary, from zero, shifted, vast or narrow."""
    style = dice.choices(["ordinary", "zero", "shifted", "vast", "narrow"], [6, 4, 2, 2, 1])[0]
    scale = {**dict.fromkeys(LENGTHS, 1), **dict.fromkeys(SPRINGS, 100)}.get(name, 20)
    force = name not in LENGTHS + SPRINGS
    if style == "zero":
        high = scale * _number(dice, "1", "2", "3/2")
        return (-high, Fraction(0)) if force and dice.random() < 1 / 2 else (Fraction(0), high)
    if style == "shifted":
        low = scale * _number(dice, "1/3", "1/2", "1/4")
        return low, low + scale * _number(dice, "1", "3/2")
    if style == "vast":
        return (Fraction(-scale * 100) if force else Fraction(0)), Fraction(scale * 100)
    if style == "narrow":
        middle = scale * _number(dice, "1/2", "1", "3/4")
        return middle - scale * Fraction(1, 100), middle + scale * Fraction(1, 70)
    return (
        -scale * _number(dice, "1", "3/2") if force else scale * _number(dice, "1/5", "1/10")
    ), scale * Fraction(2)


def _record(axes: dict[str, tuple[Fraction, Fraction]], parameters: dict[str, Any]) -> Record:
    return {
        "axes": {name: [str(low), str(high)] for name, (low, high) in axes.items()},
        "parameters": {name: str(value) for name, value in parameters.items() if name not in axes},
    }


def _windows(dice: random.Random, *names: str) -> dict[str, tuple[Fraction, Fraction]]:
    return {name: _window(dice, name) for name in names}


def _springs(dice: random.Random, equal: float) -> dict[str, Fraction]:
    if dice.random() < equal:
        return {"k": _value(dice, "k")}
    return {name: _value(dice, name) for name in ("k1", "k2", "k3")}


def _fixed(
    dice: random.Random, axes: tuple[str, ...], equal: float, sideways: float
) -> dict[str, Fraction]:
    """Values of all that is not an axis."""
    values = {name: _value(dice, name) for name in ("L1", "L2", "rho", "F3", "F4")}
    if dice.random() < sideways:
        values |= {name: _value(dice, name) for name in ("F3x", "F4x")}
    springs = set(axes) & set(SPRINGS)
    if not springs:
        values |= _springs(dice, equal)
    elif "k" not in springs:
        values |= {name: _value(dice, name) for name in ("k1", "k2", "k3")}
    elif len(springs) == 1 and dice.random() < 1 / 2:
        values |= {dice.choice(["k1", "k2", "k3"]): _value(dice, "k")}
    return {name: value for name, value in values.items() if name not in axes}


# --------------------------------------------------------------------------------------------------------------- roles


def _pair(dice: random.Random, number: int) -> Draw:
    """Two parameters of the model as axes, one draw for each pair."""
    axes = PAIRS[number]
    return Draw(_record(_windows(dice, *axes), _fixed(dice, axes, 1 / 2, 1 / 4)), "pair")


def _link(dice: random.Random, number: int) -> Draw:
    """A parameter of the model and a free name, on which one, two or three loads depend linearly."""
    name = MODEL[number % len(MODEL)]
    loads = [n for n in FORCES[:2] if n != name]
    parameters: dict[str, Any] = _fixed(dice, (name,), 2 / 3, 1 / 6)
    parameters |= {n: dice.choice(["F", "F", "-F", "2*F", "F/3", "F-5", "1-F/2"]) for n in loads}
    if dice.random() < 1 / 5:
        parameters["F3x" if name != "F3x" else "F4x"] = dice.choice(["F", "F/4", "-F+1"])
    return Draw(_record(_windows(dice, name, "F"), parameters), "link")


def _paper(dice: random.Random, _number_: int) -> Draw:
    """Equal springs and vertical loads, as in the paper."""
    axes = dice.choice([p for p in PAIRS if set(p) <= {"L1", "L2", "rho", "F3", "F4"}])
    return Draw(_record(_windows(dice, *axes), _fixed(dice, axes, 1, 0)), "paper")


def _unloaded(dice: random.Random, _number_: int) -> Draw:
    """No vertical loads; sideways loads in some."""
    axes = dice.choice([p for p in PAIRS if not set(p) & {"F3", "F4"}])
    values = _fixed(dice, axes, 1 / 3, 1 / 3) | {"F3": 0, "F4": 0}
    return Draw(_record(_windows(dice, *axes), values), "unloaded")


FORMULAS: tuple[tuple[tuple[str, str], dict[str, str]], ...] = (
    (("rho", "s"), {"L2": "rho*s", "F3": "-10", "F4": "-10"}),
    (("rho", "s"), {"L2": "1+s", "L1": "1", "F3": "-10*s", "F4": "-10"}),
    (("rho", "F"), {"L2": "1/(1+rho)", "F3": "F", "F4": "F"}),
    (("rho", "F"), {"L2": "3/2", "F3": "F*rho", "F4": "-10"}),
    (("L2", "F"), {"rho": "L2/2", "F3": "F", "F4": "-F/2"}),
    (("L1", "L2"), {"rho": "(L1+L2)/3", "F3": "-10", "F4": "-10"}),
    (("L1", "L2"), {"rho": "(L1+L2)/2"}),
    (("s", "k"), {"L1": "3/2", "L2": "1+s^2/3", "rho": "1/4+s^2/6", "F3": "0"}),
    (("L1", "L2"), {"rho": "L1*L2/2"}),
    (("s", "L2"), {"rho": "s^2", "F3": "-5"}),
    (("s", "t"), {"rho": "(s+t)/2", "L2": "s", "F3": "-10", "F4": "-10"}),
    (("s", "t"), {"L1": "1+s", "L2": "1+t", "rho": "(s+t)/2+3/4"}),
    (("k", "s"), {"k3": "k*s", "F3": "-10", "F4": "-10", "rho": "3/4"}),
    (("F", "s"), {"F3": "F*s", "F4": "F", "rho": "3/5"}),
    (("F", "rho"), {"F3": "F^2/40", "F4": "-10", "L2": "3/2"}),
    (("F", "L2"), {"F3x": "F", "F4x": "-F", "rho": "1/2"}),
    (("rho", "L2"), {"L1": "L2", "F3": "-10", "F4": "-20"}),
    (("s", "F3"), {"L2": "(s-1)^2+1/4", "F4": "-10", "rho": "2/3"}),
    (("rho", "s"), {"L2": "1+s/10", "k1": "100+50*s", "k2": "100", "k3": "80"}),
    (("L2", "k3"), {"k1": "k3", "k2": "100", "rho": "3/4", "F3": "-10", "F4": "-10"}),
)
"""Axes and parameters that depend on them: products, quotients, squares."""


def _formula(dice: random.Random, number: int) -> Draw:
    axes, parameters = FORMULAS[number % len(FORMULAS)]
    windows = {}
    for name in axes:
        like = "rho" if name in ("s", "t") else name
        windows[name] = _window(dice, like)
    values = dict(parameters)
    for name in ("F3", "F4", "rho"):
        if (
            dice.random() < 1 / 3
            and name not in axes
            and values.get(name, "1").lstrip("-").replace("/", "").isdigit()
        ):
            values[name] = str(_value(dice, name))
    return Draw(_record(windows, values), "formula")


def _flat(dice: random.Random, _number_: int) -> Draw:
    """Rods that may lie flat with their nodes on one line over the whole window: without loads that
    is refused.
    """
    values = {
        "rho": dice.choice(["(L1+L2)/2", "(L1+L2)/2", "(L1+L2)/3"]),
        "F3": dice.choice(["0", "-10", "20"]),
    }
    return Draw(_record(_windows(dice, "L1", "L2"), values), "flat")


def _general(dice: random.Random, _number_: int) -> Draw:
    """Three different springs and four loads: the most expensive."""
    axes = dice.choice([("rho", "F3"), ("F3", "F4"), ("rho", "F4"), ("F3x", "F4"), ("k1", "F3")])
    values = {name: _value(dice, name) for name in ("L1", "L2", "rho", "F3", "F4")}
    values |= {"F3x": Fraction(dice.choice([5, -3, 8])), "F4x": Fraction(dice.choice([-2, 4, 9]))}
    values |= {
        "k1": Fraction(100),
        "k2": Fraction(dice.choice([80, 120])),
        "k3": Fraction(dice.choice([60, 150])),
    }
    return Draw(_record(_windows(dice, *axes), values), "general")


ANGLES = tuple(
    (Fraction(c, h), Fraction(s, h))
    for c, s, h in (
        (3, 4, 5),
        (4, 3, 5),
        (5, 12, 13),
        (12, 5, 13),
        (-3, 4, 5),
        (-4, 3, 5),
        (15, 8, 17),
        (8, -15, 17),
    )
)
"""Cosine and sine."""


def singular(
    first: tuple[Fraction, Fraction], second: tuple[Fraction, Fraction], lengths: tuple[Fraction, Fraction],
    springs: tuple[Fraction, Fraction, Fraction], rho: Fraction, f3x: Fraction | None
) -> dict[str, Fraction]:  # fmt: skip
    """Parameters with a singular equilibrium at these angles; a cusp of the variety when ``f3x`` is
    None.
    """
    (c1, s1), (c2, s2) = first, second
    (length1, length2), (k1, k2, k3) = lengths, springs
    c12, s12 = c1 * c2 - s1 * s2, s1 * c2 + c1 * s2
    if f3x is None:
        a1, a2 = k3 * length2 * (c2 - c1 * c12), k3 * length1 * (c1 - c2 * c12)
    else:
        a1 = (k2 + k3) * rho + f3x
        a2 = k3 * length1 * c1 + k3**2 * length1 * length2 * c1 * c2 * c12**2 / (
            a1 - k3 * length2 * c2
        )
    return {
        "L1": length1, "L2": length2, "rho": rho, "k1": k1, "k2": k2, "k3": k3,
        "F3": (a1 * s1 - k3 * length2 * s12) / c1, "F4": (a2 * s2 - k3 * length1 * s12) / c2,
        "F3x": a1 - (k2 + k3) * rho, "F4x": (k1 + k3) * rho - a2,
    }  # fmt: skip


def paper_cusp(
    first: tuple[Fraction, Fraction], second: tuple[Fraction, Fraction]
) -> dict[str, Fraction]:
    """A cusp with equal springs, no sideways loads and L1 = 1: L2 = s2 / s1, 2 rho = L2 s1 s12,
    F3 = -k L2 s12 c1.
    """
    (c1, s1), (c2, s2) = first, second
    s12 = s1 * c2 + c1 * s2
    length2 = s2 / s1
    springs = (Fraction(100), Fraction(100), Fraction(100))
    return singular(first, second, (Fraction(1), length2), springs, length2 * s1 * s12 / 2, None)


def _around(
    dice: random.Random, name: str, value: Fraction, width: Fraction
) -> tuple[Fraction, Fraction]:
    """A range that holds the value, off its middle; lengths and springs stay positive."""
    scale = width * (20 if name in FORCES else 100 if name in SPRINGS else 1)
    low, high = (
        value - scale * Fraction(dice.randint(1, 9), 10),
        value + scale * Fraction(dice.randint(1, 9), 10),
    )
    return (low if name in FORCES else max(low, Fraction(0))), high


def _anchored(
    dice: random.Random,
    role: str,
    values: dict[str, Fraction],
    axes: tuple[str, str],
    widths: tuple[str, ...],
) -> Draw:
    width = Fraction(dice.choice(widths))
    windows = {name: _around(dice, name, values[name], width) for name in axes}
    return Draw(_record(windows, values), role, {name: values[name] for name in axes})


def _fold(dice: random.Random, _number_: int) -> Draw:
    """Through a rational point of the fold curve."""
    first, second = dice.choice(
        [(a, b) for a in ANGLES for b in ANGLES if a[0] * b[0] != a[1] * b[1]]
    )
    springs = dice.choice([(100, 100, 100), (100, 100, 100), (80, 120, 100)])
    k1, k2, k3 = map(Fraction, springs)
    lengths = (Fraction(1), Fraction(dice.choice(["1", "3/2", "1/2", "7/5"])))
    values = singular(
        first,
        second,
        lengths,
        (k1, k2, k3),
        Fraction(dice.choice(["1/2", "3/4", "1"])),
        Fraction(0),
    )
    axes = dice.choice([("F3", "F4"), ("rho", "F4"), ("rho", "F4x"), ("L2", "rho"), ("F3", "L1")])
    return _anchored(dice, "fold", values, axes, ("1", "1/10", "1/1000", "1e-12", "1e-30"))


def _cusp(dice: random.Random, _number_: int) -> Draw:
    """Through a rational cusp of the fold curve."""
    first, second = dice.choice(
        [(a, b) for a in ANGLES[:4] for b in ANGLES[:4] if a[0] * b[0] != a[1] * b[1]]
    )
    axes = dice.choice([("F3", "F4"), ("rho", "L2"), ("rho", "F4"), ("L2", "F3")])
    return _anchored(dice, "cusp", paper_cusp(first, second), axes, ("1", "1/2", "1/10"))


def _tiny(dice: random.Random, _number_: int) -> Draw:
    """A window of width 10^-3 to 10^-25, near the fold curve or not."""
    axes = dice.choice([p for p in PAIRS if "k" not in p])
    values = _fixed(dice, axes, 1, 1 / 4)
    width = Fraction(1, 10 ** dice.choice([3, 6, 12, 25]))
    windows = {name: _around(dice, name, _value(dice, name), width) for name in axes}
    return Draw(_record(windows, values), "tiny")


ROLES = (
    ["pair"] * len(PAIRS) + ["link"] * (2 * len(MODEL)) + ["formula"] * (2 * len(FORMULAS)) + ["paper"] * 30
    + ["unloaded"] * 20 + ["fold"] * 20 + ["cusp"] * 16 + ["tiny"] * 12 + ["general"] * 4 + ["flat"] * 5
)  # fmt: skip
NUMBERS = range(len(ROLES))

REFUSED: dict[int, tuple[str, ...]] = {
    220: ("DegenerateSliceError",),
    223: ("DegenerateSliceError",),
}
"""For a number, the exceptions of the attempts before the one that is classified."""
