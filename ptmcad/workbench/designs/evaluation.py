"""What a design attains: the length of a range, an area, a barrier or another number, exactly.

Guarantee: values are enclosed; None stands for a design that has none, as it does not fit the
question or lies where nothing can be counted. Which saddle is the lowest pass of a barrier is found
in floating point; its height is enclosed.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from fractions import Fraction
from functools import partial
from typing import NamedTuple

from ptmcad.answer.intervals import Span, lower, upper
from ptmcad.answer.poses import Poses
from ptmcad.answer.regionmap import Status
from ptmcad.ask.classification import region_map
from ptmcad.ask.members import Common, member_map
from ptmcad.ask.quantities import Quantity, named, of_pose, unknown
from ptmcad.errors import (
    ConfigError,
    DegenerateSliceError,
    ExpressionError,
    HypothesisError,
    InfiniteSolutionsError,
)
from ptmcad.options import Options
from ptmcad.question.config.designed import Aim, Design
from ptmcad.text.balls import ball_over, enclosure_of, in_balls
from ptmcad.text.enclosure import Enclosure
from ptmcad.text.flint_numbers import from_fraction, to_fraction
from ptmcad.text.numerals import Numbers
from ptmcad.text.syntax import did_you_mean, parse
from ptmcad.text.tree import Tree, names_of
from ptmcad.workbench.designs.designlines import Space

KEY = "design.maximise"
DIGITS = 15
AREA_TOLERANCE = Fraction(1, 10**6)


class Value(NamedTuple):
    """What a design attains; ``span`` are the ends of a range."""

    value: Enclosure
    span: tuple[Enclosure, Enclosure] | None = None


Evaluate = Callable[[Numbers], Value | None]


def evaluator(design: Design, common: Common | None = None, space: Space | None = None) -> Evaluate:
    """What evaluates designs.

    Parameters
    ----------
    common : what the members of the family have in common, where all designs are of one.
    space : the variety over all designs, where it is known: then a range's ends are found from it.
        Without, from the variety of each design's line alone.

    Raises
    ------
    ConfigError
        When a quantity or an expression has no meaning for the model.
    """
    found: Evaluate
    match design.aim:
        case Aim.RANGE:
            found = partial(_range, design) if space is None else partial(_range_in, design, space)
        case Aim.AREA:
            found = partial(_area, design, common)
        case Aim.BARRIER:
            found = _barrier_of(design)
        case Aim.EXPRESSION:
            found = _expression_of(design)

    with suppress(HypothesisError):
        found(design.middle)  # raises what no design can be asked

    def evaluate(values: Numbers) -> Value | None:
        if not design.holds(values):
            return None
        try:
            return found(values)
        except (HypothesisError, ConfigError):  # on the variety, or beyond what the geometry needs
            return None

    return evaluate


def _range(design: Design, values: Numbers) -> Value | None:
    from ptmcad.exact.ranges.anyline import ranges_on
    from ptmcad.exact.ranges.exactline import intervals

    first = design.over[0].name
    slice = design.slice(values)
    found: Sequence[Span]
    try:
        found = intervals(slice, design.along, {first: values[first]}, design.working).operation
    except (DegenerateSliceError, InfiniteSolutionsError):
        found, possible = ranges_on(slice, design.along, values[first], design.working)
        if found != possible:
            return None
    if not found:
        return Value(Enclosure(Fraction(0), Fraction(0)))
    widest = max(found, key=lambda span: span.width.low)
    left, right = (Enclosure(lower(end), upper(end)) for end in (widest.low, widest.high))
    return Value(widest.width, (left, right))


def _range_in(design: Design, space: Space, values: Numbers) -> Value | None:
    from ptmcad.workbench.designs.designlines import longest_on_line

    at = tuple(from_fraction(values[axis.name]) for axis in design.over)
    if (found := longest_on_line(space, at)) is None:
        return None
    low, high = (Enclosure(to_fraction(a), to_fraction(b)) for a, b in found)
    width = Enclosure(max(high.low - low.high, Fraction(0)), high.high - low.low)
    return Value(width, (low, high))


def _area(design: Design, common: Common | None, values: Numbers) -> Value:
    options = Options(engine="exact", area_tolerance=AREA_TOLERANCE)
    found = (
        region_map(design.slice(values), options)
        if common is None
        else member_map(common, values[common.family.free.name], options)
    )
    low = high = Fraction(0)
    for region in found.regions:
        if (region.total if region.stable is None else region.stable) == design.working:
            low, high = low + region.area[0], high + region.area[1]
    return Value(Enclosure(low, high))


def _poses(design: Design, values: Numbers) -> Poses | None:
    """The poses of a design that has as many stable ones as is asked."""
    from ptmcad.ask.solving import poses_at

    poses = poses_at(design.model, design.point(values), DIGITS)
    if poses.status in (Status.ON_VARIETY, Status.UNDECIDED):
        return None
    # where it is not decided whether a pose is tense, it is not taken for one
    number = sum(not (design.tension and pose.may_be_slack) for pose in poses.working)
    return poses if number == design.working else None


def _chosen(design: Design, values: Numbers) -> tuple[Poses, int] | None:
    """The poses of such a design, and the number of the one that is meant, in their order; None
    where there is no such one.
    """
    from ptmcad.workbench.fields.quantityfield import choice_of

    if (poses := _poses(design, values)) is None:
        return None
    choice = choice_of(design.pose, design.model)
    numbers = choice.numbers(poses)
    return (poses, numbers[choice.rank - 1]) if choice.rank <= len(numbers) else None


def _barrier_of(design: Design) -> Evaluate:
    from ptmcad.ask.fields.equations import state_at, unknowns_of
    from ptmcad.workbench.fields.quantityfield import choice_of

    named(design.model, "barrier", KEY)
    if choice_of(design.pose, design.model).kind != "stable":
        raise ConfigError("a barrier is that of a stable pose: ask for stable:1", key="design.pose")

    def evaluate(values: Numbers) -> Value | None:
        import numpy as np

        from ptmcad.workbench.fields.barrier import barriers

        if (chosen := _chosen(design, values)) is None:
            return None
        poses, number = chosen
        given = {name: float(value) for name, value in poses.parameters.items()}
        at = np.array([unknowns_of(pose) for pose in poses.equilibria]).T[:, None]
        found = barriers(
            lambda _pixels, where: state_at(design.model, given, where),
            at,
            np.array([number]),
            len(design.model.angles),
        )
        if np.isnan(found[0]):
            return None
        low = poses.equilibria[number].known_energy
        saddles = [pose.known_energy for pose in poses.equilibria if pose.index == 1]
        top = min(saddles, key=lambda energy: abs(float(energy) - float(low) - float(found[0])))
        return Value(Enclosure(top.low - low.high, top.high - low.low))

    return evaluate


def _expression_of(design: Design) -> Evaluate:
    model, text = design.model, design.maximise
    quantity = named(model, text, KEY) or unknown(model, text)
    if quantity is not None and quantity.name in model.angles:
        quantity = None  # by itself an angle is in radians, as in any expression
    if quantity is not None:
        return partial(_quantity, design, quantity)
    tree = _tree(design)
    needs_pose = bool(model.unknowns.keys() & set(names_of(tree)))

    def evaluate(values: Numbers) -> Value | None:
        found = _chosen(design, values) if needs_pose else (_poses(design, values), 0)
        poses, number = found or (None, 0)
        if poses is None:
            return None
        known = {name: Enclosure(v, v) for name, v in {**poses.parameters, **values}.items()}
        if needs_pose:
            pose = poses.equilibria[number]
            known |= dict(zip(model.sorted_unknowns, (*pose.angles, *pose.reals), strict=True))
        enclosed = _enclosed(tree, known)
        return None if enclosed is None else Value(enclosed)

    return evaluate


def _quantity(design: Design, quantity: Quantity, values: Numbers) -> Value | None:
    if (chosen := _chosen(design, values)) is None:
        return None
    poses, number = chosen
    found = of_pose(quantity, poses.equilibria[number])
    return None if found is None else Value(found)


def _tree(design: Design) -> Tree:
    model = design.model
    known = (*model.sorted_unknowns, *model.parameters, *(axis.name for axis in design.over))
    try:
        tree = parse(design.maximise)
    except ExpressionError as error:
        raise ConfigError(f"{design.maximise[:60]!r}: {error.message}", key=KEY) from error
    words = [aim.value for aim in Aim if aim is not Aim.EXPRESSION]
    for name in names_of(tree):
        if name not in known:
            hint = (
                did_you_mean(name, (*words, *known))
                or f"; there are {', '.join(words)} and expressions"
            )
            raise ConfigError(f"{name!r} is neither an aim nor a parameter{hint}", key=KEY)
    return tree


def _enclosed(tree: Tree, known: Mapping[str, Enclosure]) -> Enclosure | None:
    """The value of an expression; None where it has none."""
    value = in_balls(tree, {name: ball_over(e.low, e.high) for name, e in known.items()})
    return enclosure_of(value) if value.is_finite() else None
