"""What a description means, in mpmath from its data alone: equations, derivatives, energy, and what
is told of a pose.

Nothing of ptmcad is used but the data: expressions are interpreted here, an X-joint is a
reflection, a moment is integrated numerically, and derivatives are differences at a high precision.
A mechanism's residuals are the slopes of its energy less its moments; what is proportional to them
elsewhere has to say by what.

Guarantee: values are right to about `DIGITS` digits where they and their derivatives are of a
moderate size.
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import combinations
from typing import Any

from mpmath import mp, mpc, mpf

DIGITS = 24
_WORKING = 100
_STEPS = "1e-33", "1e-16"
"""Of differences, and of differences of these: the errors are about 1e-64 and 1e-32."""
_OPERATORS = {"+": operator.add, "-": operator.sub, "*": operator.mul, "/": operator.truediv}
Numbers = Mapping[str, mpf]
Function = Callable[[Numbers], mpf]


@dataclass(frozen=True, kw_only=True)
class Values:
    """A model at one place, the unknowns in the order angles, then others; None for what is not
    known.

    Attributes
    ----------
    residuals, jacobian : zero at a solution, and their derivatives.
    energy : the potential; of moments it has what is of one value for each pose.
    conditions, stability : positive at solutions that count, and at stable ones; those of a
        potential are not listed.
    forces : of springs, positive where they pull.
    deflections : cosine and sine of each spring's angle beyond rest.
    """

    residuals: Sequence[Any]
    jacobian: Sequence[Sequence[Any]]
    energy: Any = None
    conditions: Sequence[Any] | None = None
    stability: Sequence[Any] | None = None
    points: Mapping[str, tuple[Any, Any]] | None = None
    lengths: Sequence[Any] | None = None
    forces: Sequence[Any] | None = None
    deflections: Sequence[tuple[Any, Any]] | None = None


def values_at(
    model: Any, parameters: Numbers, unknowns: Numbers, powers: Sequence[Sequence[int]] = ()
) -> Values:
    """The model at a place.

    Parameters
    ----------
    parameters : all variables of the description.
    powers : for each residual the powers of `spans` by which it is multiplied, of a mechanism with
        X-joints.
    """
    with mp.workdps(_WORKING):
        at = {name: mpf(value) for name, value in {**parameters, **unknowns}.items()}
        mechanism = getattr(model, "mechanism", model)
        if not hasattr(mechanism, "springs"):
            return _of_system(model, at)
        residuals, stability = _equations(model, mechanism, powers)
        names = _unknowns(model)
        placed = _with_followers(mechanism, at)
        return Values(
            residuals=[f(at) for f in residuals],
            jacobian=[[_slope(f, name, at, 1) for name in names] for f in residuals],
            energy=_energy(mechanism, placed) + _conservative(mechanism, placed),
            stability=None if stability is None else stability(at),
            points={
                n: (value(x, placed), value(y, placed)) for n, (x, y) in mechanism.points.items()
            },
            **_of_springs(mechanism, placed),
        )


def spans(mechanism: Any, at: Numbers) -> list[mpf]:
    """Of each X-joint the squared distance of its right ends."""
    with mp.workdps(_WORKING):
        placed = _with_followers(mechanism, at)
        return [
            _squared(mechanism, joint.base[1], joint.top[1], placed) for joint in mechanism.xjoints
        ]


def value(tree: Any, at: Numbers) -> mpf:
    """An expression; an angle is a name like others."""
    match type(tree).__name__:
        case "Number":
            return mpf(tree.value.numerator) / tree.value.denominator
        case "Name":
            return at[tree.name]
        case "Negative":
            return -value(tree.operand, at)
        case "Power":
            return value(tree.base, at) ** int(value(tree.exponent, at))
        case "Call":
            return {"cos": mp.cos, "sin": mp.sin}[tree.function](value(tree.argument, at))
    total = value(tree.first, at)
    for step in tree.steps:
        total = _OPERATORS[step.operator](total, value(step.operand, at))
    return total


# ------------------------------------------------------------------------------------------------------- mechanisms


def _with_followers(mechanism: Any, at: Numbers) -> dict[str, mpf]:
    """The place with the angles of the second bars of X-joints: joints are symmetric about an axis
    that takes the right end of the base to that of the top."""
    known = dict(at)
    for joint in mechanism.xjoints:
        length, bars = value(joint.length, known), value(joint.bars, known)
        end = bars * mp.expj(known[joint.angle])  # the base lies from 0 to its length
        along = (end - length) / abs(end - length)
        top = -2 * mp.re((0 - (end + length) / 2) * mp.conj(along)) * along
        known[joint.other] = mp.arg(mpc(top) - length)
    return known


def _squared(mechanism: Any, start: str, end: str, at: Numbers) -> mpf:
    pairs = zip(mechanism.points[start], mechanism.points[end], strict=True)
    return sum(((value(b, at) - value(a, at)) ** 2 for a, b in pairs), mpf(0))


def _turned(spring: Any, at: Numbers) -> mpc:
    """exp(i (angle - rest)) of a torsion spring."""
    cosine, sine = (mpf(c.numerator) / c.denominator for c in spring.rest)
    return mp.expj(value(spring.angle, at)) * mpc(cosine, -sine)


def _energy(mechanism: Any, at: Numbers) -> mpf:
    """Of springs, torsion springs and loads."""
    total = mpf(0)
    for spring in mechanism.springs:
        stiffness, free = value(spring.stiffness, at), value(spring.free, at)
        squared = _squared(mechanism, spring.start, spring.end, at)
        total += stiffness * ((mp.sqrt(squared) - free) ** 2 if free else squared) / 2
    for spring in mechanism.torsion:
        total += value(spring.stiffness, at) * (1 - mp.re(_turned(spring, at)))
    for load in mechanism.loads:
        for force, place in zip((load.x, load.y), mechanism.points[load.point], strict=True):
            total -= value(force, at) * value(place, at)
    return total


def _conservative(mechanism: Any, at: Numbers) -> mpf:
    """The energy of what varies in the moments, where each depends on its own unknown alone."""
    total = mpf(0)
    for moment in mechanism.moments:
        name, here = moment.unknown, at[moment.unknown]
        if any(other != name and _depends(moment.value, other) for other in mechanism.unknowns):
            return mp.nan

        def work(u: mpf, name: str = name, tree: Any = moment.value) -> mpf:
            return value(tree, {**at, name: u})

        nodes = 160  # more than any degree here: the mean is exact then
        steady = work(mpf(0))
        if name in mechanism.angles:
            steady = sum((work(2 * mp.pi * k / nodes) for k in range(nodes)), mpf(0)) / nodes
        total -= mp.quad(
            lambda u, work=work, steady=steady: work(u) - steady, mp.linspace(0, here, 7)
        )
    return total


def _depends(tree: Any, name: str) -> bool:
    """Whether a name occurs."""
    if type(tree).__name__ == "Name":
        return tree.name == name
    if type(tree).__name__ == "Chain":
        return _depends(tree.first, name) or any(
            _depends(step.operand, name) for step in tree.steps
        )
    parts = (getattr(tree, part, None) for part in ("operand", "base", "exponent", "argument"))
    return any(_depends(part, name) for part in parts if part is not None)


def _of_springs(mechanism: Any, at: Numbers) -> dict[str, Any]:
    lengths = [mp.sqrt(_squared(mechanism, s.start, s.end, at)) for s in mechanism.springs]
    return {
        "lengths": lengths,
        "forces": [
            value(s.stiffness, at) * (length - value(s.free, at))
            for s, length in zip(mechanism.springs, lengths, strict=True)
        ],
        "deflections": [(mp.re(z), mp.im(z)) for z in (_turned(s, at) for s in mechanism.torsion)],
    }


def _equations(
    model: Any, mechanism: Any, powers: Sequence[Sequence[int]]
) -> tuple[list[Function], Callable[[Numbers], list[mpf]] | None]:
    """Residuals, and what is positive at stable solutions in loops."""
    names = _unknowns(mechanism)
    moments = {moment.unknown: moment.value for moment in mechanism.moments}

    def slope(name: str, at: Numbers) -> mpf:
        """Of the energy by an unknown, less its moment."""
        found = _slope(
            lambda there: _energy(mechanism, _with_followers(mechanism, there)), name, at, 0
        )
        return found - (value(moments[name], at) if name in moments else 0)

    def multiplied(name: str, exponents: Sequence[int], at: Numbers) -> mpf:
        return slope(name, at) * mp.fprod(
            d**n for d, n in zip(spans(mechanism, at), exponents, strict=False)
        )

    conditions = [
        partial(
            lambda bar, at: (
                _squared(mechanism, bar.start, bar.end, at) - value(bar.length, at) ** 2
            ),
            bar,
        )
        for bar in mechanism.closing
    ]

    def rows(at: Numbers) -> list[list[mpf]]:
        return [[_slope(g, name, at, 0) for name in names] for g in conditions]

    if not conditions:
        scales = powers or [()] * len(names)
        return [
            partial(multiplied, name, exponents)
            for name, exponents in zip(names, scales, strict=True)
        ], None
    if len(names) == len(conditions) + 1:

        def along(at: Numbers) -> mpf:
            return mp.fdot(_normal(rows(at)), [slope(name, at) for name in names])

        return [*conditions, along], lambda at: [
            _determinant([*rows(at), [_slope(along, name, at, 1) for name in names]])
        ]

    def pull(name: str, at: Numbers) -> mpf:
        pairs = zip(model.multipliers, conditions, strict=True)
        return slope(name, at) + sum(at[t] * _slope(g, name, at, 0) / 2 for t, g in pairs)

    pulls: list[Function] = [partial(pull, name) for name in names]
    halves: list[Function] = [partial(lambda g, at: g(at) / 2, g) for g in conditions]

    def definite(at: Numbers) -> list[mpf]:
        """The coefficients c_1, c_2 ... of the bordered determinant with s on the diagonal, the
        highest power first.
        """
        hessian = [[_slope(p, name, at, 1) for name in names] for p in pulls]
        border = [[x / 2 for x in row] for row in rows(at)]
        free = len(names) - len(border)

        def bordered(s: int) -> mpf:
            matrix = [
                [h + (s if i == j else 0) for j, h in enumerate(row)] + [b[i] for b in border]
                for i, row in enumerate(hessian)
            ]
            return (-1) ** len(border) * _determinant(
                matrix + [[*b, *[mpf(0)] * len(border)] for b in border]
            )

        powers_of_s = mp.matrix(
            [[mpf(s) ** k for k in range(free, -1, -1)] for s in range(free + 1)]
        )
        return list(mp.lu_solve(powers_of_s, mp.matrix([bordered(s) for s in range(free + 1)])))[1:]

    return [*pulls, *halves], definite


# ---------------------------------------------------------------------------------------------------------- systems


def _of_system(model: Any, at: Numbers) -> Values:
    names = _unknowns(model)
    functions: list[Function] = [partial(value, tree) for tree in model.equations]
    energy = None
    if model.potential is not None:
        potential = partial(value, model.potential)
        energy = potential(at)
        functions = [
            partial(lambda name, there: _slope(potential, name, there, 0), name) for name in names
        ]
    return Values(
        residuals=[f(at) for f in functions],
        jacobian=[[_slope(f, name, at, 1) for name in names] for f in functions],
        energy=energy,
        conditions=[value(tree, at) for tree in model.inequalities],
        stability=[value(tree, at) for tree in model.stability],
    )


# --------------------------------------------------------------------------------------------------------- calculus


def _unknowns(model: Any) -> tuple[str, ...]:
    angles = [name for name, kind in model.unknowns.items() if kind.value == "angle"]
    return (*angles, *(name for name in model.unknowns if name not in angles))


def _slope(function: Function, name: str, at: Numbers, order: int) -> mpf:
    """The derivative by a name, by a difference; of what is a difference itself, of order 1."""
    step = mpf(_STEPS[order])
    there, here = ({**at, name: at[name] + sign * step} for sign in (1, -1))
    return (function(there) - function(here)) / (2 * step)


def _determinant(rows: Sequence[Sequence[mpf]]) -> mpf:
    return mp.det(mp.matrix([list(row) for row in rows])) if rows else mpf(1)


def _normal(rows: Sequence[Sequence[mpf]]) -> list[mpf]:
    """At right angles to all rows, one fewer than columns: what a last row is multiplied by in the
    determinant.
    """
    width = len(rows) + 1
    minors = [
        _determinant([[row[j] for j in kept] for row in rows])
        for kept in combinations(range(width), width - 1)
    ]
    return [m * (-1) ** k for k, m in enumerate(minors)][
        ::-1
    ]  # the first minor leaves out the last column
