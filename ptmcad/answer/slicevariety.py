"""The discriminant variety of a slice as a result of its own, without a decomposition of the
window.

Guarantee: the components are those that the region map of the slice has; the elimination system has
integer coefficients and, its solutions are the singular equilibria over every point at which its
equations have a meaning.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from ptmcad.answer import with_methods
from ptmcad.answer.regionmap import Component, Kind
from ptmcad.question.slice import Slice
from ptmcad.text.plane import terms_text

Term = tuple[tuple[int, ...], int]
"""Exponents of the unknowns, then of the two axes; and the coefficient."""


@dataclass(frozen=True, slots=True)
class EliminationSystem:
    """The polynomials from which the unknowns have to be eliminated.

    Attributes
    ----------
    unknowns : cosine and sine of each angle, such as ``"cos_th1"``, the unknowns on the line, and
        inverses of what is not zero: of inequalities that exclude too many solutions, and of what
        vanishes on BOUNDARY components.
    axes : the two axes' names.
    polynomials : the equilibrium equations, cos^2 + sin^2 - 1 for each angle, each inverse times
        what it is the inverse of less 1, and last the determinant of the Hessian; each a tuple of
        terms.
    """

    unknowns: tuple[str, ...]
    axes: tuple[str, str]
    polynomials: tuple[tuple[Term, ...], ...]

    def texts(self, names: tuple[str, ...] | None = None) -> tuple[str, ...]:
        """Each polynomial as text such as ``2*cos_th1*rho - 1``.

        Parameters
        ----------
        names : other names for the unknowns and axes, in this order.
        """
        return tuple(terms_text(p, names or (*self.unknowns, *self.axes)) for p in self.polynomials)


@with_methods
@dataclass(frozen=True, slots=True)
class SliceVariety:
    """The curves off which the number of equilibria of each kind is locally constant.

    Attributes
    ----------
    components : irreducible curves, each with its kind; those that have no point in the window say
        so in ``left_out``.
    complex_solutions : number of complex solutions at a generic point.
    system : what Q(x, y) elimination started from.
    versions : of the programs that computed it.
    """

    slice: Slice
    components: tuple[Component, ...]
    complex_solutions: int
    system: EliminationSystem
    versions: Mapping[str, str]

    @property
    def critical(self) -> tuple[Component, ...]:
        """The components over which an equilibrium is singular."""
        return tuple(c for c in self.components if c.kind is Kind.CRITICAL)

    if TYPE_CHECKING:  # `ptmcad.methods` has it

        def text(self, format: str = "text") -> str: ...

    def __str__(self) -> str:
        return self.text()

    def __repr__(self) -> str:
        degrees = ", ".join(
            f"{c.kind.value} of degree {c.polynomial.total_degree}" for c in self.components[:8]
        )
        return f"<SliceVariety {self.slice.name}: {degrees}{', …' if len(self.components) > 8 else ''}>"
