"""Descriptions of mechanisms: what is derived from one, what is refused, and the paper's."""

from __future__ import annotations

import time
from copy import deepcopy
from fractions import Fraction
from typing import Any

import pytest
import yaml

from ptmcad.errors import ConfigError
from ptmcad.exact.models.modelsystem import elements_of, system_from
from ptmcad.model import Kind, Mechanism, described, mechanism_of, ptm
from ptmcad.model.builtinmechanisms import RECORD
from ptmcad.model.compile import compiled
from ptmcad.model.evaluate import evaluate, value_at
from ptmcad.text.flint_numbers import from_fraction
from ptmcad.text.syntax import parse

PAPER = """
name: ptm
parameters:
  L1: {kind: length, default: 1, range: [0, 4]}
  L2: {kind: length, default: 1, range: [0, 4]}
  rho: {kind: base, default: 1, range: [0, 4]}          # may be zero, not negative
  k: {kind: stiffness, default: 100, range: [0, 200], alias: [k1, k2, k3]}
  l0: {kind: free length, default: 0, range: [0, 1], alias: [l0_1, l0_2, l0_3]}
  F3: {kind: force, range: [-30, 0]}
  F4: {kind: force, range: [-30, 0]}
  F3x: {kind: force, range: [-30, 30]}
  F4x: {kind: force, range: [-30, 30]}
unknowns: {th1: angle, th2: angle}                      # angle: on the circle; length: on the line
points:
  A1: [0, 0]
  A2: [rho, 0]
  A3: [L1*cos(th1), L1*sin(th1)]
  A4: [rho - L2*cos(th2), L2*sin(th2)]
bars: [[A1, A3], [A2, A4]]
supports: {A1: pin, A2: slider x}
springs:
  - {between: [A1, A4], k: k1, free: l0_1}
  - {between: [A2, A3], k: k2, free: l0_2}
  - {between: [A3, A4], k: k3, free: l0_3}
loads: {A3: [F3x, F3], A4: [F4x, F4]}
"""


def test_the_built_in_record_is_the_one_of_the_design() -> None:
    """Written in YAML as a user would, the symmetries apart."""
    mine = described(yaml.safe_load(PAPER))
    assert mine == described({key: value for key, value in RECORD.items() if key != "symmetries"})
    assert mechanism_of("ptm") is ptm()


def test_what_follows_from_the_description() -> None:
    m = ptm()
    assert m.angles == ("th1", "th2")
    assert m.without_free_lengths == ("L1", "L2", "rho", "k1", "k2", "k3", "F3", "F4", "F3x", "F4x")
    assert m.free_lengths == ("l0_1", "l0_2", "l0_3")
    assert m.variables == m.without_free_lengths + m.free_lengths
    assert m.positive == ("L1", "L2", "k1", "k2", "k3")
    assert m.nonnegative == ("rho", "l0_1", "l0_2", "l0_3")
    assert m.stiffnesses == ("k1", "k2", "k3")
    assert m.forces == ("F3", "F4", "F3x", "F4x")
    assert m.shorthands == {"k": ("k1", "k2", "k3"), "l0": ("l0_1", "l0_2", "l0_3")}
    assert m.moving == ("A3", "A4")
    assert [spring.name for spring in m.springs] == ["k1", "k2", "k3"]
    assert tuple(m.parameters)[-4:] == ("l0", *m.free_lengths)
    assert (m.parameters["k2"].default, m.parameters["F3"].default) == ("k", "0")


# Wenger & Chablat, "Kinetostatic analysis and solution classification of a planar tensegrity
# mechanism", equation (1): half of k times the squared lengths of the springs, and the work of the
# loads, with each written out in the angles.
EQUATION_1 = """
  k1/2*(rho^2 + L2^2 - 2*rho*L2*cos(th2)) + k2/2*(rho^2 + L1^2 - 2*rho*L1*cos(th1))
+ k3/2*((rho - L2*cos(th2) - L1*cos(th1))^2 + (L2*sin(th2) - L1*sin(th1))^2)
- F3*L1*sin(th1) - F4*L2*sin(th2) - F3x*L1*cos(th1) - F4x*(rho - L2*cos(th2))
"""
LENGTHS = """
rho^2 + L2^2 - 2*rho*L2*cos(th2)
rho^2 + L1^2 - 2*rho*L1*cos(th1)
rho^2 + L1^2 + L2^2 - 2*rho*L1*cos(th1) - 2*rho*L2*cos(th2) + 2*L1*L2*cos(th1 + th2)
"""


class InRing:
    """Trees in the ring of the paper's system."""

    ring = system_from(ptm()).ring

    def constant(self, value: Fraction) -> Any:
        return self.ring.context.constant(from_fraction(value))

    def parameter(self, name: str) -> Any:
        return self.ring.parameter(name)

    def cos(self, angle: str) -> Any:
        return self.ring.cos(angle)

    def sin(self, angle: str) -> Any:
        return self.ring.sin(angle)

    def value(self, text: str) -> Any:
        return self.ring.reduce(evaluate(parse(text.replace("\n", " ")), self))


@pytest.mark.parametrize(
    "text", [EQUATION_1], ids=["Wenger & Chablat (1), springs and horizontal loads of their own"]
)
def test_the_potential_is_the_published_one(text: str) -> None:
    assert system_from(ptm()).potential == InRing().value(text)


def test_squared_lengths_are_the_law_of_cosines() -> None:
    expected = tuple(InRing().value(line) for line in LENGTHS.strip().splitlines())
    assert elements_of(ptm(), [spring.square for spring in compiled(ptm()).springs]) == expected


def test_bars_have_the_lengths_of_their_parameters() -> None:
    points = compiled(ptm()).points
    for (start, end), length in zip(ptm().bars, ("L1", "L2"), strict=True):
        (x0, y0), (x1, y1) = points[start], points[end]
        (square,) = elements_of(ptm(), [(x1 - x0).squared() + (y1 - y0).squared()])
        assert square == system_from(ptm()).ring.parameter(length) ** 2


# ------------------------------------------------------------------------------------------------------- other ones


PENDULUM: dict[str, Any] = yaml.safe_load("""
name: pendulum
parameters:
  m: {kind: force, default: 1}
  c: {kind: stiffness, default: 1, alias: [c1]}
  a: {default: 1/2}
unknowns: {phi: angle, x: length}
points: {O: [0, 0], P: [x + cos(2*phi), a*sin(phi - 3*phi)]}
springs: [{between: [O, P], k: 2*c}, {between: [O, P], k: c1}, {between: [P, O], k: c1, free: 1}]
loads: {P: [0, -m]}
""")


def test_another_mechanism() -> None:
    m = described(PENDULUM)
    assert m.variables == ("m", "c", "c1", "a")
    assert m.shorthands == {}  # c is used itself
    assert m.kind("a") is Kind.NUMBER
    assert (m.angles, m.moving) == (("phi",), ("P",))
    assert [spring.name for spring in m.springs] == ["OP", "c1", "PO"]
    assert m.parameters["a"].window is None
    assert value_at(m.springs[0].stiffness, {"c": Fraction(1, 3)}) == Fraction(2, 3)


def test_a_description_is_known_by_its_contents() -> None:
    other = {key: entry for key, entry in deepcopy(RECORD).items() if key != "symmetries"}
    other["springs"][0]["k"] = "2*k1"  # type: ignore[index]
    changed: Mechanism = described(other)
    assert changed != ptm()
    assert described(deepcopy(RECORD)) == ptm()
    assert system_from(changed).potential != system_from(ptm()).potential


@pytest.mark.parametrize("size", [400, 10_000])
def test_large_descriptions_take_less_than_a_second(size: int) -> None:
    """What cannot be computed with is refused at once."""
    number = range(size)
    record = {
        "name": "mat",
        "parameters": {"k": {"kind": "stiffness", "default": 1}},
        "unknowns": {"t": "angle"},
        "points": {"O": [0, 1], **{f"P{n}": ["cos(t)", "sin(t)"] for n in number[:-1]}},
        "springs": [{"between": ["O", f"P{n}"], "k": "k"} for n in number[:-1]],
        "bars": [["P0", f"P{n}"] for n in number[1:-1]],
    }
    start = time.process_time()
    if size > 400:
        with pytest.raises(ConfigError, match="10000 entries, more than the 400"):
            described(record)
    else:
        assert len(described(record).springs) == 399
    assert time.process_time() - start < 1
