"""One real root of a polynomial, by its number among those between two heights.

Guarantee: the ball that is returned contains that root and, if precision allows, is about as narrow
as it allows.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, lru_cache

from flint import arb, arb_poly, ctx, fmpq, fmpz_poly

from ptmcad.verification.sturm import changes_of


def numbered_root(p: fmpz_poly, low: fmpq, high: fmpq, number: int) -> arb | None:
    """A root in the open interval (low, high), by its number from below; None where there are not
    so many.
    """
    # halving a window would take one step for each doubling of it
    bound = _bound(p)
    low, high = max(low, -bound), min(high, bound)
    if low >= high:
        return None
    changes = _changes_of(tuple(int(c) for c in p.coeffs()))
    first, last = changes(low), changes(high) + (p(high) == 0)
    wanted = first - number  # changes below the root, one less above it
    if wanted <= last:
        return None
    while True:
        if first == wanted == last + 1:
            # where an end is a root, too, signs do not tell on which side of a number the wanted
            # one is
            found = (
                _alone(p, low, high)
                if p(low) * p(high) < 0
                else _refined(p, arb(low).union(arb(high)))
            )
            if found is not None:
                return found
        middle = (low + high) / 2
        beyond = changes(middle)
        if beyond >= wanted:
            low, first = middle, beyond
        elif beyond == wanted - 1 and p(middle) == 0:
            return arb(middle)
        else:
            high, last = middle, beyond + (p(middle) == 0)


@lru_cache(maxsize=64)
def _changes_of(coefficients: tuple[int, ...]) -> Callable[[fmpq], int]:
    """`changes_of`, for walls over the same abscissa, whose roots are told apart at the same
    heights.
    """
    return cache(changes_of(fmpz_poly(list(coefficients))))


def _bound(p: fmpz_poly) -> fmpq:
    """A power of two beyond all roots: twice the greatest |c_(n-k) / c_n|^(1/k) or more (Fujiwara)."""
    *rest, leading = (int(c).bit_length() for c in p.coeffs())
    # of bit lengths, each the logarithm rounded up or one more than it
    exponents = [-(-(bits - leading + 1) // k) for k, bits in enumerate(reversed(rest), 1) if bits]
    return fmpq(2) ** (max(exponents) + 2) if exponents else fmpq(1)


def _alone(p: fmpz_poly, low: fmpq, high: fmpq) -> arb:
    """The only root in the open interval (low, high), at whose ends the signs differ."""
    sign = p(high)
    while (height := _refined(p, arb(low).union(arb(high)))) is None:
        middle = (low + high) / 2
        value = p(middle)
        if value == 0:
            return arb(middle)
        if (value > 0) == (sign > 0):
            high = middle
        else:
            low = middle
    return height


def _refined(p: fmpz_poly, root: arb) -> arb | None:
    """A ball for the only root of p in a given one, narrowed by interval Newton steps as far as
    precision allows.

    None where the given one is so wide that the first step does not narrow it much.
    """
    value, slope = arb_poly(p), arb_poly(p.derivative())
    first = True
    while True:
        middle = root.mid()
        steepness = slope(root)
        if steepness.contains(0):
            return None if first and root.rel_accuracy_bits() < ctx.prec // 2 else root
        closer = (middle - value(middle) / steepness).intersection(root)
        if not closer.rad() * 4 < root.rad():
            return None if first and root.rel_accuracy_bits() < ctx.prec // 2 else closer
        root, first = closer, False
