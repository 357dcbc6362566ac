"""Closed loops, as equations: each loop is cut at a bar, which keeps its length. With one degree of freedom left:

Guarantee: off the places where a loop folds flat the solutions are the equilibria, and the stable ones are the strict
minima of the energy under the loops' conditions.

Let g_1 .. g_m be squared distances less squared lengths, in m + 1 unknowns, and T the vector of the maximal minors of
their derivatives, with signs: it is tangent to g = 0 and vanishes only where these derivatives are dependent, where a
loop folds flat. Along the curve g = 0, run through with velocity T, the energy has the derivative E = T . grad U, and
where that is zero the second derivative T . grad E: which is the determinant of the derivatives of g_1 .. g_m and E. So
an equilibrium is a zero of g and E, simple where the determinant is not zero, and stable where it is positive. Where T
vanishes E does, and the determinant: such places are on the curves at which solutions meet.

A spring with a free length takes K |d| off the energy, K its stiffness times that length and d between its ends, which
takes K (T . grad) |d| off E: a root, so that it is in no tree. The equations here are those without it, which exact
algebra solves where no spring has a free length; `ptmcad.certified.plain.problem` takes it off.

With several degrees of freedom left there is one multiplier for each closing bar. Let g_i = (d_i^2 - l_i^2)/2 with d_i
the distance of the ends of closing bar i and l_i its length, in n unknowns u, and U the energy. An equilibrium is a
zero of g and of the derivatives of U + sum t_i g_i by u; t_i is the bar's tension divided by its length. With B(s) the
symmetric matrix of the second derivatives of this sum by u, s added on the diagonal, bordered by the derivatives of g,

    det B(s) = (-1)^m (c_0 s^f + ... + c_(f-1) s + c_f),

m bars, f = n - m: c_0 > 0 where the derivatives of g are independent, and the roots of the polynomial, all real, are
the eigenvalues of the Hessian on the loops' tangent space with the other sign. So that is positive definite where
c_1, ..., c_f are all positive (Descartes' rule). The determinant of the Jacobian of the equations is det B(0), so that
c_f is that but for its sign. A tension that leaves every bounded set is noticed, as it is an unknown on the line: loops
fold flat on curves at infinity, which are part of the variety.

Source: elementary (Lagrange); for the bordered determinant Mann, Amer. Math. Monthly 50 (1943).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import combinations

from ptmcad.errors import ConfigError, ExpressionError, Faults
from ptmcad.model.crossed import without_xjoints
from ptmcad.model.description import ClosedMechanism, Mechanism, Model
from ptmcad.model.elements import NAMES, Closing, UnknownKind, squared_distance
from ptmcad.model.proofs import Points
from ptmcad.model.sizes import check_sizes
from ptmcad.model.trees import ZERO, cofactors, derivative, determinant, negative, product, total
from ptmcad.model.work import split_moments
from ptmcad.text.tree import Chain, Name, Number, Power, Step, Tree

MAX_ENTRIES = 8
"""Rows of the bordered matrix: its minors are multiplied out, and their number grows with the factorial."""
_TWO: Tree = Number(Fraction(2))


def check_loops(mechanism: Mechanism, faults: Faults) -> None:
    """Note what is not computed with closed loops, or with X-joints, by its key."""
    free = len(mechanism.unknowns) - len(mechanism.closing)
    roots = [f"{key}.free" for key, element in mechanism.elements.items() if element.root is not None]
    wrong: list[tuple[object, str, str]] = []
    if mechanism.closing:
        wrong += [
            (free < 1, "closing", "no degree of freedom is left: there have to be more unknowns than closing bars"),
            (
                free > 1 and mechanism.coupled, "moments",
                "a moment depends on another unknown than its own: then closed loops are computed where they leave one "
                f"degree of freedom, not {free}",
            ),
            *(
                (
                    free > 1, key,
                    f"free lengths in closed loops are computed where these leave one degree of freedom, not {free}",
                )
                for key in roots
            ),
            (mechanism.symmetries, "symmetries", "symmetries are not used in closed loops: leave them out"),
        ]  # fmt: skip
    if mechanism.xjoints:
        wrong += [
            (mechanism.closing, "closing", "closing bars beside x-joints are not computed yet"),
            (mechanism.symmetries, "symmetries", "symmetries are not used with x-joints: leave them out"),
            (mechanism.coupled, "moments", "a moment beside x-joints depends on no unknown but its own"),
            *((True, key, "free lengths are not computed with x-joints yet") for key in roots),
        ]
    for is_wrong, key, problem in wrong:
        with faults:
            if is_wrong:
                raise ConfigError(problem, key=key)


def check_closing(mechanism: Mechanism, faults: Faults) -> None:
    """Note each closing bar between points whose distance no unknown changes, and one that is listed twice."""
    points = Points(mechanism)
    known: dict[frozenset[str], int] = {}
    for n, closing in enumerate(mechanism.closing, 1):
        with faults:
            first = known.setdefault(frozenset((closing.start, closing.end)), n)
            if first < n:
                raise ConfigError(f"number {first} is a bar between the same points", key=f"closing.{n}.between")
            if not points.varies(squared_distance(NAMES, closing.start, closing.end)):
                raise ConfigError(
                    f"the distance of {closing.start} and {closing.end} is constant, so that a bar between them closes "
                    "no loop",
                    key=f"closing.{n}.between",
                )


def equations_of_loops(model: Mechanism) -> Model:
    """The equations of the equilibria of a mechanism with closed loops or X-joints.

    Raises
    ------
    ConfigError
        When these may have too many terms.
    """
    if model.xjoints:
        return without_xjoints(model)
    conditions = [_condition(model, closing) for closing in model.closing]
    names = model.sorted_unknowns
    forces = _forces(model, names)
    further: dict[str, UnknownKind] = {}
    tangent: tuple[Tree, ...] = ()
    if len(names) > len(conditions) + 1:
        further = _tensions(model)
        equations, stability = _stationary(forces, conditions, names, tuple(further))
    else:
        rows = [[derivative(g, name) for name in names] for g in conditions]
        tangent = cofactors(rows)
        slope = total(*(product(t, f) for t, f in zip(tangent, forces, strict=True)))
        equations = (*conditions, slope)
        stability = (determinant([*rows, [derivative(slope, name) for name in names]]),)
    found = ClosedMechanism.of(model, further, equations=equations, stability=stability, tangent=tangent)
    sizes = Faults()
    try:
        check_sizes(replace(found, stability=()) if further else found, sizes)
        sizes.check()
    except (ConfigError, ExpressionError) as error:
        raise ConfigError(f"with their loops closed {error.message}", key="closing") from error
    return found


def _condition(mechanism: Mechanism, closing: Closing) -> Tree:
    """Zero where the bar has its length."""
    squared = squared_distance(mechanism.points, closing.start, closing.end)
    return total(squared, negative(Power(closing.length, _TWO)))


def _forces(mechanism: Mechanism, names: Sequence[str]) -> list[Tree]:
    """The energy's derivatives by the unknowns, less the moments that are in no energy."""
    energies = (tree for element in mechanism.elements_with(mechanism.points).values() for tree in element.energies)
    moments = split_moments(mechanism)
    energy = total(*energies, *moments.energies)
    steady: Mapping[str, Tree] = {m.unknown: m.value for m in moments.beside}
    return [total(derivative(energy, name), *([negative(steady[name])] if name in steady else ())) for name in names]


def _tensions(mechanism: Mechanism) -> dict[str, UnknownKind]:
    """The further unknowns: a name for each closing bar."""
    names = [f"force_density_{closing.start}{closing.end}" for closing in mechanism.closing]
    taken = {*mechanism.parameters, *mechanism.unknowns}
    if clash := next((name for name in names if name in taken), None):
        raise ConfigError(f"'{clash}' is the name of a closing bar's force density: choose another name", key="closing")
    return dict.fromkeys(names, UnknownKind.REAL)


def _stationary(
    forces: Sequence[Tree], conditions: Sequence[Tree], names: Sequence[str], tension: Sequence[str]
) -> tuple[tuple[Tree, ...], tuple[Tree, ...]]:
    """The equations and the conditions c_1, ..., c_f for stability.

    Parameters
    ----------
    forces : the energy's derivatives by the unknowns of these names, less the moments.
    conditions : twice the g_i.

    Raises
    ------
    ConfigError
        When there are too many unknowns and bars.
    """
    count, bars = len(names), len(conditions)
    if count + bars > MAX_ENTRIES:
        raise ConfigError(
            f"{count} unknowns and {bars} closing bars: with several degrees of freedom left they may be {MAX_ENTRIES} "
            "in all",
            key="closing",
        )
    halves = [Chain(g, (Step("/", _TWO),)) for g in conditions]
    rows = [[derivative(g, name) for name in names] for g in halves]
    pulls = [
        total(force, *(_product(Name(t), row[k]) for t, row in zip(tension, rows, strict=True)))
        for k, force in enumerate(forces)
    ]
    matrix = [[*(derivative(p, name) for name in names), *(row[k] for row in rows)] for k, p in enumerate(pulls)]
    matrix += [[*row, *[ZERO] * bars] for row in rows]
    return (*pulls, *halves), tuple(_conditions(matrix, count, bars))


def _conditions(matrix: Sequence[Sequence[Tree]], count: int, bars: int) -> Iterator[Tree]:
    """c_k is the sum of the principal minors with the border and k + m of the other rows, but for its sign."""
    border = tuple(range(count, count + bars))
    for k in range(1, count - bars + 1):
        kept = [(*chosen, *border) for chosen in combinations(range(count), k + bars)]
        minors = total(*(determinant([[matrix[i][j] for j in rows] for i in rows]) for rows in kept))
        yield negative(minors) if bars % 2 else minors


def _product(factor: Tree, tree: Tree) -> Tree:
    return ZERO if tree == ZERO else Chain(factor, (Step("*", tree),))
