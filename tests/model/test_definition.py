"""What is made of descriptions, against their definition in mpmath: all shipped records, and random
descriptions.

What is under test is one argument: a function of a model, its parameters and a place that returns
`Values`, to which tolerance, relative to the largest value of a kind, and whether it has roots of
lengths.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mpmath import mp, mpf
from support.definition import Values, spans, values_at
from support.few import few
from support.random_descriptions import KINDS, random_description
from support.replacing import replace
from support.shipped_records import CONFIGS

import ptmcad
from ptmcad.ask.fields.equations import state_at
from ptmcad.exact.models import system_from
from ptmcad.formulas.evaluation import evaluated, values
from ptmcad.model import Mechanism, Model, described, described_system
from ptmcad.model.closed import without_loops
from ptmcad.model.compile import CompiledSystem, compiled
from ptmcad.text.tree import Number

Rationals = Mapping[str, Fraction]
Owner = Callable[[Model, Rationals, Rationals], Values]
RECORDS = sorted(path for path in CONFIGS.rglob("*.yaml") if path.parent.name != "families")
NUMBERS = range(200)


# --------------------------------------------------------------------------------------------- what is under test


def in_floats(model: Model, parameters: Rationals, unknowns: Rationals) -> Values:
    """The equations of fields and films."""
    at = np.array([float(unknowns[name]) for name in (*model.angles, *model.reals)])
    state = state_at(model, {name: float(value) for name, value in parameters.items()}, at)
    of_mechanism = bool(state.points)
    return Values(
        residuals=state.residuals,
        jacobian=state.jacobian,
        energy=state.energy,
        conditions=None if of_mechanism else state.conditions,
        stability=None if of_mechanism else state.stability,
        points=state.points or None,
        lengths=[length for length, _, _ in state.stretches] if of_mechanism else None,
        forces=[force for *_, force in state.stretches] if of_mechanism else None,
    )


class _InMpmath:
    """Numbers of many digits as an arithmetic for a compiled system's formulas, at a place."""

    def __init__(self, system: CompiledSystem, at: Mapping[str, mpf]):
        self.at = [at.get(name, mpf(0)) for name in system.names]
        self.turns = {k: (mp.cos(self.at[k]), mp.sin(self.at[k])) for k in system.angles}
        for f in system.followers:
            cosine, sine, below = values((f.cosine, f.sine, f.below), self)
            self.turns[f.variable] = cosine / below, sine / below

    def constant(self, value: Fraction) -> mpf:
        return mpf(value.numerator) / value.denominator

    def variable(self, number: int) -> mpf:
        return self.at[number]

    def cos(self, number: int) -> mpf:
        return self.turns[number][0]

    def sin(self, number: int) -> mpf:
        return self.turns[number][1]

    def length(self, x: mpf, y: mpf) -> mpf:
        return mp.hypot(x, y)

    def inverse_length(self, x: mpf, y: mpf) -> mpf:
        return 1 / mp.hypot(x, y)

    def direction(self, x: mpf, y: mpf) -> mpf:
        return x / mp.hypot(x, y)


def in_formulas(model: Model, parameters: Rationals, unknowns: Rationals) -> Values:
    """The compiled system, with the derivatives of its graph and with free lengths."""
    system = compiled(model)
    has_springs = bool(system.points)
    with mp.workdps(50):
        at = {
            name: mpf(value.numerator) / value.denominator
            for name, value in {**parameters, **unknowns}.items()
        }
        arithmetic = _InMpmath(system, at)
        relaxed = range(len(system.springs)) if system.tangent or system.are_slopes else ()
        equations = system.balance(relaxed)
        energy = system.energy()
        found = evaluated(
            {
                "residuals": equations,
                "jacobian": tuple(
                    tuple(system.graph.derivative(equation, k) for k in system.unknowns)
                    for equation in equations
                ),
                "points": dict(system.points),
                "lengths": tuple(spring.length for spring in system.springs),
                "forces": tuple(spring.force for spring in system.springs),
                "deflections": tuple((turned.cosine, turned.sine) for turned in system.torsion),
                "conditions": system.inequalities,
                "stability": system.stability,
            },
            arithmetic,
        )
        if has_springs:
            found |= {"conditions": None, "stability": None}
        else:
            found |= dict.fromkeys(("points", "lengths", "forces", "deflections"))
        return Values(energy=None if energy is None else values([energy], arithmetic)[0], **found)


def in_polynomials(model: Model, parameters: Rationals, unknowns: Rationals) -> Values:
    """The exact engine's equations, for springs without a free length."""
    system = system_from(model)
    with mp.workdps(50):
        at = {
            name: mpf(value.numerator) / value.denominator
            for name, value in {**parameters, **unknowns}.items()
        }
        place = [at[name] for name in system.ring.parameters]
        for angle in system.ring.angles:
            place += [mp.cos(at[angle]), mp.sin(at[angle])]
        place += [at[name] for name in system.ring.reals]

        powers = [[x**e for e in range(40)] for x in place]

        def number(polynomial: Any) -> mpf:
            total = mpf(0)
            for exponents, c in polynomial.terms():
                term = mpf(int(c.p)) / int(c.q)
                for known, e in zip(powers, exponents, strict=True):
                    if e:
                        term *= known[e]
                total += term
            return total

        is_system = not isinstance(model, Mechanism)
        return Values(
            residuals=[number(e) for e in system.equations],
            jacobian=[[number(e) for e in row] for row in system.jacobian],
            energy=None if system.potential is None else number(system.potential),
            conditions=[number(e) for e in system.inequalities] if is_system else None,
            stability=[number(e) for e in system.stability] if is_system else None,
        )


FLOATS, EXACT = (in_floats, 1e-8, True), (in_polynomials, 1e-20, False)
COMPILED = in_formulas, 1e-20, True
OWNERS = [pytest.param(owner, id=owner[0].__name__) for owner in (FLOATS, EXACT, COMPILED)]


# ----------------------------------------------------------------------------------------------------- comparison


def place_of(model: Model, seed: str) -> tuple[dict[str, Fraction], dict[str, Fraction]]:
    """Values of the parameters that make sense, and of the unknowns."""
    dice = random.Random(seed)

    def number(low: int, high: int) -> Fraction:
        return Fraction(dice.randint(97 * low, 97 * high) + dice.randint(1, 96), 97)

    kinds = {name: model.kind(name) for name in model.variables}
    parameters = {
        n: number(0 if kind.is_positive or kind.may_vanish else -2, 2) for n, kind in kinds.items()
    }
    return parameters, {name: number(-2, 2) for name in model.unknowns}


def agree(owner: tuple[Owner, float, bool], model: Model, seed: str) -> None:
    """Assert that a function's values are those of the definition at a place that is drawn."""
    function, tolerance, has_roots = owner
    model = model if has_roots else _without_roots(model)
    mechanism = model.whole
    parameters, unknowns = place_of(model, seed)
    found = function(model, parameters, unknowns)
    with mp.workdps(60):
        numbers, place = (
            {n: mpf(v.numerator) / v.denominator for n, v in values.items()}
            for values in (parameters, unknowns)
        )
        expected = values_at(model, numbers, place)
        if mechanism is not None and mechanism.xjoints:
            powers = _powers(
                found.residuals, expected.residuals, spans(mechanism, {**numbers, **place})
            )
            expected = values_at(model, numbers, place, powers)
        for name in ("residuals", "jacobian", "energy", "conditions", "stability", "points", "lengths", "forces",
                     "deflections"):  # fmt: skip
            ours, theirs = (_listed(getattr(values, name)) for values in (expected, found))
            if (
                ours is None
                or theirs is None
                or (name == "stability" and mechanism is not None and mechanism.xjoints)
            ):
                continue
            assert len(ours) == len(theirs), name
            size = 1 + max((abs(x) for x in ours), default=0)
            assert all(abs(a - b) < tolerance * size for a, b in zip(ours, theirs, strict=True)), (
                name,
                ours,
                theirs,
            )


def _without_roots(model: Model) -> Model:
    """The model with free lengths of zero."""
    mechanism = getattr(model, "mechanism", model)
    if not isinstance(mechanism, Mechanism):
        return model
    springs = tuple(spring._replace(free=Number(Fraction(0))) for spring in mechanism.springs)
    changed = replace(mechanism, springs=springs)
    return changed if mechanism is model else replace(model, mechanism=changed)


def _powers(
    found: Sequence[Any], slopes: Sequence[Any], spans: Sequence[Any]
) -> list[tuple[int, ...]]:
    """The powers of the spans by which equations of X-joints are multiplied."""
    powers = []
    for multiplied, slope in zip(found, slopes, strict=True):
        choices = product(range(7), repeat=len(spans))
        factors = ((mp.fprod(d**n for d, n in zip(spans, ns, strict=True)), ns) for ns in choices)
        powers.append(
            min(factors, key=lambda choice: abs(mpf(multiplied) / slope / choice[0] - 1))[1]
        )
    return powers


def _listed(values: Any) -> list[Any] | None:
    """All numbers in a row; None for what is not known."""
    if values is None:
        return None
    if isinstance(values, Mapping):
        values = list(values.values())
    if isinstance(values, list | tuple | np.ndarray) and np.ndim(values):
        return [number for value in values for number in _listed(value) or []]
    if isinstance(values, list | tuple):
        return []
    return [mpf(float(values)) if isinstance(values, np.generic | np.ndarray) else mpf(values)]


# ----------------------------------------------------------------------------------------------------------- tests


@pytest.mark.parametrize("owner", OWNERS)
@pytest.mark.parametrize("path", RECORDS, ids=lambda path: path.stem)
def test_shipped_records_mean_what_is_defined(path: Path, owner: tuple[Owner, float, bool]) -> None:
    agree(owner, ptmcad.load(path).model, path.stem)


@pytest.mark.parametrize("owner", OWNERS)
@pytest.mark.parametrize("number", few(NUMBERS, *NUMBERS[: 3 * len(KINDS)]))
def test_random_descriptions_mean_what_is_defined(
    number: int, owner: tuple[Owner, float, bool]
) -> None:
    agree(owner, model_of(number), str(number))


def model_of(number: int) -> Model:
    """The model of a random description, as engines take it."""
    record = random_description(number)
    if "system" in record:
        return described_system(record["system"])
    return without_loops(described(record["mechanism"]))


def test_random_descriptions_are_of_all_kinds() -> None:
    records = [random_description(number) for number in NUMBERS]
    mechanisms = [record["mechanism"] for record in records if "mechanism" in record]
    for key in ("springs", "torsion", "loads", "moments", "closing", "x-joint", "bodies"):
        assert sum(key in m for m in mechanisms) >= 10, key
    models = [model_of(number) for number in NUMBERS[:: len(KINDS) // 2 - 1]]
    assert {model.criterion.matrix for model in models} == {"Hessian", "Jacobian"}
