"""Random extreme cases whose right answer is known by construction.

Guarantee: the same seed and number give the same case. A scaled or mirrored copy has the counts of its tame original,
which come from the second method; points beside a fold or a cusp have those of the construction.
"""

from __future__ import annotations

import random
from fractions import Fraction

from ptmcad.mechanism import ptm
from ptmcad.mechanism.evaluate import value_at
from ptmcad.studies.stress.case import FEW, Case, Degenerate, Question, degenerate
from ptmcad.studies.stress.methods import sextic_poses

KINDS = ("scaled", "mirrored", "swapped", "fold", "cusp")
MAX_EXPONENT = 30
"""Scales are 10^-30 to 10^30, distances from a fold 10^-30 to 10^-3."""
CONSTRUCTED = "construction of a degenerate pose in rational numbers, and on which side of it two more exist"
ORIGINAL = "symmetry of the equations: counts of the tame original, by the second method"
TEN = Fraction(10)

_MECHANISM = ptm()
_SYMMETRIES = dict(zip(("swapped", "mirrored"), _MECHANISM.symmetries, strict=True))

Values = dict[str, Fraction]


def random_case(seed: int, number: int) -> Case:
    """The case with this number."""
    dice = random.Random(f"{seed}/{number}")
    kind = KINDS[number % len(KINDS)]
    name, family = f"random-{seed}-{number}-{kind}", f"random {kind}"
    if kind in ("fold", "cusp"):
        at, distance = _degenerate(dice, cusp=kind == "cusp"), TEN ** -dice.randint(3, MAX_EXPONENT)
        side, (total, stable) = dice.choice([(1, at.many), (-1, FEW)])
        return Case(name, family, distance, Question(at.beside(side * distance)), CONSTRUCTED, f"{total}/{stable}")
    original, expected = tame(dice)
    scale = TEN ** (dice.choice([-1, 1]) * dice.randint(3, MAX_EXPONENT))
    question = Question(scaled(changed(original, kind), scale, TEN ** dice.randint(-9, 9)))
    return Case(name, family, scale, question, ORIGINAL, expected)


def scaled(p: Values, stiffness: Fraction, length: Fraction) -> Values:
    """Stiffnesses and lengths multiplied, and forces by both: the equilibria stay."""
    factors = dict.fromkeys(_MECHANISM.stiffnesses, stiffness) | dict.fromkeys(_MECHANISM.forces, stiffness * length)
    return {name: v * factors.get(name, length) for name, v in p.items()}


def changed(p: Values, kind: str) -> Values:
    """Vertical forces reversed (mirrored), which changes the angles' signs, or left and right exchanged (swapped)."""
    symmetry = _SYMMETRIES.get(kind, {})
    return {name: value_at(symmetry[name], p) if name in symmetry else v for name, v in p.items()}


def tame(dice: random.Random) -> tuple[Values, str]:
    """A random point with ordinary numbers, and its counts."""
    while True:
        p = {name: Fraction(dice.randint(5, 30), 10) for name in ("L1", "L2", "rho")}
        equal = dice.random() < 1 / 2
        springs = [Fraction(100)] * 3 if equal else [Fraction(dice.randint(50, 150)) for _ in range(3)]
        p |= dict(zip(_MECHANISM.stiffnesses, springs, strict=True))
        p |= {name: Fraction(dice.randint(-40, 40)) for name in ("F3", "F4")}
        sideways = dice.random() < 1 / 3
        p |= {name: Fraction(dice.randint(-40, 40) if sideways else 0) for name in ("F3x", "F4x")}
        try:
            poses = sextic_poses(p)
        except ArithmeticError:  # a degenerate point
            continue
        return p, f"{len(poses)}/{sum(pose.index == 0 for pose in poses)}"


def _degenerate(dice: random.Random, *, cusp: bool) -> Degenerate:
    """A random fold or cusp."""
    while True:
        tangents, lengths = ([Fraction(dice.randint(*ends), 10) for _ in range(2)] for ends in ((-30, 30), (5, 20)))
        springs = [Fraction(dice.choice([50, 100, 100, 100, 150])) for _ in range(3)]
        rho = Fraction(dice.randint(2, 20), 10)
        try:
            return degenerate(tangents, cusp=cusp, lengths=lengths, rho=rho, springs=springs)
        except ValueError:
            continue
