"""A continuous quantity of one equilibrium over a map's window, pixel by pixel, in floating point.

Not guaranteed: more than `Field.checked` says. Each pixel shows one of as many different solutions
as the exact map counts there, found by Newton's method; a share of the pixels was compared with
exact poses.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from ptmcad.answer import with_methods
from ptmcad.answer.boundaries import NONE, extent_of

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Flags = NDArray[
        np.bool_
    ]  # a name of its own: a page's markup takes the underscore at its end for a link


@with_methods
@dataclass(frozen=True, slots=True, eq=False)
class Field:
    """The values of a quantity at the centres of pixels; nan where there is no such solution, or
    none was found.

    Attributes
    ----------
    quantity, pose : as they were asked for.
    unit : of the values, as the record declares it or in words; empty where it is not known.
    x, y : shapes (columns,) and (rows,): the centres' coordinates.
    names : of the two axes.
    values : shape (rows, columns), from the bottom.
    region : shape (rows, columns): numbers of the map's regions, -1 where the map says nothing: a
        certified map of what is undetermined, an exact one of points on a curve.
    missed : number of pixels with such a solution that was not found.
    beyond : number of pixels where the quantity has a value that no double is near, larger than
        1.8e308 or nearer to zero than 2.2e-308; nan is there.
    checked : number of pixels that were compared with exact poses.
    difference : the largest difference found there, as a share of the largest modulus of a value.
    jumps : whether the solution at a pixel is of another branch than that at its neighbour of the
        same region, at the right, shape (rows, columns - 1), and above, shape (rows - 1, columns):
        following it by Newton's method does not lead there. None where that was not looked for.
    """

    quantity: str
    pose: str
    unit: str
    x: NDArray[np.float64]
    y: NDArray[np.float64]
    names: tuple[str, str]
    values: NDArray[np.float64]
    region: NDArray[np.int64]
    missed: int
    checked: int
    difference: float
    beyond: int = 0
    jumps: tuple[Flags, Flags] | None = None

    @property
    def extent(self) -> tuple[float, float, float, float]:
        """The window as left, right, bottom, top: what `imshow` calls so, together with
        ``origin="lower"``.
        """
        return extent_of(self.x, self.y)

    @property
    def known(self) -> NDArray[np.float64]:
        """The values of the pixels that have one, row after row from the bottom."""
        values: NDArray[np.float64] = self.values[self.values == self.values]
        return values

    @property
    def shares(self) -> str:
        """At which share of the pixels there is a value, and of which the map says nothing, in
        words.
        """
        known, open = (
            100 * float(part.mean()) for part in (self.values == self.values, self.region == NONE)
        )
        return f"at {known:.3g} % of the pixels" + (f"; {open:.3g} % undetermined" if open else "")

    def __repr__(self) -> str:
        rows, columns = self.values.shape
        return f"<Field {self.quantity} of {self.pose}, {columns} x {rows} pixels over {self.names[0]}, {self.names[1]}>"
