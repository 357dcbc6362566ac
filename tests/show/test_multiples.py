"""Pictures of families: small multiples, and maps one above the other."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from mpl_toolkits.mplot3d import proj3d
from support.replacing import replace

import ptmcad
from ptmcad.answer.boundarysurface import BoundarySurface
from ptmcad.answer.family import FamilyMap
from ptmcad.errors import ConfigError
from ptmcad.show.render.printing import save
from ptmcad.show.render.solid import MAX_FLOORS, solid_figure
from ptmcad.show.render.surfacepicture import MAX_SIDE, box_of, halved, towards_eye
from ptmcad.show.style import DEFAULT

RECORD: dict[str, Any] = yaml.safe_load("""
name: cubic
system: {unknowns: {x: real}, equations: [x^3 - a*x + b + c*x^2]}
axes: {a: [-2, 2], b: [-2, 2]}
free: {c: [0, 3]}
members: 7
""")


@pytest.fixture(name="family", scope="module")
def small() -> FamilyMap:
    return ptmcad.family(RECORD, areas=False)


def test_every_member_has_its_chart_its_value_and_the_same_colours(family: FamilyMap) -> None:
    figure = family.plot()
    assert len(figure.axes) == 7
    assert [axes.get_title(loc="left") for axes in figure.axes] == [
        "c = 0", "c = 0.5", "c = 1", "c = 1.5", "c = 2", "c = 2.5", "c = 3",
    ]  # fmt: skip
    faces: dict[int, set[object]] = {}
    for axes, (_, result) in zip(figure.axes, family, strict=True):
        patches = {patch.get_gid(): patch for patch in axes.patches}
        for number, region in enumerate(result.regions):
            found = next(
                patch for gid, patch in patches.items() if gid and gid.endswith(f"-region-{number}")
            )
            faces.setdefault(region.total or 0, set()).add(found.get_facecolor())
    assert set(faces) == {1, 3}
    assert all(len(colours) == 1 for colours in faces.values())


def test_outer_charts_alone_have_names(family: FamilyMap) -> None:
    names = [(axes.get_xlabel(), axes.get_ylabel()) for axes in family.plot().axes]
    assert names == [("", "b"), ("", ""), ("", ""), ("a", ""), ("a", "b"), ("a", ""), ("a", "")]


def test_what_does_not_fit_is_refused(family: FamilyMap) -> None:
    with pytest.raises(ConfigError, match="7 maps do not fit"):
        family.plot(size="2x1in")


def test_of_many_maps_a_few_are_filled_and_of_the_others_there_are_curves(
    family: FamilyMap,
) -> None:
    axes = family.plot(solid=True).axes[0]
    kinds = [type(found).__name__ for found in axes.collections]
    assert MAX_FLOORS == len(family.members) == 7
    assert kinds.count("Line3DCollection") == 7
    assert len(axes.patches) == sum(len(result.regions) for result in family.members)
    assert "curves of the other members" not in [
        text.get_text() for text in family.plot(solid=True).texts
    ]
    more = ptmcad.family(RECORD, values=[0, 1, 2, 3, "1/2", "3/2", "5/2", "1/4"], areas=False)
    drawn = more.plot(solid=True)
    assert "curves of the other members" in [text.get_text() for text in drawn.texts]
    left_out = [n for n in range(8) if n not in (0, 1, 2, 4, 5, 6, 7)]
    whole = sum(len(result.regions) for result in more.members)
    assert len(drawn.axes[0].patches) == whole - sum(len(more.members[n].regions) for n in left_out)


@pytest.fixture(name="solid", scope="module")
def with_surface() -> tuple[FamilyMap, BoundarySurface]:
    found = ptmcad.family(RECORD | {"members": 3}, areas=False, changes=True)
    return found, found.boundary_surface("1/50")


@pytest.mark.slow
def test_a_surface_of_many_pieces_is_an_image_in_a_vector_picture(
    solid: tuple[FamilyMap, BoundarySurface], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("ptmcad.show.render.surfacepicture.MAX_PIECES", 100)
    found, surface = solid
    save(solid_figure(found, 100, DEFAULT, surface), tmp_path / "a.svg")
    assert (tmp_path / "a.svg").read_text().count("<image") == 1


def test_what_is_in_front_is_painted_last(solid: tuple[FamilyMap, BoundarySurface]) -> None:
    """Triangles are cut so that none is long, together as large as before; the camera knows where
    the eye is.
    """
    corners = np.array(
        [[[0.0, 0, 0], [1, 0, 0], [0, 1, 1]], [[0, 0, 0], [0.01, 0, 0], [0, 0.01, 0]]]
    )
    cut, colours = halved(corners, np.array([[1.0, 0, 0], [0, 1, 0]]))
    sides = np.linalg.norm(np.roll(cut, -1, axis=1) - cut, axis=2)
    areas = np.linalg.norm(np.cross(cut[:, 1] - cut[:, 0], cut[:, 2] - cut[:, 0]), axis=1) / 2
    assert sides.max() <= MAX_SIDE
    assert areas[colours[:, 0] == 1].sum() == pytest.approx(2**0.5 / 2)
    assert (colours[:, 1] == 1).sum() == 1
    axes = solid[0].plot(surface=solid[1]).axes[0]
    low, size = box_of(axes)
    eye = (0.5 + 10 * towards_eye(axes)) * size + low
    middle = 0.5 * size + low
    depths = [proj3d.proj_transform(*point, axes.get_proj())[2] for point in (eye, middle)]
    screen = [proj3d.proj_transform(*point, axes.get_proj())[:2] for point in (eye, middle)]
    assert depths[0] < depths[1]
    assert screen[0] == pytest.approx(screen[1], abs=1e-9)


def test_the_table_has_a_line_for_each_member(family: FamilyMap) -> None:
    lines = family.table().splitlines()
    assert len(lines) == 9
    assert lines[1].split()[:3] == ["0", "2", str(len(family.members[0].cells))]
    assert family.at(Fraction(1, 2)) is family.members[1]
    with pytest.raises(KeyError):
        family.at(Fraction(1, 3))
    assert "<pre" in replace(family, title="T")._repr_html_()
