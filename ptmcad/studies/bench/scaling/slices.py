"""Slices whose variety has a given degree, or whose numbers have a given height, drawn from a seed.

Guarantee: over all sizes of one family the regions are the same in number, so that only what is named grows.

Why. A parameter p becomes p + q(x, y) with a polynomial q that has, on |x|, |y| <= 1, a modulus of at most `SHIFT` and
derivatives of at most n `SHIFT` < 1/3, n being its degree (its coefficients' moduli add up to `SHIFT`). So the plane is
only bent a little, and the window's edge meets the same curves in the same order. Numbers of more digits begin with
the digits of those of fewer.
"""

from __future__ import annotations

import random
from fractions import Fraction

from ptmcad.question.slice import Slice
from ptmcad.studies.bench.scaling.folds import with_parameters
from ptmcad.studies.slices import ptm_slice
from ptmcad.text.expressions import Expression, Term, axis

SHIFT = Fraction(1, 100)
MAX_COEFFICIENT = 9
"""Coefficients are drawn from -9 to 9 without 0, so no term is missing."""
DIGITS = 400
"""Most digits; they are 1, 3, 7 or 9, so that no decimal fraction can be shortened."""


def bend(n: int, seed: int) -> Expression:
    """A dense polynomial of total degree n whose coefficients' moduli add up to at most `SHIFT`."""
    source = random.Random(f"bend {n} {seed}")
    powers = [(i, j) for i in range(n + 1) for j in range(n + 1 - i)]
    scale = SHIFT / (MAX_COEFFICIENT * len(powers))
    terms: list[Term] = [(i, j, scale * source.choice((-1, 1)) * source.randint(1, MAX_COEFFICIENT)) for i, j in powers]
    return Expression(tuple(sorted(terms)))


def unloaded(n: int, seed: int) -> Slice:
    """No loads, rho = 1 + x, L2 = 1 + y + q(x, y): three curves, dense, of total degree n each; four regions."""
    ends = ("-9/10", "19/20")
    slice = ptm_slice(f"unloaded-{n}", {"x": ends, "y": ends}, L1=1, k=100, rho="1 + x", L2="1 + y")
    return with_parameters(slice, L2=1 + axis(1) + bend(n, seed))


def loaded(n: int, seed: int) -> Slice:
    """Equal bars and loads, F3 = F4 = -(1 + y + q(x, y)), k = 2, rho = 1/2 + x/3: two curves of total degree 6 n."""
    ends = ("-4/5", "4/5")
    slice = ptm_slice(f"loaded-{n}", {"x": ends, "y": ends}, L1=1, L2=1, k=2, rho="1/2 + x/3", F3="-1 - y", F4="-1 - y")
    force = -(1 + axis(1) + bend(n, seed))
    return with_parameters(slice, F3=force, F4=force)


def digits(n: int, seed: int) -> Slice:
    """Equal bars and loads as in the paper's figure 3, with numbers of about n digits for L, k and F/y."""
    source = random.Random(f"digits {seed}")
    length, stiffness, force = ("".join(source.choice("1379") for _ in range(DIGITS)) for _ in range(3))
    bar, load = f"1.00{length[:n]}", f"1.00{force[:n]}*F"
    axes = {"rho": (0, 2), "F": (-10, 0)}
    return ptm_slice(f"digits-{n}", axes, L1=bar, L2=bar, k=f"100.00{stiffness[:n]}", F3=load, F4=load)
