"""The texts of the equations that were solved, against those that follow from the description.

Guarantee: that of `ptmcad.verification.polynomialtexts`. Potential, equations, their derivatives and
conditions in a result are the description's in all parameters, so for every slice at once.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from flint import fmpq_mpoly

from ptmcad.answer.regionmap import System
from ptmcad.verification.claims import Claims
from ptmcad.verification.derivation import Derivation, coordinates_of, derivation_of, parameters_of
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
    _check_sizes(system, true)
    relations = (f"cos_{angle}^2 + sin_{angle}^2 - 1" for angle in model.angles)
    for k, (text, relation) in enumerate(zip(system.relations, relations, strict=True)):
        if text != relation:
            raise Violation(f"relation {k} is {relation}, not {text[:60]}")
    names = dict(zip((*unknowns, *ring.names[len(unknowns) :]), ring.names, strict=True))
    texts = PolynomialTexts(true, names, seed or drawn(None))
    reasons = []
    if true.potential is not None:
        reasons.append(texts.compare_potential(system.potential, true.moments, varying=True))
    reasons += [texts.compare(what, text, p) for what, text, p in _of_system(system, true)]
    _check_free_lengths(claims, true)
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
    if closed and len(system.relations) != len(true.closing):
        raise Violation(
            f"there are {len(true.closing)} loops that are closed, and {len(system.relations)} relations"
        )
    stated = true.energy is not None and (true.from_energy or closed)
    if (system.relations and not closed) or system.hessian or (stated and system.gradient):
        raise Violation(
            "a certified map has no relations, and its gradient and Hessian follow from the potential"
        )
    if system.moments and not (stated and true.apart):
        raise Violation(
            "moments are stated in addition to the potential only where one depends on another unknown"
        )
    if not stated and (system.potential or len(system.gradient) != len(true.equations)):
        raise Violation(f"there are {len(true.equations)} equations and no potential")
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
    kinds = (
        ("equation", system.gradient, () if stated else true.equations),
        ("moment", system.moments, moments if stated and true.apart else ()),
        ("inequality", system.inequalities, true.inequalities),
        ("condition for stability", system.stability, () if closed else true.stability),
        ("relation", system.relations, true.closing if closed else ()),
    )
    for what, stored, polynomials in kinds:
        if len(stored) != len(polynomials):
            raise Violation(f"there are {len(polynomials)} of the kind {what}, not {len(stored)}")
        named = zip(stored, polynomials, strict=True)
        reasons += [texts.compare(f"{what} {k}", text, p) for k, (text, p) in enumerate(named)]
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


def _check_sizes(system: System, true: Derivation) -> None:
    n = len(true.equations)
    if (len(system.gradient), [len(row) for row in system.hessian]) != (n, [n] * n):
        raise Violation(f"{n} unknowns have {n} equations and a {n} x {n} matrix of derivatives")
    for what, stored, expected in (
        ("relations", system.relations, true.ring.relations),
        ("inequalities", system.inequalities, true.inequalities),
        ("conditions for stability", system.stability, true.stability),
    ):
        if len(stored) != len(expected):
            raise Violation(f"there are {len(expected)} {what}, not {len(stored)}")
    if true.potential is None and system.potential:
        raise Violation(
            "equations are given, or a moment depends on another unknown, so there is no potential"
        )


def _of_system(system: System, true: Derivation) -> Iterator[tuple[str, str, fmpq_mpoly]]:
    """Each stored polynomial: its name, its text, and the true one."""
    for i, (text, row, equation) in enumerate(
        zip(system.gradient, system.hessian, true.equations, strict=True)
    ):
        yield true.meaning.equation.format(i), text, equation
        for j, entry in enumerate(row):
            yield true.meaning.entry.format(i, j), entry, true.jacobian[i][j]
    for k, (text, p) in enumerate(zip(system.inequalities, true.inequalities, strict=True)):
        yield f"inequality {k}", text, p
    for k, (text, p) in enumerate(zip(system.stability, true.stability, strict=True)):
        yield f"condition {k} for stability", text, p


def _check_free_lengths(claims: Claims, true: Derivation) -> None:
    """No spring has a free length on the slice; of one that is no parameter there it is zero."""
    for what, value, strict in true.required:
        if not (
            strict
            or all(numerator.is_zero() for numerator, _ in on_slice(claims, true, value).values())
        ):
            raise Violation(f"{what} is not zero, so that the map is of another mechanism")
