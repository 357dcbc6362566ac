"""Covers of all kinds, drawn: rectangles that touch, overlap and enclose, and windows' edges."""

from __future__ import annotations

from hypothesis import strategies as st

from ptmcad.cover.rectangles import Cover, Rectangle


@st.composite
def rectangles(draw: st.DrawFn, steps: int) -> Rectangle:
    """Short ones mostly, so that they leave something open between them."""
    left, bottom = draw(st.integers(0, steps - 1)), draw(st.integers(0, steps - 1))
    width, tall = (
        draw(st.integers(1, max(1, steps // draw(st.sampled_from((1, 2, 4)))))) for _ in range(2)
    )
    return left, min(left + width, steps), bottom, min(bottom + tall, steps)


@st.composite
def covers(draw: st.DrawFn) -> Cover:
    """Up to 14 rectangles on a lattice of up to 16 steps."""
    steps = 2 ** draw(st.integers(0, 4))
    return Cover(steps, tuple(sorted(set(draw(st.lists(rectangles(steps), max_size=14))))))
