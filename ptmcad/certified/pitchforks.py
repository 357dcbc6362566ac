"""Pitchforks along a line: an equilibrium that a reflection fixes ceases to be regular, and two others meet it.

Guarantee: in the boxes that are explained no equilibrium is singular but at the pitchforks that are found, of which
each is enclosed. A reflection u -> 2 c - u of some unknowns s, the others being w, is proved to keep the energy for all
values of the line. So the slopes f_s are odd in s - c and f_w are even. With s = c + r z, where one z is 1, and q = r^2

    g = (f_s / r, f_w)     as functions of q, the other z and w

vanishes at equilibria off s = c, and they are regular where its Jacobian is. That is enclosed over the whole box: by
Taylor's formula its entries are averages of derivatives of f there. On s = c the Hessian is made of two blocks; that of
w is proved regular, and interval Newton proves that there is one value of the line at which that of s is singular.

References
----------
Golubitsky, Stewart & Schaeffer, Singularities and Groups in Bifurcation Theory II (1988), on Z2 and division by s.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import combinations, product
from math import pi

import numpy as np
from flint import arb, arb_mat, ctx

from ptmcad.certified.arb_evaluation import ball, lower, run_arb, upper
from ptmcad.certified.arb_isolation import Box, newton, refined
from ptmcad.certified.formula import Formula, Graph
from ptmcad.certified.parameters import parameter_formulas, values_at
from ptmcad.certified.plain.chart import determinant
from ptmcad.certified.plain.problem import FIRST, problem_of
from ptmcad.certified.plain.straight import branches
from ptmcad.certified.potential import potential
from ptmcad.certified.search import Boxes
from ptmcad.certified.system import system
from ptmcad.certified.tape import record
from ptmcad.mechanism import Mechanism
from ptmcad.mechanism.proofs import energy_is_kept
from ptmcad.question.slice import Slice

NEAR = 0.3
"""Boxes whose unknowns differ by less are tried as those of one pitchfork."""
_MARGIN = Fraction(1, 10)
"""Of a hull of boxes, by which it is made wider."""

Interval = tuple[Fraction, Fraction]


@dataclass(frozen=True, slots=True)
class _Line:
    """A line of a slice on which the axis of number ``varying`` varies and the other one is fixed."""

    slice: Slice
    mechanism: Mechanism
    varying: int
    fixed: Fraction


def pitchforks(slice: Slice, varying: int, fixed: Fraction, left: Boxes, bits: int) -> list[Interval] | None:
    """Enclosures of the pitchforks in boxes that a search for singular equilibria left; None unless all have to do with
    one.

    Parameters
    ----------
    varying, fixed : the number of the axis along which the line runs, and the other one's value.
    left : over the axes and all unknowns, row by row.
    bits : precision to which pitchforks are enclosed.
    """
    mechanism = slice.model
    if not len(left) or not isinstance(mechanism, Mechanism) or not _is_plain(slice, mechanism, left[0]):
        return None
    line = _Line(slice, mechanism, varying, fixed)
    found, waiting, width = list[Interval](), left, left.shape[1] // 2
    while len(waiting):
        centres = (waiting[:, FIRST:width] + waiting[:, width + FIRST :]) / 2
        near = (np.abs(centres - centres[0]) <= NEAR).all(axis=1)
        place = _pitchfork(line, _hull(waiting[near]), bits)
        if place is None:
            return None
        found.append(place)
        waiting = waiting[~near]
    return found


def _is_plain(slice: Slice, mechanism: Mechanism, box: Boxes) -> bool:
    """Whether boxes are in the description's unknowns, and the equations are an energy's slopes."""
    if mechanism.moments or not mechanism.has_potential or len(box) != 2 * (FIRST + len(mechanism.unknowns)):
        return False
    return not any(b.covering for b in branches(problem_of(slice), slice.axes))


def _hull(boxes: Boxes) -> list[Interval]:
    """Bounds of each variable in some boxes, a little wider."""
    found = []
    lows, highs = np.split(boxes, 2, axis=1)
    for low, high in zip(lows.min(axis=0).tolist(), highs.max(axis=0).tolist(), strict=True):
        margin = _MARGIN * Fraction(high - low)
        found.append((Fraction(low) - margin, Fraction(high) + margin))
    return found


def _pitchfork(line: _Line, hull: Sequence[Interval], bits: int) -> Interval | None:
    """The only value of the line at which an equilibrium in a hull is singular, as a pitchfork; None without proof."""
    for turns in _reflections(line, hull):
        with ctx.workprec(bits):
            place = _proved(line, hull, turns, bits)
        if place is not None:
            return place
    return None


def _reflections(line: _Line, hull: Sequence[Interval]) -> Iterator[dict[int, int]]:
    """Of reflections that keep the energy all along the line, the unknowns' numbers with the quarter turns of c."""
    mechanism, here = line.mechanism, {}
    for number, name in enumerate(mechanism.unknowns, FIRST):
        low, high = map(float, hull[number])
        n = round((low + high) / pi) if name in mechanism.angles else 0
        if low <= n * pi / 2 <= high:
            here[number] = n
    names = dict(enumerate(mechanism.unknowns, FIRST))
    first, second = (values_at(line.slice, *_at(line, axis)) for axis in _ends(line))
    parameters = {name: value for name, value in first.items() if _is_constant(line, name) and value == second[name]}
    for size in range(len(here), 0, -1):
        for chosen in combinations(here, size):
            odd = [names[k] for k in chosen if here[k] % 2]
            if energy_is_kept(mechanism, parameters, [names[k] for k in chosen], odd):
                yield {k: here[k] for k in chosen}


def _ends(line: _Line) -> Interval:
    axis = line.slice.axes[line.varying]
    return axis.low, axis.high


def _at(line: _Line, value: Fraction) -> Interval:
    return (value, line.fixed) if line.varying == 0 else (line.fixed, value)


def _is_constant(line: _Line, name: str) -> bool:
    """Whether a parameter is the same number all along the line."""
    given = line.slice.parameters.get(name)
    powers = () if given is None else (term[line.varying] for term in (*given.numerator, *given.denominator))
    return not any(powers)


def _proved(line: _Line, hull: Sequence[Interval], turns: dict[int, int], bits: int) -> Interval | None:
    """The value at which the fixed equilibrium is singular, where it is proved that no other is in the hull."""
    graph, names = Graph(), line.mechanism.unknowns
    variables = {name: graph.variable(number) for number, name in enumerate(names, FIRST)}
    energy = potential(line.mechanism, parameter_formulas(graph, line.slice), variables).energy
    odd, even = list(turns), [k for k in range(FIRST, FIRST + len(names)) if k not in turns]
    slopes = {k: graph.derivative(energy, k) for k in (*odd, *even)}
    centre = {k: arb.pi() * n / 2 for k, n in turns.items()}  # of a length n is 0
    box = [ball(*bounds) for bounds in hull]
    box[1 - line.varying] = ball(line.fixed, line.fixed)
    reach = {k: abs(box[k] - centre[k]).upper() for k in odd}
    for k in odd:
        box[k] = centre[k] + arb(0, 1) * reach[k]
    hessian = tuple(tuple(graph.derivative(slopes[a], b) for b in odd) for a in odd)
    singular = system([*(slopes[k] for k in even), determinant(hessian)], [line.varying, *even])
    fixed = tuple(centre.get(k, b) for k, b in enumerate(box))
    step = newton(singular, fixed, bits)
    if step is None or not step[1] or not _is_regular(graph, slopes, odd, even, tuple(box), reach):
        return None
    value = refined(singular, fixed, bits)[line.varying]
    return lower(value), upper(value)


def _is_regular(
    graph: Graph, slopes: dict[int, Formula], odd: Sequence[int], even: Sequence[int], box: Box, reach: dict[int, arb]
) -> bool:
    """Whether all equilibria in the box that are not fixed are regular, and all that are but for the odd block."""
    unknowns = [*odd, *even]
    formulas: dict[tuple[int, ...], Formula] = {(k,): slope for k, slope in slopes.items()}
    for order in (1, 2, 3):  # derivatives by the unknowns in their order, the third ones by those that are reflected
        for key in [key for key in formulas if len(key) == order]:
            for k in unknowns if order < 3 else odd:
                if order == 1 or unknowns.index(k) >= unknowns.index(key[-1]):
                    formulas[*key, k] = graph.derivative(formulas[key], k)
    tape = record([list(formulas.values())])
    values = run_arb(tape, box, ctx.prec)
    known = dict(zip(formulas, (values[int(place)] for place in tape.outputs[0]), strict=True))

    def d(i: int, *by: int) -> arb:
        return known[i, *sorted(by, key=unknowns.index)]

    if even and not _invertible([[d(i, k) for k in even] for i in even]):
        return False
    for lead, left_out in product(odd, repeat=2):
        others = [k for k in odd if k != lead]
        z = _directions(
            [[d(i, k) for k in others] for i in odd if i != left_out], [d(i, lead) for i in odd if i != left_out]
        )
        if z is None:
            continue
        along = {lead: arb(1), **dict(zip(others, z, strict=True))}
        radius = reach[lead] * arb(0, 1)

        def twice(i: int, k: int, along: dict[int, arb] = along) -> arb:
            return sum((d(i, a, k) * along[a] for a in odd), arb(0))

        rows = []
        for i in unknowns:
            if i in odd:
                cubic = sum(
                    (d(i, a, b, c) * along[a] * along[b] * along[c] for a, b, c in product(odd, repeat=3)), arb(0)
                )
                rows.append(
                    [cubic / 6, *(d(i, k) + radius * twice(i, k) for k in others), *(twice(i, k) for k in even)]
                )
            else:
                square = sum((twice(i, b) * along[b] for b in odd), arb(0))
                rows.append([square / 2, *(radius * d(i, k) for k in others), *(d(i, k) for k in even)])
        if _invertible(rows):
            return True
    return False


def _directions(matrix: list[list[arb]], column: list[arb]) -> list[arb] | None:
    """The other components of a kernel's vector of which one is 1; None where they are not enclosed."""
    if not matrix:
        return []
    try:
        found = arb_mat(matrix).solve(arb_mat([[-c] for c in column]))
    except ZeroDivisionError:
        return None
    return [found[k, 0] for k in range(len(matrix))]


def _invertible(rows: list[list[arb]]) -> bool:
    """Whether every matrix in a matrix of balls is proved regular."""
    matrix = arb_mat(rows)
    if not all(entry.is_finite() for row in rows for entry in row):
        return False
    try:
        near = arb_mat([[entry.mid() for entry in row] for row in rows]).inv()
    except ZeroDivisionError:
        return False
    return not (near * matrix).det().contains(0)
