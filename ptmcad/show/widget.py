"""The report's living map as a widget of Jupyter, whose point and exact poses Python has.

Guarantee: what the browser shows is the report's page as it is, in a frame that may run its script
and nothing else; nothing is loaded from a network. ``poses`` are those of the point that ``point``
has, or None where there is none.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from importlib.resources import files
from math import isfinite
from typing import Any

import anywidget
import traitlets

from ptmcad.answer.poses import Poses
from ptmcad.answer.regionmap import RegionMap
from ptmcad.errors import PtmcadError
from ptmcad.show.report import page
from ptmcad.text.numerals import exactly

DIGITS = 6
"""Of the numbers in the table."""


class Explorer(anywidget.AnyWidget):  # type: ignore[misc]
    """A region map over which one drags a point.

    Attributes
    ----------
    point : where it is: the two axes' names to floats; empty until the page has said where it
        begins. May be set.
    poses : the exact solutions there, the floats taken as the decimal numbers that they show.
    """

    _esm = (files("ptmcad.show") / "widget.js").read_text(encoding="utf-8")
    _page = traitlets.Unicode().tag(sync=True)
    _names = traitlets.List(traitlets.Unicode()).tag(sync=True)
    _answer = traitlets.Unicode().tag(sync=True)
    point = traitlets.Dict().tag(sync=True)
    poses = traitlets.Instance(Poses, allow_none=True, read_only=True)

    def __init__(self, result: RegionMap, solve: Callable[[Fraction, Fraction], Poses]):
        self._result, self._solve = result, solve
        super().__init__(_page=page(result), _names=list(result.slice.axis_names))

    @traitlets.validate("point")  # type: ignore[untyped-decorator]
    def _inside(self, proposal: Any) -> dict[str, float]:
        """Both axes, inside the window."""
        given = proposal["value"]
        axes = self._result.slice.axes
        if not given:
            return {}
        try:
            point = {axis.name: float(given[axis.name]) for axis in axes}
        except (KeyError, TypeError, ValueError) as error:
            names = " and ".join(axis.name for axis in axes)
            raise traitlets.TraitError(f"a point has numbers for {names}") from error
        for axis in axes:
            value = point[axis.name]
            if not (isfinite(value) and axis.low < exactly(value) < axis.high):
                raise traitlets.TraitError(
                    f"{axis.name} = {value} is not inside the window, {axis.low} to {axis.high}"
                )
        return point

    @traitlets.observe("point")  # type: ignore[untyped-decorator]
    def _solved(self, _change: Any) -> None:
        """Solve at the new point, and let the page's reader see it."""
        if not self.point:
            return
        try:
            poses = self._solve(*(exactly(self.point[name]) for name in self._names))
        except (
            PtmcadError
        ) as error:  # of a point where the question has no answer; the next one may have
            self.set_trait("poses", None)
            self._answer = str(error)
        else:
            self.set_trait("poses", poses)
            self._answer = f"Exact solutions at the point:\n{poses.table(DIGITS)}"
