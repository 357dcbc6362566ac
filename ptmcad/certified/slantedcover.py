"""Covers with slanted pieces: the window halved into leaves, over each of which all solutions lie
in a few tubes.

Guarantee: each solution in the boxes of the enclosures projects into the cover. (Lemma 31 of
docs/soundness.md.)

A leaf is done when no box is over it, or when tubes are found that hold all solutions in its boxes,
are disjoint, and part it in the way that `ptmcad.cover.rectangles.Patch` asks for. Else it is
quartered, the largest ones first, until what is left is small enough; over that the cover has
rectangles. So around smooth pieces of the curves leaves stay large however small the tolerance is,
and towards cusps and crossings they shrink geometrically.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from fractions import Fraction
from heapq import heappop, heappush
from math import ceil, comb

import numpy as np
from flint import fmpq

from ptmcad.certified.branchandprune import Boxes, search_curve
from ptmcad.certified.covering import Lattice, meeting, outward
from ptmcad.certified.curvetubes import Tubes, tubes
from ptmcad.certified.equationsystem import Arguments
from ptmcad.certified.refinement import CurveEnclosure
from ptmcad.cover import tubeframes as exact
from ptmcad.cover.lattice import from_boxes
from ptmcad.cover.rectangles import Cover, Patch, Rectangle, Tube
from ptmcad.formulas.intervalarithmetic import Floats
from ptmcad.text.flint_numbers import from_fraction

FINER = 64
"""Boxes over a leaf are bisected until their projection is so many times smaller than the leaf."""
BUDGET = 2000
"""Boxes that are treated for that, at most."""
MAX_BOXES = 1500
"""A leaf with more is quartered at once."""
MAX_LEAF = Fraction(1, 4)
"""Of the window's sides: a larger one, too."""
BISECTIONS, BISECTIONS_PER_BOX = 300, 2
"""Boxes that are treated until all are in tubes."""
TUBE_SHARE = Fraction(1, 200)
"""Of the tolerance: half width of tubes, as a part of the window, at most. The curves would have to
be fifty times as long as the window for tubes to use up half of it."""
MIN_HALF = Fraction(1, 2**38)
"""... and thinner ones are not asked for: doubles have not many digits more."""
MAX_LEAVES = 20_000
"""That wait: a set of solutions that is no curve would have them without end."""
SPECK_SHARE = Fraction(3, 4)
"""Of the tolerance: what leaves that are not done may have."""
MERGED = 8
"""Tubes are one if they are nearer to each other than this many times their half widths."""
LEAVES_PER_JOB = 4
"""Leaves that are quartered before it is asked again whether it is late: some tenths of a second.
"""


@dataclass(frozen=True, slots=True)
class _Leaf:
    """A rectangle of the lattice, and all boxes over it, curve by curve."""

    rectangle: Rectangle
    boxes: tuple[Boxes, ...]
    inner: Rectangle
    """What of it the boxes are over."""

    @property
    def area(self) -> int:
        left, right, bottom, top = self.inner
        return (right - left) * (top - bottom)


@dataclass(frozen=True, slots=True)
class Slanting:
    """What makes slanted covers of some enclosures.

    Attributes
    ----------
    whole, alone : of each curve the system, and its equations alone.
    """

    enclosures: Sequence[CurveEnclosure]
    lattice: Lattice
    whole: tuple[Arguments, ...]
    alone: tuple[Arguments, ...]

    def cover(self, tolerance: Fraction, jobs: int, late: Callable[[], bool]) -> Cover:
        """A cover that leaves at most this part of the window undetermined.

        It leaves more when it was late, or where leaves become too many, or tubes cannot be thin
        enough.
        """
        steps = self.lattice.steps
        limit = int(SPECK_SHARE * tolerance * steps**2)
        window = (0, steps, 0, steps)
        first = _Leaf(
            window, tuple(_sorted(enclosure.boxes()) for enclosure in self.enclosures), window
        )
        number, total = 0, first.area
        waiting = [(-total, number, first)]
        patches: list[Patch] = []
        rectangles: set[Rectangle] = set()
        with ThreadPoolExecutor(jobs) as pool:
            while waiting and total > limit and len(waiting) <= MAX_LEAVES and not late():
                chosen = [
                    heappop(waiting)[2] for _ in range(min(len(waiting), LEAVES_PER_JOB * jobs))
                ]
                quarters = [
                    (leaf, quarter) for leaf in chosen for quarter in _quarters(leaf.rectangle)
                ]
                rectangles |= {leaf.inner for leaf in chosen if not _quarters(leaf.rectangle)}
                total -= sum(leaf.area for leaf in chosen if _quarters(leaf.rectangle))
                for found in pool.map(
                    lambda pair: self._settled(pair[1], pair[0].boxes, tolerance), quarters
                ):
                    if isinstance(found, Patch):
                        patches.append(found)
                    elif found is not None:
                        number, total = number + 1, total + found.area
                        heappush(waiting, (-found.area, number, found))
        rectangles |= {leaf.inner for _, _, leaf in waiting}
        return Cover(steps, tuple(sorted(rectangles)), tuple(sorted(patches)))

    def _settled(
        self, rectangle: Rectangle, around: tuple[Boxes, ...], tolerance: Fraction
    ) -> _Leaf | Patch | None:
        """None where no box is over the rectangle, the tubes where they can be had, else the leaf."""
        frame = outward(self.lattice.window, np.array([rectangle]), self.lattice.steps)
        boxes = tuple(
            self._over(frame, own, system, enclosure)
            for own, system, enclosure in zip(around, self.whole, self.enclosures, strict=True)
        )
        inner = self._inner(rectangle, boxes)
        if inner is None:
            return None
        leaf = _Leaf(rectangle, boxes, inner)
        small = (
            max(rectangle[1] - rectangle[0], rectangle[3] - rectangle[2])
            <= MAX_LEAF * self.lattice.steps
        )
        if not small or sum(map(len, boxes)) > MAX_BOXES:
            return leaf
        wide = inner[1] - inner[0] >= inner[3] - inner[2]
        for along in (0, 1) if wide else (1, 0):
            patch = self._patch(leaf, along, tolerance)
            if patch is not None:
                return patch
        return leaf

    def _over(
        self, frame: Boxes, boxes: Boxes, system: Arguments, enclosure: CurveEnclosure
    ) -> Boxes:
        """The boxes over a frame, one rectangle, bisected until they are small enough."""
        boxes = boxes[meeting(frame, boxes)[0]]
        if not len(boxes):
            return boxes
        left, bottom, right, top = frame[0].tolist()
        area = (right - left) * (top - bottom) / FINER
        found = search_curve(system, boxes, area, BUDGET, enclosure.curve.importance()).left()
        over: Boxes = found[meeting(frame, found)[0]]
        return over

    def _inner(self, rectangle: Rectangle, boxes: tuple[Boxes, ...]) -> Rectangle | None:
        """The least part of a rectangle that all boxes over it project to."""
        hulls = [_hull(own) for own in boxes if len(own)]
        if not hulls:
            return None
        low, high = np.min([h[0] for h in hulls], axis=0), np.max([h[1] for h in hulls], axis=0)
        around = from_boxes(
            self.lattice.window, low[None], high[None], self.lattice.steps
        ).rectangles
        if not around:
            return None
        left, right, bottom, top = around[0]
        inner = (
            max(left, rectangle[0]), min(right, rectangle[1]), max(bottom, rectangle[2]), min(top, rectangle[3]),
        )  # fmt: skip
        # boxes that only touch the leaf, from outside
        return inner if inner[0] < inner[1] and inner[2] < inner[3] else None

    def _patch(self, leaf: _Leaf, along: int, tolerance: Fraction) -> Patch | None:
        """The leaf's tubes along an axis, if they part it as they should."""
        low, high = self.lattice.window[1 - along]
        most = float((high - low) * max(tolerance * TUBE_SHARE, MIN_HALF))
        hulls = [_hull(own) for own in leaf.boxes if len(own)]
        interval = (
            along,
            min(float(h[0][along]) for h in hulls),
            max(float(h[1][along]) for h in hulls),
        )
        order = order_for(tolerance)
        found: list[Tube] = []
        ends = leaf.inner[2 * along], leaf.inner[2 * along + 1]
        for own, whole, alone, enclosure in zip(
            leaf.boxes, self.whole, self.alone, self.enclosures, strict=True
        ):
            if not len(own):
                continue
            budget = BISECTIONS + BISECTIONS_PER_BOX * len(own)
            result = tubes(
                whole, alone, own, enclosure.curve.importance(), interval, (order, most, budget)
            )
            if result.left:
                return None
            found += self._on_lattice(result, along, ends)
        return _parted(leaf.rectangle, along, ends, _merged(found))

    def _on_lattice(self, found: Tubes, along: int, ends: tuple[int, int]) -> list[Tube]:
        """The tubes with controls on the lattice, and half widths that make up for the rounding."""
        steps = self.lattice.steps
        (low, high), (bottom, top) = self.lattice.window[along], self.lattice.window[1 - along]
        step = (high - low) / steps
        radius = Fraction(found.radius)
        start = (low + ends[0] * step - Fraction(found.middle)) / radius
        length = (ends[1] - ends[0]) * step / radius
        scale = steps / (top - bottom)
        result = []
        for coefficients, half in zip(
            found.coefficients.tolist(), found.half.tolist(), strict=True
        ):
            heights = controls(
                [from_fraction(Fraction(c)) for c in coefficients],
                from_fraction(start),
                from_fraction(length),
            )
            places = tuple(
                round_half((height - from_fraction(bottom)) * from_fraction(scale))
                for height in heights
            )
            result.append(Tube(ceil(Fraction(half) * scale) + 1, places))
        return result


def slanting(enclosures: Sequence[CurveEnclosure], lattice: Lattice) -> Slanting:
    """What makes slanted covers of enclosures."""
    return Slanting(
        enclosures,
        lattice,
        tuple(enclosure.curve.system.arguments() for enclosure in enclosures),
        tuple(enclosure.curve.system.alone().arguments() for enclosure in enclosures),
    )


def order_for(tolerance: Fraction) -> int:
    """The order of the polynomials: higher ones pay where tubes have to be thinner."""
    return 8 if tolerance >= Fraction(1, 10**6) else 12


def round_half(value: fmpq) -> int:
    """The nearest integer, or one of two."""
    return int((value + fmpq(1, 2)).floor())


def _sorted(boxes: Boxes) -> Boxes:
    """The boxes in an order that does not depend on which task was done first."""
    return boxes[np.lexsort(boxes.T)]


def _hull(boxes: Boxes) -> tuple[Floats, Floats]:
    """The ends of the boxes' projections."""
    half = boxes.shape[1] // 2
    return boxes[:, :2].min(axis=0), boxes[:, half : half + 2].max(axis=0)


def _quarters(rectangle: Rectangle) -> list[Rectangle]:
    """None where the lattice is too coarse."""
    left, right, bottom, top = rectangle
    if right - left < 2 or top - bottom < 2:
        return []
    x, y = (left + right) // 2, (bottom + top) // 2
    return [(a, b, c, d) for a, b in ((left, x), (x, right)) for c, d in ((bottom, y), (y, top))]


def _merged(found: list[Tube]) -> list[Tube]:
    """The tubes from below, with one in place of two that are next to the same curve."""
    result: list[Tube] = []
    for tube in sorted(found, key=lambda t: sum(t.controls)):
        if result:
            last = result[-1]
            apart = max(abs(a - b) for a, b in zip(last.controls, tube.controls, strict=True))
            if apart <= MERGED * max(last.half, tube.half):
                result[-1] = Tube(max(last.half, tube.half + apart), last.controls)
                continue
        result.append(tube)
    return result


def _parted(
    rectangle: Rectangle, along: int, ends: tuple[int, int], found: list[Tube]
) -> Patch | None:
    """The patch of tubes in as low a frame as there can be, if it is one."""
    if not found:
        return None
    low, high = rectangle[2 - 2 * along], rectangle[3 - 2 * along]
    bottom = max(low, min(min(t.controls) - t.half for t in found) - 1)
    top = min(high, max(max(t.controls) + t.half for t in found) + 1)
    if bottom >= top:
        return None
    frame = (*ends, bottom, top) if along == 0 else (bottom, top, *ends)
    patch = Patch(frame, along, tuple(found))
    return None if exact.flaw(patch, 2**62) else patch


def controls(coefficients: Sequence[fmpq], start: fmpq, length: fmpq) -> list[fmpq]:
    """Those of p(start + length t) for t in [0, 1], from the first to the last, exact.

    Parameters
    ----------
    coefficients : of p, the constant one first.

    >>> controls([fmpq(0), fmpq(0), fmpq(1)], fmpq(1), fmpq(2))
    [1, 3, 9]
    """
    composed: list[fmpq] = []
    for c in reversed(coefficients):
        # Horner's rule: (...) (start + length t) + c
        composed = [
            start * a + length * b
            for a, b in zip([*composed, fmpq(0)], [fmpq(0), *composed], strict=True)
        ]
        composed[0] += c
    degree = len(coefficients) - 1
    return [
        sum((fmpq(comb(k, j), comb(degree, j)) * composed[j] for j in range(k + 1)), fmpq(0))
        for k in range(degree + 1)
    ]
