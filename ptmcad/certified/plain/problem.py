"""The critical points of a slice's potential: a smooth part, and a cone for each spring with a free length.

Or the solutions of a system's equations; and of either, what has to be positive at those that count.

Guarantee: every term is read off the description. Up to a constant the potential is V - sum of K_s |d_s|, with V and
the coordinates of d_s trigonometric polynomials: a spring of stiffness k and free length l0 between points that are d
apart has the energy k |d|^2/2 - k l0 |d| + k l0^2/2, so that K = k l0.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, fields, replace
from fractions import Fraction
from itertools import combinations

from ptmcad.certified.formula import Formula, Graph, length
from ptmcad.certified.parameters import expression_formula
from ptmcad.certified.plain.ends import Vector, springs_of
from ptmcad.certified.plain.parallel import shares
from ptmcad.certified.plain.trigonometric import Harmonics, TrigonometricPolynomial
from ptmcad.errors import ConfigError, DegenerateSliceError, GeometryError
from ptmcad.model import ClosedMechanism, Kind, Mechanism, System, mechanism_in
from ptmcad.model.energy import points_in, with_springs
from ptmcad.model.evaluate import evaluate
from ptmcad.model.fourbars import closed_by, flat_everywhere
from ptmcad.model.work import split_moments
from ptmcad.question.counts import Count, Margin
from ptmcad.question.domain import fault, unproved
from ptmcad.question.slice import Axis, Slice
from ptmcad.text.expressions import Expression, constant
from ptmcad.text.numerals import text_of
from ptmcad.text.tree import Tree, to_text

MAX_UNKNOWNS = 3
"""Angles and lengths; the time of a search multiplies with every one."""
MAX_UNKNOWNS_AT_POINTS = 5
"""The same at a single point, without axes to be searched: of four angles a second, of five half a minute."""
FIRST = 2
"""Number of the first unknown among the variables, after the two axes."""

_IRRELEVANT = frozenset(
    {"name", "title", "parameters", "unknowns", "source", "bars", "bodies", "supports", "symmetries"}
)
_SAID_IN_EQUATIONS = frozenset({"mechanism", "tangent", "multipliers"})
"""Of a mechanism with closed loops."""
_USED = frozenset(
    {"points", "springs", "torsion", "loads", "moments", "equations", "potential", "inequalities", "stability"}
)
"""What a description may have: nothing else may go unnoticed into a proof."""


@dataclass(frozen=True, slots=True)
class Cone:
    """A spring with a free length, or several side by side: K, and the difference d of the ends' coordinates.

    Attributes
    ----------
    name : of the spring, or of each.
    weights : one vector w_i for each equation, from which it takes K u . w_i, u = d/|d|: the derivatives of d by the
        unknowns; with closed loops that along them, in the last equation, and zero in the others.
    """

    name: str
    pull: Expression
    difference: Vector
    weights: tuple[Vector, ...]


@dataclass(frozen=True, slots=True)
class Push:
    """What a spring takes off the equations that can only point along one line: K |e| w_i, K with its side.

    Attributes
    ----------
    weights : the derivatives of s by the unknowns, where its vector is s e, e turned by angles or not; as those of a
        `Cone` with closed loops.
    """

    pull: Expression
    direction: tuple[Expression, Expression]
    weights: tuple[TrigonometricPolynomial, ...]

    def strength(self, graph: Graph) -> Formula:
        """K |e|"""
        return expression_formula(graph, self.pull) * length(*(expression_formula(graph, e) for e in self.direction))


@dataclass(frozen=True, slots=True)
class Condition:
    """What is positive at solutions that count, or at stable ones: a `Margin` over a slice.

    Attributes
    ----------
    text, curve, reason : as of the margin.
    squares : where the value is the sum of their squares, what vanishes in its place; else none.
    """

    text: str
    value: TrigonometricPolynomial
    curve: str = ""
    reason: str = ""
    squares: tuple[TrigonometricPolynomial, ...] = ()


@dataclass(frozen=True, slots=True)
class Problem:
    """Equations, one for each unknown, and the cones whose slopes are to be taken off them.

    Attributes
    ----------
    unknowns : names in the description's order; variables 2, 3 ... of formulas.
    reals : those that are no angles.
    equations : the derivatives of a potential V by the unknowns, less the moments; or a system's.
    is_gradient : whether they are near each configuration the derivatives of one function; then the Jacobian is a
        Hessian. With a moment that depends on another unknown than its own they are not.
    inequalities : a solution counts where all are positive.
    stability : without a potential, it is stable where all of these are, too.
    multiples : of the equations, which vanish at solutions as well.
    closing : so many of the first equations say that loops are closed, and no spring is in them; the last one is the
        energy's slope along the curve of configurations that is left. A solution is stable where the determinant of the
        Jacobian is positive, which then is not among ``stability``. 0 without springs of free lengths, and without
        loops.
    pushes : of springs along one line each, of which a branch of a problem has one side; the equations lack them.
    where : which branch it is, in words (`ptmcad.certified.plain.straight`).
    further : all are positive where the predicate holds that a count is by; empty where it is by none.
    covering : of each of the description's unknowns its whole multiples of these, where these are others
        (`ptmcad.certified.plain.covering`).
    """

    unknowns: tuple[str, ...]
    reals: tuple[str, ...]
    equations: tuple[TrigonometricPolynomial, ...]
    cones: tuple[Cone, ...]
    is_gradient: bool
    inequalities: tuple[Condition, ...] = ()
    stability: tuple[Condition, ...] = ()
    multiples: tuple[TrigonometricPolynomial, ...] = ()
    closing: int = 0
    pushes: tuple[Push, ...] = ()
    where: str = ""
    further: tuple[Condition, ...] = ()
    covering: tuple[tuple[int, ...], ...] = ()

    @property
    def has_springs(self) -> bool:
        """Whether some parts of the equations are no polynomials."""
        return bool(self.cones or self.pushes)

    def conditions(self, count: Count) -> tuple[Condition, ...]:
        """What is positive at all solutions that are counted, and at no others, but for a determinant.

        Where it is by a predicate, all stable ones are counted.
        """
        return self.inequalities + (self.stability if count.is_of_stable else ())

    @property
    def variables(self) -> tuple[int, ...]:
        """The unknowns' numbers among the variables."""
        return tuple(range(FIRST, FIRST + len(self.unknowns)))


def problem_of(slice: Slice, most: int = MAX_UNKNOWNS) -> Problem:
    """The problem of a slice's model.

    Raises
    ------
    ConfigError
        When the plain formulas do not take the model: more than ``most`` unknowns; or when a condition on solutions
        holds nowhere.
    GeometryError
        When it is not proved that k l0 is nowhere negative in the window: only then is a spring without length, whose
        energy has a peak there, no stable equilibrium that is not counted.
    DegenerateSliceError
        When a closed loop is proved to fold flat all over the window; the message says what its branches are.
    """
    model = slice.model
    if len(model.unknowns) > most:
        raise ConfigError(
            f"the certified engine takes up to {most} unknowns, and {model.name} has {len(model.unknowns)}",
            key="unknowns",
        )
    for key in (found.name for found in fields(model)):
        if key not in _IRRELEVANT | _SAID_IN_EQUATIONS | _USED and getattr(model, key):
            raise ConfigError(f"the certified engine does not take {key}, and {model.name} has some", key=key)
    ring = Harmonics(tuple(model.unknowns), model.reals, slice.parameters)
    problem, predicate = _equations(slice, ring), slice.count.kind.predicate
    if predicate is None:
        return problem
    if (mechanism := mechanism_in(model)) is None:
        raise ConfigError(predicate.of_systems, key="count")
    return replace(problem, further=_conditions((("count", margin) for margin in predicate.margins(mechanism)), ring))


def _equations(slice: Slice, ring: Harmonics) -> Problem:
    """The problem but for what is asked of stable solutions beyond the model's conditions."""
    model = slice.model
    if isinstance(model, ClosedMechanism) and model.tangent:
        check_loops(model, slice)
    if isinstance(model, ClosedMechanism) and slice.has_free_lengths:
        return _of_loops(model, ring, slice.axes)
    if isinstance(model, System):
        return _of_system(model, ring)
    assert isinstance(model, Mechanism)
    cones = _checked(model, _cones(model, ring), slice.axes)
    equations = list(_gradient(_energy(model, ring), ring))
    for unknown, tree in split_moments(model).steady:
        k = ring.unknowns.index(unknown)
        equations[k] = equations[k] - evaluate(tree, ring)
    return Problem(ring.unknowns, ring.reals, tuple(equations), cones, model.has_potential)


def _checked(mechanism: Mechanism, cones: Iterable[Cone], axes: tuple[Axis, Axis]) -> tuple[Cone, ...]:
    """The cones of a mechanism, no K of which is negative anywhere in the window; those side by side are one."""
    found: list[Cone] = []
    for cone in cones:
        asked = f"stiffness times free length of spring {cone.name}", Kind.FREE_LENGTH, cone.pull, axes
        if problem := fault(*asked) or unproved(*asked):
            number = next(n for n, s in enumerate(mechanism.springs, 1) if cone.name in (s.name, s.start + s.end))
            raise GeometryError(problem, part=f"springs.{number}")
        for k, other in enumerate(found):
            # each of K |d| and K' |d'| alone has a cone, and where both are short at once neither direction would be
            # balanced by the rest; but K f |e| and K' g |e| are one
            if parts := shares(other.difference, cone.difference, axes):
                f, g = parts
                pull = f * other.pull + g * cone.pull
                found[k] = replace(_over(other, f), name=f"{other.name} + {cone.name}", pull=pull)
                break
        else:
            found.append(cone)
    return tuple(found)


def _over(cone: Cone, factor: Expression) -> Cone:
    """The cone with its vector over a factor."""
    (dx, dy), *weights = (
        (across.scaled(1 / factor), up.scaled(1 / factor)) for across, up in (cone.difference, *cone.weights)
    )
    return replace(cone, difference=(dx, dy), weights=tuple(weights))


def check_loops(model: ClosedMechanism, slice: Slice) -> None:
    """Refuse a loop with flat poses all over the window: the Jacobian is singular there, nothing would be decided."""
    found = flat_everywhere(model.mechanism, slice.parameters)
    if found is not None:
        loop, fold = found
        raise DegenerateSliceError(
            f"at every point of the slice the loop that {closed_by(model.mechanism)} closes can fold flat"
            f"{loop.named(fold, slice.has_free_lengths)}. Of the branches together the certified engine decides no "
            "count, not even that of stable equilibria",
            part="closing.1",
        )


def _of_loops(model: ClosedMechanism, ring: Harmonics, axes: tuple[Axis, Axis]) -> Problem:
    """Of closed loops with one degree of freedom left: where K |d| is taken off the energy, K u . w is taken off its
    slope along the loops, w being the derivative of d along them."""
    places = [ring.unknowns.index(name) for name in (*model.angles, *model.reals)]
    # where unknowns are in another order the Jacobian's determinant may have the other sign: so has the slope then
    sign = Fraction(-1 if sum(a > b for a, b in combinations(places, 2)) % 2 else 1)
    tangent = [evaluate(tree, ring).scaled(sign) for tree in model.tangent]
    nothing = ring.constant(Fraction(0))

    def along(f: TrigonometricPolynomial) -> TrigonometricPolynomial:
        slopes = (t * f.derivative(k) for t, k in zip(tangent, places, strict=True))
        return sum(slopes, start=nothing)

    bars = len(model.equations) - 1
    cones = tuple(
        replace(cone, weights=(*[(nothing, nothing)] * bars, (along(cone.difference[0]), along(cone.difference[1]))))
        for cone in _checked(model.mechanism, _cones(model.mechanism, ring), axes)
    )
    *closed, slope = (evaluate(tree, ring) for tree in model.equations)
    return Problem(ring.unknowns, ring.reals, (*closed, slope.scaled(sign)), cones, False, closing=bars)


def _of_system(system: System, ring: Harmonics) -> Problem:
    inequalities = _conditions(_listed("positive", system.inequalities), ring)
    stability = _conditions(_listed("stable", system.stability), ring)
    if system.potential is not None:
        gradient = _gradient(evaluate(system.potential, ring), ring)
        return Problem(ring.unknowns, ring.reals, gradient, (), True, inequalities)
    equations = tuple(evaluate(tree, ring) for tree in system.equations)
    # an unknown that is not zero where solutions count is no factor of an equation: without this, the solutions at
    # which it is zero, say those where a species is extinct, would be undecided all over the window
    nonzero = [k for k in range(len(ring.unknowns)) if any(_is_multiple(c.value, k) for c in inequalities)]
    divided = tuple(_without_factors(f, nonzero) for f in equations)
    multiples = tuple(f for f, g in zip(equations, divided, strict=True) if f != g)
    return Problem(ring.unknowns, ring.reals, divided, (), False, inequalities, stability, multiples)


def _listed(key: str, trees: Sequence[Tree]) -> Iterator[tuple[str, Margin]]:
    """A system's conditions, with the key of each in the record."""
    for n, tree in enumerate(trees, 1):
        yield f"{key}.{n}", Margin(to_text(tree), tree)


def _conditions(margins: Iterable[tuple[str, Margin]], ring: Harmonics) -> tuple[Condition, ...]:
    """The conditions that say something, of margins with the keys of a record that they come from.

    Raises
    ------
    ConfigError
        When one holds nowhere.
    """
    found = []
    for key, margin in margins:
        value = evaluate(margin.value, ring)
        if set(value.terms) - set(ring.constant(Fraction(1)).terms) or not constant_of(value).is_constant:
            squares = tuple(f for f in (evaluate(tree, ring) for tree in margin.squares) if f.terms)
            is_sum = value == sum((f * f for f in squares), start=ring.constant(Fraction(0)))
            found.append(Condition(margin.text, value, margin.curve, margin.reason, squares if is_sum else ()))
        elif (number := constant_of(value).constant()) <= 0:
            raise ConfigError(f"no solution counts: {margin.text} is {text_of(number)} all over the window", key=key)
    return tuple(found)


def _is_multiple(f: TrigonometricPolynomial, k: int) -> bool:
    """Whether a polynomial vanishes wherever a real unknown does."""
    return all(e[k] for _, e in f.terms)


def _without_factors(f: TrigonometricPolynomial, unknowns: Sequence[int]) -> TrigonometricPolynomial:
    """An equation divided by all powers of these unknowns that divide it."""
    least = {k: min((e[k] for _, e in f.terms), default=0) for k in unknowns}
    return TrigonometricPolynomial(
        {(m, tuple(p - least.get(k, 0) for k, p in enumerate(e))): c for (m, e), c in f.terms.items()}
    )


def _gradient(energy: TrigonometricPolynomial, ring: Harmonics) -> tuple[TrigonometricPolynomial, ...]:
    return tuple(energy.derivative(k) for k in range(len(ring.unknowns)))


def _cones(mechanism: Mechanism, ring: Harmonics) -> Iterator[Cone]:
    """The springs with a free length, as parts of the energy's derivatives by the unknowns."""
    for spring, (dx, dy) in springs_of(mechanism, ring):
        pull = constant_of(evaluate(spring.stiffness, ring) * evaluate(spring.free, ring))
        if pull.numerator and (dx.terms or dy.terms):
            slopes = tuple((dx.derivative(k), dy.derivative(k)) for k in range(len(ring.unknowns)))
            yield Cone(spring.name, pull, (dx, dy), slopes)


def _energy(mechanism: Mechanism, ring: Harmonics) -> TrigonometricPolynomial:
    """Without what springs with a free length take off it."""
    smooth = ring.constant(Fraction(0))
    for spring, (dx, dy) in springs_of(mechanism, ring):
        smooth = smooth + (evaluate(spring.stiffness, ring) * (dx * dx + dy * dy)).scaled(Fraction(1, 2))
    return with_springs(mechanism, ring, points_in(mechanism, ring), smooth)


def constant_of(value: TrigonometricPolynomial) -> Expression:
    """The function of the axes that a polynomial without unknowns is."""
    return next((a for a, _ in value.terms.values()), constant(0))
