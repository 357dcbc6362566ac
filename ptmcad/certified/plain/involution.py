"""Involutions of a problem's unknowns that leave its solutions as they are: exchanges, signs and half turns.

Guarantee: each `Involution` that is found maps solutions to solutions, stable ones to stable ones, at every point of
the slice: identities of polynomials over Q(x, y), decided exactly. None is found that a parameter would have to follow.

With q'_k = sign_k q_image(k) + half_k pi an energy V is kept where its slopes have f_k(q') = sign_k f_image(k)(q), and
the springs with a free length are the same ones in another order.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import permutations, product

from ptmcad.certified.plain.problem import Problem
from ptmcad.certified.plain.trigonometric import TrigonometricPolynomial
from ptmcad.text.expressions import Expression


@dataclass(frozen=True, slots=True)
class Involution:
    """What becomes of the unknowns, by number.

    Attributes
    ----------
    images : which unknown comes to each one's place.
    signs : 1 or -1.
    halves : half turns that are added, 0 or 1; none to unknowns on the line.
    """

    images: tuple[int, ...]
    signs: tuple[int, ...]
    halves: tuple[int, ...]

    @property
    def odd(self) -> int:
        """How many unknowns are odd, in coordinates of which the others are kept."""
        return sum(j > k or (j == k and s < 0) for k, (j, s) in enumerate(zip(self.images, self.signs, strict=True)))

    def of(self, f: TrigonometricPolynomial) -> TrigonometricPolynomial:
        """The polynomial's values at the images."""
        return f.moved(self.images, self.signs, self.halves)


def involution_of(problem: Problem) -> Involution | None:
    """One with as many odd unknowns as there is, if there is any; it has fixed points.

    None, too, in half angles, and where springs are pushes.
    """
    if problem.pushes or problem.covering:
        return None
    found = [each for each in _candidates(problem) if is_symmetry(problem, each)]
    return max(found, key=lambda each: each.odd, default=None)


def is_symmetry(problem: Problem, change: Involution) -> bool:
    """Whether the problem, which has an energy, is proved to be kept."""
    for k, f in enumerate(problem.equations):
        if _differ(change.of(f), problem.equations[change.images[k]], change.signs[k]):
            return False
    springs = [(cone.pull, square_of(cone.difference)) for cone in problem.cones]
    conditions = [c.value for c in (*problem.inequalities, *problem.stability)]
    return _same(springs, [(pull, change.of(f)) for pull, f in springs]) and _same(
        [(None, f) for f in conditions], [(None, change.of(f)) for f in conditions]
    )


def square_of(vector: tuple[TrigonometricPolynomial, TrigonometricPolynomial]) -> TrigonometricPolynomial:
    """The squared length."""
    x, y = vector
    return x * x + y * y


def _candidates(problem: Problem) -> Iterator[Involution]:
    is_angle = [name not in problem.reals for name in problem.unknowns]
    size = range(len(is_angle))
    for images in permutations(size):
        if any(images[images[k]] != k or is_angle[images[k]] != is_angle[k] for k in size):
            continue
        # of two that are exchanged the first one's sign and half turn are the other one's, too
        own = [k for k in size if images[k] >= k]
        choices = [_choices(is_angle[k], images[k] == k) for k in own]
        for chosen in product(*choices):
            known = dict(zip(own, chosen, strict=True))
            pairs = [known[min(k, images[k])] for k in size]
            found = Involution(images, tuple(s for s, _ in pairs), tuple(h for _, h in pairs))
            if found.odd:
                yield found


def _choices(is_angle: bool, alone: bool) -> list[tuple[int, int]]:
    """Signs and half turns; one angle that only turns by half a turn is fixed nowhere."""
    return [(s, h) for s in (1, -1) for h in (0, 1) if not (h and (not is_angle or (alone and s > 0)))]


def _differ(f: TrigonometricPolynomial, g: TrigonometricPolynomial, sign: int) -> bool:
    return bool((f - g if sign > 0 else f + g).terms)


_Weighed = tuple[Expression | None, TrigonometricPolynomial]


def _same(some: Iterable[_Weighed], others: Iterable[_Weighed]) -> bool:
    """Whether the same polynomials, each with its weight, are in both lists."""

    def counted(pairs: Iterable[_Weighed]) -> Counter[tuple[Expression | None, frozenset[object]]]:
        return Counter((weight, frozenset(f.terms.items())) for weight, f in pairs)

    return counted(some) == counted(others)
