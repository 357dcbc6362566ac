"""`ptmcad.solve` against independent methods, known answers, symmetries, degenerate points, extreme
values.
"""

from __future__ import annotations

import random
from collections.abc import Iterator
from decimal import Decimal
from fractions import Fraction

import mpmath
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mpmath import mpf
from support.examples import examples
from support.maps import CONFIGS
from support.newton import DIGITS, Found, equilibria, improved
from support.oracle import count

from ptmcad import Enclosure, Pose, Poses, slice_from_mapping, solve
from ptmcad.answer.regionmap import Status
from ptmcad.errors import ConfigError
from ptmcad.question.config import point_from_mapping

few = settings(max_examples=examples(15))

# ------------------------------------------------------------------------- against Newton's method, to all shown digits


def parameters_of(generator: random.Random) -> dict[str, Fraction]:
    """A random mechanism; one in three has equal springs, one in three no horizontal loads, some
    are symmetric.
    """

    def between(low: int, high: int) -> Fraction:
        return Fraction(generator.randint(low * 1000, high * 1000), 1000)

    values = {"L1": between(1, 3), "L2": between(1, 4) / 2, "rho": between(0, 3)}
    same = generator.random() < 0.34
    stiffness = between(50, 150)
    values |= {name: stiffness if same else between(50, 150) for name in ("k1", "k2", "k3")}
    values |= {name: between(-150, 150) for name in ("F3", "F4", "F3x", "F4x")}
    if generator.random() < 0.34:
        values |= {"F3x": Fraction(0), "F4x": Fraction(0)}
    if generator.random() < 0.1:
        values |= {
            "L2": values["L1"],
            "F4": values["F3"],
            "F4x": -values["F3x"],
            "k2": values["k1"],
        }
    return values


def agrees(x: Enclosure, value: mpf, digits: int) -> bool:
    """Whether the text is the value rounded to nearest: within half a unit of its last digit, or
    exact.
    """
    text = x.text(digits)
    with mpmath.workdps(DIGITS):
        error = abs(mpf(text) - value)
        if x.exact is not None and Fraction(Decimal(text)) == x.exact:
            return bool(error < mpf(10) ** (25 - DIGITS) * max(1, abs(value)))
        entry = Decimal(text).as_tuple()
        assert len(entry.digits) == digits
        assert isinstance(entry.exponent, int)
        return bool(error <= mpf(10) ** entry.exponent / 2 * (1 + mpf(10) ** -20))


def pairs(pose: Pose, found: Found) -> Iterator[tuple[str, Enclosure, mpf]]:
    """Every number of a pose with the one that Newton's method gave."""
    with mpmath.workdps(DIGITS):
        for k in (0, 1):
            yield f"th{k + 1}", pose.angles[k], found.angles[k]
            yield f"th{k + 1} in degrees", pose.degrees[k], found.angles[k] * 180 / mpmath.pi
            yield f"cos th{k + 1}", pose.cosines_sines[2 * k], mpmath.cos(found.angles[k])
            yield f"sin th{k + 1}", pose.cosines_sines[2 * k + 1], mpmath.sin(found.angles[k])
            yield f"eigenvalue {k}", pose.eigenvalues[k], found.eigenvalues[k]
        for name, (x, y) in pose.nodes.items():
            yield f"{name} x", x, found.nodes[name][0]
            yield f"{name} y", y, found.nodes[name][1]
        for k, spring in enumerate(pose.springs):
            yield f"length {spring.name}", spring.length, found.lengths[k]
            yield f"force {spring.name}", spring.force, found.forces[k]
        yield "energy", pose.known_energy, found.energy


def matches(pose: Pose, found: Found, digits: int) -> list[str]:
    """Names of the numbers that differ."""
    return [name for name, x, value in pairs(pose, found) if not agrees(x, value, digits)]


def check_against_newton(seed: int, number: int, digits: int = 12) -> None:
    generator = random.Random(seed)
    for _ in range(number):
        parameters = parameters_of(generator)
        poses = solve(digits=digits, **parameters)
        found = equilibria(parameters)
        if len(found) != len(
            poses.equilibria
        ):  # two that are close together may lie between two points of the grid
            found = equilibria(parameters, grid=20_000)
        assert poses.status is Status.EXACT
        assert len(poses.equilibria) == len(found), parameters
        assert len(found) in (4, 6)
        # a pose and what Newton's method found belong together when their angles do
        for pose in poses.equilibria:
            near = min(found, key=lambda f: sum(abs(mpmath.sin((float(a) - b) / 2)) for a, b in
                                                zip(pose.angles, f.angles, strict=True)))  # fmt: skip
            found.remove(near)
            assert matches(pose, near, digits) == [], parameters
            assert pose.index == near.index
            assert pose.stable is (near.index == 0)
            assert (pose.multiplicity, pose.flat) == (1, False)


def test_random_points_agree_with_newton_to_all_digits() -> None:
    check_against_newton(1, 15)


@pytest.mark.slow
def test_1000_random_points_agree_with_newton_to_all_digits() -> None:
    check_against_newton(1, 900)
    check_against_newton(3, 100, digits=60)


# ----------------------------------------------------------------------------------------------------- known answers


def signature(poses: Poses) -> tuple[int, int, int]:
    return (
        sum(p.index == 0 for p in poses.equilibria),
        sum(p.index == 1 for p in poses.equilibria),
        sum(p.index == 2 for p in poses.equilibria),
    )


def test_unloaded_equation_9_of_the_paper_corrected() -> None:
    """cos th1 = (4 rho^2 + L1^2 - L2^2) / (4 rho L1), and likewise cos th2; two mirror images, and
    four flat poses.
    """
    poses = solve(rho=1, L2="3/2")
    assert signature(poses) == (2, 3, 1)
    for pose, sign in zip(poses.equilibria[:2], (1, -1), strict=True):
        assert pose.cosines_sines[0].exact == Fraction(11, 16)
        assert pose.cosines_sines[2].exact == Fraction(7, 8)
        assert sign * pose.angles[0].low > 0
    assert [pose.flat for pose in poses.equilibria] == [False, False, True, True, True, True]
    assert [p.energy.exact for p in poses.equilibria] == [
        Fraction(225, 2),
        Fraction(225, 2),
        125,
        225,
        425,
        1125,
    ]


@pytest.mark.parametrize(
    ("parameters", "counts"),
    [
        (
            {"F3": -10, "F4": -10, "rho": "0.0025"},
            (1, 3, 2),
        ),  # the sliver: six equilibria, one stable
        ({"F3": -10, "F4": -10, "rho": "0.0026"}, (1, 2, 1)),
        ({"F3": -10, "F4": -10, "rho": "0.2149"}, (1, 2, 1)),
        ({"F3": -10, "F4": -10, "rho": "0.215"}, (2, 3, 1)),
        ({"F3": -10, "F4": -10, "rho": "0.8034"}, (2, 3, 1)),
        ({"F3": -10, "F4": -10, "rho": "0.8035"}, (1, 2, 1)),
        ({"F3": -10, "F4": -20, "L2": "3/2", "rho": "0.9805"}, (2, 3, 1)),
        ({"F3": -10, "F4": -20, "L2": "3/2", "rho": "0.9806"}, (1, 2, 1)),
    ],
    ids=lambda value: str(value).replace(" ", ""),
)
def test_counts_of_the_reference(
    parameters: dict[str, object], counts: tuple[int, int, int]
) -> None:
    assert signature(solve(**parameters)) == counts  # type: ignore[arg-type]


def test_what_is_rational_is_exact() -> None:
    """At rho = 1/2, L1 = L2 = 1 the stable rods stand at 60 degrees, in an equilateral triangle
    upside down.
    """
    pose = solve(rho="1/2").equilibria[0]
    assert [x.exact for x in pose.degrees] == [60, 60]
    assert pose.angles[0].text(12) == "1.04719755120"
    assert [s.length.exact for s in pose.springs] == [1, 1, Fraction(1, 2)] or pose.springs[
        2
    ].length.exact is not None


def test_poses_are_in_an_order_that_rounding_does_not_change() -> None:
    for rho in ("1/4", "1/2", "3/4", "0.99"):
        poses = solve(rho=rho)
        by_kind = [pose.stable is not True for pose in poses.equilibria]
        assert by_kind == sorted(by_kind)
        for pose, other in zip(poses.equilibria, poses.equilibria[1:], strict=False):
            if pose.stable == other.stable:
                assert pose.known_energy.low <= other.energy.high
        assert [p.angles[0].low > 0 for p in poses.equilibria[:2]] == [
            True,
            False,
        ]  # equal energies


# ---------------------------------------------------------------------------------------- degenerate by construction

rationals = st.fractions(min_value=-4, max_value=4, max_denominator=7)
lengths = st.fractions(min_value=Fraction(1, 5), max_value=4, max_denominator=7)


def at_pose(
    t1: Fraction, t2: Fraction, x: Fraction, y: Fraction, rho: Fraction, length: Fraction
) -> dict[str, Fraction]:
    """Loads that hold the rods at tan(th/2) = t1, t2 with H11 = x L1 k, H22 = y L2 k, where L1 = 1,
    L2 = length, k = 1.

    dU/dth1 = 0 and the value of H11 are two linear equations for (2 rho + F3x, F3), with
    determinant 1.
    """
    (c1, s1), (c2, s2) = (((1 - t * t) / (1 + t * t), 2 * t / (1 + t * t)) for t in (t1, t2))
    s12, c12 = s1 * c2 + c1 * s2, c1 * c2 - s1 * s2
    radial1, radial2 = x + length * c12, y + c12
    across1, across2 = length * s12, s12
    return {
        "L2": length, "rho": rho, "k": Fraction(1),
        "F3x": radial1 * c1 + across1 * s1 - 2 * rho, "F3": radial1 * s1 - across1 * c1,
        "F4x": 2 * rho - radial2 * c2 - across2 * s2, "F4": radial2 * s2 - across2 * c2,
    }  # fmt: skip


def degenerate(poses: Poses) -> Pose:
    (pose,) = (p for p in poses.equilibria if p.multiplicity > 1)
    assert poses.status is Status.ON_VARIETY
    assert (pose.index, pose.stable) == (None, None)
    assert 0 in (pose.eigenvalues[0].exact, pose.eigenvalues[1].exact)
    return pose


def cosine_of_sum(t1: Fraction, t2: Fraction) -> Fraction:
    return ((1 - t1 * t1) * (1 - t2 * t2) - 4 * t1 * t2) / ((1 + t1 * t1) * (1 + t2 * t2))


@few
@given(rationals, rationals, rationals, st.integers(0, 3), lengths)
def test_folds_by_construction(
    t1: Fraction, t2: Fraction, x: Fraction, rho: int, length: Fraction
) -> None:
    """H11 H22 = H12^2 with a chosen H11: multiplicity 2, or more where the third derivative along
    the kernel vanishes.

    That derivative is 3 L1 L2 sin(th1 + th2) v1 v2 (v1 + v2) for the kernel vector (v1, v2).
    """
    c12 = cosine_of_sum(t1, t2)
    s12_is_zero = abs(c12) == 1
    if x == 0 or c12 == 0:
        return
    y = length * c12 * c12 / x
    pose = degenerate(solve(**at_pose(t1, t2, x, y, Fraction(rho), length)))
    cusp = s12_is_zero or x == -length * c12  # else v1 v2 (v1 + v2) is not zero
    assert (pose.multiplicity == 2) is not cusp
    assert pose.cosines_sines[0].exact == (1 - t1 * t1) / (1 + t1 * t1)
    assert pose.cosines_sines[3].exact == 2 * t2 / (1 + t2 * t2)
    assert {e.exact for e in pose.eigenvalues} == {0, x + length * y}


@few
@given(rationals, rationals, lengths)
def test_cusps_by_construction(t1: Fraction, t2: Fraction, length: Fraction) -> None:
    """H11 = H22 = H12: the kernel is (1, -1), and a third derivative vanishes: multiplicity 3, or
    more.
    """
    c12 = cosine_of_sum(t1, t2)
    if c12 == 0 or abs(c12) == 1:
        return
    pose = degenerate(solve(**at_pose(t1, t2, -length * c12, -c12, Fraction(1), length)))
    assert pose.multiplicity == 3


@few
@given(rationals, lengths)
def test_elliptic_umbilics_by_construction(t: Fraction, length: Fraction) -> None:
    """Rods at right angles and a Hessian of zero: the cubic is a product of three different lines,
    multiplicity 4.
    """
    if t == -1:
        return
    other = (1 - t) / (1 + t)  # the tangent of half of 90 degrees minus th1
    pose = degenerate(solve(**at_pose(t, other, Fraction(0), Fraction(0), Fraction(1), length)))
    assert pose.multiplicity == 4
    assert [e.exact for e in pose.eigenvalues] == [0, 0]


@pytest.mark.parametrize(
    ("parameters", "flat", "multiplicity"),
    [
        ({"rho": "5/4", "L2": "3/2"}, True, 3),
        ({"rho": "1/4", "L2": "3/2"}, True, 3),
        ({"rho": "1/4", "L2": "1/2"}, True, 3),
        ({"rho": 1, "L2": 1}, True, 3),
        ({"L2": "4/3", "rho": "2/5", "F3": "-320/3", "F4": -60}, False, 4),
    ],
    ids=[
        "fig2-2rho=L2+1",
        "fig2-2rho=L2-1",
        "fig2-2rho=1-L2",
        "fig2-symmetric",
        "elliptic-umbilic",
    ],
)
def test_degenerate_points_of_the_paper(
    parameters: dict[str, object], flat: bool, multiplicity: int
) -> None:
    """On the lines of fig. 2 the two mirror images and a flat pose meet: a pitchfork, at exactly
    flat rods.
    """
    poses = solve(**parameters)  # type: ignore[arg-type]
    pose = degenerate(poses)
    assert (pose.flat, pose.multiplicity) == (flat, multiplicity)
    assert all(
        p.multiplicity == 1 and p.stable is not None for p in poses.equilibria if p is not pose
    )
    assert sum(p.multiplicity for p in poses.equilibria) in (4, 6)


@pytest.mark.parametrize("offset", ["1e-9", "1e-30", "1e-300"])
@pytest.mark.parametrize("side", [1, -1])
def test_beside_a_fold_the_counts_are_those_of_the_side(offset: str, side: int) -> None:
    """The flat pose of fig. 2 is stable beyond the line, and a saddle with two stable neighbours
    before it.
    """
    poses = solve(rho=Fraction(5, 4) + side * Fraction(offset), L2="3/2")
    assert signature(poses) == ((1, 2, 1) if side > 0 else (2, 3, 1))


@pytest.mark.parametrize(
    "parameters",
    [{"rho": 0}, {"rho": 0, "L2": "3/2"}, {"rho": 1, "F3x": -200, "F4x": 200}],
    ids=str,
)
def test_infinitely_many_equilibria_are_said(parameters: dict[str, object]) -> None:
    poses = solve(**parameters)  # type: ignore[arg-type]
    assert (poses.status, poses.equilibria) == (Status.UNDECIDED, ())
    assert "infinitely many equilibria" in poses.remark
    assert "infinitely many equilibria" in poses.table()


# ------------------------------------------------------------------------------------------- symmetries (theorem 5)

forces = st.fractions(min_value=-200, max_value=200, max_denominator=9)


def close(a: Enclosure, b: Enclosure, factor: Fraction = Fraction(1)) -> bool:
    """Whether a may be factor times b: the enclosures meet."""
    ends = sorted((factor * b.low, factor * b.high))
    return a.low <= ends[1] and ends[0] <= a.high


# ------------------------------------------------------------------------------------------------------ extreme values

EXTREME = [
    {"rho": "1e-12", "L2": "3/2", "F3": -10},
    {"rho": "1e-12", "F3": "1e30", "k": "1e12"},
    {"rho": "1", "L2": "1+1e-20", "F3": "-1e-25"},
    {"L1": "1e-9", "L2": "1e9", "F4": "-1e-9"},
    {"rho": "1e12", "F3": -10, "F4": -10},
    {"k1": "1e-12", "k2": "1e12", "k3": "3", "F3": "7", "F4": -1},
    {"F3": "1e30", "F4": "-1e30+1", "F3x": "1e-30"},
    {"rho": "0", "F3": "1e-40", "L2": "2"},
]


@pytest.mark.parametrize("given_values", EXTREME, ids=str)
@pytest.mark.slow_cases(
    "{'rho': '1e-12', 'F3': '1e30', 'k': '1e12'}",
    "{'rho': '1', 'L2': '1+1e-20', 'F3': '-1e-25'}",
    "{'rho': '1e12', 'F3': -10, 'F4': -10}",
    "{'F3': '1e30', 'F4': '-1e30+1', 'F3x': '1e-30'}",
)
def test_extreme_values_agree_with_the_oracle_and_newton(given_values: dict[str, object]) -> None:
    """Counts by Sturm sequences; digits by Newton's method from the poses themselves, which moves
    what is no zero.
    """
    parameters = point_from_mapping(given_values)
    poses = solve(**given_values)  # type: ignore[arg-type]
    assert signature(poses) == count(parameters)
    fine = solve(digits=60, **given_values)  # type: ignore[arg-type]
    for pose, finer in zip(poses.equilibria, fine.equilibria, strict=True):
        with mpmath.workdps(DIGITS):
            start = [mpf(x.center.numerator) / x.center.denominator for x in finer.angles]
        found = improved(parameters, start)
        wrong = [
            name
            for name, x, value in pairs(pose, found)
            if not agrees(x, value, 12) and abs(value) > mpf("1e-60")
        ]
        assert wrong == []


def test_many_digits() -> None:
    """sin of 2 arctan 2 is rational; a flat angle is pi, whose digits are known."""
    with mpmath.workdps(520):
        expected = mpmath.nstr(mpmath.pi, 500, strip_zeros=False)
    pose = solve(digits=500, rho=1, L2="3/2").equilibria[-1]
    assert pose.angles[0].text(500) == expected


# ----------------------------------------------------------------------------------------------------------- bad input


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"rho": 0.7j}, "rho: 0.7j of type complex is not an exact number"),
        ({"rho": float("inf")}, "rho: inf is not a number"),
        ({"rhoo": 1}, "did you mean 'rho'"),
        ({"L2": 0}, "L2: L2 is 0, but a length must be positive"),
        ({"k": -1}, "stiffness must be positive"),
        ({"rho": "-1e-300"}, "base length must be not negative"),
        ({"l0": "-1/5"}, "free length must be not negative"),
        ({"l0_2": -1}, "free length must be not negative"),
        ({"F3": "F4", "F4": "F3"}, "circle"),
        ({"rho": None}, "has no value"),
        ({"rho": True}, "yes-or-no"),
        ({"rho": [1]}, "not a list"),
        ({"rho": Decimal("nan")}, "not a number"),
        ({"k": 1, "k1": 1, "k2": 1, "k3": 1}, "has no effect"),
        ({"digits": 0}, "digits: 0 is not a number of digits from 1 to 1000"),
        ({"digits": True}, "digits"),
        ({"digits": 1001}, "digits"),
    ],
    ids=str,
)
def test_bad_values_are_refused(values: dict[str, object], message: str) -> None:
    with pytest.raises(ConfigError) as refused:
        solve(**values)  # type: ignore[arg-type]
    assert message in str(refused.value)


def test_exact_values_of_every_kind_are_one_point() -> None:
    first = solve(rho="0.7", L2="3/2", F3="-2*5")
    assert first == solve(rho=Fraction(7, 10), L2=Decimal("1.5"), F3=-10, k1="k", k=100, l0=0)
    assert first.parameters["rho"] == Fraction(7, 10)


def test_a_record_a_mapping_and_its_slice_give_the_point_s_other_parameters() -> None:
    loads = {"F3": "-10", "F4": "-10"}
    record = {"axes": {"rho": [0, 2], "L2": [0, 2]}, "parameters": loads}
    wanted = solve(rho="7/10", L2="3/2", **loads)
    for question in (record, slice_from_mapping(record)):
        assert solve(question, rho="7/10", L2="3/2") == wanted
    heavier = solve(record, rho="7/10", L2="3/2", F3=-20)
    assert heavier == solve(rho="7/10", L2="3/2", F3=-20, F4=-10)
    family = {**record, "parameters": {"F3": "F", "F4": "F"}, "free": {"F": [-40, 0]}}
    assert solve(family, rho="7/10", L2="3/2", F=-10) == wanted


def test_what_nothing_says_stability_of_has_no_stable_poses_to_its_name() -> None:
    assert repr(solve(CONFIGS / "systems" / "duffing.yaml", W=2, G="1/2")).startswith(
        "<Poses of duffing: 1, exact"
    )
