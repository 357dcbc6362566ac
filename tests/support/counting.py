"""What the checker of certified maps counts at parameters that are given as numbers."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

from ptmcad.exact.models import ParametricSystem, system_from
from ptmcad.model import Model, known_of, mechanism_of
from ptmcad.question.slice import Axis, Count, Point, Slice
from ptmcad.text.expressions import constant
from ptmcad.verification.certified.counted import CountedPoint
from ptmcad.verification.certified.coverclaims import CertifiedClaims
from ptmcad.verification.certified.models import ModelCounting
from ptmcad.verification.solutions import map_of

PAPER = known_of("ptm")
MIDDLE = Point(("x", "y"), Fraction(1, 2), Fraction(1, 2))


def claims_of(
    values: Mapping[str, Fraction], count: Count, model: Model = PAPER
) -> CertifiedClaims:
    """A window on which nothing depends."""
    axes = (Axis("x", Fraction(0), Fraction(1)), Axis("y", Fraction(0), Fraction(1)))
    return CertifiedClaims(
        map_of(Slice("", model, axes, {n: constant(v) for n, v in values.items()}, count), ())
    )


def counted_at(
    values: Mapping[str, Fraction], count: Count
) -> tuple[CertifiedClaims, ModelCounting, CountedPoint]:
    """The window, the way of counting, and what is counted in its middle."""
    claims = claims_of(values, count)
    return claims, claims.counting, claims.counting.at(*MIDDLE)


def system_of(mechanism: str) -> ParametricSystem:
    """The parametric system of a built-in mechanism by its name."""
    return system_from(mechanism_of(mechanism))
