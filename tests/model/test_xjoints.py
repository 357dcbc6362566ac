"""X-joints: their geometry, two derivations, counts by other ways, and what is refused."""

from __future__ import annotations

import json
from fractions import Fraction
from pathlib import Path
from random import Random
from typing import Any

import pytest
import yaml
from support.cases import cases

import ptmcad
from ptmcad.errors import ConfigError
from ptmcad.model.crossed import second_bar

CONFIGS = Path(__file__).resolve().parents[2] / "configs" / "mechanisms"


def description(name: str) -> dict[str, Any]:
    return dict(yaml.safe_load((CONFIGS / f"{name}.yaml").read_text(encoding="utf-8"))["mechanism"])


ONE = description("x-joint")


def rational_circle(t: Fraction) -> tuple[Fraction, Fraction]:
    return (1 - t * t) / (1 + t * t), 2 * t / (1 + t * t)


def test_the_second_bar_is_the_first_one_reflected() -> None:
    """In the bisector of A1 B1, which takes A0 to B0: so the bars stay crossed, and the top is as
    long as the base.
    """
    random = Random(3)
    for _ in range(20):
        b = Fraction(random.randrange(1, 20), 7)
        far = b + Fraction(random.randrange(1, 20), 5)
        c, s = rational_circle(Fraction(random.randrange(-30, 30), 11))
        cosine, sine, below = second_bar(far, b, c, s)
        cosine, sine = cosine / below, sine / below
        end = (far * c, far * s)  # B1, with A0 = 0 and A1 = (b, 0)
        across = (end[0] - b, end[1])
        step = (far * far - b * b) / (across[0] ** 2 + across[1] ** 2)
        assert (b + far * cosine, far * sine) == (step * across[0], step * across[1])
        assert (end[0] - b - far * cosine) ** 2 + (end[1] - far * sine) ** 2 == b * b
        assert cosine**2 + sine**2 == 1


def test_a_map_is_stored_with_its_joint_and_verified() -> None:
    found = ptmcad.classify(
        {"mechanism": ONE, "axes": {"F": [-1, 1], "b": ["1/2", 1]}, "parameters": {"G": "1/3"}}
    )
    document = json.loads(found.to_json())
    assert document["slice"]["mechanism"]["x-joint"] == ONE["x-joint"]
    again = ptmcad.RegionMap.from_json(found.to_json())
    assert again == found
    assert ptmcad.verify(again).ok


@pytest.mark.parametrize(
    ("change", "key", "said"),
    cases("xjoints", "faults"),
)
def test_what_is_wrong_is_told_by_its_key(change: dict[str, Any], key: str, said: str) -> None:
    joint = {
        **ONE["x-joint"]["X"],
        **{k: v for k, v in change.items() if k not in ("mechanism", "x-joint")},
    }
    numbers = (
        {"parameters": {**ONE["parameters"], "b": {"default": 1}}}
        if "base" in change or "bars" in change
        else {}
    )
    points = {"points": {"A": [0, 0], "B": [1, 0]}} if numbers else {}
    record = {**ONE, **numbers, **points, "x-joint": {"X": joint}, **change.get("mechanism", {})}
    if "x-joint" in change:
        record["x-joint"] = change["x-joint"]
    with pytest.raises(ConfigError) as caught:
        ptmcad.Mechanism(record)
    wrong = [fault for fault in caught.value.faults if (fault.key or "").endswith(key)]
    assert any(said in fault.message for fault in wrong), [
        (f.key, f.message) for f in caught.value.faults
    ]


@pytest.mark.parametrize(
    ("change", "key"),
    cases("xjoints", "single faults"),
)
def test_one_fault_of_a_joint_is_told_alone(change: dict[str, Any], key: str) -> None:
    """Springs and loads that name the points of its top are not to blame."""
    joint = {k: v for k, v in {**ONE["x-joint"]["X"], **change}.items() if v is not None}
    with pytest.raises(ConfigError) as caught:
        ptmcad.Mechanism({**ONE, "x-joint": {"X": joint}})
    assert [fault.key for fault in caught.value.faults] == [f"mechanism.x-joint.X.{key}"]


def test_bars_are_not_as_long_as_the_base_all_over_the_window() -> None:
    with pytest.raises(
        ConfigError, match=r"x-joint.X.bars: a length must be positive in the whole window"
    ):
        ptmcad.classify({"mechanism": ONE, "axes": {"F": [-1, 1], "b": [1, 3]}})
