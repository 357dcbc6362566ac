"""Enclosures and algebraic numbers as text; poses as JSON and as a table."""

from __future__ import annotations

import json
from decimal import ROUND_HALF_EVEN, Context, Decimal
from fractions import Fraction
from pathlib import Path
from typing import Any

import jsonschema
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from ptmcad import AlgebraicNumber, Enclosure, Poses, solve
from ptmcad.model import ptm
from ptmcad.show.document.posedocument import FORMAT
from ptmcad.show.table import WIDTH
from ptmcad.text.numerals import fraction_of

SCHEMA = json.loads(
    (Path(__file__).resolve().parents[2] / "docs" / "poses.schema.json").read_text(encoding="utf-8")
)
VALIDATOR = jsonschema.Draft202012Validator(SCHEMA)
POINTS: list[dict[str, Any]] = [
    {"rho": 1, "L2": "3/2"},
    {"rho": "7/10", "L2": "3/2", "F3": -10, "F4": -10},
    {"L2": "4/3", "rho": "2/5", "F3": "-320/3", "F4": -60},
    {"rho": 0},
    {"rho": "1e-12", "F3": "1e30", "k": "1e12", "digits": 30},
    {"rho": "1/3", "L2": "7/3", "k1": "1/3", "digits": 1},
]
rationals = st.fractions().filter(bool) | st.builds(
    lambda m, e: m * Fraction(10) ** e,
    st.fractions(max_denominator=50).filter(bool),
    st.integers(-40, 40),
)


# ---------------------------------------------------------------------------------------------------------- enclosures


def exactly(value: Fraction) -> Enclosure:
    return Enclosure(value, value)


@given(rationals, st.integers(1, 30))
def test_text_is_the_number_rounded_to_nearest(value: Fraction, digits: int) -> None:
    """Against Python's decimal arithmetic, whose division rounds once, and half to even."""
    rounded = Context(prec=digits, rounding=ROUND_HALF_EVEN).divide(
        Decimal(value.numerator), Decimal(value.denominator)
    )
    text = exactly(value).text(digits)
    assert Decimal(text) == rounded
    assert fraction_of(text) == Fraction(rounded)
    if Fraction(rounded) != value:
        assert len(Decimal(text).as_tuple().digits) == digits


@given(rationals, st.integers(1, 12), st.integers(1, 20))
def test_a_text_is_the_rounding_of_every_number_of_the_enclosure(
    value: Fraction, digits: int, narrow: int
) -> None:
    radius = abs(value) / 10**narrow
    around = Enclosure(value - radius * 2 / 3, value + radius / 3)
    shown = next((more for more in range(digits, digits + 6) if around.settles(more)), None)
    if shown is None:
        middle, error = map(Fraction, around.text(digits).split(" ± "))
        assert (
            middle - error <= around.low < around.high <= middle + error <= around.high + 3 * error
        )
        return
    ends = {Fraction(Decimal(exactly(end).text(shown))) for end in (around.low, around.high)}
    assert ends == {Fraction(Decimal(around.text(digits)))}


@given(rationals, st.integers(1, 12))
def test_a_narrow_enclosure_has_a_text_of_any_number_of_digits(
    value: Fraction, digits: int
) -> None:
    """One that contains a single number halfway between two texts is written with one digit more."""
    radius = abs(value) / 10**40
    around = Enclosure(value - radius, value + radius)
    assume(around.low != around.high)
    assert (
        abs(Fraction(Decimal(around.text(digits))) / value - 1) <= Fraction(10) ** (1 - digits) / 2
    )


def test_zero_is_settled_only_when_it_is_exact() -> None:
    assert not Enclosure(Fraction(-1, 10**9), Fraction(1, 10**9)).settles(1)
    assert not Enclosure(Fraction(0), Fraction(1, 10**9)).settles(1)
    assert exactly(Fraction(0)).settles(1000)


ROOT2 = AlgebraicNumber((-2, 0, 1), Fraction(1), Fraction(2))


def test_the_root_of_two() -> None:
    assert ROOT2.text(50) == "1.4142135623730950488016887242096980785696718753769"
    assert ROOT2.exact is None
    assert ROOT2.compare(Fraction(7, 5)) == 1
    assert ROOT2.compare(Fraction(3, 2)) == ROOT2.compare(Fraction(3)) == -1
    narrow = ROOT2.refined(Fraction(1, 10**60))
    assert narrow.high - narrow.low <= Fraction(1, 10**60)
    assert narrow.low**2 < 2 < narrow.high**2


# ---------------------------------------------------------------------------------------------------------------- JSON


def test_the_schema_is_valid_and_names_the_format() -> None:
    jsonschema.Draft202012Validator.check_schema(SCHEMA)
    assert SCHEMA["properties"]["format"]["const"] == FORMAT


@pytest.mark.parametrize("point", POINTS, ids=str)
@pytest.mark.fast_cases("{'L2': '4/3', 'rho': '2/5', 'F3': '-320/3', 'F4': -60}", "{'rho': 0}")
def test_poses_validate_and_are_read_back_equal(point: dict[str, Any]) -> None:
    poses = solve(**point)
    text = poses.to_json()
    VALIDATOR.validate(json.loads(text))
    again = Poses.from_json(text)
    assert again == poses
    assert again.to_json() == text
    assert tuple(poses.parameters) == ptm().without_free_lengths


@pytest.mark.parametrize(
    ("place", "value", "fault"),
    [
        (("energy", "text"), "112.500000001", "energy.text is not '112.5', as the rest says"),
        (("energy", "center"), "112.6", "is not '112.6', as the rest says"),
        (("energy", "radius"), "-1", "is negative"),
        (("energy", "radius"), "1", "is not '112 ± 2', as the rest says"),
        (("energy", "center"), "1/0", "zero denominator"),
        (("angles", 0), {}, "lacks the key"),
        (("angles",), [], "has 0 entries, not 2"),
        (("stable",), 1, "is not true or false"),
        (("index",), -1, "is not between"),
        (("nodes",), {"A 1": []}, "is not a name"),
        (("springs", 0, "name"), "k\n1", "printable"),
    ],
    ids=str,
)
def test_a_changed_document_is_refused_with_its_place(
    place: tuple[Any, ...], value: object, fault: str
) -> None:
    data = json.loads(solve(rho=1, L2="3/2").to_json())
    target = data["equilibria"][0]
    for step in place[:-1]:
        target = target[step]
    target[place[-1]] = value
    with pytest.raises(ValueError, match=r"equilibria\[0\]") as refused:
        Poses.from_json(json.dumps(data))
    assert fault in str(refused.value)


@pytest.mark.parametrize(
    "text", ["", "[]", "{}", '{"format": "ptmcad-poses/0"}', "[" * 100_000, '{"a": 1, "a": 2}']
)
def test_what_is_no_document_is_refused(text: str) -> None:
    with pytest.raises(ValueError, match=r"."):
        Poses.from_json(text)


# --------------------------------------------------------------------------------------------------------------- table


@pytest.mark.parametrize("point", POINTS, ids=str)
def test_the_table_has_a_row_for_each_pose_in_each_block_and_fits(point: dict[str, Any]) -> None:
    poses = solve(**point)
    lines = str(poses).splitlines()
    assert max(map(len, lines)) <= WIDTH
    blocks = [block.splitlines() for block in str(poses).split("\n\n")[1:-1]]
    assert all(len(block) == 1 + len(poses.equilibria) for block in blocks)
    assert all(len({len(line) for line in block}) == 1 for block in blocks)
    for pose in poses.equilibria:
        assert any(pose.energy.text(poses.digits) in line.split() for line in lines)


def test_the_table_of_a_degenerate_point_names_it() -> None:
    table = solve(**POINTS[2]).table(6)
    assert "1 stable, 1 maximum, 1 degenerate, on the variety" in table
    assert "2  degenerate    no      -      4" in table
    assert "F3 = -320/3, F4 = -60" in table


def test_the_table_with_fewer_digits_rounds_once() -> None:
    poses = solve(rho="7/10", L2="3/2", F3=-10, F4=-10, digits=40)
    for digits in (3, 9, 20, 40):
        assert poses.equilibria[0].energy.text(digits) in poses.table(digits)
        assert str(solve(rho="7/10", L2="3/2", F3=-10, F4=-10, digits=digits)) == poses.table(
            digits
        )
