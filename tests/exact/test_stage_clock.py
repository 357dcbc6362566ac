"""The exact engine's stages against a clock that the test sets: the limit, and the stages' times."""

from collections.abc import Callable
from typing import Any

import pytest
import yaml

from ptmcad.answer.regionmap import RegionMap, Status
from ptmcad.ask.stepwise import slice_from
from ptmcad.errors import LimitReached
from ptmcad.exact import exactmap
from ptmcad.exact.exactmap import exact_map
from ptmcad.options import Options

CUSP = slice_from(
    yaml.safe_load("""
name: cusp
system: {unknowns: {z: real}, equations: [z^3 - a*z + b]}
axes: {a: [-1, 2], b: [-1, 1]}
count: total
""")
)
FUNCTIONS = {
    "variety": "variety_of",
    "projection": "projection_of",
    "stacks": "stacks_of",
    "counts": "counts_of",
    "adjacency": "crossings_of",
    "areas": "areas_of",
}
"""The function of each stage, in the order in which the stages are run."""


@pytest.fixture
def seconds(monkeypatch: pytest.MonkeyPatch) -> dict[str, float]:
    """What each stage lasts by the clock, all of it at the end, and what a hand-over does.

    Without an entry it takes no time.
    """
    lasts: dict[str, float] = {}
    now = [0.0]
    monkeypatch.setattr(exactmap, "perf_counter", lambda: now[0])

    def slowed(name: str, function: Callable[..., Any]) -> Callable[..., Any]:
        def run(*arguments: Any, **options: Any) -> Any:
            result = function(*arguments, **options)
            now[0] += lasts.get(name, 0)
            return result

        return run

    for name, function in FUNCTIONS.items():
        monkeypatch.setattr(exactmap, function, slowed(name, getattr(exactmap, function)))
    monkeypatch.setattr(exactmap, "assemble", slowed("hand-over", exactmap.assemble))
    return lasts


@pytest.mark.parametrize("stage", FUNCTIONS)
def test_a_stage_that_is_finished_at_the_limit_is_kept(
    stage: str, seconds: dict[str, float]
) -> None:
    whole = exact_map(CUSP)
    seconds[stage] = 20
    if stage == "areas":
        assert exact_map(CUSP, Options(deadline=10)) == whole
        return
    with pytest.raises(LimitReached) as stopped:
        exact_map(CUSP, Options(deadline=10))
    found = stopped.value.partial
    assert isinstance(found, RegionMap)
    assert found.status is Status.PARTIAL
    assert [c.polynomial for c in found.components] == [c.polynomial for c in whole.components]
    if stage == "adjacency":
        assert (found.cells, found.components) == (whole.cells, whole.components)
        assert found.undetermined == 0
        assert {r.area for r in found.regions} == {(0, 6)}


def test_a_map_without_areas_is_complete_when_its_cells_are(seconds: dict[str, float]) -> None:
    seconds["adjacency"] = 20
    assert exact_map(CUSP, Options(deadline=10, areas=False)).status is Status.EXACT


def test_no_stage_has_the_time_in_which_the_caller_has_the_map(
    seconds: dict[str, float],
) -> None:
    stages = {name: 2.0**k for k, name in enumerate(FUNCTIONS)}
    seconds.update(stages)
    seconds["hand-over"] = 100
    found = exact_map(CUSP, Options(partial=lambda _map: None))
    assert found.timings == stages | {"total": 63 + 200}
