"""The certified engine counts by whatever predicate a kind of count has: here heights in the place
of lengths.
"""

from __future__ import annotations

import random
from collections.abc import Iterator
from fractions import Fraction

import pytest
from support.replacing import replace

import ptmcad
from ptmcad.ask.solving import poses_at
from ptmcad.errors import ConfigError
from ptmcad.model import Mechanism
from ptmcad.question.config import load
from ptmcad.question.counts import KINDS, Count, Margin


def heights(mechanism: Mechanism) -> Iterator[Margin]:
    for name in mechanism.moving:
        yield Margin(f"the height of {name}", mechanism.points[name][1])


ENGINES = [
    ("fig4", "auto"), ("fig4", "exact"), ("horizontal", "exact"), ("three-cables", "auto"), ("four-bar", "auto"),
    ("four-bar-free", "auto"), ("forces", "exact"),
]  # fmt: skip


@pytest.mark.parametrize(("record", "engine"), ENGINES)
@pytest.mark.fast_cases("fig4-auto", "horizontal-exact", "four-bar-auto", "forces-exact")
def test_stable_equilibria_above_the_ground(
    record: str, engine: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The map's counts are those of poses at random points; either engine answers where it can."""
    kind = KINDS[Count.ADMISSIBLE]
    assert kind.predicate is not None
    raised = replace(kind.predicate, margins=heights, is_symmetric=False, needs_free_lengths=False)
    monkeypatch.setitem(KINDS, Count.ADMISSIBLE, replace(kind, predicate=raised))
    slice = load(record)
    accuracy = {} if engine == "exact" else {"tolerance": "1/10"}
    found = ptmcad.classify(slice, count="admissible", engine=engine, jobs=1, **accuracy)
    assert (found.cover is None) == (engine == "exact") and len(
        {region.admissible for region in found.regions}
    ) > 1
    mechanism = slice.model.whole
    assert mechanism is not None
    choose = random.Random(41)
    for _ in range(30):
        at = {
            axis.name: axis.low + (axis.high - axis.low) * Fraction(choose.randint(1, 999), 1000)
            for axis in slice.axes
        }
        place = found.locate(at)
        if place.admissible is None:
            continue
        values = {name: value.evaluate(*at.values()) for name, value in slice.parameters.items()}
        poses = [
            pose for pose in poses_at(slice.model, values, 12).equilibria if pose.stable is True
        ]
        high = [all(pose.nodes[name][1].low > 0 for name in mechanism.moving) for pose in poses]
        assert place.admissible == high.count(True), at
    if record == "four-bar":
        with pytest.raises(ConfigError, match="only the certified engine"):
            ptmcad.classify(slice, count="admissible", engine="exact")
