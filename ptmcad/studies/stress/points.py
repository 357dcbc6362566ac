"""The named stress cases that ask for the equilibria at one point.

Guarantee: each expected count follows from a theorem or a construction named in ``source``, and does not come from the
program. The theorems are those of the manual: without load two equilibria are stable, of six, exactly if |L2 - L1| <
2 rho < L1 + L2, else one of four; loads that are small (large) enough against k rho and k L change nothing else (leave
four, one of them stable); equations stay the same when stiffnesses and forces, or lengths and force/stiffness, are
scaled together.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from math import isqrt

from ptmcad.studies.stress.case import Case, PointAnswer, PointQuestion
from ptmcad.studies.stress.constructions import Degenerate, beside_cusp, beside_fold, cusp, fold, rational_pose

ONE = Fraction(1)
THEOREM = "unloaded: two stable of six exactly if |L2 - L1| < 2 rho < L1 + L2"
NO_LOAD = f"limit of no load; {THEOREM}"
MUCH_LOAD = "limit of large loads: each bar points along its load or against it, four equilibria, one stable"
SCALING = "scaling: the equations are those of the sibling"
SECOND = "second method: roots of the sextic isolated to 100 digits with proof"
ELIMINATION = (
    "scaling: the equations are those of l0 = 1/5, where elimination leaves 94 real roots, six of them equilibria"
)
CONSTRUCTED = "construction of a degenerate pose in rational numbers, and on which side of it two more exist"
PETALS = "the rose and the astroid of the symmetric slice, evaluated exactly"
SIX, SLIVER, FOUR = PointAnswer(6, 2), PointAnswer(6, 1), PointAnswer(4, 1)


def ten(exponent: int) -> Fraction:
    """A power of ten."""
    return Fraction(10) ** exponent


def point(**given: Fraction | int | str) -> PointQuestion:
    """A point of the paper's mechanism: L1 = 1, L2 = 3/2, rho = 7/10, k = 100 and no load unless given."""
    values = {name: Fraction(value) for name, value in given.items()}
    stiffness, free = values.pop("k", Fraction(100)), values.pop("l0", Fraction(0))
    p = {"L1": ONE, "L2": Fraction(3, 2), "rho": Fraction(7, 10)}
    p |= dict.fromkeys(("k1", "k2", "k3"), stiffness) | dict.fromkeys(("F3", "F4", "F3x", "F4x"), Fraction(0))
    p |= dict.fromkeys(("l0_1", "l0_2", "l0_3"), free)
    if not values.keys() <= p.keys():
        raise ValueError(f"unknown parameters {sorted(values.keys() - p.keys())}")
    p |= values
    return PointQuestion({name: v for name, v in p.items() if v or not name.startswith("l0")})


TAME = point(F3=-10, F4=-10)
UNLOADED = point()


def point_cases() -> Iterator[Case]:
    """All of them, family by family."""
    yield from _stiffness()
    yield from _units()
    yield from _lengths()
    yield from _flat()
    yield from _forces()
    yield from _nearly_symmetric()
    yield from _straight()
    yield from _folds()
    yield from _cusps()
    yield from _nodes()
    yield from _long_numbers()
    yield from _unequal_springs()
    yield from _free_lengths()


def _stiffness() -> Iterator[Case]:
    for e in (-12, -9, -6, -3, 4, 6, 9, 12):
        expected, source = (SIX, NO_LOAD) if e > 0 else (FOUR, MUCH_LOAD)
        yield Case(f"stiffness-1e{e}", "stiffness", ten(e), point(k=ten(e), F3=-10, F4=-10), TAME, expected, source)


def _units() -> Iterator[Case]:
    for e in (-30, -12, 12, 30):
        question = point(k=100 * ten(e), F3=-10 * ten(e), F4=-10 * ten(e))
        yield Case(f"units-force-1e{e}", "units", ten(e), question, TAME, SIX, SCALING)
    for e in (-9, 9):
        s = ten(e)
        question = point(L1=s, L2=s * 3 / 2, rho=s * 7 / 10, F3=-10 * s, F4=-10 * s)
        yield Case(f"units-length-1e{e}", "units", s, question, TAME, SIX, SCALING)


def _lengths() -> Iterator[Case]:
    for e in (-9, -6, -3, 3, 6, 9):
        # in the strip where two are stable, which is as narrow as the shorter bar
        rho = (max(ten(e), ONE) + min(ten(e), ONE) / 5) / 2
        yield Case(f"lengths-strip-1e{e}", "lengths", ten(e), point(L2=ten(e), rho=rho), UNLOADED, SIX, THEOREM)
    for e in (-9, 9):
        outside = "limit of a bar that is too short or too long: |L2 - L1| > 2 rho or L1 + L2 < 2 rho, four equilibria"
        yield Case(f"lengths-loaded-1e{e}", "lengths", ten(e), point(L2=ten(e), F3=-10, F4=-10), TAME, FOUR, outside)


def _flat() -> Iterator[Case]:
    for e in (-3, -6, -9, -12):
        question = point(L2=1, rho=ten(e), F3=-10, F4=-10)
        sibling = point(L2=1, rho="1/2", F3=-10, F4=-10)
        yield Case(
            f"short-base-1e{e}", "short base", ten(e), question, sibling, _petal(2 * ten(e), Fraction(1, 10)), PETALS
        )
    yield Case("short-base-paper-1e-12", "short base", ten(-12), point(rho=ten(-12), F3=-10, F4=-10), TAME,
               PointAnswer(), SECOND)  # fmt: skip


def _forces() -> Iterator[Case]:
    for e in (-30, -20, -10, -3, 6, 10, 20, 30):
        expected, source = (SIX, NO_LOAD) if e < 0 else (FOUR, MUCH_LOAD)
        yield Case(f"forces-1e{e}", "forces", ten(e), point(F3=-ten(e), F4=-ten(e)), TAME, expected, source)
    yield Case("forces-sideways-1e30", "forces", ten(30), point(F3x=ten(30), F4x=2 * ten(30), F3=-10), TAME, FOUR,
               MUCH_LOAD)  # fmt: skip
    yield Case("forces-mixed-1e30", "forces", ten(30), point(F3=ten(30), F4=-ten(-30)), TAME, PointAnswer(), SECOND)


def _nearly_symmetric() -> Iterator[Case]:
    for e in (-5, -10, -15, -20):
        second = 1 + ten(e)
        for name, rho, expected in (("inside", ten(e), SIX), ("outside", ten(e) / 4, FOUR)):
            yield Case(f"symmetry-{name}-1e{e}", "symmetry", ten(e), point(L2=second, rho=rho),
                       point(L2="11/10", rho="1/10" if expected is SIX else "1/40"), expected, THEOREM)  # fmt: skip
    question = point(L2=1 + ten(-20), rho="1/2", F3=-10, F4=-10)
    yield Case("symmetry-loaded-1e-20", "symmetry", ten(-20), question, TAME, _petal(ONE, Fraction(1, 10)), PETALS)


def _straight() -> Iterator[Case]:
    """Poses that are nearly flat: the boundary 2 rho = L1 + L2, where the stable poses straighten."""
    for e in (-6, -12, -18, -24, -30):
        for name, sign, expected, tame in (("inside", -1, SIX, "6/5"), ("outside", 1, FOUR, "3/2")):
            question = point(rho=(Fraction(5, 2) + sign * ten(e)) / 2)
            yield Case(f"straight-{name}-1e{e}", "straight", ten(e), question, point(rho=tame), expected, THEOREM)


def _degenerate() -> tuple[tuple[str, Degenerate], ...]:
    lengths, springs = (ONE, Fraction(3, 2)), (Fraction(100),) * 3
    first, second = rational_pose(Fraction(1, 3), Fraction(2, 5)), rational_pose(Fraction(3, 2), Fraction(1, 5))
    return (
        ("fold", fold(lengths, Fraction(7, 10), springs, first)),
        ("fold", fold(lengths, Fraction(7, 10), springs, second)),
        ("fold", fold(lengths, Fraction(7, 10), springs, rational_pose(Fraction(-2), Fraction(3)))),
        ("cusp", cusp(lengths, Fraction(7, 10), springs, rational_pose(Fraction(1, 2), Fraction(3, 7)))),
        ("cusp", cusp(lengths, Fraction(7, 10), springs, first)),
    )


FOLD, OTHER_FOLD, MAXIMUM_FOLD, CUSP, MAXIMUM_CUSP = (at for _, at in _degenerate())


def _folds() -> Iterator[Case]:
    for name, at, exponents in (
        ("fold", FOLD, (-6, -12, -16, -20, -30)),
        ("fold-of-maxima", MAXIMUM_FOLD, (-16, -30)),
    ):
        for e in exponents:
            for side, sign, counts in (("many", 1, at.many), ("few", -1, at.few)):
                sibling = PointQuestion(beside_fold(at, sign * Fraction(1, 10)))
                question = PointQuestion(beside_fold(at, sign * ten(e)))
                yield Case(f"{name}-{side}-1e{e}", "fold", ten(e), question, sibling, PointAnswer(*counts), CONSTRUCTED)


def _cusps() -> Iterator[Case]:
    for name, at, exponents in (("cusp", CUSP, (-6, -12, -16, -30)), ("cusp-of-maxima", MAXIMUM_CUSP, (-16, -30))):
        for e in exponents:
            for side, sign, counts in (("many", 1, at.many), ("few", -1, at.few)):
                sibling = PointQuestion(beside_cusp(at, sign * Fraction(1, 10)))
                question = PointQuestion(beside_cusp(at, sign * ten(e)))
                yield Case(f"{name}-{side}-1e{e}", "cusp", ten(e), question, sibling, PointAnswer(*counts, at.pose),
                           CONSTRUCTED)  # fmt: skip


def _petal(x: Fraction, y: Fraction) -> PointAnswer:
    """The counts of the symmetric slice from its two curves, the rose and the astroid, with x = 2 rho and y = |F|/k."""
    rose = (x * x + y * y) ** 3 - 4 * x * x * y * y
    astroid = (x * x + y * y - 4) ** 3 + 108 * x * x * y * y
    if rose < 0 or astroid > 0:
        return FOUR
    return SIX if x > y else SLIVER


def _nodes() -> Iterator[Case]:
    """The rose and the astroid touch at x = y = 1/sqrt 2, where four regions with three different counts meet."""
    for e in (-6, -15, -30):
        # the curves are about d^2 apart at the distance d, so that the node's digits have to reach beyond that
        digits = 4 - 2 * e
        node, d = Fraction(isqrt(2 * 100**digits), 2 * 10**digits), ten(e)
        for name, x, y in (
            ("right", node + d, node - d), ("left", node - d, node + d),
            ("inner", node - d, node - d), ("outer", node + d, node + d),
        ):  # fmt: skip
            if e != -30 and name in ("inner", "outer"):
                continue
            sibling = {"right": ("1", "1/10"), "left": ("1/100", "1/2"), "inner": ("1/2", "1/2"), "outer": ("1", "1")}
            near = [Fraction(text) for text in sibling[name]]
            yield Case(f"node-{name}-1e{e}", "node", d, _symmetric(x, y), _symmetric(*near), _petal(x, y), PETALS)


def _symmetric(x: Fraction, y: Fraction) -> PointQuestion:
    return point(L2=1, rho=x / 2, F3=-100 * y, F4=-100 * y)


def _long_numbers() -> Iterator[Case]:
    digits = Fraction(1234567891234567891234567891234567891234, 10**40)
    question = point(L1=1 + digits / 100, L2=Fraction(3, 2) + digits, rho=Fraction(6, 10) + digits,
                     k=100 + digits, F3=-10 - digits, F4=-10 + digits)  # fmt: skip
    yield Case("digits-40", "digits", ten(40), question, TAME, PointAnswer(), SECOND)
    question = point(L2=Fraction(3, 2) + digits, rho=Fraction(3, 2) - digits)
    yield Case("digits-40-unloaded", "digits", ten(40), question, UNLOADED, FOUR, THEOREM)


def _unequal_springs() -> Iterator[Case]:
    for e in (-12, -6, 6, 12):
        for name in ("k1", "k3"):
            stiff = {name: 100 * ten(e)}
            question = point(k=100, F3=-10, F4=-10, **stiff)
            yield Case(f"springs-{name}-1e{e}", "springs", ten(e), question, TAME, PointAnswer(), SECOND)


def _free_lengths() -> Iterator[Case]:
    sibling = point(l0="1/5", F3=-10, F4=-10)
    limit = "limit of free lengths zero, where the counts are (6, 2) by the exact engine and all poses nondegenerate"
    for e in (-12, -9, -6, -3):
        yield Case(f"free-length-1e{e}", "free length", ten(e), point(l0=ten(e), F3=-10, F4=-10), sibling, SIX, limit)
    proved = (
        "second method: as many equilibria as Newton's method in balls, from a grid of starts, proves to exist, and "
        "Euler's sum with the cones"
    )
    for e in (1, 2, 3):
        yield Case(f"free-length-1e{e}", "free length", ten(e), point(l0=ten(e), F3=-10, F4=-10), sibling,
                   PointAnswer(), proved)  # fmt: skip
    for e in (-12, 12):
        s = ten(e)
        question = point(k=100 * s, l0="1/5", F3=-10 * s, F4=-10 * s)
        yield Case(f"free-length-units-1e{e}", "free length", s, question, sibling, SIX, ELIMINATION)
    question = point(l0="1/5", F3=-10 * ten(-12), F4=-10 * ten(-12))
    yield Case("free-length-forces-1e-12", "free length", ten(-12), question, sibling, PointAnswer(), proved)
