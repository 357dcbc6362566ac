"""The shipped records of other mechanisms with free lengths, against the figures that they say are
independent.
"""

from __future__ import annotations

from pathlib import Path

import pytest
import yaml
from support.shipped_records import OTHER_FREE

import ptmcad
from ptmcad.answer.regionmap import Status

pytest.importorskip("numba")


@pytest.mark.parametrize("path", OTHER_FREE, ids=lambda path: path.stem)
@pytest.mark.slow_cases("three-cables")
def test_the_record_s_own_figures(path: Path) -> None:
    record = yaml.safe_load(path.read_text(encoding="utf-8"))
    known, asked = record["reference"], record["count"]
    m = ptmcad.classify(ptmcad.load(path), tolerance="1/500")
    assert m.status is Status.CERTIFIED
    for count, area in known["areas"].items():
        found = sum(
            float(sum(region.area)) / 2 for region in m.regions if getattr(region, asked) == count
        )
        assert found == pytest.approx(float(area), rel=float(known["tolerance"]))
    for entry in known["counts"]:
        poses = ptmcad.solve(path, **entry["at"])
        taut = sum(pose.admissible is True for pose in poses.equilibria)
        numbers = {"total": len(poses.equilibria), "stable": poses.stable, "admissible": taut}
        assert (
            numbers.items() >= {key: value for key, value in entry.items() if key != "at"}.items()
        )
        assert getattr(m.locate(**entry["at"]), asked) == entry[asked]
