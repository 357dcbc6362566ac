"""Signs proved by `ptmcad.verification.windowsigns` against `ptmcad.question.positivity`, which shares no
code with it.
"""

from __future__ import annotations

import random
from collections.abc import Callable
from fractions import Fraction

import pytest
from flint import fmpq
from support.certified_maps import certified
from support.dips import AXES, DIPS, NAMES, random_square, thin_dip
from support.replacing import replace

import ptmcad
from ptmcad.answer.regionmap import RegionMap
from ptmcad.cover.rectangles import Cover
from ptmcad.question.positivity import Need, decide
from ptmcad.question.slice import PROVED, Axis, Count, Slice, Witness
from ptmcad.text.expressions import Expression, axis, constant
from ptmcad.text.parsing import parse
from ptmcad.verification.certified.parameterdomain import check_domain
from ptmcad.verification.claims import Claims
from ptmcad.verification.report import Unchecked, Violation
from ptmcad.verification.windowsigns import Sign, has_no_pole, is_in_domain

WINDOW = ((fmpq(0), fmpq(2)), (fmpq(-3), fmpq(1)))


def sign(expression: Expression, need: Need) -> Sign:
    if need is Need.NO_POLE:
        return has_no_pole(expression, WINDOW)
    return is_in_domain(expression, WINDOW, need is Need.POSITIVE)


def agree(expression: Expression, need: Need) -> bool:
    """Whether both decide; a contradiction fails."""
    engine, checker = decide(expression, AXES, need), sign(expression, need)
    if (not isinstance(engine, Witness) and engine) or checker is Sign.UNCHECKED:
        return False
    assert (checker is Sign.PROVED) == (engine == PROVED)
    return True


@pytest.mark.parametrize("need", Need)
@pytest.mark.parametrize("kind", DIPS)
@pytest.mark.slow_cases(
    "diagonal-Need.POSITIVE",
    "diagonal-Need.NO_POLE",
    "degree 20-Need.NOT_NEGATIVE",
    "degree 20-Need.NO_POLE",
    "degree 8 in both-Need.POSITIVE",
    "degree 8 in both-Need.NO_POLE",
    "irrational-Need.POSITIVE",
    "irrational-Need.NO_POLE",
    "degree 8 in both-Need.NOT_NEGATIVE",
    "edge-Need.NOT_NEGATIVE",
    "edge-Need.POSITIVE",
    "far corner-Need.NOT_NEGATIVE",
    "far corner-Need.NO_POLE",
    "far corner-Need.POSITIVE",
    "line-Need.NO_POLE",
    "line-Need.POSITIVE",
    "upper edge-Need.NOT_NEGATIVE",
    "upper edge-Need.NO_POLE",
)
def test_narrow_dips(kind: str, need: Need) -> None:
    """The checker decides them; the engine, which halves boxes, may not, and never contradicts it."""
    for p in thin_dip(kind):
        e = 1 / p if need is Need.NO_POLE else p
        agree(e, need)
        assert sign(e, need) is not Sign.UNCHECKED or kind.startswith("degree 20 in both")


@pytest.mark.parametrize(
    ("text", "strict", "expected"),
    [("rho*(F+3)", True, Sign.PROVED), ("1/(rho-3)", True, Sign.WRONG), ("-1/(rho-3)", True, Sign.PROVED),
     ("(rho-1)^2", True, Sign.WRONG), ("(rho-1)^2", False, Sign.PROVED), ("(rho-1)^3", False, Sign.WRONG),
     ("F^2*(rho-1)^2*(F+3)", False, Sign.PROVED), ("0*F", False, Sign.PROVED), ("0*F", True, Sign.WRONG),
     ("-1-F^2", False, Sign.WRONG), ("rho^2+(F+1/3)^2", True, Sign.PROVED),
     ("(rho-1)^2+(F+1)^2", False, Sign.PROVED), ("(rho-1)^2+(F+1)^2", True, Sign.UNCHECKED),
     ("(rho-1)^2+(F+1)^2+1e-20", True, Sign.PROVED), ("rho^16*F^16+1+rho*F", True, Sign.UNCHECKED),
     ("1/(rho-1)-3", True, Sign.UNCHECKED), ("-1/(rho-3/2)-F", False, Sign.UNCHECKED), ("1/rho", True, Sign.PROVED)],
)  # fmt: skip
def test_known_signs(text: str, strict: bool, expected: Sign) -> None:
    assert is_in_domain(parse(text, NAMES), WINDOW, strict) is expected


@pytest.mark.parametrize("seed", range(12))
@pytest.mark.slow_cases("2", "3", "11", "6", "9")
def test_random_functions_have_the_sign_that_the_engine_decides(seed: int) -> None:
    rng = random.Random(seed)
    p = random_square(rng, 4)
    q = constant(rng.randint(1, 9)) + sum(
        (rng.randint(-2, 2) * v for v in NAMES.values()), constant(0)
    )
    for e in (p, p - rng.randint(0, 3), q, p * q, (p + 1) / q, q / (p + 1)):
        for need in Need:
            agree(e, need)


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [("l0_3", "(rho-1)^2 + (L2-1/3)^2 - 1e-18", "l0_3 is negative somewhere"),
     ("k2", "1/(rho-1)", "k2 has a pole"), ("L1", "(rho-1)^2", "L1 is not positive somewhere"),
     ("F3", "1/(3*rho-2)^2", "F3 has a pole"), ("l0_1", "rho^7*(2-L2)^3/(L2+1)", "")],
)  # fmt: skip
def test_a_certified_map_outside_of_the_domain_is_rejected(
    name: str, text: str, message: str
) -> None:
    """A stored map is read without asking for signs; random boxes do not meet a dip of width 1e-9."""
    true = certified(Cover(2**10, ()), lambda x, y: 2)
    assert not isinstance(check_domain(Claims(true)), Unchecked)
    slice = true.slice
    expression = parse(text, {"rho": axis(0), "L2": axis(1)})
    altered = replace(
        slice, parameters={**slice.parameters, name: expression}, text={**slice.text, name: text}
    )
    if message:
        with pytest.raises(Violation, match=message):
            check_domain(Claims(replace(true, slice=altered)))
    else:
        assert not isinstance(check_domain(Claims(replace(true, slice=altered))), Unchecked)


def test_a_base_below_zero_is_rejected_and_what_is_too_long_is_said_to_be_unchecked() -> None:
    true = certified(Cover(2**10, ()), lambda x, y: 2)
    names = {"rho": axis(0), "L2": axis(1)}
    given = {**true.slice.parameters, "rho": parse("rho-1", names)}
    with pytest.raises(Violation, match="rho is not positive"):
        check_domain(Claims(replace(true, slice=replace(true.slice, parameters=given))))
    given = {
        **true.slice.parameters,
        "rho": constant(0),
        "k1": parse("rho^16*L2^16+1+rho*L2", names),
    }
    found = check_domain(Claims(replace(true, slice=replace(true.slice, parameters=given))))
    assert isinstance(found, Unchecked)
    assert found.startswith("k1")


@pytest.mark.parametrize(
    ("name", "text"),
    [("L1", "(rho-1/3)^2"), ("L1", "(rho-1)^2"), ("k2", "100*(rho-1/3)^2"), ("F3", "1/(rho-1/3)^2"),
     ("l0_3", "1/10 - (rho/2)^16*(L2/2)^15")],
)  # fmt: skip
def test_signs_of_an_exact_map_too(name: str, text: str, shipped: Callable[..., RegionMap]) -> None:
    """Zeros and poles of even order change no sign at a sample, and beyond the degrees values are
    tried.
    """
    true = shipped("fig4")
    expression = parse(text, {"rho": axis(0), "L2": axis(1)})
    altered = replace(true.slice, parameters={**true.slice.parameters, name: expression})
    assert not isinstance(check_domain(Claims(true)), Unchecked)
    with pytest.raises(Violation, match=f"{name} (is|has)"):
        check_domain(Claims(replace(true, slice=altered)))


@pytest.mark.parametrize(
    ("part", "message"),
    [
        ({"k": "a - 1"}, "the stiffness of spring AP is not positive"),
        ({"k": "1", "free": "b - 1"}, "the free length of spring AP is negative"),
        ({"k": "a + 1", "free": "b"}, ""),
    ],
)
def test_what_a_spring_is_given_is_checked(
    part: dict[str, str], message: str, shipped: Callable[..., RegionMap]
) -> None:
    mechanism = ptmcad.Mechanism(
        parameters={"a": {}, "b": {}},
        unknowns={"th": "angle"},
        points={"A": ["-2", "0"], "P": ["sin(th)", "cos(th)"]},
        springs=[{"between": ["A", "P"], **part}],
        loads={"P": ["a", "b"]},
    )
    true = shipped("fig4")
    axes = (Axis("a", Fraction(0), Fraction(2)), Axis("b", Fraction(0), Fraction(3)))
    slice = Slice(
        "s", mechanism, axes, {"a": axis(0), "b": axis(1)}, Count.STABLE, text={"a": "a", "b": "b"}
    )
    claims = Claims(replace(true, slice=slice))
    if message:
        with pytest.raises(Violation, match=message):
            check_domain(claims)
    else:
        assert not isinstance(check_domain(claims), Unchecked)
