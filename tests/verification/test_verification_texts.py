"""Texts in a result, checked: the parameters as they were written, and the potential of a certified
map.
"""

from __future__ import annotations

import re
from fractions import Fraction
from types import SimpleNamespace

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from support.examples import examples
from support.replacing import replace

from ptmcad.answer.regionmap import RegionMap, Status, System
from ptmcad.errors import ConfigError
from ptmcad.model import ptm
from ptmcad.question.config import slice_from_mapping
from ptmcad.question.slice import Axis, Slice
from ptmcad.show.report.reproduction import reproduction
from ptmcad.text.expressions import axis, constant
from ptmcad.verification.certified.parameterdomain import check_domain
from ptmcad.verification.equationtexts import check_potential
from ptmcad.verification.parameterclaims import check_text
from ptmcad.verification.report import Unchecked, Violation

WINDOW = {"rho": ["1/5", "2"], "L2": ["1/5", "2"]}


def claims(slice: Slice, potential: str = "") -> SimpleNamespace:
    """A result in which only the slice and the potential are looked at, as a file has it."""
    system = System(("th1", "th2"), (), potential, (), ())
    result = RegionMap(slice=slice, status=Status.PARTIAL, system=system, complex_solutions=6,
                       undetermined=Fraction(1), versions={})  # fmt: skip
    return SimpleNamespace(result=RegionMap.from_json(result.to_json()))


def asked(axes: dict[str, list[str]] = WINDOW, **parameters: str) -> Slice:
    return slice_from_mapping({"name": "asked", "parameters": parameters, "axes": axes})


# ---------------------------------------------------------------------------------------- parameters as written

NAMED = [
    ({"k": "100", "k1": "k", "k2": "2*k", "k3": "k"}, {"k"}),
    ({"k1": "90", "k2": "80", "k3": "100", "F3": "k/10"}, {"k"}),
    ({"F3": "l0-10"}, {"l0"}),
    ({"l0": "0", "F3": "l0-10"}, {"l0"}),
    ({"F3": "l0_1-10"}, {"l0_1"}),
    ({"l0_2": "l0_1", "F3": "l0_2"}, {"l0_1", "l0_2"}),
    ({"l0": "1/5", "l0_1": "2*l0"}, {"l0"}),
    ({"l0": "k/500", "k1": "rho", "k2": "1", "k3": "2"}, {"k"}),
    ({"k1": "1", "k2": "3", "k3": "2", "k": "l0+1", "l0": "l0_1", "F3": "k"}, {"k", "l0", "l0_1"}),
    ({}, set()),
]


@pytest.mark.parametrize(
    ("parameters", "alone"),
    NAMED,
    ids=lambda x: str(x) if isinstance(x, dict) else "-".join(sorted(x)),
)
def test_names_in_texts_have_texts(parameters: dict[str, str], alone: set[str]) -> None:
    """Every name that a text names is explained, also where it is no parameter; the parameters are
    what they were.
    """
    try:
        slice = asked(**parameters)
    except ConfigError as error:  # l0_1 is l0 by default
        assert "circle" in str(error)
        slice = asked(**{**parameters, "l0_1": "0"})
    assert slice.text.keys() - slice.parameters.keys() == alone
    assert not alone & slice.parameters.keys()
    check_text(claims(slice))
    assert "parameters" in check_domain(claims(slice))
    record = reproduction(slice)[0]
    assert record is not None
    assert all(name in record for name in alone - {"l0"})


def test_names_of_axes_need_no_text() -> None:
    slice = asked({"k": ["1", "20"], "L2": ["1/5", "2"]}, k1="k", k2="k", k3="100", L1="k/10")
    assert "k" not in slice.text
    check_text(claims(slice))
    check_domain(claims(slice))


FREE_LENGTHS = ptm().free_lengths
STIFF, FREE, LOADS = ("k", "k1", "k2", "k3"), ("l0", *FREE_LENGTHS), ("F3", "F4", "F3x")
AXES = (
    ("rho", "L2"),
    ("u", "v"),
    ("k", "u"),
    ("l0", "v"),
    ("k1", "L1"),
    ("l0_2", "F4"),
    ("F3", "k3"),
)


@st.composite
def records(draw: st.DrawFn) -> dict[str, object]:
    """Records in which parameters, axes and names that are only there for others name each other."""
    axes = draw(st.sampled_from(AXES))
    known = ["7/3", *axes]
    parameters = {}
    free = draw(st.sampled_from([(), FREE, FREE[1:]]))
    for name in draw(st.permutations(sorted({*STIFF, *free, *LOADS, "L1"} - {*axes}))):
        if draw(st.booleans()):
            one, two = draw(st.sampled_from(known)), draw(st.sampled_from(known))
            forms = ["{0}", "2*{0}", "{0} + {1}", "{0}/10 + 1", "({0} + 1)*{1}", "3"]
            forms += (
                ["0", "{0}/({1} + 1)"]
                if name in FREE
                else ["-{0}", "{0} - {1}"]
                if name in LOADS
                else []
            )
            parameters[name] = draw(st.sampled_from(forms)).format(one, two)
        known.append(name)
    parameters["F4x"] = f"{axes[0]} - {axes[1]}"  # so that both axes are used
    return {"parameters": parameters, "axes": {name: ["1/5", "3/2"] for name in axes}}


@settings(max_examples=examples(150), deadline=None)
@given(records())
def test_texts_of_any_record_are_explained(record: dict[str, object]) -> None:
    try:
        slice = slice_from_mapping(record)
    except ConfigError:
        assume(False)
    check_text(claims(slice))


@pytest.mark.parametrize(
    ("parameters", "changes", "message"),
    [
        ({}, {"l0": "1/5"}, "the parameter l0 is stored, but nothing depends on it"),
        (
            {"F3": "l0_1"},
            {"l0_1": "1/5", "F3": "l0_1 - 1/5"},
            "l0_1 was written as '1/5', but is left out as if",
        ),
        ({"F3": "l0"}, {"l0": "1"}, "F3 was written as 'l0', but is 0"),
        ({"F3": "l0"}, {"l0": "0*k", "k": "100 + l0"}, "name what is not explained"),
        (
            {"k1": "1", "k2": "1", "k3": "1"},
            {"k": "100"},
            "the parameter k is stored, but nothing depends on it",
        ),
    ],
)
def test_false_texts_are_told(
    parameters: dict[str, str], changes: dict[str, str], message: str
) -> None:
    slice = asked(**parameters)
    with pytest.raises(Violation, match=message):
        check_text(claims(replace(slice, text={**slice.text, **changes})))


def test_an_axis_has_no_text_beside_its_parameter() -> None:
    slice = asked({"k": ["1", "20"], "L2": ["1/5", "2"]}, k1="k", k2="k", k3="100")
    with pytest.raises(Violation, match="a text its parameter"):
        check_text(claims(replace(slice, text={**slice.text, "k": "100"})))


# -------------------------------------------------------------------------------------- signs of what is only named


def springs(slice: Slice, name: str) -> Slice:
    """All springs have minus what ``name`` says, in the text only."""
    of = ("k1", "k2", "k3") if name == "k" else ptm().free_lengths
    return replace(slice, text={**slice.text, **dict.fromkeys(of, f"-{name}"), name: "-1/5"},
                   parameters={**slice.parameters, **dict.fromkeys(of, constant(Fraction(1, 5)))})  # fmt: skip


@pytest.mark.parametrize("name", ["k", "l0"])
@pytest.mark.parametrize("stored", [True, False])
def test_the_sign_of_what_is_only_named_is_checked(name: str, stored: bool) -> None:
    """A k of -1/5 with springs of -k, which a record is refused for; with and without k among the
    parameters.
    """
    forged = springs(asked(k1="1", k2="1", k3="1"), name)
    if stored:
        forged = replace(forged, parameters={**forged.parameters, name: constant(Fraction(-1, 5))})
    check_text(claims(forged))
    with pytest.raises(Violation, match=f"{name} is (not positive|negative) somewhere"):
        check_domain(claims(forged))
    with pytest.raises(ConfigError, match=f"{name} is -1/5, but a"):
        slice_from_mapping({"parameters": {n: forged.text[n] for n in ("k1", "k2", "k3", name, *ptm().free_lengths)
                                           if n in forged.text}, "axes": WINDOW})  # fmt: skip


def test_the_sign_of_an_axis_is_checked() -> None:
    slice = asked({"k": ["1", "2"], "L2": ["1/5", "2"]}, k1="k", k2="k", k3="k")
    parameters = {**slice.parameters, **dict.fromkeys(("k1", "k2", "k3"), -axis(0))}
    forged = replace(slice, axes=(Axis("k", Fraction(-2), Fraction(-1)), slice.axes[1]), parameters=parameters,
                     text={**slice.text, "k1": "-k", "k2": "-k", "k3": "-k"})  # fmt: skip
    check_text(claims(forged))
    with pytest.raises(Violation, match="k is not positive"):
        check_domain(claims(forged))


def test_a_pole_of_what_is_only_named_is_found() -> None:
    slice = asked(k1="1", k2="1", k3="1")
    forged = replace(slice, text={**slice.text, "k": "1/(rho - 1)^2", "F3": "0*k"})
    check_text(claims(forged))
    with pytest.raises(Violation, match="k has a pole"):
        check_domain(claims(forged))


def test_an_undecided_sign_of_what_is_only_named_is_refused() -> None:
    """No engine would look at it, and the verification may find it wrong."""
    window = {"rho": ["0", "2"], "L2": ["0", "2"]}
    with pytest.raises(ConfigError, match="it is not proved that k is positive"):
        asked(
            window, k="(rho - 137/100)^24 + (L2 - 1/10)^24 + 1e-216", k1="1", k2="1", k3="1", F3="k"
        )


# ------------------------------------------------------------------------------------------------ the potential


@pytest.fixture(scope="module")
def energy() -> str:
    pytest.importorskip("numba")
    from ptmcad.certified.statement import system_text
    from ptmcad.model import ptm

    return system_text(ptm()).potential


TRUE = [
    ("", ""),
    ("1/2*k1*", "k1/2*"),
    ("(L2*sin(th2) - L1*sin(th1))^2", "(L1*sin(th1) - L2*sin(th2))*(L1*sin(th1) - L2*sin(th2))"),
    ("(rho - L2*cos(th2))^2 + (L2*sin(th2))^2", "rho^2 + L2^2 - 2*rho*L2*cos(th2)"),
    ("$", " + rho*(cos(th1)^2 + sin(th1)^2 - 1)"),
    ("$", " + sqrt(rho^2 + L1^2 - 2*rho*L1*cos(th1))^2 - rho^2 - L1^2 + 2*rho*L1*cos(th1)"),
]


@pytest.mark.parametrize(("old", "new"), TRUE)
def test_the_potential_may_be_written_in_any_way(energy: str, old: str, new: str) -> None:
    text = energy + new if old == "$" else energy.replace(old, new)
    assert (text != energy) == bool(new)
    check_potential(claims(asked(), text))


FALSE = [
    (r"\bF3\b", "sqrt(F3^2)", "a root of what is no spring's length"),
    (r"\bl0_1\b", "sqrt(l0_1^2)", "a root of what is no spring's length"),
    ("$", " + sqrt(rho^2) - rho", "a root of what is no spring's length"),
    ("$", " + sqrt(0 - 1)", "a root of what is no spring's length"),
    (
        "$",
        " + 1000*F3*(262144*rho - 594256)*(262144*rho - 228345)*(262144*rho - 89146)",
        "differs from the mechanism",
    ),
    ("$", f" + F3/{10**45}", "differs from the mechanism's"),
    ("$", " + 1", "differs from the mechanism's"),
    ("$", f" + 1/{10**45}*(cos(th1) - 1)", "differs from the mechanism's"),
    ("1/2\\*k1", "1/2*k2", "differs from the mechanism's"),
    (" - F3\\*", " + F3*", "differs from the mechanism's"),
    ("\\(L2\\*sin\\(th2\\)\\)\\^2", "(L1*sin(th2))^2", "a root of what is no spring's length"),
    ("sin\\(th1\\)", "sin(rho)", "names 'cos\\(rho\\)'"),
    ("cos\\(th1\\)", "th1", "names 'th1'"),
    ("^", "exit() + ", "cannot be read: "),
    ("$", " + 1/rho", "it divides by what is no number"),
    ("$", "*L1/L1", "it divides by what is no number"),
    ("$", "*L1^0.5", "an exponent that is no whole number"),
    ("$", "*2^0.3", "an exponent that is no whole number"),
    ("$", "*L1^(0-1)", "an exponent that is no"),
    ("$", " + 0*cos(2^0.5*th1)", "no whole number"),
    ("$", " + 1/(rho - rho)", "it divides by what is no number"),
    ("$", " + 0*foo", "names 'foo'"),
    ("$", " + 0*9^9^9^9", "a part that is no formula"),
    ("$", " + 0.5", "differs from the mechanism"),
    ("$", "*(L1 + L2)^9*(L1 + L2)^9", "differs from the mechanism"),
    ("$", " + rho**2", "cannot be read: "),
    ("$", " + (", "cannot be read"),
    ("$", " + " + "(" * 2000 + "1" + ")" * 2000, "cannot be read"),
    (
        "$",
        " + " + "-" * 4000 + "rho",
        "cannot be read: ",
    ),
    ("$", " + rho" * 700, "differs from the mechanism's"),
    ("$", " + ((L1 + L2 + rho)^9)^9", "differs from the mechanism's"),
    (
        "$",
        " + (k1 + k2 + k3 + F3 + F4)^6*(L1 + L2 + rho + F3x + F4x)^6",
        "differs from the mechanism's",
    ),
]


@pytest.mark.parametrize(("old", "new", "message"), FALSE, ids=lambda v: v[:40])
def test_no_other_potential_is_accepted(energy: str, old: str, new: str, message: str) -> None:
    """Nor one that agrees at all points of one sign, at points known beforehand, or to many digits."""
    text = re.sub(old, lambda _: new, energy)
    assert text != energy
    with pytest.raises(Violation, match=message):
        check_potential(claims(asked(), text))


def test_a_text_of_too_high_a_degree_is_not_checked(energy: str) -> None:
    found = check_potential(claims(asked(), f"{energy} + ((L1 + L2)^99999)^99999"))
    assert isinstance(found, Unchecked)
    assert "too high a degree" in found
