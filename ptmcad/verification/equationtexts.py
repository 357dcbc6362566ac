"""The texts of the equations that were solved, against those that follow from the description.

Guarantee: that of `ptmcad.verification.polynomialtexts`. Potential, equations, their derivatives and
conditions in a result are the description's in all parameters, so for every slice at once.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from flint import fmpq_mpoly

from ptmcad.answer.regionmap import System
from ptmcad.verification.claims import Claims
from ptmcad.verification.derivation import coordinates_of, derivation_of, parameters_of
from ptmcad.verification.parameterclaims import on_slice
from ptmcad.verification.polynomialtexts import PolynomialTexts
from ptmcad.verification.report import Unchecked, Violation, drawn


def check_system(claims: Claims, seed: str = "") -> str:
    """The equations of an exact map. Springs have no free length there."""
    model, system, true = claims.model, claims.result.system, claims.derivation
    unknowns, parameters, ring = coordinates_of(model), parameters_of(model), true.ring
    _check_unknowns(system, unknowns)
    if len({*unknowns, *parameters}) != len(unknowns) + len(parameters):
        raise Violation(
            "a parameter has the name of a coordinate, so that no text can be understood"
        )
    relations = tuple(f"cos_{angle}^2 + sin_{angle}^2 - 1" for angle in model.angles)
    if system.relations != relations:
        raise Violation(
            f"the relations are {', '.join(relations)}, not {', '.join(system.relations)[:80]}"
        )
    if system.moments:
        raise Violation("moments are stated, which are in the equations of an exact map")
    if len(system.hessian) != len(true.jacobian):
        raise Violation(f"there are {len(true.jacobian)} rows of derivatives")
    if true.potential is None and system.potential:
        raise Violation(
            "equations are given, or a moment depends on another unknown, so there is no potential"
        )
    names = dict(zip((*unknowns, *ring.names[len(unknowns) :]), ring.names, strict=True))
    texts = PolynomialTexts(true, names, seed or drawn(None))
    reasons = []
    if true.potential is not None:
        reasons.append(texts.compare_potential(system.potential, true.moments, varying=True))
    entries = [true.meaning.entry.format(i, "{}") for i in range(len(true.jacobian))]
    for what, stored, polynomials in (
        (true.meaning.equation, system.gradient, true.equations),
        *zip(entries, system.hessian, true.jacobian, strict=True),
        ("inequality {}", system.inequalities, true.inequalities),
        ("condition {} for stability", system.stability, true.stability),
    ):
        reasons += _compared(texts, what, stored, polynomials)
    for what, value, strict in true.required:  # of one that is no parameter there it is zero
        on_it = () if strict else on_slice(claims, true, value).values()
        if not all(numerator.is_zero() for numerator, _ in on_it):
            raise Violation(f"{what} is not zero, so that the map is of another mechanism")
    number = f"{len(reasons)} polynomials in {len(unknowns)} unknowns"
    return _outcome(reasons, f"{number} and {len(parameters)} parameters")


def check_potential(claims: Claims, seed: str = "", *, closed: bool = False) -> str:
    """The potential or the equations of a certified map, whose springs may have free lengths.

    Parameters
    ----------
    closed : whether there are closed loops and springs with free lengths.
    """
    system, slice = claims.result.system, claims.result.slice
    unknowns, true = tuple(slice.model.unknowns), derivation_of(slice.model)
    _check_unknowns(system, unknowns)
    if len(true.equations) != len(unknowns):
        raise Violation(f"there are {len(true.equations)} equations for {len(unknowns)} unknowns")
    stated = true.energy is not None and (true.from_energy or closed)
    if system.hessian:
        raise Violation("a Hessian is stated, which follows from the potential or the equations")
    if not stated and system.potential:
        raise Violation("equations are given, and no potential")
    names = {*true.ring.names[true.coordinates :], *unknowns}
    has_work = stated and true.moved and not true.apart
    texts = PolynomialTexts(
        true,
        {name: name for name in names if has_work or name not in true.ring.angles},
        seed or drawn(None),
        true.springs if stated else (),
    )
    reasons = []
    if stated:
        nothing = dict.fromkeys(unknowns, true.ring.context.constant(0))
        work = nothing if true.apart else true.moments
        reasons.append(texts.compare_potential(system.potential, work))
    moments = [true.moments[unknown] for unknown in unknowns]
    for what, stored, polynomials in (
        ("equation {}", system.gradient, () if stated else true.equations),
        ("moment {}", system.moments, moments if stated and true.apart else ()),
        ("inequality {}", system.inequalities, true.inequalities),
        ("condition {} for stability", system.stability, () if closed else true.stability),
        ("relation {}", system.relations, true.closing if closed else ()),
    ):
        reasons += _compared(texts, what, stored, polynomials)
    what = "the equations"
    if stated:
        what = "the potential and the moments" if true.apart else "the potential"
    number = f"{len(unknowns)} unknowns and {len(slice.model.variables)} parameters"
    return _outcome(reasons, f"{what} in {number}")


def _check_unknowns(system: System, unknowns: tuple[str, ...]) -> None:
    if system.unknowns != unknowns:
        raise Violation(f"the unknowns are {system.unknowns}, not {unknowns}")


def _outcome(reasons: Iterable[str], found: str) -> str:
    reason = next(filter(None, reasons), "")
    return Unchecked(reason) if reason else found


def _compared(
    texts: PolynomialTexts, name: str, stored: Sequence[str], true: Sequence[fmpq_mpoly]
) -> list[str]:
    """Why some texts were not compared, empty where they were; ``name`` has a place for the number."""
    if len(stored) != len(true):
        raise Violation(f"there are {len(true)} of the kind {name.format('n')}, not {len(stored)}")
    pairs = enumerate(zip(stored, true, strict=True))
    return [texts.compare(name.format(k), text, p) for k, (text, p) in pairs]
