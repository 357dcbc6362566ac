"""Savings: with any of them, or all, switched off the answer is the same, and the plan says which
were.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from pathlib import Path

import pytest
from flint import fmpq
from hypothesis import given, settings
from hypothesis import strategies as st
from support.examples import examples
from support.few import few
from support.random_slices import drawn
from support.replacing import replace
from support.same_maps import difference
from support.shipped_records import EXACT

import ptmcad
from ptmcad.algebra.groebner import groebner_basis
from ptmcad.algebra.polynomials import (
    ONE,
    PLANE,
    Coefficient,
    UnivariatePolynomial,
)
from ptmcad.algebra.quotient_algebra import (
    bounded_away_from_zero,
    multiples,
    multiplicity,
    norm,
    quotient_algebra,
)
from ptmcad.answer.regionmap import HARMLESS, Kind, RegionMap
from ptmcad.cli import run
from ptmcad.errors import ConfigError, HypothesisError
from ptmcad.exact.cad.stacks import heights_between
from ptmcad.question.config import slice_from_mapping
from ptmcad.question.savings import ALL, SAVINGS, switched_off
from ptmcad.question.slice import Slice

ROOT = Path(__file__).resolve().parents[2]
NAMES = tuple(SAVINGS["exact"])
Shipped = Callable[..., RegionMap]


def record(name: str) -> Slice:
    return ptmcad.load(ROOT / "configs" / f"{name}.yaml")


# ------------------------------------------------------------------------------------------------------ the same answer


@pytest.mark.parametrize("without", [*NAMES, ALL])
@pytest.mark.parametrize("name", ["fig2", "fig3"])
@pytest.mark.fast_cases(
    "fig2-hermite-matrix",
    "fig2-infinity",
    "fig2-no-real-points",
    "fig2-axis-order",
    "fig2-even-powers",
    "fig2-equal-counts",
)
def test_without_a_saving_the_map_says_the_same(name: str, without: str, shipped: Shipped) -> None:
    result = ptmcad.classify(record(name), without=[without])
    assert difference(shipped(name), result) == ""
    done = {step.saving for step in result.plan if step.saving and step.done}
    assert done <= (switched_off([without], certified=False) if without == ALL else {without})
    assert RegionMap.from_json(result.to_json()) == result


@pytest.mark.slow
@pytest.mark.parametrize("without", [*NAMES, ALL])
@pytest.mark.parametrize("path", EXACT, ids=lambda p: p.stem)
def test_without_a_saving_every_shipped_map_says_the_same(
    path: Path, without: str, shipped: Shipped
) -> None:
    result = ptmcad.classify(ptmcad.load(path), without=[without])
    assert difference(shipped(path.stem), result) == ""


SMALL = st.fractions(Fraction(1, 4), Fraction(2), max_denominator=6)
LOADS = st.fractions(Fraction(-20), Fraction(20), max_denominator=3)


@st.composite
def slices(draw: st.DrawFn) -> Slice:
    """Small rational slices: two lengths, or a length and a load; unloaded ones among them."""
    axes = draw(
        st.sampled_from([("rho", "L2"), ("L2", "rho"), ("rho", "F"), ("F3", "F4"), ("L1", "L2")])
    )
    parameters = {"L1": "1", "L2": str(draw(SMALL)), "rho": str(draw(SMALL)), "k": "100"}
    parameters |= {"F3": str(draw(LOADS)), "F4": str(draw(LOADS))} if draw(st.booleans()) else {}
    if "F" in axes:
        parameters |= {"F3": "F", "F4": draw(st.sampled_from(["F", "-F", "2*F"]))}
    windows = {}
    for axis in axes:
        low = draw(LOADS if axis.startswith("F") else SMALL)
        windows[axis] = [str(low), str(low + draw(SMALL) * (20 if axis.startswith("F") else 1))]
    rest = {name: value for name, value in parameters.items() if name not in axes}
    return slice_from_mapping(
        {"axes": windows, "parameters": rest, "count": draw(st.sampled_from(["stable", "index"]))}
    )


def both_ways(slice: Slice) -> None:
    try:
        result = ptmcad.classify(slice)
    except HypothesisError as refused:
        with pytest.raises(type(refused)):
            ptmcad.classify(slice, without=ALL)
        return
    assert difference(result, ptmcad.classify(slice, without=ALL)) == ""


@given(slices())
@settings(max_examples=examples(8))
def test_the_plain_pipeline_says_the_same_on_random_slices(slice: Slice) -> None:
    both_ways(slice)


# --------------------------------------------------------------------------------------------------- curves at infinity


X, Y = PLANE.gens()


@pytest.mark.parametrize(
    ("constant", "expected"),
    [(ONE, True), (Y, False), (X, True)],
    ids=["the other root stays", "the other root vanishes on the curve", "it vanishes elsewhere"],
)
def test_away_from_zero_where_a_root_is_lost(constant: Coefficient, expected: bool) -> None:
    """Roots of y u^2 - u + c near y = 0: one is about 1/y, the other about c; with c = y their
    product is 1.
    """
    basis = groebner_basis([{(2,): Y, (1,): -ONE, (0,): constant}], (0,))
    algebra = quotient_algebra(basis)
    assert algebra is not None
    unknown = {(1,): ONE}
    assert (
        bounded_away_from_zero(multiples(algebra, unknown), norm(algebra, unknown), Y) is expected
    )


def test_multiplicity_of_a_factor() -> None:
    assert multiplicity(X**3 * (Y + 1) * 6, X) == 3
    assert multiplicity(X + 1, X) == 0


@pytest.mark.parametrize("number", few([157, 161, 164], 157))
def test_real_curves_over_which_complex_solutions_are_lost_are_no_walls(number: int) -> None:
    slice = slice_from_mapping(drawn(number).record)
    result = ptmcad.classify(slice)
    plain = ptmcad.classify(slice, without=["infinity"])
    (harmless,) = (c for c in result.components if c.left_out == HARMLESS)
    assert next(c for c in plain.components if c.polynomial == harmless.polynomial).left_out == ""
    assert len(plain.cells) > len(result.cells)
    assert difference(result, plain) == ""
    assert ptmcad.verify(result).ok
    # a critical curve that is said to be harmless is noticed
    k = next(n for n, c in enumerate(result.components) if c.kind is Kind.CRITICAL)
    lie = replace(result.components[k], kind=Kind.INFINITY, left_out=HARMLESS)
    assert not ptmcad.verify(
        replace(result, components=(*result.components[:k], lie, *result.components[k + 1 :]))
    ).ok


def test_samples_keep_off_curves_that_are_no_walls() -> None:
    half = UnivariatePolynomial([-1, 2])
    third = UnivariatePolynomial([-1, 3])
    assert heights_between((), (fmpq(0), fmpq(1))) == (fmpq(1, 2),)
    (height,) = heights_between((), (fmpq(0), fmpq(1)), [half, third])
    assert 0 < height < 1
    assert height not in (fmpq(1, 2), fmpq(1, 3))


# ------------------------------------------------------------------------------------------------------------- the plan


def test_every_saving_is_in_the_plan_once(shipped: Shipped) -> None:
    result = shipped("fig3")
    made = [step.saving for step in result.plan if step.saving and not step.done]
    assert set(made) == {*NAMES, "imports"}
    assert not [step for step in result.plan if step.saving and step.done]
    plain = ptmcad.classify(record("fig3"), without=ALL)
    assert {step.saving for step in plain.plan if step.done and step.saving} == {*NAMES, "imports"}
    assert not [step for step in plain.plan if step.saving and not step.done]
    assert {c.left_out for c in plain.components} == {""}
    assert Kind.AUXILIARY in {c.kind for c in plain.components}


def test_areas_that_nobody_asks_for(shipped: Shipped) -> None:
    whole = shipped("fig4")
    result = ptmcad.classify(record("fig4"), areas=False)
    assert {region.area for region in result.regions} == {(0, 4)}
    assert "areas     not computed" in result.table()
    assert result.status is whole.status
    assert difference(whole, result) == ""
    assert ptmcad.verify(result).ok
    assert not ptmcad.verify(replace(whole, plan=result.plan)).ok
    with pytest.raises(ConfigError, match="leave one out"):
        ptmcad.classify(record("fig4"), areas=False, area_tolerance="1e-3")


def test_verify_refuses_what_was_made_without_a_saving(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], shipped: Shipped
) -> None:
    """The document says so, and a plan that says otherwise is false."""
    assert run(["classify", str(ROOT / "configs" / "fig2.yaml"), "--without", "sign-curve", "--without", "infinity",
                "--format", "json", "--out", str(tmp_path)]) == 0  # fmt: skip
    path = tmp_path / "fig2.json"
    plain = RegionMap.from_json(path.read_text(encoding="utf-8"))
    with pytest.raises(
        ConfigError,
        match=r"computed without these savings, .* infinity, sign-curve.* are not checked",
    ):
        ptmcad.verify(plain)
    capsys.readouterr()
    assert run(["verify", str(path)]) == 2
    assert "infinity, sign-curve. Such results are not checked" in capsys.readouterr().err
    honest = shipped("fig2")
    report = ptmcad.verify(replace(plain, plan=honest.plan))
    assert report.violation is not None


@pytest.mark.parametrize(
    ("names", "part"),
    [
        (("axis-ordr",), "did you mean 'axis-order'?; there are sign-curve, "),
        (("leading", "all"), "'leading' is no saving"),
        (
            ("cones-and-creases",),
            "a saving of the certified engine, and this slice is the exact engine's",
        ),
        ("", "'' is no saving"),
    ],
    ids=str,
)
def test_names_that_no_saving_has_are_refused(names: tuple[str, ...] | str, part: str) -> None:
    with pytest.raises(ConfigError) as caught:
        ptmcad.classify(record("fig2"), without=names)
    assert caught.value.key == "without"
    assert part in caught.value.message


def test_the_older_name_is_taken(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.warns(DeprecationWarning, match="without"):
        older = ptmcad.classify(record("fig2"), areas=False, keep=["axis-order"])
    assert older.plan == ptmcad.classify(record("fig2"), areas=False, without=["axis-order"]).plan
    with pytest.raises(ConfigError, match="give one of them"):
        ptmcad.classify(record("fig2"), without=["axis-order"], keep=["sign-curve"])

    fig2 = str(ROOT / "configs" / "fig2.yaml")
    command = [
        "classify",
        fig2,
        "--no-areas",
        "--format",
        "json",
        "--out",
        str(tmp_path),
        "--explain",
    ]
    assert run([*command, "--keep", "axis-order", "--without", "sign-curve"]) == 0
    shown = capsys.readouterr().out
    assert "(the first axis, as asked for)" in shown
    assert "computed: projection of H11 = 0 (kept, as asked for)" in shown
    assert run(["classify", "--help"]) == 0
    page = capsys.readouterr().out
    assert "--without" not in page and "--keep" not in page


# ------------------------------------------------------------------------------------------------- the certified engine
