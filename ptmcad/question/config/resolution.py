"""From a record's texts to exact expressions and numbers.

Guarantee: what leaves here is complete and exact; no length or stiffness is known to be out of the
range that the geometry needs. Where its sign could not be decided at once (see
`ptmcad.question.positivity`) it is left to the engines, which decide or refuse:
`ptmcad.question.domain.proved`. What is proved here the slice carries. Its texts name only its axes
and each other.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from fractions import Fraction

from ptmcad.errors import ExpressionError, Faults, Place
from ptmcad.model import Kind, Mechanism, Model
from ptmcad.model.evaluate import value_at
from ptmcad.question.config.binding import resolved, texts_of
from ptmcad.question.config.problemrecord import Record, read_record, swept_names
from ptmcad.question.config.scalars import Window, names_in_scalar, number_of
from ptmcad.question.counts import usual_count
from ptmcad.question.domain import MAX_DEGREE, sign_of, sign_of_part
from ptmcad.question.positivity import window_of
from ptmcad.question.shipped import AXES
from ptmcad.question.slice import (
    PROVED,
    Axes,
    Axis,
    Finding,
    Slice,
    Subject,
    count_fault,
    have_free_lengths,
)
from ptmcad.text.entry import Tree
from ptmcad.text.expressions import Expression, Expressions, axis, constant
from ptmcad.text.syntax import did_you_mean, parse
from ptmcad.text.tree import names_of


def checked_slice(tree: Tree) -> Slice:
    """The slice of a record.

    Raises
    ------
    ConfigError
        That knows all faults of the record, those of keys and shapes and those of what is written
        there.
    """
    return slice_of(*described_record(tree))


def described_record(tree: Tree) -> tuple[Record, Faults]:
    """A record as `read_record` has it, with its `unread` names, and what is wrong with it, where
    there is a model.

    Raises
    ------
    ConfigError
        Without one: then nothing can be said of the values.
    """
    faults = Faults()
    record = read_record(tree, faults)
    return record._replace(unread=_unread(record, tree, faults)), faults


def _unread(record: Record, tree: Tree, faults: Faults) -> frozenset[str]:
    """The names in a record's values of which nothing can be said, because what would tell what
    they are is faulty.
    """
    found, hidden = set(), False
    for key in ("axes", "free", "sweep"):
        node = tree.entries.get(key)
        if isinstance(node, Tree):
            found |= {
                name for name in node.entries if key != "axes" or faults.concern(f"{key}.{name}")
            }
        hidden = hidden or ([key] in faults.steps and not isinstance(node, Tree))
    if hidden:  # any name may be one of those, and any parameter without a value
        found |= record.model.parameters.keys() - record.values.keys()
        for scalar in record.values.values():
            with Faults():  # a text that cannot be read is reported with the others
                found.update(names_in_scalar(scalar))
    return frozenset(found - record.axes.keys())


def note_values(record: Record, faults: Faults, unread: Iterable[str] = ()) -> None:
    """Note what is wrong with the axes and values of a record that asks nothing yet, and raise all
    that is known.

    Parameters
    ----------
    unread : further names of which nothing can be said.

    Raises
    ------
    ConfigError
        When anything was noted, there or before.
    """
    _judged(record._replace(unread=record.unread.union(unread)), faults)
    faults.check()


def slice_of(record: Record, faults: Faults | None = None) -> Slice:
    """Resolve a record to a slice.

    Parameters
    ----------
    faults : what was found in the record before, and is raised with the rest.
    """
    faults = faults or Faults()
    if record.sweep is not None:
        with faults:
            raise record.sweep.place.error(
                "the record asks for a sweep: `ptmcad sweep` answers it, and --set NAME=VALUE chooses one member"
            )
        record = record._replace(unread=record.unread | swept_names(record).keys())
    if record.free is not None:
        name, window = record.free
        with faults:
            raise window.place.error(
                f"{name} is free, and the record is one of a family: give it a value with --set {name}=VALUE, or ask "
                "for its members with ptmcad classify or ptmcad.family"
            )
        record = record._replace(unread=record.unread | {name})
    axes, values, signs = _judged(record, faults)
    with faults:
        if not faults.parts & {"mechanism", "system"} and all(
            fault.file == record.place.file for fault in faults.found
        ):
            if faults.found:
                _note_unnamed_axes(record, faults)
            count = record.counting
            if count is not None and (problem := count_fault(count, record.model, values)):
                raise record.count_place.error(problem)
    faults.check()
    return _slice(record, axes, values, signs)


def _note_unnamed_axes(record: Record, faults: Faults) -> None:
    """Note axes of which no text has the name, beside faults because of which it is not known what
    depends on what.
    """
    named = set[str]()
    for scalar in record.values.values():
        try:
            named.update(names_of(parse(scalar.text)))
        except ExpressionError:
            return  # this is reported with the others, and such a text may be meant to name any axis
    if named - record.model.parameters.keys() - record.axes.keys() - record.unread:
        return  # an unknown name may be a slip of the axis's
    for name in _needed_axes(record)[:2]:
        place = record.axes[name].place
        if (
            name not in named
            and name not in record.model.parameters
            and not faults.concern(f"axes.{name}")
        ):
            with faults:
                raise place.error(f"the axis {name} is not used: no parameter depends on it")


def _needed_axes(record: Record) -> tuple[str, ...]:
    """The axes on which something has to depend: none of a published system, which may have fewer
    parameters.
    """
    return tuple(record.axes) if isinstance(record.model, Mechanism) else ()


def _judged(record: Record, faults: Faults) -> tuple[Axes, dict[str, Expression], list[Finding]]:
    """The axes, every parameter as a function of them, and the signs of these and of what springs
    are given.

    Faults are noted, and none that follows from another.
    """
    with faults:
        if not record.axes and not faults.concern("axes"):
            raise record.place.below("axes").error(
                f"is missing: a slice needs two axes, such as {AXES}"
            )
    for name in record.axes:
        with faults:
            if name in record.values:
                place = record.values[name].place
                raise place.error(
                    f"{name} is an axis and cannot be fixed too: remove it here or from the axes"
                )
    axes = [_judged_axis(name, window, record, faults) for name, window in record.axes.items()]
    unread = record.unread | set(tuple(record.axes)[2:])  # of three axes the last one
    record = record._replace(unread=unread)
    values, faulty = resolved(
        record, {name: axis(k) for k, name in enumerate(tuple(record.axes)[:2])}, faults
    )
    assert faults.found or not faulty, "a name that stands for 1 has no value"
    known = [a for a in axes[:2] if a is not None]
    window = (known[0], known[1]) if len(known) == 2 else None
    wrong: set[str] = set()
    signs: list[Finding] = []
    for name in sorted(values, key=lambda name: bool(_inherited(name, record))):
        if name in record.axes or name in faulty or _inherited(name, record) in wrong:
            continue  # what has the value of another one is wrong with that one, where it stands
        with faults:
            wrong.add(name)
            signs += _signs_of_value(name, values[name], record, window)
            wrong.remove(name)
    doubtful = wrong | faulty
    for part in record.model.parts:
        with faults:
            if window is not None and not doubtful & {*names_of(part.tree)}:
                sign = sign_of_part(record.model, part, values, window)
                signs.append(_accepted(sign, record.place_of_part(part.key)))
    if window is None:
        faults.check()
        raise AssertionError("what is wrong with an axis was noted")
    return window, values, signs


def _judged_axis(name: str, window: Window, record: Record, faults: Faults) -> Axis | None:
    """An axis, of which what is wrong is noted: then where in its range values make sense, if they
    do anywhere.
    """
    with faults:
        if name in record.model.unknowns:
            raise window.place.error(
                f"{name} is an unknown: an axis is a parameter, or a new name that one uses"
            )
    with faults:
        return axis_of(name, window, record.model)
    with Faults():  # noted above
        low, high = sorted((number_of(window.low), number_of(window.high)))
        kind = record.model.kind(name) if name in record.model.parameters else Kind.NUMBER
        low = max(low, Fraction(0)) if kind.demand else low
        return Axis(name, low, high) if low < high else None
    return None


def _inherited(name: str, record: Record) -> str:
    """The parameter whose value another one has, since it is given none; empty for one that has its
    own.
    """
    return "" if name in record.values else record.model.parameters[name].alias_of or ""


def _slice(record: Record, axes: Axes, resolved: Expressions, signs: Sequence[Finding]) -> Slice:
    """The slice of a record whose entries are right one by one."""
    mechanism = record.model
    given = {*record.values, *record.axes}
    # not named: a shorthand of free lengths, and one whose parameters are all given
    left_out = {
        name
        for name, own in mechanism.shorthands.items()
        if mechanism.kind(name) is Kind.FREE_LENGTH or given.issuperset(own)
    }
    left_out.update(mechanism.idle)
    if not _names_free_lengths(mechanism, resolved):
        left_out.update(mechanism.free_lengths)
    effective = {name: expression for name, expression in resolved.items() if name not in left_out}
    _check_shorthands_are_used(record, mechanism, given)
    for index, name in enumerate(_needed_axes(record)):
        if not any(expression.uses(index) for expression in effective.values()):
            known = mechanism.parameters
            hint = "" if name in known else did_you_mean(name, known)
            other = next((parameter for parameter in known if parameter not in record.axes), "")
            example = f", such as {other}: {name}" if other else ""
            remedy = f"no parameter depends on it{hint or ';'} use it in an expression{example}"
            if name in mechanism.shorthands:
                own = _listed(mechanism.shorthands[name])
                remedy = f"{own} are all given and none depends on it; use it in one of them"
            raise record.axes[name].place.error(f"the axis {name} is not used: {remedy}")
    return Slice(
        name=record.name or "slice-" + "-".join(record.axes),
        model=record.model,
        axes=axes,
        parameters=effective,
        count=record.counting or usual_count(record.model),
        title=record.title,
        reference=record.reference,
        text=_texts(effective, record, signs),
        units=record.units,
        signs=tuple(sign for sign in signs if sign.subject.part or sign.subject.text in effective),
    )


def point_of(record: Record) -> dict[str, Fraction]:
    """Resolve a record to a point; its axes that are no parameters have numbers in place of their
    names.
    """
    mechanism = record.model
    faults = Faults()
    expressions, faulty = resolved(record, {}, faults)
    faults.check()
    assert not faulty, "a name that stands for 1 has no value"
    values = {name: expression.constant() for name, expression in expressions.items()}
    for name, value in values.items():
        check_number(name, mechanism.kind(name), value, record.place_of(name))
    for part in mechanism.parts:
        if problem := part.fault(value_at(part.tree, values)):
            raise record.place_of_part(part.key).error(problem)
    _check_shorthands_are_used(record, mechanism, set(record.values))
    return without_shorthands(values, mechanism)


def without_shorthands(values: Mapping[str, Fraction], mechanism: Model) -> dict[str, Fraction]:
    """The values that define a point: no shorthand, nothing idle, and free lengths only if
    some is not zero.
    """
    left_out = {*mechanism.shorthands, *mechanism.idle}  # what they stand for is there
    expressions = {name: constant(value) for name, value in values.items()}
    if not _names_free_lengths(mechanism, expressions):
        left_out.update(mechanism.free_lengths)
    return {name: value for name, value in values.items() if name not in left_out}


def _names_free_lengths(model: Model, values: Expressions) -> bool:
    """Whether parameters that are free lengths are shown: where one is not zero, or a spring has
    another free length.
    """
    given = (values[name] for name in model.free_lengths if name in values)
    return any(value.numerator for value in given) or have_free_lengths(model, values)


def _texts(effective: Iterable[str], record: Record, signs: Iterable[Finding]) -> dict[str, str]:
    """What the parameters were written as, and every name in those texts, but for the axes.

    A k that the springs do not have by default, say, is no parameter of the mechanism, but "k/10"
    says nothing without it. No engine looks at the sign of such a name, so it has to be proved
    here.
    """
    written = texts_of(effective, record)
    unproved = {
        sign.subject.text: sign.problem for sign in signs if sign.problem and not sign.subject.part
    }
    for name in written.keys() - {*effective}:
        if name in unproved:
            raise record.place_of(name).error(unproved[name])
    texts = {**written, **{name: name for name in effective if name in record.axes}}
    return {name: texts[name] for name in record.model.parameters if name in texts}


def axis_of(name: str, window: Window, model: Model) -> Axis:
    """An axis with its range, which is not empty and has no length below zero."""
    low, high = number_of(window.low), number_of(window.high)
    if low == high:
        raise window.place.error(f"the range of {name} is empty: {low} to {high}")
    if low > high:
        raise window.place.error(f"the range of {name} is reversed: write [{high}, {low}]")
    kind = model.kind(name) if name in model.parameters else Kind.NUMBER
    if low < 0 and kind.demand:
        raise window.place.error(
            f"the range of {name} goes below zero, but a {kind.noun} is {kind.demand}: start it at 0 or above"
        )
    return Axis(name, low, high)


def _signs_of_value(
    name: str, expression: Expression, record: Record, axes: Axes | None
) -> tuple[Finding, ...]:
    """The sign of a parameter, where the window is known.

    What the geometry excludes is refused, and so is a denominator that vanishes in the window.
    """
    place, subject = record.place_of(name), Subject(name, record.model.kind(name), expression)
    if expression.degree > MAX_DEGREE:
        raise place.error(
            f"{name} has degree {expression.degree} in the axes: at most {MAX_DEGREE} can be computed"
        )
    if expression.is_constant:
        check_number(name, subject.kind, expression.constant(), place)
    if axes is None:
        return ()
    if expression.is_constant:
        return (Finding(subject, window_of(axes), PROVED),)
    return (_accepted(sign_of(subject, axes), place),)


def _accepted(sign: Finding, place: Place) -> Finding:
    """A sign that is not known to be wrong."""
    if sign.problem and sign.is_final:
        raise place.error(sign.problem)
    return sign


def check_number(name: str, kind: Kind, value: Fraction, place: Place) -> None:
    """Refuse a number that the geometry excludes."""
    if kind.excludes(value):
        raise place.error(f"{name} is {value}, but a {kind.noun} must be {kind.demand}")


def _check_shorthands_are_used(record: Record, mechanism: Model, given: set[str]) -> None:
    """Refuse a value for all springs, such as k or l0, that none of them takes."""
    for shorthand, names in mechanism.shorthands.items():
        if shorthand not in record.values or not given.issuperset(names):
            continue
        if not any(
            shorthand in names_in_scalar(s)
            for name, s in record.values.items()
            if name != shorthand
        ):
            raise record.values[shorthand].place.error(
                f"has no effect, since {_listed(names)} are all given: leave it out"
            )


def _listed(names: tuple[str, ...]) -> str:
    return f"{', '.join(names[:-1])} and {names[-1]}" if len(names) > 1 else names[0]
