"""QEPCAD's decomposition of the window, read from what it prints, and held against a region map.

Guarantee: `compare` raises AssertionError unless every quantity that has to agree does agree
exactly. No rounding takes part: samples are rational, and critical values are compared as roots of
polynomials in isolating intervals.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise

from ptmcad import RegionMap
from ptmcad.answer.regionmap import CriticalValue
from ptmcad.question.slice import Axis
from ptmcad.text.plane import PlanePolynomial
from support import oracle
from support.programs import ProgramError, monomials, qepcad_session
from support.sextic_question import formulas
from support.singular_slice import CountingFormula, integral

# a label, where the factor comes from (one line or more), and last the factor itself
_FACTOR = re.compile(r"^[AP]_(\d+),(\d+)\s*= .*\n(?:\s+= .*\n)*?\s+= (.*)\n\s*\n", re.MULTILINE)
_CELL = re.compile(
    r"^-+ Information about the cell \((.*?)\) -+$(.*?)^-{50,}$", re.MULTILINE | re.DOTALL
)
_TRUTH = re.compile(r"^Truth value\s*: (\S)", re.MULTILINE)
_VANISHING = re.compile(r"\((\d+),\d+\)")
_MULTIPLICITIES = re.compile(r"^Multiplicities\s*: \((.*)\)$", re.MULTILINE)
_COORDINATE = re.compile(r"^Coordinate (\d+) = (-?\d+(?:/\d+)?)$", re.MULTILINE)
_ROOT = re.compile(r"^alpha = the unique root of (.*) between (\S+) and (\S+)$", re.MULTILINE)


@dataclass(frozen=True, slots=True)
class QepcadCell:
    """A cell of the (x, y)-plane, or of the x-axis when its index has one number.

    Attributes
    ----------
    index : from the left, then from below; an odd last number for a sector, an even one for a
        section.
    truth : T, F, ? where it was not decided, * where the assumptions do not hold.
    vanishing : numbers of the factors of its level that vanish on a section.
    sample : its coordinates, None for those that are not rational.
    root : of the sample when that is not rational: polynomial in x, and isolating interval.
    """

    index: tuple[int, ...]
    truth: str
    vanishing: tuple[int, ...]
    sample: tuple[Fraction | None, ...]
    root: tuple[oracle.Polynomial, Fraction, Fraction] | None


@dataclass(frozen=True, slots=True)
class Decomposition:
    """QEPCAD's projection factors in (x, y), by level and number, and its cells up to level two."""

    factors: dict[tuple[int, int], PlanePolynomial]
    cells: dict[tuple[int, ...], QepcadCell]

    def sectors(self, over: tuple[int, ...] = ()) -> list[QepcadCell]:
        """The open cells over a cell, in order."""
        return [self.cells[i] for i in sorted(self.cells) if i[:-1] == over and i[-1] % 2]

    def between(self, below: QepcadCell) -> QepcadCell:
        """The section above (or right of) a sector."""
        return self.cells[(*below.index[:-1], below.index[-1] + 1)]


DISPLAY = ("d-proj-factors", "d-all-cells-in-subtree ()")
"""The commands whose output `decomposition` reads."""


def decomposition(output: str, names: Sequence[str] = ("x", "y", "t")) -> Decomposition:
    """Read the output of `DISPLAY`; levels above the second are passed over.

    Parameters
    ----------
    names : the variables, the base axis first.

    Raises
    ------
    ProgramError
        When the output has no cells, or a cell is not as expected.
    """
    factors = {}
    for level, number, text in _FACTOR.findall(output):
        if int(level) <= 2:
            whole = integral(monomials(text, names))
            factors[int(level), int(number)] = PlanePolynomial.of(
                (e[0], e[1], c) for e, c in whole.items()
            )
    cells = {}
    for index_text, body in _CELL.findall(output):
        index = tuple(int(i) for i in index_text.split(",") if i)
        if not 1 <= len(index) <= 2:
            continue
        truth, multiplicities = _TRUTH.search(body), _MULTIPLICITIES.search(body)
        if truth is None or multiplicities is None:
            raise ProgramError(f"QEPCAD's cell {index} is not as expected: {body[:300]}")
        rational = {int(n): Fraction(value) for n, value in _COORDINATE.findall(body)}
        sample = tuple(rational.get(n + 1) for n in range(len(index)))
        root = None
        if sample[0] is None and len(index) == 1:
            found = _ROOT.search(body)
            if found is None:
                raise ProgramError(f"QEPCAD's cell {index} has no sample: {body[:300]}")
            terms = integral(monomials(found.group(1), ("x",)))  # whatever the variable is called
            dense = [terms.get((n,), 0) for n in range(max(e for (e,) in terms) + 1)]
            root = dense, Fraction(found.group(2)), Fraction(found.group(3))
        vanishing = tuple(int(n) for n in _VANISHING.findall(multiplicities.group(1)))
        cells[index] = QepcadCell(index, truth.group(1), vanishing, sample, root)
    if not cells:
        raise ProgramError(f"QEPCAD printed no cells: {output[-300:]}")
    return Decomposition(factors, cells)


def seen_from_base(polynomial: PlanePolynomial, base: int) -> PlanePolynomial:
    """The polynomial in (x, y) for the base axis as x."""
    return PlanePolynomial.of((i, j, c) if base == 0 else (j, i, c) for i, j, c in polynomial.terms)


def window_cad(result: RegionMap, *, full: bool = False) -> Decomposition:
    """QEPCAD's decomposition for the components that the map uses, with the window as assumption.

    Parameters
    ----------
    full : lift over sections of the x-axis too (much more expensive: their abscissae are algebraic
        numbers).
    """
    used = [seen_from_base(c.polynomial, result.base) for c in result.components if not c.left_out]
    edges = [f"{_text(_edge(end, 0))} {sign} 0" for end, sign in _ends(_axis(result, 0))]
    edges += [f"{_text(_edge(end, 1))} {sign} 0" for end, sign in _ends(_axis(result, 1))]
    problem = "\n".join(
        (
            f"[ {result.slice.name} ]",
            "(x,y)",
            "2",
            "[ " + r" /\ ".join(f"{_text(p)} /= 0" for p in used) + " ].",
            "assume [ " + r" /\ ".join(edges) + " ]",
            "full-cad" if full else "measure-zero-error",
            *("go",) * 3,
            *DISPLAY,
        )
    )
    return decomposition(qepcad_session([problem])[0])


def _axis(result: RegionMap, level: int) -> Axis:
    return result.slice.axes[result.base if level == 0 else 1 - result.base]


def _ends(axis: Axis) -> tuple[tuple[Fraction, str], tuple[Fraction, str]]:
    return (axis.low, ">"), (axis.high, "<")


def _edge(end: Fraction, level: int) -> PlanePolynomial:
    """The line x = end or y = end, positive beyond it."""
    exponents = (1, 0) if level == 0 else (0, 1)
    return PlanePolynomial.of(((*exponents, end.denominator), (0, 0, -end.numerator)))


def _text(p: PlanePolynomial) -> str:
    return p.text(("x", "y")).replace("*", " ")


@dataclass(frozen=True, slots=True)
class Comparison:
    """Figures of a comparison that succeeded.

    Attributes
    ----------
    stacks, cells : of the map; QEPCAD's are the same once stacks are joined over its further
        sections.
    qepcad_stacks, qepcad_cells : of QEPCAD in the window, before that.
    lifted : whether QEPCAD's further sections were shown to be crossed by every branch without a
        meeting.
    """

    stacks: int
    cells: int
    qepcad_stacks: int
    qepcad_cells: int
    lifted: bool


def compare(result: RegionMap, cad: Decomposition) -> Comparison:
    """Hold the map's open decomposition of the window against QEPCAD's.

    What must agree, and why. The window's edges are factors of QEPCAD's input, so each of its cells
    lies inside the window or outside, which its neighbours' rational samples tell. QEPCAD's
    projection contains the discriminants and resultants of the components and their resultants with
    the edges. So

    - each critical value of the map is one of its sections: the same root of a common factor of
      both polynomials;
    - over each of its stacks, which lies over one stack of the map, the real roots in the window
      are the map's walls: as many, of the same components, in the same order, and so are the cells;
    - QEPCAD has further sections (meetings of complex branches, leading coefficients, meetings
      outside the window). The stacks on both sides of such a section then belong to the same stack
      of the map, so that with stacks joined there, stacks and cells are equal in number. That no
      two branches meet over a further section is checked where QEPCAD was asked to lift over
      sections: it finds as many roots there as beside it.
    """
    numbers = {
        seen_from_base(c.polynomial, result.base): n
        for n, c in enumerate(result.components)
        if not c.left_out
    }
    known = set(cad.factors.values())
    for level in (0, 1):
        for end, _ in _ends(_axis(result, level)):
            assert _edge(end, level) in known, "QEPCAD has no such edge of the window"
    component = {
        f: numbers[p] for (level, f), p in cad.factors.items() if level == 2 and p in numbers
    }
    x_axis, y_axis = _axis(result, 0), _axis(result, 1)
    stacks = [cell for cell in cad.sectors() if _inside(cell, x_axis)]

    values = list(result.critical_values)
    walls: list[Walls] = []
    counted = 0
    for k, here in enumerate(stacks):
        found = _walls(cad, here.index, y_axis, component)
        assert all(len(wall) == 1 for wall in found), (
            f"cell {here.index}: not one component on each of its sections"
        )
        counted += len(found) + 1
        if k == 0:
            walls.append(found)
            continue
        section = cad.between(stacks[k - 1])
        if values and _same_root(section, values[0]):
            values.pop(0)
            walls.append(found)
            continue
        assert found == walls[-1], (
            f"cell {here.index}: QEPCAD's walls change over {section.sample}, the map's do not"
        )
        if cad.sectors(section.index):
            over = _walls(cad, section.index, y_axis, component)
            assert over == found, (
                f"branches meet over QEPCAD's section {section.index}, the map has no critical value"
            )
    assert not values, f"QEPCAD has no critical value near {float(values[0].low)}"
    stored = [tuple((wall.component,) for wall in stack.walls) for stack in result.stacks]
    assert walls == stored, f"components of the walls: QEPCAD has {walls}, the map {stored}"
    assert [len(stack.cells) for stack in result.stacks] == [len(found) + 1 for found in walls]
    assert sum(len(found) + 1 for found in walls) == len(result.cells)
    for stack in result.stacks:
        roots = [wall.root for wall in stack.walls]
        of_component = [wall.component for wall in stack.walls]
        assert roots == [of_component[:n].count(c) for n, c in enumerate(of_component)], (
            "root indices of the walls"
        )
    lifted = all(cad.sectors(cad.between(left).index) for left, _ in pairwise(stacks))
    return Comparison(len(result.stacks), len(result.cells), len(stacks), counted, lifted)


def _inside(cell: QepcadCell, axis: Axis) -> bool:
    at = cell.sample[-1]
    if at is None:
        raise ProgramError(f"QEPCAD's sector {cell.index} has no rational sample")
    return axis.low < at < axis.high


Walls = tuple[tuple[int, ...], ...]
"""For each section of a stack inside the window, from below, the components that vanish on it."""


def _walls(
    cad: Decomposition, over: tuple[int, ...], axis: Axis, component: dict[int, int]
) -> Walls:
    sectors = [cell for cell in cad.sectors(over) if _inside(cell, axis)]
    assert sectors, f"QEPCAD has not lifted over the cell {over}"
    sections = [cad.between(below).vanishing for below in sectors[:-1]]
    assert all(f in component for section in sections for f in section), (
        f"a curve of QEPCAD's own over the cell {over}"
    )
    return tuple(tuple(component[f] for f in section) for section in sections)


def _same_root(section: QepcadCell, value: CriticalValue) -> bool:
    """Whether QEPCAD's section of the x-axis is the critical value."""
    ours = oracle.primitive(value.polynomial)
    if section.sample[0] is not None:
        at = section.sample[0]
        return value.low <= at <= value.high and _value(ours, at) == 0
    assert section.root is not None
    theirs, low, high = section.root
    common = oracle.common_divisor(ours, theirs)
    low, high = max(low, value.low), min(high, value.high)
    # the common factor has at most one root in the intersection, for each polynomial has one in its
    # own interval
    return low <= high and len(common) > 1 and _value(common, low) * _value(common, high) <= 0


def _value(p: oracle.Polynomial, x: Fraction) -> Fraction:
    return sum((c * x**n for n, c in enumerate(p)), Fraction(0))


def indices(
    formulas: Sequence[CountingFormula], expected: Sequence[tuple[int, int, int]]
) -> list[tuple[bool, ...]]:
    """Whether at each point there are exactly so many minima, saddles and maxima, in QEPCAD's
    judgement.
    """
    problems = []
    for formula, numbers in zip(formulas, expected, strict=True):
        p, h, h11 = (_dense(q) for q in (formula.roots, formula.h, formula.h11))
        kinds = (rf"{h} > 0 /\ {h11} > 0", f"{h} < 0", rf"{h} > 0 /\ {h11} < 0")
        problems += [
            exactly(n, rf"{p} = 0 /\ {kind}") for n, kind in zip(numbers, kinds, strict=True)
        ]
    truths = decided(problems)
    return [tuple(truths[3 * n : 3 * n + 3]) for n in range(len(formulas))]


def exactly(number: int, condition: str) -> str:
    """The problem whether exactly so many values of t satisfy a condition on t alone."""
    quantified = f"(X{number} t)[ {condition} ]" if number else f"(A t)[ ~[ {condition} ] ]"
    return "\n".join(("[ count ]", "(t)", "0", f"{quantified}.", *("go",) * 3, "solution T"))


def decided(problems: Sequence[str]) -> list[bool]:
    """The truth of sentences without free variables."""
    return [_truth(output) for output in qepcad_session(problems)]


def _truth(output: str) -> bool:
    found = formulas(output)
    if found not in (["TRUE"], ["FALSE"]):
        raise ProgramError(f"QEPCAD does not decide: {output[-300:]}")
    return found == ["TRUE"]


def _dense(p: Sequence[int]) -> str:
    return (
        " ".join(
            f"{'+' if c > 0 else '-'} {abs(c)} t^{n}" for n, c in enumerate(p) if c
        ).removeprefix("+ ")
        or "0"
    )
