"""The checker's own derivation of the potential, against the engine's and against the record by
numbers.
"""

from __future__ import annotations

from copy import deepcopy
from fractions import Fraction
from itertools import product

import pytest
import yaml
from flint import fmpq, fmpq_mpoly
from mpmath import mp, mpf
from support.maps import CONFIGS
from support.mechanisms_energy import energy

import ptmcad
from ptmcad.exact.models import system_from
from ptmcad.model import Mechanism, described, ptm
from ptmcad.text.flint_numbers import from_fraction
from ptmcad.verification.derivation import derivation_at, derivation_of
from ptmcad.verification.normalform.waves import form_of

# coordinates with quotients, powers and sums of three angles, which the built-in mechanism does not
# have
RECORD = yaml.safe_load("""
name: chain
parameters: {a: {default: 1}, k: {kind: stiffness, default: 1}, F: {kind: force}}
unknowns: {u: angle, v: angle, w: angle}
points:
  O: [0, 1]
  P: [a*cos(u) + 2*cos(u + v)/3, a*sin(u) - sin(2*v - u)^2]
  Q: [-(a - cos(w + u - v)), sin(-w)*(a + 1)^2]
springs: [{between: [O, P], k: 2*k}, {between: [Q, P], k: k}]
loads: {Q: [-F, F/2]}
""")
CHAIN = described(RECORD)
POINTS = ((3, 4, 5), (-5, 12, 13), (8, -15, 17))
"""Of the circles: cosine, sine and radius."""


def values(m: Mechanism) -> dict[str, Fraction]:
    return {name: Fraction(3 + n, 7) for n, name in enumerate(m.without_free_lengths)}


def coordinates(m: Mechanism) -> list[fmpq]:
    return [fmpq(c, r) for x, y, r in POINTS[: len(m.angles)] for c in (x, y)]


@pytest.mark.parametrize("m", [ptm(), CHAIN], ids=lambda m: m.name)
def test_the_engine_and_the_checker_derive_the_same_potential(m: Mechanism) -> None:
    """By two readers of the same trees."""
    found, engines = derivation_at(m, values(m)).energy, system_from(m).potential
    assert found is not None
    assert engines is not None
    assert found(*coordinates(m)) == engines(
        *map(from_fraction, values(m).values()), *coordinates(m)
    )


def test_the_polynomials_have_the_values_and_derivatives_of_the_record() -> None:
    """By differences of many digits."""
    found = derivation_of(CHAIN)
    at = [*coordinates(CHAIN), *map(from_fraction, values(CHAIN).values())]
    with mp.workdps(60):
        numbers = {name: mpf(v.numerator) / v.denominator for name, v in values(CHAIN).items()}
        place = tuple(mp.atan2(y, x) for x, y, _ in POINTS)

        def true(*order: int) -> mpf:
            return mp.diff(lambda *angles: energy(RECORD, numbers, angles), place, order)

        def differs(p: fmpq_mpoly | None, other: mpf) -> bool:
            assert p is not None
            exact = p(*at)
            return abs(mpf(int(exact.p)) / int(exact.q) - other) > mpf(10) ** -25

        assert not differs(found.energy, energy(RECORD, numbers, place))
        for i, equation in enumerate(found.equations):
            assert not differs(equation, true(*(int(i == k) for k in range(3))))
        for i, j in product(range(3), repeat=2):
            assert not differs(found.jacobian[i][j], true(*((i == k) + (j == k) for k in range(3))))


def test_loops_that_differ_in_a_free_length_only_are_told_apart() -> None:
    """Without free lengths they have the same equations."""
    record = yaml.safe_load(
        (CONFIGS / "mechanisms" / "four-bar-free.yaml").read_text(encoding="utf-8")
    )
    record.pop("reference")
    longer = deepcopy(record)
    longer["mechanism"]["springs"][0]["free"] = 2
    slices = [ptmcad.slice_from_mapping(one) for one in (record, longer)]
    one, other = ([str(e) for e in derivation_of(slice.model).equations] for slice in slices)
    assert one == other
    first, second = (form_of(slice).cones[0] for slice in slices)
    assert str(first.pull) != str(second.pull)


def test_poses_of_loops_with_free_lengths_are_accepted() -> None:
    """They were held against what a map of all counts stores, which has no stable ones."""
    poses = ptmcad.solve(ptmcad.load(CONFIGS / "mechanisms" / "four-bar-free.yaml"), F=0, G=0)
    assert len(poses.equilibria) == 4 and poses.stable == 2
    assert ptmcad.verify(poses).ok
