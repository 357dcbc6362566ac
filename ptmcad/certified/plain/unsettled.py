"""Why no pose is told at a point: which number of which equilibrium could not be distinguished from zero."""

from __future__ import annotations

from collections.abc import Collection, Mapping

from ptmcad.mechanism import Mechanism
from ptmcad.text.enclosure import Enclosure

_MAX_NAMED = 3
"""Numbers that are named."""
_LENGTH = 300
"""Characters of the sentence; a file of poses takes no longer remark."""
_DIGITS = 5
"""Of the unknowns by which the equilibrium is recognized."""


def not_settled(mechanism: Mechanism, found: Mapping[str, Enclosure], missing: Collection[str]) -> str:
    """The sentence that says so.

    Parameters
    ----------
    found : the equilibrium's numbers that are settled, by the names that `ptmcad.certified.plain.poses` gives them.
    missing : the names of those that are not.
    """
    named = list(dict.fromkeys(_named(mechanism, name) for name in sorted(missing)))
    more = [f"{len(named) - _MAX_NAMED} more"] if len(named) > _MAX_NAMED else []
    *first, last = [*named[:_MAX_NAMED], *more]
    what = f"{', '.join(first)} and {last}" if first else last
    which = "they" if len(named) > 1 else "it"
    end = f"{which} may be exactly zero, by a coincidence of which no proof is known"
    at = [f"{a} = {_text(found[f'degrees {a}'])} deg" for a in mechanism.angles if f"degrees {a}" in found]
    at += [f"{name} = {_text(found[f'real {name}'])}" for name in mechanism.reals if f"real {name}" in found]
    where = f" at {', '.join(at[:_MAX_NAMED])}" if at else ""
    said = f"{what} could not be distinguished from zero in the equilibrium{where}: {end}"
    return said if len(said) <= _LENGTH else "a number of an equilibrium could not be distinguished from zero"


def _text(number: Enclosure) -> str:
    """A settled number with a few digits, or with as many as were asked for where these are less."""
    return number.text(1 if number.told_digits(_DIGITS) is None else _DIGITS)


def _named(mechanism: Mechanism, name: str) -> str:
    """A number as a reader knows it."""
    kind, _, last = name.rpartition(" ")
    if kind in ("length", "force"):
        return f"the {kind} of spring {mechanism.springs[int(last)].name}"
    if kind.startswith("torsion "):
        return f"the deflection of torsion spring {mechanism.torsion[int(last)].name}"
    if kind in mechanism.points:
        return f"{'xy'[int(last)]} of {kind}"
    if kind == "eigenvalue":
        return f"eigenvalue {int(last) + 1}"
    if kind in ("degrees", "real"):
        return last
    return f"{kind}({last})" if kind else "the energy" if name == "energy" else name
