"""Random extreme cases whose right answer is known by construction.

Guarantee: the same seed and number give the same case. A scaled or mirrored copy has the counts of its tame original,
which come from the second method; points beside a fold or a cusp have those of the construction.
"""

from __future__ import annotations

import random
from collections.abc import Mapping
from fractions import Fraction

from ptmcad.mechanism import ptm
from ptmcad.mechanism.evaluate import value_at
from ptmcad.studies.stress.case import Case, PointAnswer, PointQuestion
from ptmcad.studies.stress.constructions import Degenerate as DegeneratePose
from ptmcad.studies.stress.constructions import beside_cusp, beside_fold, cusp, fold, rational_pose
from ptmcad.studies.stress.points import CONSTRUCTED, ten
from ptmcad.studies.stress.reference import Degenerate, sextic_poses
from ptmcad.text.tree import Tree

KINDS = ("scaled", "mirrored", "swapped", "fold", "cusp")
MAX_EXPONENT = 30
"""Scales are 10^-30 to 10^30, distances from a fold 10^-30 to 10^-3."""
ORIGINAL = "symmetry of the equations: counts of the tame original, by the second method"

_MECHANISM = ptm()
_ACROSS, _ALONG = _MECHANISM.symmetries

Values = dict[str, Fraction]


def random_case(seed: int, number: int) -> Case:
    """The case with this number."""
    dice = random.Random(f"{seed}/{number}")
    kind = KINDS[number % len(KINDS)]
    name = f"random-{seed}-{number}-{kind}"
    if kind in ("fold", "cusp"):
        at, exponent = _degenerate(dice, kind), -dice.randint(3, MAX_EXPONENT)
        beside = beside_fold if kind == "fold" else beside_cusp
        side, counts = dice.choice([(1, at.many), (-1, at.few)])
        question = PointQuestion(beside(at, side * ten(exponent)))
        sibling = PointQuestion(beside(at, side * Fraction(1, 10)))
        return Case(name, f"random {kind}", ten(exponent), question, sibling, PointAnswer(*counts), CONSTRUCTED)
    original, expected = _tame(dice)
    exponent = dice.choice([-1, 1]) * dice.randint(3, MAX_EXPONENT)
    moved = mirrored(original) if kind == "mirrored" else swapped(original) if kind == "swapped" else original
    # springs and forces together, then lengths together with forces
    stretch = dice.randint(-9, 9)
    question = PointQuestion(stretched(stiffened(moved, ten(exponent)), ten(stretch)))
    return Case(name, f"random {kind}", ten(exponent), question, PointQuestion(original), expected, ORIGINAL)


def stiffened(p: Values, factor: Fraction) -> Values:
    """Stiffnesses and forces multiplied: the equilibria stay."""
    pulled = _MECHANISM.stiffnesses + _MECHANISM.forces
    return {name: v * factor if name in pulled else v for name, v in p.items()}


def stretched(p: Values, factor: Fraction) -> Values:
    """Lengths and forces multiplied: the equilibria stay."""
    return {name: v if name in _MECHANISM.stiffnesses else v * factor for name, v in p.items()}


def mirrored(p: Values) -> Values:
    """Vertical forces reversed: the angles change their signs."""
    return _substituted(p, _ALONG)


def swapped(p: Values) -> Values:
    """Left and right exchanged: the angles are too."""
    return _substituted(p, _ACROSS)


def _substituted(p: Values, symmetry: Mapping[str, Tree]) -> Values:
    return {name: value_at(symmetry[name], p) if name in symmetry else v for name, v in p.items()}


def _tame(dice: random.Random) -> tuple[Values, PointAnswer]:
    """A random point with ordinary numbers, and its counts."""
    while True:
        p = {name: Fraction(dice.randint(5, 30), 10) for name in ("L1", "L2", "rho")}
        equal = dice.random() < 1 / 2
        springs = [Fraction(100)] * 3 if equal else [Fraction(dice.randint(50, 150)) for _ in range(3)]
        p |= dict(zip(("k1", "k2", "k3"), springs, strict=True))
        p |= {name: Fraction(dice.randint(-40, 40)) for name in ("F3", "F4")}
        sideways = dice.random() < 1 / 3
        p |= {name: Fraction(dice.randint(-40, 40) if sideways else 0) for name in ("F3x", "F4x")}
        try:
            poses = sextic_poses(p)
        except Degenerate:
            continue
        return p, PointAnswer(len(poses), sum(pose.index == 0 for pose in poses))


def _degenerate(dice: random.Random, kind: str) -> DegeneratePose:
    """A random fold or cusp."""
    while True:
        pose = rational_pose(Fraction(dice.randint(-30, 30), 10), Fraction(dice.randint(-30, 30), 10))
        lengths = (Fraction(dice.randint(5, 20), 10), Fraction(dice.randint(5, 20), 10))
        springs = tuple(Fraction(dice.choice([50, 100, 100, 100, 150])) for _ in range(3))
        rho = Fraction(dice.randint(2, 20), 10)
        try:
            return (fold if kind == "fold" else cusp)(lengths, rho, springs, pose)
        except ValueError:
            continue
