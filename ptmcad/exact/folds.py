"""Loops that fold flat at every point of a slice, as a parallelogram's and a kite's do: told apart from other faults.

The poses of such a loop are several branches, which meet where it is flat; of a loop of four bars they are named.

Guarantee: exact. Where a loop folds flat at a point is decided by the ideal of its equations and the tangent.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from fractions import Fraction
from itertools import combinations

from flint import fmpq

from ptmcad.algebra.bases import quotient
from ptmcad.algebra.polynomials import Ratio, evaluate
from ptmcad.errors import DegenerateSliceError, ExpressionError, InfiniteSolutionsError
from ptmcad.exact.models.potential import elements_of
from ptmcad.exact.models.system import ParametricSystem, at_point, polynomial_at
from ptmcad.exact.witness import Point
from ptmcad.mechanism import ClosedMechanism, Mechanism, Model
from ptmcad.mechanism.description import Closing
from ptmcad.mechanism.evaluate import value_at
from ptmcad.mechanism.proofs import MirrorImage, Points

Degenerate = DegenerateSliceError | InfiniteSolutionsError


def with_folds(
    error: Degenerate,
    model: Model,
    system: ParametricSystem,
    parameters: Mapping[str, Ratio],
    at: Iterable[Point],
) -> Degenerate:
    """The error, or one that says that it is a loop which folds flat all over the slice.

    Parameters
    ----------
    at : points of the slice that nobody has chosen.
    """
    if not isinstance(model, ClosedMechanism) or not model.tangent:
        return error
    seen = {p: found for p in at if (found := _folds_at(model, system, parameters, p)) is not None}
    if not seen or not all(seen.values()):
        return error
    which = " and ".join(f"{c.start}{c.end}" for c in model.mechanism.closing)
    why = _branches(model, parameters, tuple(seen))
    return DegenerateSliceError(
        f"at every point of the slice the loop that {which} closes can fold flat{why}", part=error.part
    )


def _folds_at(
    model: ClosedMechanism, system: ParametricSystem, parameters: Mapping[str, Ratio], at: Point
) -> bool | None:
    """Whether some pose, real or complex, has a tangent that is zero; None where a parameter has no value."""
    below = [evaluate(b, *at) for _, b in parameters.values()]
    if not all(below):
        return None
    values = {name: evaluate(a, *at) / b for (name, (a, _)), b in zip(parameters.items(), below, strict=True)}
    flat = [polynomial_at(system, p, values) for p in elements_of(model, model.tangent)]
    circles = [{m: fmpq(c) for m, c in circle.items()} for circle in system.ring.circles]
    found = quotient([e for e in (*at_point(system, values)[0], *flat) if e] + circles, system.ring.width)
    return found is None or found.dimension > 0


def _branches(model: ClosedMechanism, parameters: Mapping[str, Ratio], at: Sequence[Point]) -> str:
    """What the branches are that meet in flat poses, where they can be named, and how to describe each by itself."""
    mechanism = model.mechanism
    for closing in mechanism.closing if len(mechanism.closing) == 1 else ():
        for loop in _four_bars(mechanism, closing):
            kinds = [_kind(mechanism, closing, loop, _values(parameters, p)) for p in at]
            if kinds and kinds[0] and len(set(kinds)) == 1:
                return _named(kinds[0], loop)
    return (
        ", as lengths of its bars add up alike: two ways of assembling it meet there, and flat poses are multiple "
        "solutions whatever the loads are; give its bars other lengths, or write the branch that you mean as an open "
        "chain"
    )


_SINGULAR = "in flat poses, the loop is singular, and these are multiple solutions whatever the loads are"
Loop = tuple[str, str, str, str]
"""Points A, P, Q and B: PQ is the closing bar."""


def _named(kind: str, loop: Loop) -> str:
    a, p, q, b = loop
    if kind == "parallelogram":
        return (
            f": {a} {p} {q} {b} is a parallelogram with two branches, on one {a}{p} and {b}{q} are parallel, on the "
            f"other they cross; where the two meet, {_SINGULAR}. Describe the parallel branch as an open chain, with "
            f"{q} as far from {p} as {b} from {a}, and the crossed one by 'x-joint:'"
        )
    if kind == "rhombus":
        return (
            f": {a} {p} {q} {b} is a rhombus with three branches, on one {a}{p} and {b}{q} are parallel, on the others "
            f"{p} stays at {b} or {q} at {a}; where they meet, {_SINGULAR}. Describe each branch as an open chain"
        )
    still, centre, far = (p, b, f"{a}{q}") if kind == f"kite {p}" else (q, a, f"{b}{p}")
    return (
        f": {a} {p} {q} {b} is a kite with two branches, on one {still} stays at {centre} and two bars turn about it, "
        f"the other is symmetric about {far}; where the two meet, {_SINGULAR}. Describe the symmetric branch by the "
        f"angle and the length of {far} as unknowns; the other one is an open chain"
    )


def _four_bars(mechanism: Mechanism, closing: Closing) -> Iterator[Loop]:
    """The loops of four rigid parts that a closing bar is in."""
    fixed = [name for name in mechanism.points if name not in mechanism.moving]
    rigid = {
        frozenset(pair)
        for part in (*mechanism.bars, fixed, *mechanism.bodies.values())
        for pair in combinations(part, 2)
    }
    p, q = closing.start, closing.end
    for a in mechanism.points:
        for b in mechanism.points:
            if {a, b} & {p, q} or a == b:
                continue
            if {frozenset((a, p)), frozenset((q, b)), frozenset((b, a))} <= rigid:
                yield a, p, q, b


def _values(parameters: Mapping[str, Ratio], at: Point) -> dict[str, Fraction]:
    found = {}
    for name, (above, below) in parameters.items():
        value = evaluate(above, *at) / evaluate(below, *at)
        found[name] = Fraction(int(value.p), int(value.q))
    return found


def _kind(mechanism: Mechanism, closing: Closing, loop: Loop, values: Mapping[str, Fraction]) -> str:
    """What a loop of four bars is by its lengths at values of the parameters; empty where they are no equal pairs."""
    points = Points(mechanism, MirrorImage(values))
    a, p, q, b = loop
    try:
        first, second, ground = (points.squared(*pair).terms.get((), Fraction(0)) for pair in ((a, p), (q, b), (b, a)))
    except ExpressionError:
        return ""
    coupler = value_at(closing.length, values) ** 2
    if first == second and coupler == ground:
        return "rhombus" if first == ground else "parallelogram"
    if first == ground and coupler == second:
        return f"kite {p}"
    return f"kite {q}" if first == coupler and second == ground else ""
