"""What a description of a mechanism has to satisfy and no single entry shows: rigid bars, no loose
unknown, symmetries, and loops that are computed.

Guarantee: exact; decided by identities of polynomials. A bar is accepted only when its length was
proved constant, a symmetry only when it was proved to be one; an unknown is refused only when its
equation was proved to vanish identically.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from fractions import Fraction

from ptmcad.errors import ConfigError, ExpressionError, Faults
from ptmcad.model.description import Mechanism, Model
from ptmcad.model.elements import squared_distance
from ptmcad.model.evaluate import multiples, value_at
from ptmcad.model.identities import Points, Polynomial
from ptmcad.model.trees import ZERO
from ptmcad.text.tree import Name, names_of

MAX_BORDERED = 8
"""Rows of the bordered matrix of closed loops with several degrees of freedom: the number of terms
of its minors grows with the factorial."""


def check_bars(mechanism: Mechanism, faults: Faults) -> None:
    """Note each bar whose length varies, or is too large an expression."""
    points = Points(mechanism)
    rigid = {bar for joint in mechanism.xjoints for bar in joint.rigid}
    for n, (start, end) in enumerate(mechanism.bars, 1):
        key = f"bars.{n}"
        if (start, end) in rigid:
            continue  # by the joint's own formulas
        with faults:
            try:
                squared = points.squared(start, end)
                loose = [
                    u
                    for u in (*mechanism.unknowns, *mechanism.followers)
                    if squared.derivative(u).terms
                ]
            except ExpressionError as error:
                raise ConfigError(
                    f"it is not proved that its length is constant: {error.message}", key=key
                ) from None
            if loose:
                raise ConfigError(
                    f"the length of {start}{end} is not constant, it varies with {' and '.join(loose)}: a bar is "
                    "rigid; leave it out, or make it a spring",
                    key=key,
                )


def check_elements(mechanism: Mechanism, faults: Faults) -> None:
    """Note each spring whose length or angle no unknown changes."""
    points = Points(mechanism)
    closing = [
        frozenset(names_of(squared_distance(bar.start, bar.end))) for bar in mechanism.closing
    ]
    for key, element in mechanism.elements.items():
        varying = element.varying
        if (
            varying is not None
            and frozenset(names_of(varying)) not in closing
            and points.varies(varying)
        ):
            continue
        with faults:
            if element.idle:
                raise ConfigError(element.idle, key=key)


def check_numbers(model: Model, faults: Faults) -> None:
    """Note each stiffness or length that is a number, and one that makes no sense."""
    for part in model.parts:
        if names_of(part.tree):
            continue  # it has a value in the window of a slice only
        with faults:
            if problem := part.fault(value_at(part.tree, {})):
                raise ConfigError(problem, key=part.key)


def check_unknowns(mechanism: Mechanism, faults: Faults) -> None:
    """Note each unknown whose equation vanishes identically: nothing holds it."""
    held: set[str] = set()
    try:
        held = _held(mechanism)
    except ExpressionError:
        return  # the engines find out
    for unknown, kind in mechanism.unknowns.items():
        with faults:
            if unknown not in held:
                motion = "turns" if kind.turns else "moves"
                raise ConfigError(
                    f"no equation holds this unknown: no spring or load feels how it {motion}",
                    key=f"unknowns.{unknown}",
                )


def _held(mechanism: Mechanism) -> set[str]:
    """The unknowns whose equations do not vanish identically."""
    points = Points(mechanism)
    energy, roots, work = _felt(points)
    held = {unknown for unknown, moment in work.items() if moment.terms}
    # a root does not cancel against the rest
    lengths = [squared for _, squared in roots]
    lengths += [points.squared(bar.start, bar.end) for bar in mechanism.closing]
    held.update(u for u in mechanism.unknowns for p in (energy, *lengths) if p.derivative(u).terms)
    return held | {
        first for second, first in mechanism.followers.items() if energy.derivative(second).terms
    }


def check_symmetries(mechanism: Mechanism, faults: Faults) -> None:
    """Note each substitution that is not proved to leave the equilibria as they are."""
    for n, images in enumerate(mechanism.symmetries, 1):
        key = f"symmetries.{n}"
        with faults:
            try:
                here, there = _felt(Points(mechanism)), _felt(Points(mechanism, images=images))
                change = here[0] - there[0]
                holds = here[1:] == there[1:] and not any(
                    change.derivative(u).terms for u in mechanism.unknowns
                )
            except ExpressionError as error:
                raise ConfigError(
                    f"it is not proved to be a symmetry: {error.message}", key=key
                ) from None
            if not holds:
                raise ConfigError(
                    "this is no symmetry: with these substitutions the energy changes by something that varies with an "
                    "unknown, or the moments do other work; leave it out, or mend it",
                    key=key,
                )


Felt = tuple[Polynomial, Counter[tuple[Polynomial, Polynomial]], dict[str, Polynomial]]
"""The energy's polynomial part, its roots (pull, squared length), and the moments' work along each
unknown. Equilibria are the same where these are, but for numbers in the energy."""


def _felt(points: Points) -> Felt:
    """What unknowns feel in a mechanism."""
    mechanism, zero = points.mechanism, points.ring.constant(Fraction(0))
    energy, roots = zero, Counter[tuple[Polynomial, Polynomial]]()
    for element in mechanism.elements.values():
        *energies, pull, squared = points.values(
            (*element.energies, *(element.root or (ZERO, ZERO)))
        )
        energy = sum(energies, energy)
        if pull.terms:
            roots[pull, squared] += 1
    work = dict.fromkeys(mechanism.unknowns, zero)
    for own, value in mechanism.work.items():
        for unknown, c in multiples(points.images.get(own, Name(own))).items():
            if unknown in work:
                work[unknown] += points.value(value) * points.ring.constant(c)
    return energy, roots, work


def check_loops(mechanism: Mechanism, faults: Faults) -> None:
    """Note what is not computed with closed loops, or with X-joints, by its key."""
    roots = [
        f"{key}.free" for key, element in mechanism.elements.items() if element.root is not None
    ]
    of_loops = _limits_of_loops(mechanism, roots) if mechanism.closing else ()
    of_xjoints = _limits_of_xjoints(mechanism, roots) if mechanism.xjoints else ()
    for key, problem in (*of_loops, *of_xjoints):
        with faults:
            raise ConfigError(problem, key=key)


def _limits_of_loops(mechanism: Mechanism, roots: Sequence[str]) -> Iterator[tuple[str, str]]:
    """What is not computed with closed loops: keys and problems."""
    count, bars = len(mechanism.unknowns), len(mechanism.closing)
    free = count - bars
    if free < 1:
        yield (
            "closing",
            "no degree of freedom is left: there have to be more unknowns than closing bars",
        )
    if free > 1 and mechanism.coupled:
        yield (
            "moments",
            "a moment depends on another unknown than its own: then closed loops are computed where they leave one "
            f"degree of freedom, not {free}",
        )
    for key in roots if free > 1 else ():
        yield (
            key,
            f"free lengths in closed loops are computed where these leave one degree of freedom, not {free}",
        )
    if mechanism.symmetries:
        yield "symmetries", "symmetries are not used in closed loops: leave them out"
    taken = {*mechanism.parameters, *mechanism.unknowns}
    for name in mechanism.force_densities:
        if name in taken:
            yield (
                "closing",
                f"'{name}' is the name of a closing bar's force density: choose another name",
            )
    if free > 1 and count + bars > MAX_BORDERED:
        yield (
            "closing",
            f"{count} unknowns and {bars} closing bars: with several degrees of freedom left they may be "
            f"{MAX_BORDERED} in all",
        )


def _limits_of_xjoints(mechanism: Mechanism, roots: Sequence[str]) -> Iterator[tuple[str, str]]:
    """The same with X-joints."""
    if mechanism.closing:
        yield "closing", "closing bars beside x-joints are not computed yet"
    if mechanism.symmetries:
        yield "symmetries", "symmetries are not used with x-joints: leave them out"
    if mechanism.coupled:
        yield "moments", "a moment beside x-joints depends on no unknown but its own"
    for key in roots:
        yield key, "free lengths are not computed with x-joints yet"


def check_closing(mechanism: Mechanism, faults: Faults) -> None:
    """Note each closing bar between points whose distance no unknown changes, and one that is
    listed twice.
    """
    points = Points(mechanism)
    known: dict[frozenset[str], int] = {}
    for n, closing in enumerate(mechanism.closing, 1):
        with faults:
            first = known.setdefault(frozenset((closing.start, closing.end)), n)
            if first < n:
                raise ConfigError(
                    f"number {first} is a bar between the same points", key=f"closing.{n}.between"
                )
            if not points.varies(squared_distance(closing.start, closing.end)):
                raise ConfigError(
                    f"the distance of {closing.start} and {closing.end} is constant, so that a bar between them closes "
                    "no loop",
                    key=f"closing.{n}.between",
                )
