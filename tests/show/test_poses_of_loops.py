"""Poses of mechanisms with closed loops and X-joints: bars keep their lengths, energies are those
of the springs.
"""

from __future__ import annotations

import json
from math import hypot
from pathlib import Path

import pytest

import ptmcad
from ptmcad.answer.poses import Poses
from ptmcad.show.document.posedocument import read_poses

MECHANISMS = Path(__file__).resolve().parents[2] / "configs" / "mechanisms"
AT = {
    "four-bar": {"F": "23/8", "G": "7/8"},
    "slider-crank": {"W": "1/3", "M": "1/10"},
    "x-joint": {"F": "1/4", "G": "1/2"},
    "two-dof-tensegrity-loaded": {"r1": "37/20", "r2": "163/100"},
    "platform-loop": {"L": "1", "W": "5/2"},
}
LENGTHS = {
    "four-bar": {"A0P": 1, "B0Q": 1.2, "PQ": 1.5},
    "slider-crank": {"OP": 1, "PS": 2},
    "x-joint": {"AD": 2, "BC": 2, "CD": 1},
    "two-dof-tensegrity-loaded": {"AC": 1.85, "AD": 1, "BC": 1, "BD": 1.63},
    "platform-loop": {"OP": 1, "PQ": 1.5, "QR": 2**0.5, "RP": 1.25**0.5},
}
LOADS: dict[str, dict[str, tuple[float, float]]] = {
    "four-bar": {"P": (0, 2.875), "Q": (0, 0.875)},
    "slider-crank": {"P": (0, -1 / 3)},
    "x-joint": {"C": (0.25, -0.5), "D": (0.25, -0.5)},
    "two-dof-tensegrity-loaded": {"C": (0, -0.5)},
    "platform-loop": {"Q": (0, -2.5)},
}


def poses(name: str) -> Poses:
    return ptmcad.solve(ptmcad.load(MECHANISMS / f"{name}.yaml"), **AT[name])


@pytest.mark.parametrize("name", AT)
@pytest.mark.slow_cases("two-dof-tensegrity-loaded")
def test_bars_keep_their_lengths_and_energies_are_told(name: str) -> None:
    found = poses(name)
    mechanism = found.model.whole
    assert mechanism is not None
    assert found.equilibria
    for pose in found.equilibria:
        at = {n: (float(x.center), float(y.center)) for n, (x, y) in pose.nodes.items()}
        far = {a + b: hypot(at[a][0] - at[b][0], at[a][1] - at[b][1]) for a, b in mechanism.bars}
        assert far == pytest.approx(LENGTHS[name])
        energy = -1.0 * sum(
            f * u for n, force in LOADS[name].items() for f, u in zip(force, at[n], strict=True)
        )
        for spring in pose.springs:
            length = hypot(*(at[spring.start][k] - at[spring.end][k] for k in (0, 1)))
            assert float(spring.length.center) == pytest.approx(length)
            assert float(spring.force.center) == pytest.approx(float(spring.stiffness) * length)
            energy += float(spring.stiffness) * length**2 / 2
        assert float(pose.known_energy.center) == pytest.approx(energy)
    stable = [pose.stable for pose in found.equilibria]
    assert stable == sorted(stable, reverse=True)
    for kind in (True, False):
        energies = [pose.known_energy.center for pose in found.equilibria if pose.stable is kind]
        assert energies == sorted(energies)


def test_a_mirror_image_has_the_same_energy() -> None:
    """B may be on either side of A: the energies are equal, and known to be."""
    energies = [pose.known_energy.center for pose in poses("two-dof-tensegrity-loaded").equilibria]
    assert all(abs(a - b) < 10**-8 for a, b in zip(energies[::2], energies[1::2], strict=True))


@pytest.mark.parametrize("name", ["slider-crank", "x-joint", "platform-loop"])
@pytest.mark.slow_cases("x-joint", "platform-loop")
def test_poses_are_stored_shown_and_drawn(name: str) -> None:
    from ptmcad.show.render.posepicture import draw_poses

    found = poses(name)
    text = found.to_json()
    assert read_poses(text) == found
    assert json.loads(text)["equilibria"][0]["springs"]
    table = found.table()
    assert "equilibria: 2 stable" in table
    assert "energy" in table
    assert "force" in table
    figure = draw_poses(found)
    drawn = {artist.get_gid() for axes in figure.axes for artist in axes.lines}
    bar = {"slider-crank": "PS", "x-joint": "CD", "platform-loop": "OP"}[name]
    assert f"pose-1-bar-{bar}" in drawn
