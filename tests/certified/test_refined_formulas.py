"""The formulas made by hand for the built-in mechanism equal those derived from its description, in exact arithmetic.

All are rational in the parameters, the cosines and sines and the lengths. Over a prime field whose size is far beyond
their degrees, formulas that differ agree at a random point with a chance below 1e-15 (Schwartz and Zippel). There,
lengths are square roots, angles are pairs on the circle, and loads or stiffnesses that make a configuration an
equilibrium are the solution of linear equations.
"""

from __future__ import annotations

import random
from collections.abc import Mapping
from dataclasses import dataclass, replace
from fractions import Fraction

import pytest

from ptmcad.certified.formula import Formula, Graph, Operation
from ptmcad.certified.potential import potential
from ptmcad.certified.ptm.cones import excess_of_pull, height_squared
from ptmcad.certified.ptm.statics import PHI_UNIT, Angles, Hessian, Statics, statics
from ptmcad.mechanism import ptm

PRIME = 2**61 - 1
NAMES = ptm().variables
TH1, TH2, PHI = 2, 3, 4
Multiples = dict[int, Fraction]
"""An angle as multiples of the variables."""


class NoRootError(Exception):
    """The point has no square root, or a division by zero: another one has to be taken."""


def root(value: int) -> int:
    """The same square root for every occurrence of a number."""
    found = pow(value, (PRIME + 1) // 4, PRIME)
    if found * found % PRIME != value % PRIME:
        raise NoRootError
    return found


def inverse(value: int) -> int:
    if value % PRIME == 0:
        raise NoRootError
    return pow(value, -1, PRIME)


def circle_point(t: int) -> tuple[int, int]:
    return (1 - t * t) * inverse(1 + t * t) % PRIME, 2 * t * inverse(1 + t * t) % PRIME


@dataclass(repr=False)
class Point:
    """A point of the prime field: variables by number, and for angles the cosine and sine of a part of the variable."""

    variables: dict[int, int]
    parts: Mapping[int, tuple[Fraction, tuple[int, int]]]
    known: dict[int, int]

    def __call__(self, formula: Formula) -> int:
        if formula.number not in self.known:
            self.known[formula.number] = self._value(formula) % PRIME
        return self.known[formula.number]

    def _value(self, f: Formula) -> int:
        if f.value is not None:
            return modular(f.value)
        if f.operation is Operation.VARIABLE:
            return self.variables[f.variable]
        assert f.a is not None
        if f.operation in (Operation.SINE, Operation.COSINE):
            return self.wave(multiples(f.a))[f.operation is Operation.SINE]
        a = self(f.a)
        if f.operation is Operation.NEGATE:
            return -a
        if f.operation is Operation.SQUARE:
            return a * a
        assert f.b is not None
        b = self(f.b)
        if f.operation is Operation.ADD:
            return a + b
        if f.operation is Operation.SUBTRACT:
            return a - b
        if f.operation is Operation.MULTIPLY:
            return a * b
        if f.operation is Operation.DIVIDE:
            return a * inverse(b)
        if f.operation is Operation.MEET:
            assert a == b, "two formulas of one number differ"
            return a
        length = root(a * a + b * b)
        if f.operation is Operation.LENGTH:
            return length
        return (a if f.operation is Operation.DIRECTION else 1) * inverse(length)

    def wave(self, angle: Multiples) -> tuple[int, int]:
        cosine, sine = 1, 0
        for variable, multiple in angle.items():
            part, (c, s) = self.parts[variable]
            times = multiple / part
            assert times.denominator == 1 and times >= 0
            for _ in range(int(times)):
                cosine, sine = (cosine * c - sine * s) % PRIME, (sine * c + cosine * s) % PRIME
        return cosine, sine


def multiples(f: Formula) -> Multiples:
    """The argument of a sine or cosine."""
    if f.operation is Operation.VARIABLE:
        return {f.variable: Fraction(1)}
    assert f.a is not None and f.b is not None
    if f.operation is Operation.ADD:
        return multiples(f.a) | multiples(f.b)
    assert f.operation is Operation.MULTIPLY
    factor, rest = (f.a, f.b) if f.a.value is not None else (f.b, f.a)
    assert factor.value is not None
    return {variable: factor.value * multiple for variable, multiple in multiples(rest).items()}


@dataclass(repr=False)
class Case:
    """Formulas of both kinds over one graph; parameters are variables, but those that are zero or tied to another."""

    graph: Graph
    values: dict[str, Formula]
    angles: Angles
    statics: Statics
    gradient: tuple[Formula, Formula]
    hessian: tuple[Formula, Formula, Formula]
    lengths: tuple[Formula, ...]


def case(zero: tuple[str, ...], tied: Mapping[str, str], *, phi: bool, positive_base: bool = False) -> Case:
    graph = Graph()
    values = {name: graph.variable(10 + n) for n, name in enumerate(NAMES)}
    values |= {name: graph.constant(0) for name in zero} | {name: values[other] for name, other in tied.items()}
    th1, th2 = graph.variable(TH1), graph.variable(TH2)
    creases = tied.get("rho") == "L2", tied.get("rho") == "L1"
    angles = Angles(th1, th2, PHI_UNIT * graph.variable(PHI) if phi else None, creases)
    derived = potential(ptm(), values, {"th1": th1, "th2": th2})
    first, second = (graph.derivative(derived.energy, n) for n in (TH1, TH2))
    second_derivatives = (graph.derivative(first, TH1), graph.derivative(first, TH2), graph.derivative(second, TH2))
    m = statics(values, angles, positive_base=positive_base)
    return Case(graph, values, angles, m, (first, second), second_derivatives, derived.lengths)


def random_point(c: Case, rng: random.Random, balanced: tuple[str, str] | None) -> Point:
    """A point at which all lengths are in the field; an equilibrium if two parameters may balance the gradient."""
    for _ in range(1000):
        variables = {n: rng.randrange(1, PRIME) for n in range(10, 10 + len(NAMES))}
        halves = {n: (Fraction(1, 2), circle_point(rng.randrange(PRIME))) for n in (TH1, TH2)}
        point = Point(variables, halves, {})
        try:
            if balanced:
                point = solved(c, point, balanced)
            d3 = tuple(point(x) for x in c.statics.vectors[2])
            l3 = root(d3[0] ** 2 + d3[1] ** 2)
            unit = (d3[0] * inverse(l3) % PRIME, d3[1] * inverse(l3) % PRIME)
            point = replace(point, parts={**halves, PHI: (Fraction(PHI_UNIT), unit)}, known={})
            # with creases a length has a formula of its own, of either sign in this field
            if all(point(f) == point(g) for f, g in zip(c.statics.lengths, c.lengths, strict=True)):
                return point
        except NoRootError:
            continue
    raise AssertionError("the lengths differ from the derived ones at every point")


def solved(c: Case, point: Point, names: tuple[str, str]) -> Point:
    """The point with values of two parameters, one linear in each component, at which the gradient vanishes."""
    variables = dict(point.variables)
    for name, component in zip(names, c.gradient, strict=True):
        number = c.values[name].variable
        slope = point(c.graph.derivative(component, number))
        variables[number] = (variables[number] - point(component) * inverse(slope)) % PRIME
    return replace(point, variables=variables, known={})


LOADS = ("F3", "F4", "F3x", "F4x")
CASES = {
    "all different": ((), {}),
    "no free length of spring 3": (("l0_3",), {}),
    "no free lengths of springs 1 and 2": (("l0_1", "l0_2"), {}),
    "rho = L2": ((), {"rho": "L2"}),
    "rho = L1": ((), {"rho": "L1"}),
    "rho = L1 = L2": ((), {"rho": "L1", "L2": "L1"}),
}


@pytest.mark.parametrize("phi", [False, True])
@pytest.mark.parametrize("name", CASES)
def test_formulas_equal_the_derived_ones(name: str, phi: bool) -> None:
    """Everywhere, and at equilibria those that hold there; a `meet` of different numbers fails by itself."""
    c = case(*CASES[name], phi=phi)
    rng = random.Random(11)
    for balanced in (None, None, ("F3", "F4"), ("F3x", "F4x"), ("k2", "k1")):
        compare(c, random_point(c, rng, balanced), at_equilibrium=balanced is not None)


def test_unloaded_formulas_equal_the_derived_ones_over_rho() -> None:
    c = case(LOADS, {}, phi=False, positive_base=True)
    assert c.statics.unloaded is not None
    rng = random.Random(12)
    for balanced in (None, ("k2", "k1")):
        compare(c, random_point(c, rng, balanced), at_equilibrium=balanced is not None)


def compare(c: Case, at: Point, *, at_equilibrium: bool) -> None:
    m, (p1, p2, rho) = c.statics, (at(c.values[name]) for name in ("L1", "L2", "rho"))
    g1, g2 = (at(g) for g in c.gradient)
    h11, h12, h22 = (at(h) for h in c.hessian)
    determinant = (h11 * h22 - h12 * h12) * inverse(p1 * p2) % PRIME
    l1, l2, l3 = (at(length) for length in m.lengths)
    assert [at(e) for e in m.equilibrium] == [g1 * inverse(p1) % PRIME, g2 * inverse(p2) % PRIME]

    def same(h: Hessian) -> bool:
        return [at(f) for f in (h.p11, h.p22, h.q, h.determinant, h.determinant_times_l3, h.levelled)] == [
            x % PRIME for x in (
                h11 * inverse(p1), h22 * inverse(p2), h12 * inverse(p1 * p2), determinant, l3 * determinant,
                l1 * l2 * l3 * determinant,
            )
        ]  # fmt: skip

    assert same(m.hessian)
    # without loads, on a positive base, a factor rho is left out
    scale = inverse(rho) if m.unloaded else 1
    assert at(m.dependent[0]) == (g1 - g2) * scale % PRIME
    assert at(m.turn) == (h11 - 2 * h12 + h22) * scale % PRIME
    if m.unloaded:
        assert m.unloaded[0] is m.dependent[0]
    if m.aligned is not None:
        assert at(m.aligned) == 0
    # both say |pull of spring 3|^2 s12^2: of the two unit vectors that the balance allows
    if m.unit is not None and m.pull is not None:
        assert at(m.unit) == at(m.pull)
    if at_equilibrium:
        assert (g1, g2) == (0, 0)
        assert same(m.at_equilibrium)
        assert at(m.turned) == p2 * determinant * scale % PRIME
        vanishing = [*m.dependent, *(f for f in (m.unit, m.pull) if f is not None)]
        assert [at(f) for f in vanishing] == [0] * len(vanishing)
        if m.unloaded:
            assert at(m.unloaded[1]) == p2 * determinant * scale % PRIME


def test_the_excess_over_the_cone_is_what_the_statics_say_at_a_spring_of_no_length() -> None:
    """At rational triangles, in which springs 1 and 2 are as long as the bars; from there into the prime field."""
    rng = random.Random(13)

    def number() -> Fraction:
        return Fraction(rng.randrange(1, 99), rng.randrange(1, 99))

    c = case((), {}, phi=False)
    assert c.statics.unit is not None
    compared = 0
    while compared < 5:
        t1, t2 = number(), number()
        (c1, s1), (c2, s2) = (((1 - t * t) / (1 + t * t), 2 * t / (1 + t * t)) for t in (t1, t2))
        values = {name: number() for name in NAMES}
        height = values["L1"] * s1
        values["L2"] = height / s2
        values["rho"] = values["L1"] * c1 + values["L2"] * c2
        if values["rho"] <= 0:
            continue
        assert height_squared(values) == height**2
        even, odd = excess_of_pull(values)
        variables = {c.values[name].variable: modular(value) for name, value in values.items()}
        halves = {n: (Fraction(1), (modular(x), modular(y))) for n, (x, y) in ((TH1, (c1, s1)), (TH2, (c2, s2)))}
        at = Point(variables, halves, {})
        assert [at(x) for x in c.statics.vectors[2]] == [0, 0]
        if [at(length) for length in c.statics.lengths[:2]] == [modular(values[name]) for name in ("L1", "L2")]:
            assert at(c.statics.unit) == modular(even + odd * height)
            compared += 1


def modular(value: Fraction) -> int:
    return value.numerator * inverse(value.denominator) % PRIME


def test_constants_are_combined() -> None:
    graph = Graph()
    two, three = graph.constant(2), graph.constant(3)
    assert ((two + three).value, (two - three).value, (two * three).value) == (5, -1, 6)
