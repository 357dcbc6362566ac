"""The critical points of a slice's potential: a smooth part, and a cone for each spring with a free
length.

Or the solutions of a system's equations; and of either, what has to be positive at those that
count.

Guarantee: every term is one of the compiled system's. Up to a constant the potential is V - sum of
K_s |d_s|, with V and the coordinates of d_s trigonometric polynomials: a spring of stiffness k and
free length l0 between points that are d apart has the energy k |d|^2/2 - k l0 |d| + k l0^2/2, so
that K = k l0.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import combinations
from typing import NamedTuple

from ptmcad.certified.plain.harmonics import Harmonics, TrigonometricPolynomial, Vector
from ptmcad.errors import ConfigError, DegenerateSliceError
from ptmcad.formulas.graph import Formula, Graph, expression_formula, length
from ptmcad.model.builtinmechanisms import title_of
from ptmcad.model.closed import conditions_of
from ptmcad.model.compile import CompiledSystem, compiled
from ptmcad.model.evaluate import evaluate
from ptmcad.model.fourbars import closed_by, flat_everywhere
from ptmcad.question.counts import Count, Margin
from ptmcad.question.slice import Slice
from ptmcad.text.expressions import Expression, constant
from ptmcad.text.numerals import text_of
from ptmcad.text.tree import Tree, to_text

MAX_UNKNOWNS = 3
"""Angles and lengths; the time of a search multiplies with every one."""
MAX_UNKNOWNS_AT_POINTS = 5
"""The same at a single point, without axes to be searched: of four angles a second, of five half a
minute.
"""
FIRST = 2
"""Number of the first unknown among the variables, after the two axes."""
TURN = (-3.0, -3.0 + 6.2832)
"""A little more than a full turn, cut where no symmetric solution lies."""
Range = tuple[float, float]
"""Of an unknown: all solutions are between its ends."""


class SpringCone(NamedTuple):
    """A spring with a free length, or several side by side: K, and the difference d of the ends'
    coordinates.

    Attributes
    ----------
    name : of the spring, or of each.
    weights : one vector w_i for each equation, from which it takes K u . w_i, u = d/|d|: the
        derivatives of d by the unknowns; with closed loops that along them, in the last equation,
        and zero in the others.
    """

    name: str
    pull: Expression
    difference: Vector
    weights: tuple[Vector, ...]


@dataclass(frozen=True, slots=True)
class Push:
    """What a spring takes off the equations that can only point along one line: K |e| w_i, K with
    its side.

    Attributes
    ----------
    weights : the derivatives of s by the unknowns, where its vector is s e, e turned by angles or
        not; as those of a `SpringCone` with closed loops.
    """

    pull: Expression
    direction: tuple[Expression, Expression]
    weights: tuple[TrigonometricPolynomial, ...]

    def strength(self, graph: Graph) -> Formula:
        """K |e|"""
        return expression_formula(graph, self.pull) * length(
            *(expression_formula(graph, e) for e in self.direction)
        )


Condition = Margin[TrigonometricPolynomial]
"""What is positive at solutions that count, or at stable ones; with squares where the value is
exactly their sum.
"""


@dataclass(frozen=True, slots=True)
class Problem:
    """Equations, one for each unknown, and the cones whose slopes are to be taken off them.

    Attributes
    ----------
    unknowns : names in the description's order; variables 2, 3 ... of formulas.
    is_angle : of each, whether it is one.
    equations : the derivatives of a potential V by the unknowns, less the moments; or a system's.
    is_gradient : whether they are near each configuration the derivatives of one function; then the
        Jacobian is a Hessian. With a moment that depends on another unknown than its own they are
        not.
    inequalities : a solution counts where all are positive.
    stability : without a potential, it is stable where all of these are, too.
    multiples : of the equations, which vanish at solutions as well.
    closing : so many of the first equations say that loops are closed, and no spring is in them;
        the last one is the energy's slope along the curve of configurations that is left. A
        solution is stable where the determinant of the Jacobian is positive, which then is not
        among ``stability``. 0 without springs of free lengths, and without loops.
    pushes : of springs along one line each, of which a branch of a problem has one side; the
        equations lack them.
    where : which branch it is, in words for the names of curves.
    is_branch : whether it is one of several problems, each on one side of some springs' kinks
        (`ptmcad.certified.plain.straight`): its inequalities say which.
    further : all are positive where the predicate holds that a count is by; empty where it is by
        none.
    rows : of each of the description's unknowns, as whole multiples of this problem's; none where
        the unknowns are the same (`ptmcad.certified.plain.straight`).
    """

    unknowns: tuple[str, ...]
    is_angle: tuple[bool, ...]
    equations: tuple[TrigonometricPolynomial, ...]
    cones: tuple[SpringCone, ...]
    is_gradient: bool
    inequalities: tuple[Condition, ...] = ()
    stability: tuple[Condition, ...] = ()
    multiples: tuple[TrigonometricPolynomial, ...] = ()
    closing: int = 0
    pushes: tuple[Push, ...] = ()
    where: str = ""
    is_branch: bool = False
    further: tuple[Condition, ...] = ()
    rows: tuple[tuple[int, ...], ...] = ()

    @property
    def has_springs(self) -> bool:
        """Whether some parts of the equations are no polynomials."""
        return bool(self.cones or self.pushes)

    def conditions(self, count: Count) -> tuple[Condition, ...]:
        """What is positive at all solutions that are counted, and at no others, but for a
        determinant.

        Where it is by a predicate, all stable ones are counted.
        """
        return self.inequalities + (self.stability if count.is_of_stable else ())

    @property
    def variables(self) -> tuple[int, ...]:
        """The unknowns' numbers among the variables."""
        return tuple(range(FIRST, FIRST + len(self.unknowns)))


def problem_of(slice: Slice, most: int = MAX_UNKNOWNS) -> Problem:
    """The problem of a slice's model.

    Guarantee: no K of a spring is negative anywhere in the window of a slice that
    `ptmcad.question.domain.proved` has returned. Only then is a spring without length, whose energy
    has a peak there, no stable equilibrium that is not counted.

    Raises
    ------
    ConfigError
        When the plain formulas do not take the model: more than ``most`` unknowns; or when a
        condition on solutions holds nowhere.
    DegenerateSliceError
        When a closed loop is proved to fold flat all over the window; the message says what its
        branches are.
    """
    model = slice.model
    if len(model.unknowns) > most:
        raise ConfigError(
            f"the certified engine takes up to {most} unknowns, and {model.name} has {len(model.unknowns)}",
            key="unknowns",
        )
    check_loops(slice)
    ring = Harmonics(tuple(model.unknowns), model.reals, slice.parameters)
    problem, predicate = _equations(slice, ring), slice.count.kind.predicate
    if predicate is None:
        return problem
    if (mechanism := model.whole) is None:
        raise ConfigError(predicate.of_systems, key="count")
    return replace(
        problem,
        further=_conditions((("count", margin) for margin in predicate.margins(mechanism)), ring),
    )


def _equations(slice: Slice, ring: Harmonics) -> Problem:
    """The problem but for what is asked of stable solutions beyond the model's conditions."""
    model = slice.model
    system, (_, positive, stable) = compiled(model), conditions_of(model)
    inequalities = _conditions(_margins(positive), ring)
    is_angle = tuple(kind.turns for kind in model.unknowns.values())
    problem = Problem(ring.unknowns, is_angle, (), (), system.is_gradient, inequalities)
    if system.are_slopes or (slice.has_free_lengths and system.tangent):
        return _with_springs(problem, slice, system, ring)
    stability = _conditions(
        _margins({f"stable.{n}": tree for n, tree in enumerate(stable, 1)}), ring
    )
    # an unknown that is not zero where solutions count is no factor of an equation: without this,
    # the solutions at which it is zero, say those where a species is extinct, would be undecided
    # all over the window
    nonzero = [
        k for k in range(len(ring.unknowns)) if any(_is_multiple(c.value, k) for c in inequalities)
    ]
    equations = system.values(system.equations, ring)
    divided = tuple(_without_factors(f, nonzero) for f in equations)
    multiples = tuple(f for f, g in zip(equations, divided, strict=True) if f != g)
    return replace(problem, equations=divided, stability=stability, multiples=multiples)


def check_loops(slice: Slice) -> None:
    """Refuse a loop with flat poses all over the window: the Jacobian is singular there, nothing
    would be decided.
    """
    mechanism = slice.model.whole
    found = None if mechanism is None else flat_everywhere(mechanism, slice.parameters)
    if mechanism is not None and found is not None:
        loop, fold = found
        raise DegenerateSliceError(
            f"at every point of the slice the loop that {closed_by(mechanism)} closes can fold flat"
            f"{loop.named(fold, slice.has_free_lengths)}. Of the branches together the certified engine decides no "
            "count, not even that of stable equilibria",
            part="closing.1",
        )


def _places(system: CompiledSystem, ring: Harmonics) -> list[int]:
    """The numbers of the compiled system's unknowns, angles first, in the description's order."""
    return [ring.unknowns.index(system.names[k]) for k in system.unknowns]


def _order(system: CompiledSystem, ring: Harmonics) -> Fraction:
    """Where unknowns are in another order the Jacobian's determinant may have the other sign: so
    has the slope then.
    """
    exchanged = sum(a > b for a, b in combinations(_places(system, ring), 2))
    return Fraction(-1 if exchanged % 2 else 1)


def _with_springs(
    problem: Problem, slice: Slice, system: CompiledSystem, ring: Harmonics
) -> Problem:
    """The equations of open chains, or those of closed loops with one degree of freedom, with a
    cone for each spring with a free length."""
    places, order, nothing = _places(system, ring), _order(system, ring), ring.constant(Fraction(0))
    equations, tangent = system.values(system.equations, ring), system.values(system.tangent, ring)
    rigid = [(nothing, nothing)] * (len(equations) - 1)

    def along(f: TrigonometricPolynomial) -> TrigonometricPolynomial:
        return sum(
            (t * f.derivative(k) for t, k in zip(tangent, places, strict=True)), start=nothing
        ).scaled(order)

    def weights(x: TrigonometricPolynomial, y: TrigonometricPolynomial) -> tuple[Vector, ...]:
        """What takes K |d| off the energy takes K u . w off its slope along loops, w being d's
        derivative there.
        """
        if tangent:
            return (*rigid, (along(x), along(y)))
        return tuple((x.derivative(k), y.derivative(k)) for k in range(len(places)))

    return replace(
        problem,
        equations=(*equations[:-1], equations[-1].scaled(order))
        if tangent
        else tuple(equations[places.index(k)] for k in range(len(places))),
        closing=len(rigid) if tangent else 0,
        cones=tuple(
            SpringCone(name, pull, d, weights(*d)) for name, pull, d in _pulls(slice, system, ring)
        ),
    )


def _pulls(
    slice: Slice, system: CompiledSystem, ring: Harmonics
) -> list[tuple[str, Expression, Vector]]:
    """Name, K and d of each spring with a free length; of those between the same points as of one."""
    found: list[tuple[str, Expression, Vector]] = []
    for spring, weight, (across, up) in system.pulling(ring):
        if not (across.terms or up.terms):
            continue
        name, pull = title_of(spring, slice.model), constant_of(weight)
        for k, (other, its_pull, its_vector) in enumerate(found):
            # where both are short at once neither direction would be balanced by the rest
            if its_vector in ((across, up), (-across, -up)):
                found[k] = f"{other} + {name}", its_pull + pull, its_vector
                break
        else:
            found.append((name, pull, (across, up)))
    return found


def _margins(trees: Mapping[str, Tree]) -> Iterator[tuple[str, Margin[Tree]]]:
    """A model's conditions, with the key of each in the record."""
    for key, tree in trees.items():
        yield key, Margin(to_text(tree), tree)


def _conditions(
    margins: Iterable[tuple[str, Margin[Tree]]], ring: Harmonics
) -> tuple[Condition, ...]:
    """The conditions that say something, of margins with the keys of a record that they come from.

    Raises
    ------
    ConfigError
        When one holds nowhere.
    """
    found = []
    for key, margin in margins:
        value = evaluate(margin.value, ring)
        if value != value.still or not constant_of(value).is_constant:
            squares = tuple(f for f in (evaluate(tree, ring) for tree in margin.squares) if f.terms)
            is_sum = value == sum((f * f for f in squares), start=ring.constant(Fraction(0)))
            found.append(
                Condition(
                    margin.text, value, margin.curve, margin.reason, squares if is_sum else ()
                )
            )
        elif (number := constant_of(value).constant()) <= 0:
            raise ConfigError(
                f"no solution counts: {margin.text} is {text_of(number)} all over the window",
                key=key,
            )
    return tuple(found)


def _is_multiple(f: TrigonometricPolynomial, k: int) -> bool:
    """Whether a polynomial vanishes wherever a real unknown does."""
    return all(e[k] for _, e in f.terms)


def _without_factors(
    f: TrigonometricPolynomial, unknowns: Sequence[int]
) -> TrigonometricPolynomial:
    """An equation divided by all powers of these unknowns that divide it."""
    least = {k: min((e[k] for _, e in f.terms), default=0) for k in unknowns}
    return TrigonometricPolynomial(
        {
            (m, tuple(p - least.get(k, 0) for k, p in enumerate(e))): c
            for (m, e), c in f.terms.items()
        }
    )


def constant_of(value: TrigonometricPolynomial) -> Expression:
    """The function of the axes that a polynomial without unknowns is."""
    return next((a for a, _ in value.terms.values()), constant(0))
