"""A basis from msolve is used after a proof only: fake programs that lose a root, add one, crash,
hang or babble.
"""

from __future__ import annotations

import stat
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from flint import fmpq
from support.programs import needs_msolve

import ptmcad
from ptmcad.algebra import bases, msolve
from ptmcad.algebra.bases import quotient
from ptmcad.algebra.fibre_algebra import RationalPolynomial, WorkLimit, own_quotient
from ptmcad.algebra.membership import lies_in_ideal
from ptmcad.algebra.msolve import MsolveError, parsed_basis, quotient_by_msolve
from ptmcad.algebra.quotient_algebra import standard_monomials
from ptmcad.errors import LimitReached, PtmcadWarning

ONE = fmpq(1)
CORNERS: tuple[RationalPolynomial, ...] = ({(2, 0): ONE, (0, 0): -ONE}, {(0, 2): ONE, (0, 0): -ONE})
"""The corners of a square, (1, 1) to (-1, -1)."""
RIGHT = "#Reduced Groebner basis data\n[u1^2-1, \nu0^2-1]:\n"
LOST = "[u0*u1+u0+u1+1, u0^2-1, u1^2-1]:"
ADDED = "[u0^2-1*u1^2, u0*u1^2-u0, u1^3-u1]:"

Fake = Callable[[str], None]


@pytest.fixture
def fake(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Fake:
    """Puts a program named msolve on the PATH, which runs these lines of Python; FILE is where its
    answer goes.
    """

    def install(lines: str) -> None:
        program = tmp_path / "msolve"
        program.write_text(
            f"#!{sys.executable}\nimport os, sys, time\nFILE = sys.argv[-1]\n{lines}\n"
        )
        program.chmod(program.stat().st_mode | stat.S_IXUSR)
        monkeypatch.setenv("PATH", str(tmp_path), prepend=":")

    return install


def answering(text: str) -> str:
    return f"open(FILE, 'w').write({text!r})"


def test_a_basis_that_is_proved_is_used(fake: Fake) -> None:
    fake(answering(RIGHT))
    found = quotient_by_msolve(CORNERS, 2, 20)
    own = own_quotient(CORNERS, 2)
    assert found.by_msolve
    assert own is not None
    assert (found.basis, found.multiplication) == (own.basis, own.multiplication)


WRONG = {
    "lost": (answering(LOST), "it may miss solutions"),
    "added": (answering(ADDED), "more solutions than Bezout"),
    "moved": (answering("[u0^2-1, u1^2-4]:"), "an equation is not zero at its solutions"),
    "all lost": (answering("[1]:"), "it may miss solutions"),
    "of no finite quotient": (answering("[u0^2-1]:"), "infinitely many"),
    "not a basis": (answering("[u0^2-1, u0*u1-u0, u1^2-u1-1]:"), "do not commute"),
    "not reduced": (answering("[u0^2-1, u1^2-1, u0^2*u1-u1]:"), "not reduced"),
    "a tail that is not reduced": (answering("[u0-u1^3, u1^2-1]:"), "not reduced|more solutions"),
    "too many": (answering("[u0^9-1, u1^9-1]:"), "more solutions than Bezout"),
    "garbage": (answering("[u0^2-1, import this]:"), "not understood"),
    "cut short": (answering(RIGHT[:-4]), "not understood"),
    "other unknowns": (answering("[u0^2-1, u7^2-1]:"), "not understood"),
    "not text": ("open(FILE, 'wb').write(bytes(range(256)))", "not understood"),
    "silent": ("pass", "failed with status 0"),
    "status": ("sys.exit('no memory')", "failed with status 1: 'no memory"),
    "crash": ("os.abort()", "failed with status -6"),
    "endless": ("time.sleep(60)", "did not end within 0.2 s"),
}


@pytest.mark.parametrize("what", WRONG)
def test_a_wrong_answer_is_refused_and_survived(
    fake: Fake, monkeypatch: pytest.MonkeyPatch, what: str
) -> None:
    lines, why = WRONG[what]
    fake(lines)
    with pytest.raises(MsolveError, match=why):
        quotient_by_msolve(CORNERS, 2, 0.2 if what == "endless" else 20)
    monkeypatch.setattr(bases, "MANY", 1)
    monkeypatch.setattr(bases, "SMALL", WorkLimit(0, 0, 0, 0))
    monkeypatch.setattr(bases, "SECONDS", 0.2 if what == "endless" else 20)
    with pytest.warns(PtmcadWarning, match="its basis is not used"):
        assert quotient(CORNERS, 2) == own_quotient(CORNERS, 2)


def test_an_added_root_within_the_bound_is_seen(fake: Fake) -> None:
    three = (*CORNERS, {(1, 1): ONE, (1, 0): ONE, (0, 1): ONE, (0, 0): ONE})
    fake(answering(RIGHT))  # the fourth corner too
    with pytest.raises(MsolveError, match="an equation is not zero"):
        quotient_by_msolve(three, 2, 20)
    fake(answering(LOST))  # which is right here
    assert quotient_by_msolve(three, 2, 20).dimension == 3


def test_a_lost_root_changes_no_count(fake: Fake, monkeypatch: pytest.MonkeyPatch) -> None:
    fake(answering(LOST))
    system = ptmcad.System(unknowns={"x": "real", "y": "real"}, equations=["x^2 - a", "y^2 - a"])
    monkeypatch.setattr(bases, "MANY", 1)
    monkeypatch.setattr(bases, "SMALL", WorkLimit(0, 0, 0, 0))
    with pytest.warns(PtmcadWarning, match="may miss solutions"):
        assert ptmcad.counts_at(system, a=1).total == 4
    fake(answering(RIGHT))
    with pytest.warns(PtmcadWarning, match="an equation is not zero"):
        assert ptmcad.counts_at(system, a=4).total == 4
    poses = ptmcad.solve(model=system, a=1)
    assert len(poses.equilibria) == 4
    assert "computed by msolve and proved" in poses.remark


def test_without_msolve_the_extra_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(msolve, "program", lambda: None)
    monkeypatch.setattr(bases, "MANY", 1)
    monkeypatch.setattr(bases, "SMALL", WorkLimit(0, 0, 0, 0))
    with pytest.warns(PtmcadWarning, match=r"may take very long; .*pip install 'ptmcad\[large\]'"):
        assert quotient(CORNERS, 2) == own_quotient(CORNERS, 2)
    with pytest.raises(LimitReached, match=r"pip install 'ptmcad\[large\]'"):
        quotient(CORNERS, 2, WorkLimit(0, 0, 0, 0, by_msolve=10))


def test_small_systems_and_small_questions_do_not_ask_msolve(fake: Fake) -> None:
    fake("os.abort()")
    assert quotient(CORNERS, 2) == own_quotient(CORNERS, 2)
    many = ({(12, 0): ONE, (0, 0): -ONE}, {(0, 12): ONE, (0, 1): ONE})
    assert bases.is_large(many)
    assert quotient(many, 2) == own_quotient(many, 2)  # its basis is small
    with pytest.raises(LimitReached):
        quotient(CORNERS, 2, WorkLimit(1, 100, 100, 100))


def test_membership_with_falling_degrees_over_q() -> None:
    """x y = 1 and x^2 = 2: y = x/2 is of lower degree than what it follows from."""
    equations = ({(1, 1): ONE, (0, 0): -ONE}, {(2, 0): ONE, (0, 0): fmpq(-2)})
    rules = {(1, 0): {(0, 1): fmpq(2)}, (0, 2): {(0, 0): fmpq(1, 2)}}
    basis = standard_monomials(tuple(rules), 2)
    assert basis == ((0, 0), (0, 1))
    assert lies_in_ideal(equations, rules, basis, lambda: None)
    doubled = ({(4, 0): ONE, (2, 0): fmpq(-4), (0, 0): fmpq(4)}, {(1, 1): ONE, (0, 0): -ONE})
    assert not lies_in_ideal(doubled, rules, basis, lambda: None)


def test_a_prime_that_divides_a_denominator_is_not_used(monkeypatch: pytest.MonkeyPatch) -> None:
    from ptmcad.algebra import membership

    monkeypatch.setattr(membership, "primes", lambda: iter((2, 3, 10_007)))
    equations = ({(1,): fmpq(1, 2), (0,): fmpq(1, 3)},)
    assert lies_in_ideal(equations, {(1,): {(0,): fmpq(-2, 3)}}, ((0,),), lambda: None)


def test_what_is_no_list_of_polynomials_is_refused() -> None:
    assert parsed_basis("#x\n[-2/3*u0^2*u1+u1*5,\n 7]:", 2) == (
        {(2, 1): fmpq(-2, 3), (0, 1): fmpq(5)},
        {(0, 0): fmpq(7)},
    )
    for text in (
        "",
        "[]:",
        "[u0",
        "[u0,]:",
        "[u0u1]:",
        "[2u0]:",
        "[u0^]:",
        "[1/0]:",
        "[u0^99999]:",
        "[--u0]:",
    ):
        with pytest.raises(MsolveError, match="not understood"):
            parsed_basis(text, 2)


def test_the_plan_says_whose_basis_it_is(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(msolve, "program", lambda: "msolve")
    assert "then by msolve" in bases.plan_text(bases.MANY)
    monkeypatch.setattr(msolve, "program", lambda: None)
    assert "pip install 'ptmcad[large]'" in bases.plan_text(bases.MANY)
    assert bases.plan_text(bases.MANY - 1) == ""


@needs_msolve
def test_msolve_itself_is_proved_right() -> None:
    third: RationalPolynomial = {(1, 0, 0): ONE, (0, 1, 1): fmpq(2, 3), (0, 0, 0): fmpq(-5)}
    equations = (
        third,
        {(0, 2, 0): ONE, (1, 0, 1): fmpq(-7, 2), (0, 0, 1): ONE},
        {(0, 0, 3): ONE, (1, 1, 0): ONE, (0, 0, 0): fmpq(1, 9)},
    )
    found, own = quotient_by_msolve(equations, 3, 60), own_quotient(equations, 3)
    assert own is not None
    assert (found.basis, found.multiplication) == (own.basis, own.multiplication)
