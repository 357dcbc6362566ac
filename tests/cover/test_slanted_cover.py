"""Covers with slanted pieces: exact sides, areas and components, against the checker's sweep and
plain arithmetic.
"""

from __future__ import annotations

import random
from fractions import Fraction
from itertools import pairwise

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support.examples import examples

from ptmcad.cover import components, union_area
from ptmcad.cover import tubeframes as tubes
from ptmcad.cover.connectivity import shown, stepped
from ptmcad.cover.rectangles import Cover, Patch, Tube
from ptmcad.cover.subdivision import FREE
from ptmcad.verification.certified.coversweep import sweep
from ptmcad.verification.certified.slantedframes import SlantedFrame
from ptmcad.verification.report import Violation

STEPS = 2**20


def value(tube: Tube, t: Fraction) -> Fraction:
    """By de Casteljau's rule."""
    row = [Fraction(c) for c in tube.controls]
    while len(row) > 1:
        row = [a + t * (b - a) for a, b in pairwise(row)]
    return row[0]


@st.composite
def patches(draw: st.DrawFn, frame: tuple[int, int, int, int]) -> Patch:
    """Of up to three tubes: they ascend or descend and pass the frame's sides, or stay inside."""
    along = draw(st.integers(0, 1))
    low, high = frame[2 - 2 * along], frame[3 - 2 * along]
    size, degree = high - low, draw(st.integers(1, 4))
    half = draw(st.integers(1, size // 40))
    steps = [draw(st.integers(1, size)) for _ in range(degree)]
    sign = draw(st.sampled_from((1, -1)))
    start = draw(st.integers(low - size // 4, high + size // 4))
    ascending = [start + sign * sum(steps[:k]) for k in range(degree + 1)]
    found = []
    for k in range(draw(st.integers(1, 3))):
        found.append(Tube(half, tuple(c + k * (2 * half + 1 + size // 20) for c in ascending)))
    return Patch(frame, along, tuple(found))


@st.composite
def covers(draw: st.DrawFn) -> Cover:
    """Frames and rectangles in some squares of a grid."""
    side = STEPS // 4
    frames, rectangles = [], []
    for i in range(4):
        for j in range(4):
            square = (i * side, (i + 1) * side, j * side, (j + 1) * side)
            kind = draw(st.integers(0, 3))
            if kind > 1:
                frames.append(draw(patches(square)))
            elif kind:
                rectangles.append(square)
    return Cover(STEPS, tuple(rectangles), tuple(sorted(frames)))


@settings(deadline=None, max_examples=examples(60))
@given(covers(), st.integers(0, 10**6))
def test_engine_and_checker_see_the_same_components(cover: Cover, seed: int) -> None:
    one, two = components(cover), sweep(cover)
    rng = random.Random(seed)
    label: dict[int, int] = {}
    for _ in range(60):
        u, v = (Fraction(rng.randrange(1, 7 * STEPS), 7) for _ in range(2))
        a, b = one.locate(u, v), two.locate(u, v)
        if a is None:
            continue  # or in a part too small to be one
        assert b is not None
        assert label.setdefault(a, b) == b
    assert len(set(label.values())) == len(label)
    slack = 8 * sum(p.frame[1] - p.frame[0] + p.frame[3] - p.frame[2] for p in cover.patches) + 1
    for a, b in label.items():
        assert one.areas[a] <= two.areas[b] <= one.areas[a] + slack
    assert sum(one.areas) + union_area(cover) == STEPS**2


@settings(deadline=None, max_examples=examples(60))
@given(patches((0, 3 * 2**10, 2**10, 2**12)), st.integers(0, 10**6))
def test_places_and_sides_agree_with_de_casteljau(patch: Patch, seed: int) -> None:
    assert not tubes.flaw(patch, STEPS)
    rng = random.Random(seed)
    (low, high), (bottom, top) = patch.ends, patch.heights
    for _ in range(20):
        u, v = (
            a + (b - a) * Fraction(rng.randrange(1, 1000), 1000)
            for a, b in ((low, high), (bottom, top))
        )
        t = (u - low) / (high - low)
        away = [v - value(tube, t) for tube in patch.tubes]
        within = any(abs(a) <= tube.half for a, tube in zip(away, patch.tubes, strict=True))
        expected = None if within else sum(a > 0 for a in away)
        assert tubes.place(patch, u, v) == expected
        assert SlantedFrame(patch, 0).place(u, v) == expected
    for end, height in ((0, bottom), (1, top)):
        pieces = tubes.side(patch, 1 - patch.along, end)
        assert pieces[0].low == low and pieces[-1].high == high
        for piece in pieces:
            if not piece.tube and piece.high > piece.low:
                for k in (1, 5, 9):
                    u = piece.low + (piece.high - piece.low) * Fraction(k, 10)
                    assert tubes.place(patch, u, Fraction(height)) == piece.number


@settings(deadline=None, max_examples=examples(60))
@given(patches((0, 3 * 2**10, 2**10, 2**12)))
def test_areas_of_parts_are_lower_bounds_and_near(patch: Patch) -> None:
    (low, high), (bottom, top) = patch.ends, patch.heights
    columns = 400
    for number, area in enumerate(tubes.part_areas(patch)):
        total = Fraction(0)
        for k in range(columns):
            t = Fraction(2 * k + 1, 2 * columns)
            floor = (
                Fraction(bottom)
                if number == 0
                else value(patch.tubes[number - 1], t) + patch.tubes[number - 1].half
            )
            roof = (
                Fraction(top)
                if number == len(patch.tubes)
                else value(patch.tubes[number], t) - patch.tubes[number].half
            )
            total += max(Fraction(0), min(roof, Fraction(top)) - max(floor, Fraction(bottom)))
        total *= Fraction(high - low, columns)
        assert abs(total - area) <= Fraction((top - bottom) * (high - low), 50)
        assert (
            area <= SlantedFrame(patch, 0).parts[number] <= area + 4 * (top - bottom + high - low)
        )


def test_a_tube_from_side_to_side_parts_the_window_and_drawn_steps_cover_it() -> None:
    tube = Tube(3, (10, 400, 900))
    cover = Cover(1024, (), (Patch((0, 1024, 0, 1024), 0, (tube,)),))
    found = components(cover)
    assert len(found.areas) == 2
    # the integral of the center is the mean of its controls, times the width
    assert found.areas[1] == 1024 * (10 + 400 + 900) // 3 - 3 * 1024
    assert sum(found.areas) + sum(found.cluster_areas) == 1024**2
    assert found.locate(Fraction(512), value(tube, Fraction(1, 2))) is None
    drawn = shown(found)
    free = drawn.subdivision.state == FREE
    assert set(drawn.owner[free].tolist()) == {0, 1}
    steps = components(stepped(cover))
    for x in range(5, 1024, 97):
        v = value(tube, Fraction(x, 1024))
        assert all(steps.locate(Fraction(x), v + d) is None for d in (-3, 0, 3))


def test_a_long_tube_is_drawn_in_more_steps() -> None:
    """Of two tubes with the same slope, one over half of the window, what is drawn is beyond them
    by about as much.
    """
    half, quarter, short = 2**19, 2**18, 2**12
    long = Patch((0, half, 0, half), 0, (Tube(5, (10, half - 10)),))
    other = Patch(
        (half + quarter, half + quarter + short, 0, short), 0, (Tube(5, (10, short - 10)),)
    )
    beyond = []
    for patch in (long, other):
        drawn = shown(components(Cover(STEPS, (), (patch,))))
        free = drawn.subdivision.bounds[drawn.subdivision.state == FREE]
        covered = STEPS**2 - sum((b - a) * (d - c) for a, b, c, d in free.tolist())
        beyond.append(covered / (patch.frame[1] - patch.frame[0]) - 10)
    assert beyond[1] < 0.05 * short
    assert (
        beyond[0] < 8 * beyond[1]
    )  # with as many steps for each tube it would be 128 times as much


@pytest.mark.parametrize(
    ("patch", "what"),
    [
        (Patch((0, 8, 0, 8), 0, (Tube(1, (2, 12, 2)),)), "neither stays"),
        (Patch((0, 8, 0, 8), 0, (Tube(1, (2, 2)), Tube(1, (5, 3)))), "ascending and disjoint"),
        (Patch((0, 8, 0, 8), 0, (Tube(0, (2, 3)),)), "half width"),
        (Patch((0, 8, 0, 8), 0, ()), "no tubes"),
        (Patch((0, 99, 0, 8), 0, (Tube(1, (2, 3)),)), "not a rectangle"),
    ],
)
def test_what_is_no_patch_is_refused(patch: Patch, what: str) -> None:
    with pytest.raises(ValueError, match=what):
        components(Cover(16, (), (patch,)))


def test_a_tube_that_turns_outside_of_its_frame_would_part_it_in_three() -> None:
    """Without the condition that tubes ascend, descend or stay inside, the lower part is not
    connected.
    """
    patch = Patch((0, 64, 16, 64), 0, (Tube(1, (40, -40, 40)),))
    assert (
        tubes.place(patch, Fraction(1), Fraction(17))
        == 0
        == tubes.place(patch, Fraction(63), Fraction(17))
    )
    assert tubes.place(patch, Fraction(32), Fraction(17)) == 1
    with pytest.raises(ValueError, match="neither stays"):
        components(Cover(64, (), (patch,)))
    with pytest.raises(Violation, match="turns back"):
        sweep(Cover(64, (), (patch,)))


def test_frames_that_overlap_are_refused() -> None:
    tube = Tube(1, (2, 3))
    for cover in (
        Cover(16, (), (Patch((0, 8, 0, 8), 0, (tube,)), Patch((4, 12, 0, 8), 0, (tube,)))),
        Cover(16, ((4, 12, 0, 8),), (Patch((0, 8, 0, 8), 0, (tube,)),)),
    ):
        with pytest.raises(ValueError, match="meets another one, or a rectangle"):
            components(cover)
        with pytest.raises(Violation, match="meets"):
            sweep(cover)
