"""A description compiled: unknowns, points, springs, energy, equations and conditions as formulas
of one graph.

It is made once for a description, whatever the slice, and both engines, fields, pictures and pages
read it; the checker does not.

Guarantee: exact, and nothing is known by name: each formula follows from the description's
expressions. All are polynomials in the parameters, the unknowns on the line, and the cosines and
sines of angles; what a spring with a free length takes off the energy is kept apart, as that has a
root.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cached_property, lru_cache
from operator import sub
from typing import TypeVar

from ptmcad.formulas.evaluation import values
from ptmcad.formulas.graph import Formula, Graph, gradient
from ptmcad.model import closedloops as loops
from ptmcad.model import crossed
from ptmcad.model.criterion import Criterion
from ptmcad.model.crossed import Follower
from ptmcad.model.description import Mechanism, Model, equations_in
from ptmcad.model.evaluate import Assignment, ByNames, Ring, RingElement, evaluate, evaluated
from ptmcad.model.springs import AngularSpring, ElasticLine, Vector
from ptmcad.model.work import split_moments

E = TypeVar("E", bound=RingElement)


@dataclass(frozen=True, eq=False)
class CompiledSystem:
    """A description's formulas, in variables: the parameters, the unknown angles, those on the
    line, then followers.

    Attributes
    ----------
    names : of the variables; a variable's number is its place.
    angles, reals : numbers of the unknowns.
    followers : with their relations to the unknowns; points and what is made of them may depend on
        them.
    points : coordinates by name; empty of a system.
    springs, torsion : in the description's order.
    loads : the forces' components.
    smooth : the energy of springs and loads, or the potential, as if no spring had a free length;
        None of equations.
    others : its terms that are of no spring between points.
    moments : for each unknown, what its equation lacks of the energy's slope: constant moments;
        without a potential all moments.
    equations : one for each unknown, zero at solutions as if no spring had a free length; with
        closed loops those that close them, and then the energy's slope along them.
    are_slopes : whether they are the smooth energy's derivatives by the unknowns, less the moments.
    inequalities, stability : a solution counts, and is stable, where all are positive.
    tangent : along closed loops with one degree of freedom, the direction in which unknowns move.
    heights : of the points that the unknowns raise, where no loop holds these together.
    has_energy : whether that is an energy, and not only a part of what acts, as beside moments
        without a potential.
    criterion : what is known of solutions; where they have an index they are critical points of the
        energy, less the work of constant moments.
    """

    graph: Graph = field(repr=False)
    names: tuple[str, ...]
    angles: tuple[int, ...]
    reals: tuple[int, ...]
    followers: tuple[Follower[int, Formula], ...] = ()
    points: Mapping[str, Vector] = field(default_factory=dict, repr=False)
    springs: tuple[ElasticLine, ...] = ()
    torsion: tuple[AngularSpring, ...] = ()
    loads: tuple[Vector, ...] = ()
    smooth: Formula | None = None
    others: tuple[Formula, ...] = ()
    moments: tuple[Formula, ...] = ()
    equations: tuple[Formula, ...] = ()
    are_slopes: bool = False
    inequalities: tuple[Formula, ...] = ()
    stability: tuple[Formula, ...] = ()
    tangent: tuple[Formula, ...] = ()
    heights: tuple[Formula, ...] = ()
    has_energy: bool = False
    criterion: Criterion = field(kw_only=True)

    @cached_property
    def shown(self) -> CompiledSystem:
        """What is drawn and followed of a pose: no points, springs and loads yet where loops are
        closed.
        """
        return (
            self if self.are_slopes else replace(self, points={}, springs=(), torsion=(), loads=())
        )

    @property
    def unknowns(self) -> tuple[int, ...]:
        """Their numbers, angles first."""
        return self.angles + self.reals

    @property
    def is_gradient(self) -> bool:
        """Whether the equations are near each solution the slopes of one function."""
        return bool(self.criterion.order)

    @property
    def stretches(self) -> tuple[tuple[Formula, Formula, Formula], ...]:
        """Of each spring its length, its free length, and its force, which is positive where it
        pulls.
        """
        return tuple((spring.length, spring.free, spring.force) for spring in self.springs)

    @property
    def elastic(self) -> tuple[tuple[ElasticLine, ...], tuple[AngularSpring, ...]]:
        """The springs between points, and those between directions."""
        return self.springs, self.torsion

    def summands(self, relaxed: Iterable[int] = ()) -> tuple[Formula, ...]:
        """Of the energy with the free lengths of some springs."""
        counted = set(relaxed)
        parts = (s.energy if k in counted else s.smooth for k, s in enumerate(self.springs))
        return (*parts, *self.others)

    def pulling(self, ring: Ring[E]) -> Iterator[tuple[ElasticLine, E, tuple[E, E]]]:
        """The springs that have a free length where parameters are in a ring, with pull and
        difference there.
        """
        for spring in self.springs:
            pull, x, y = self.values((spring.pull, *spring.difference), ring)
            if pull != ring.constant(Fraction(0)):
                yield spring, pull, (x, y)

    @property
    def acting(self) -> dict[int, Formula]:
        """The moments that are not zero, by the unknowns' places, where the equations are slopes."""
        return {
            k: moment
            for k, moment in enumerate(self.moments)
            if moment.value != 0 and self.are_slopes
        }

    @property
    def forces(self) -> tuple[Formula, ...]:
        """The smooth energy's slopes by the unknowns, less the moments."""
        assert self.smooth is not None
        return tuple(map(sub, gradient(self.smooth, self.unknowns), self.moments))

    @property
    def work(self) -> Formula:
        """Of the moments."""
        parts = (
            self.graph.variable(self.unknowns[k]) * moment for k, moment in self.acting.items()
        )
        return sum(parts, self.graph.constant(0))

    def energy(self, relaxed: Iterable[int] | None = None) -> Formula | None:
        """With the springs' free lengths; None where there is none.

        Parameters
        ----------
        relaxed : numbers of the springs whose free length counts, others being zero; all where
            nothing is said.
        """
        return self.stored(relaxed) if self.has_energy else None

    def potential(self, relaxed: Iterable[int] | None = None) -> Formula | None:
        """The same where solutions are its critical points, less the work of moments; else None."""
        return self.energy(relaxed) if self.criterion.order else None

    def stored(self, relaxed: Iterable[int] | None = None) -> Formula | None:
        """The same, whatever else acts."""
        if self.smooth is None:
            return None
        counted = range(len(self.springs)) if relaxed is None else relaxed
        return sum(self.summands(counted), start=self.graph.constant(0))

    def balance(self, relaxed: Iterable[int]) -> tuple[Formula, ...]:
        """The equations with the free lengths of some springs."""
        slack = self.graph.constant(0)
        for k in relaxed:
            slack = slack - self.springs[k].pull * self.springs[k].length
        slopes = gradient(slack, self.unknowns)
        if self.tangent:  # the last equation is the slope along the loops
            slopes = (loops.dot(self.tangent, slopes),)
        closed = len(self.equations) - len(slopes)
        balanced = (
            equation + slope
            for equation, slope in zip(self.equations[closed:], slopes, strict=True)
        )
        return (*self.equations[:closed], *balanced)

    @property
    def quantities(self) -> dict[str, Formula]:
        """By name: ``P.x`` and ``P.y`` of a point, ``.length`` and ``.force`` of a spring, of a
        torsion spring ``.deflection.cos``, ``.deflection.sin`` and ``.moment``."""
        found: dict[str, Formula] = {}
        for name, (x, y) in self.points.items():
            found |= {f"{name}.x": x, f"{name}.y": y}
        springs: tuple[ElasticLine | AngularSpring, ...] = (*self.springs, *self.torsion)
        for spring in springs:
            found |= {
                f"{spring.name}.{what}": formula for what, formula in spring.quantities.items()
            }
        return found

    def values(self, formulas: Sequence[Formula], ring: Ring[E]) -> list[E]:
        """The formulas' values in a ring that has the parameters and unknowns by their names."""
        return values(formulas, ByNames(self.names, ring))


@lru_cache(maxsize=8)
def compiled(model: Model) -> CompiledSystem:
    """The formulas of a description.

    Raises
    ------
    ExpressionError
        When a moment that depends on its unknown is too large to be multiplied out.
    """
    graph, names = Graph(), [*model.variables, *model.sorted_unknowns]
    if model.whole is not None:
        names += model.whole.followers
    return compiled_with(model, {name: graph.variable(k) for k, name in enumerate(names)})


def compiled_with(model: Model, variables: Mapping[str, Formula]) -> CompiledSystem:
    """The same with formulas of one graph for all names; those for unknowns and followers are
    variables.

    So parameters may be numbers or functions of others. Names are known of the variables in their
    places alone.
    """
    mechanism = model.whole
    followers = () if mechanism is None else tuple(mechanism.followers)
    graph = next((formula.graph for formula in variables.values()), Graph())
    ring = Assignment(variables, graph.constant, {*model.angles, *followers})
    angles, reals = (
        tuple(variables[name].variable for name in some) for some in (model.angles, model.reals)
    )
    conditions = evaluated(model.conditions.values(), ring)
    known = CompiledSystem(
        graph, tuple(variables), angles, reals, inequalities=conditions, criterion=model.criterion
    )
    if mechanism is None:
        return _of_system(known, model, ring)
    known = _with_mechanism(known, mechanism, ring)
    if mechanism is model:
        return _of_slopes(known)
    if mechanism.xjoints:
        found = crossed.conditions(mechanism, variables)
    else:
        found = _of_loops(known, mechanism, ring)
    equations, stability, tangent, further = found
    return replace(
        known,
        equations=equations,
        stability=stability,
        tangent=tangent,
        inequalities=known.inequalities + further,
    )


def _with_mechanism(
    known: CompiledSystem, mechanism: Mechanism, ring: Assignment[Formula]
) -> CompiledSystem:
    """Points, springs, loads, the smooth energy, moments."""
    points = {
        name: (evaluate(x, ring), evaluate(y, ring)) for name, (x, y) in mechanism.points.items()
    }
    springs = tuple(ElasticLine.of(spring, points, ring) for spring in mechanism.springs)
    torsion = [
        AngularSpring(t.name, *evaluated((t.stiffness, *t.deflection), ring))
        for t in mechanism.torsion
    ]
    moments, energies = split_moments(mechanism)
    others = [turned.stiffness * (1 - turned.cosine) for turned in torsion]
    loads = []
    for load in mechanism.loads:
        (across, up), (x, y) = evaluated((load.x, load.y), ring), points[load.point]
        loads.append((across, up))
        others.append(-(across * x + up * y))
    others += evaluated(energies, ring)
    steady = dict.fromkeys(mechanism.unknowns, ring.constant(Fraction(0)))
    steady |= {moment.unknown: evaluate(moment.value, ring) for moment in moments}
    followers = tuple(
        crossed.follower(
            joint, ring, *(ring.values[angle].variable for angle in (joint.angle, joint.other))
        )
        for joint in mechanism.xjoints
    )
    known = replace(
        known,
        followers=followers,
        points=points,
        springs=springs,
        torsion=tuple(torsion),
        loads=tuple(loads),
        others=tuple(others),
        moments=tuple(steady[name] for name in mechanism.sorted_unknowns),
        heights=()
        if mechanism.closing or followers
        else tuple(points[name][1] for name in mechanism.rising),
        has_energy=not mechanism.coupled,
    )
    return replace(known, smooth=sum(known.summands(), start=ring.constant(Fraction(0))))


def _of_system(known: CompiledSystem, model: Model, ring: Assignment[Formula]) -> CompiledSystem:
    """What is zero, and what is positive, at solutions of a system."""
    own = equations_in(model)
    assert own is not None
    known = replace(
        known, equations=evaluated(own.equations, ring), stability=evaluated(own.stability, ring)
    )
    if own.potential is None:
        return known
    moments = (ring.constant(Fraction(0)),) * len(known.unknowns)
    energy = evaluate(own.potential, ring)
    return _of_slopes(
        replace(known, smooth=energy, others=(energy,), moments=moments, has_energy=True)
    )


def _of_slopes(known: CompiledSystem) -> CompiledSystem:
    """Solutions are where the energy's slopes are the moments."""
    return replace(known, equations=known.forces, are_slopes=True)


def _of_loops(
    known: CompiledSystem, mechanism: Mechanism, ring: Assignment[Formula]
) -> loops.Conditions:
    """Solutions are where loops are closed and balanced."""
    closing = []
    for bar in mechanism.closing:
        (x0, y0), (x1, y1) = known.points[bar.start], known.points[bar.end]
        closing.append(
            (x1 - x0).squared() + (y1 - y0).squared() - evaluate(bar.length, ring).squared()
        )
    own = len(known.unknowns) - len(mechanism.force_densities)
    tensions = tuple(map(known.graph.variable, known.unknowns[own:]))
    return loops.conditions(tuple(closing), known.forces[:own], known.unknowns[:own], tensions)
