"""Slices on which the mechanism is its own mirror image: its energy in coordinates that are regular on the mirror.

Guarantee: `is_own_image` says True only where exchanging th1 and th2 leaves the potential as it is, at every point of
the slice; `opening` has the derivatives of that potential. Loads neither numpy nor numba.

With s = (th1 + th2)/2, d = (th1 - th2)/2 and w = cos d such a potential is a function u(s, w), smooth also where w = 1,
as the distance from the mirror th1 = th2 goes into it by its square only. In th1 and th2 the Jacobian of E1, E2 and D
loses rank where a pair of equilibria leaves the mirror; that of the derivatives of u does not.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from ptmcad.certified.formula import Formula, inverse_length
from ptmcad.certified.ptm.statics import Statics
from ptmcad.question.slice import Slice
from ptmcad.text.expressions import constant

PAIRS = (("L1", "L2"), ("k1", "k2"), ("l0_1", "l0_2"), ("F3", "F4"))
"""Parameters that the mirror exchanges; it also exchanges F3x and -F4x."""


class Opening(NamedTuple):
    """The derivatives du/dw and d2u/dw2 at constant s.

    By d they are U_d = -sin d u_w and U_dd = sin^2 d u_ww - cos d u_w.
    """

    slope: Formula
    curvature: Formula


def is_own_image(slice: Slice) -> bool:
    """Whether the mirror leaves the mechanism as it is, everywhere on the slice; it has a load and a base.

    Expressions that are equal but were not reduced to the same form do not count as equal.
    """
    zero = constant(0)
    at = {name: slice.parameters.get(name, zero) for name in slice.model.variables}
    loaded = any(at[name].numerator for name in slice.model.forces)
    equal = all(at[name] == at[image] for name, image in PAIRS) and at["F3x"] == -at["F4x"]
    return equal and loaded and bool(at["rho"].numerator)


def opening(values: Mapping[str, Formula], m: Statics, s: Formula, w: Formula) -> Opening:
    """For parameters of a slice that is its own mirror image.

    Parameters
    ----------
    m : the mechanism at th1 = s + d, th2 = s - d.
    w : cos d.
    """
    rho, bar, pull1, pull3 = values["rho"], values["L1"], *(values[f"k{n}"] * values[f"l0_{n}"] for n in (1, 3))
    # l1^2 + l2^2 = 2 mean - 2 lever w and l3^2 = rho^2 + 4 L^2 cos^2 s - 2 lever w
    reach, mean = 2 * (rho * bar), rho.squared() + bar.squared()
    lever = reach * s.cos()
    load = 2 * (bar * (values["F3"] * s.sin() + values["F3x"] * s.cos()))
    slope, curvature = -((values["k1"] + values["k3"]) * lever) - load, s.graph.constant(0)
    if pull1.value != 0:
        # (l1 l2)^2 = mean^2 - 2 mean lever w + reach^2 (cos^2 s + w^2 - 1), and l1 + l2 is the root of a sum
        l1, l2, _ = m.lengths
        product, total = l1 * l2, l1 + l2
        product_w = reach * (reach * w - mean * s.cos()) / product
        total_w = (product_w - lever) / total
        product_ww = (reach.squared() - product_w.squared()) / product
        slope = slope - pull1 * total_w
        curvature = curvature - pull1 * ((product_ww - total_w.squared()) / total)
    if pull3.value != 0:
        inverse = inverse_length(*m.vectors[2])
        slope = slope + pull3 * (lever * inverse)
        curvature = curvature + pull3 * (lever.squared() * (inverse * inverse.squared()))
    return Opening(slope, curvature)
