"""Slices of the paper's mechanism for studies, from exact numbers or text of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction

from ptmcad.question.config import slice_from_mapping
from ptmcad.question.slice import Slice

Exact = int | str | Fraction
"""An exact number; in a parameter's place also an expression in the axes."""


def ptm_slice(name: str, axes: Mapping[str, Sequence[Exact]], **parameters: Exact) -> Slice:
    """The slice with these windows and parameters."""
    window = {axis: [str(end) for end in ends] for axis, ends in axes.items()}
    values = {key: str(value) for key, value in parameters.items()}
    return slice_from_mapping({"name": name, "mechanism": "ptm", "parameters": values, "axes": window})
