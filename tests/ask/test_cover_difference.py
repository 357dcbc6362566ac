"""Two certified maps compared, against one place in each square of their lattices: neither count
changes within one.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from support.certified_maps import certified, circle
from support.examples import examples
from support.maps import part_of_free02, shipped
from support.replacing import replace

from ptmcad.answer.comparison import Comparison
from ptmcad.answer.regionmap import RegionMap
from ptmcad.cli import run
from ptmcad.cover.rectangles import Cover
from ptmcad.errors import ConfigError

Label = Callable[[Fraction, Fraction], int | None]
"""The count at a point of the unit square; None where it is undetermined."""


def covered(cover: Cover, x: Fraction, y: Fraction) -> bool:
    u, v = x * cover.steps, y * cover.steps
    return any(
        left <= u <= right and bottom <= v <= top for left, right, bottom, top in cover.rectangles
    )


def sampled(first: Label, second: Label, steps: int) -> Counter[tuple[int | None, int | None]]:
    """How many squares of a lattice have each pair of counts in their middles."""
    middles = [Fraction(2 * k + 1, 2 * steps) for k in range(steps)]
    return Counter((first(x, y), second(x, y)) for x in middles for y in middles)


def check(
    found: Comparison, pairs: Counter[tuple[int | None, int | None]], square: Fraction
) -> None:
    """Areas are what the squares of these pairs have."""

    def area(*wanted: set[int | None]) -> Fraction:
        return square * sum(
            n for pair, n in pairs.items() if all(v in w for v, w in zip(pair, wanted, strict=True))
        )

    known = {v for pair in pairs for v in pair if v is not None}
    certain = {(a, b): area({a}, {b}) for a in known for b in known if a != b}
    changes = {
        (found.first.regions[c.before].stable, found.second.regions[c.after].stable): c.area
        for c in found.changes
    }
    assert set(changes) == {pair for pair, value in certain.items() if value}
    for (a, b), (low, high) in changes.items():
        assert a is not None and b is not None
        assert (low, high) == (certain[a, b], area({a, None}, {b, None}))
    undetermined = square * sum(n for pair, n in pairs.items() if None in pair)
    assert found.undetermined == undetermined
    assert found.area == (sum(certain.values()), sum(certain.values()) + undetermined)


SIDE = 8
RECTANGLES = st.lists(
    st.tuples(*[st.tuples(st.integers(0, SIDE - 1), st.integers(1, 3)) for _ in range(2)]),
    min_size=0,
    max_size=7,
)


def random_cover(boxes: list[tuple[tuple[int, int], tuple[int, int]]], steps: int) -> Cover:
    sides = [(min(x, steps - 1), min(y, steps - 1), w, h) for (x, w), (y, h) in boxes]
    return Cover(
        steps, tuple(sorted({(x, min(x + w, steps), y, min(y + h, steps)) for x, y, w, h in sides}))
    )


def flooded(cover: Cover) -> dict[tuple[int, int], int]:
    """The squares outside a cover, and the number of the part of the window that each is in, from
    left and below.
    """
    middles = {(x, y): (Fraction(2 * x + 1, 2), Fraction(2 * y + 1, 2)) for x in range(cover.steps)
               for y in range(cover.steps)}  # fmt: skip
    free = {
        k for k, (x, y) in middles.items() if not covered(cover, x / cover.steps, y / cover.steps)
    }
    number: dict[tuple[int, int], int] = {}
    for start in sorted(free):
        if start in number:
            continue
        part, waiting = len(set(number.values())), [start]
        while waiting:
            x, y = waiting.pop()
            if (x, y) in free and (x, y) not in number:
                number[x, y] = part
                waiting += [(x + 1, y), (x - 1, y), (x, y + 1), (x, y - 1)]
    return number


def random_map(cover: Cover) -> tuple[RegionMap, Label]:
    """Parts with counts by turns, of which the smallest is without a count where there are several."""
    parts = flooded(cover)

    def count(x: float, y: float) -> int:
        return parts[int(x * cover.steps), int(y * cover.steps)] % 3

    result = certified(cover, count)
    left_out = None
    if len(result.cells) > 1:
        x, y = (float(v) / 2 for v in (result.cells[-1].sample[0], result.cells[-1].sample[1]))
        left_out = parts[int(x * cover.steps), int(y * cover.steps)]
        result = replace(result, cells=result.cells[:-1], regions=result.regions[:-1])

    def label(x: Fraction, y: Fraction) -> int | None:
        part = parts.get((int(x * cover.steps), int(y * cover.steps)))
        return None if part is None or part == left_out else part % 3

    return result, label


@given(RECTANGLES, RECTANGLES)
@settings(max_examples=examples(60), deadline=None)
def test_any_covers_of_two_lattices(
    one: list[tuple[tuple[int, int], tuple[int, int]]],
    other: list[tuple[tuple[int, int], tuple[int, int]]],
) -> None:
    covers = random_cover(one, SIDE // 2), random_cover(other, SIDE)
    assume(all(flooded(cover) for cover in covers))  # something is outside each of them
    (first, before), (second, after) = map(random_map, covers)
    check(first.compare(second), sampled(before, after, SIDE), Fraction(4, SIDE**2))


def test_what_cannot_be_compared_is_said() -> None:
    with pytest.raises(ConfigError, match="one map is exact and the other certified"):
        shipped("fig4").compare(circle(5))
    with pytest.raises(ConfigError, match="not the same axes"):
        part_of_free02().compare(circle(5))
    own = circle(5)
    metres, feet = (
        replace(own, slice=replace(own.slice, units={"length": unit})) for unit in ("m", "ft")
    )
    with pytest.raises(ConfigError, match="not the same units"):
        metres.compare(feet)
    assert metres.compare(own).changes == ()


def test_the_damaged_file_is_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    whole = circle(5)
    # the sample of the inner region is put into the outer one
    outer = next(c for c in whole.cells if c.stable == 2)
    damaged = replace(whole, cells=tuple(replace(c, sample=outer.sample) for c in whole.cells))
    files = {"whole": whole, "damaged": damaged}
    for name, result in files.items():
        (tmp_path / f"{name}.json").write_text(result.to_json())
    (tmp_path / "cut.json").write_text(whole.to_json()[:-100])
    for other, reason in (("damaged", "contradicts itself"), ("cut", "damaged")):
        for pair in (("whole", other), (other, "whole")):
            one, two = (str(tmp_path / f"{name}.json") for name in pair)
            assert run(["plot", one, "--compare", two]) == 2
            said = capsys.readouterr().err
            assert f"{other}.json" in said and "whole.json" not in said and reason in said
