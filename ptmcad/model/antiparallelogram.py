"""An X-joint, whose four corners are those of an antiparallelogram, as an element of descriptions.

Guarantee: the angle of its second bar is the one on the branch on which its bars stay crossed.
"""

from __future__ import annotations

from typing import NamedTuple

from ptmcad.model.elements import Element, Kind, Part, squared
from ptmcad.model.trees import cosine_and_sine, negative, total
from ptmcad.text.tree import Chain, Name, Number, Step, Tree


class XJoint(NamedTuple):
    """An X-joint: two crossed bars of one length between a base and a top of another, an
    antiparallelogram.

    The second bar's angle psi follows from the first one's, th, on the branch on which the bars
    stay crossed:

        cos psi = ((L^2 + b^2) cos th - 2 L b)/D,   sin psi = (L^2 - b^2) sin th/D,
        D = L^2 + b^2 - 2 L b cos th

    with L the bars' length and b the base's, both angles against the base. That is
    tan(psi/2) = (L + b)/(L - b) tan(th/2), and D, the squared distance of the two ends on the
    right, is positive where L and b differ. The top is turned by th + psi - pi.

    Source: elementary; Furet and Wenger, Kinetostatic analysis and actuation strategy of a planar
    tensegrity 2-X manipulator, J. Mech. Robotics 11 (2019), name it.

    Attributes
    ----------
    base : the points A0 and A1.
    top : the points B0 and B1; the bars are A0 B1 and A1 B0.
    angle : of the bar A0 B1 against the base: an unknown.
    other : of the bar A1 B0, which follows from it.
    length, bars : the base's and the bars'.
    direction, turns : of the base: a sum of angles, and the quarter turns that are added to it.
    """

    name: str
    base: tuple[str, str]
    top: tuple[str, str]
    angle: str
    other: str
    length: Tree
    bars: Tree
    direction: Tree
    turns: int

    @property
    def rigid(self) -> tuple[tuple[str, str], ...]:
        """The bars and the top."""
        (a, c), (b, d) = self.base, self.top
        return (a, d), (c, b), (b, d)

    @property
    def upper(self) -> tuple[Tree, int]:
        """Direction and quarter turns of the top."""
        return self._towards(Chain(Name(self.angle), (Step("+", Name(self.other)),))), (
            self.turns + 2
        ) % 4

    def bar(self, angle: str) -> tuple[Tree, Tree]:
        """Cosine and sine of the direction of a bar at this angle against the base."""
        return cosine_and_sine(self._towards(Name(angle)), self.turns)

    def _towards(self, angle: Tree) -> Tree:
        return (
            angle
            if isinstance(self.direction, Number)
            else Chain(self.direction, (Step("+", angle),))
        )

    @property
    def element(self) -> Element:
        """For traversals."""
        off = total(self.bars, negative(self.length))
        meaning = "the bars of an x-joint are longer or shorter than its base"
        return Element(
            (
                Part("base", Kind.LENGTH, self.length),
                Part("bars", Kind.LENGTH, self.bars),
                Part("bars", Kind.LENGTH, squared(off), meaning),
            )
        )
