"""The boundary surface of a family: its vertices lie on the variety, and no sheet reaches past a
change.
"""

from __future__ import annotations

from fractions import Fraction
from functools import cache
from math import lcm, pi, prod, sqrt
from typing import Any

import numpy as np
import pytest
import yaml
from flint import fmpz_poly
from support.few import few
from support.replacing import replace

import ptmcad
from ptmcad.algebra.real_roots import has_root_between, squarefree_part
from ptmcad.answer.boundarysurface import ACCURACY, BoundarySurface
from ptmcad.answer.family import FamilyMap, SpaceTerms
from ptmcad.ask.members import in_common
from ptmcad.errors import ConfigError, LimitReached
from ptmcad.question.config import family_from
from ptmcad.text.flint_numbers import from_fraction
from ptmcad.workbench import boundarymesh as asking

SQUARE = {"a": [-1, 1], "b": [-1, 1]}


def of(equation: str, low: Any, high: Any, axes: Any = None, members: int = 3) -> dict[str, Any]:
    """A system in one real unknown, with the free parameter c."""
    return {
        "system": {"unknowns": {"u": "real"}, "equations": [equation]}, "axes": axes or SQUARE,
        "free": {"c": [low, high]}, "members": members,
    }  # fmt: skip


BOWL = of("u^2 - c + a^2 + b^2", -1, 3)
CONE = of("u^2 - c^2 + a^2 + b^2", -1, 1, members=2)
SWALLOWTAIL = of("u^4 + a*u^2 + b*u + c", -1, 1, {"a": [-2, 2], "b": [-2, 2]})
LOADS = yaml.safe_load("""
mechanism: ptm
parameters: {F3: F, F4: F}
axes: {rho: [0, 2], L2: [0, 2]}
free: {F: [-40, 0]}
members: 2
""")
SHIPPED = {"bowl": BOWL, "cone": CONE, "swallowtail": SWALLOWTAIL, "loads": LOADS}


@cache
def maps(name: str) -> FamilyMap:
    return ptmcad.family(SHIPPED[name], areas=False, changes=True)


@cache
def surface(name: str) -> BoundarySurface:
    return maps(name).boundary_surface()


def _along(terms: SpaceTerms, point: tuple[Fraction, Fraction, Fraction], axis: int) -> fmpz_poly:
    """A polynomial of the variety on a line through a point, up to a constant."""
    found = [Fraction(0)] * (1 + max(powers[axis] for powers, _ in terms))
    for powers, c in terms:
        found[powers[axis]] += c * prod(
            v**n for k, (v, n) in enumerate(zip(point, powers, strict=True)) if k != axis
        )
    scale = lcm(*(c.denominator for c in found))
    return fmpz_poly([int(c * scale) for c in found])


def _is_on(found: FamilyMap, point: tuple[Fraction, Fraction, Fraction], share: Fraction) -> bool:
    """Whether a polynomial of the variety has a root within a share of the window from a point,
    along an axis.
    """
    for k, axis in enumerate(found.axes):
        near = (axis.high - axis.low) * share
        ends = [from_fraction(point[k] + s * near) for s in (-1, 1)]
        if any(
            has_root_between(squarefree_part(_along(p, point, k)), *ends) for p in found.surfaces
        ):
            return True
    return False


@pytest.mark.parametrize("name", few(SHIPPED, "bowl", "cone", "swallowtail"))
@pytest.mark.slow_cases("bowl", "swallowtail")
def test_every_vertex_lies_on_the_variety_at_its_members_height(name: str) -> None:
    found, mesh = maps(name), surface(name)
    heights = [float(value) for value in mesh.members]
    assert len(mesh.vertices) > 100
    assert np.array_equal(mesh.vertices[:, 2], np.array(heights)[mesh.member])
    step = max(1, len(mesh.vertices) // 250)
    for vertex, member in zip(
        mesh.vertices[::step].tolist(), mesh.member[::step].tolist(), strict=True
    ):
        point = (Fraction(vertex[0]), Fraction(vertex[1]), mesh.members[member])
        assert _is_on(found, point, 2 * ACCURACY), point


@pytest.mark.parametrize("name", ["bowl", "cone", "swallowtail"])
@pytest.mark.slow_cases("swallowtail")
def test_no_sheet_reaches_past_a_change(name: str) -> None:
    found, mesh = maps(name), surface(name)
    assert found.changes is not None
    values = [change.value for change in found.changes]
    width = found.free.high - found.free.low
    members = mesh.member[mesh.faces]
    for value in values:
        first_above = sum(member < value.high for member in mesh.members)
        assert mesh.members[first_above - 1] <= value.low
        assert not np.any(
            (members.min(axis=1) < first_above) & (members.max(axis=1) >= first_above)
        )
        assert all(sheet.high <= value.low or sheet.low >= value.high for sheet in mesh.sheets)
        # on one side at least sheets come near to it
        assert min(abs(member - value.low) for member in mesh.members) <= 2 * asking.NEAR * width
    assert mesh.complete
    assert mesh.deviation <= asking.TOLERANCE
    assert not mesh.unresolved


def test_a_paraboloid_has_its_area() -> None:
    """That of c = a^2 + b^2 below c = 1, where it reaches the window's sides: (5^1.5 - 1) pi/6."""
    mesh = surface("bowl")
    corners = mesh.vertices[mesh.faces]
    areas = (
        np.linalg.norm(
            np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1
        )
        / 2
    )
    below = corners[:, :, 2].max(axis=1) < 1
    assert areas[below].sum() == pytest.approx((5 * sqrt(5) - 1) * pi / 6, rel=0.01)
    assert mesh.vertices[:, 2].min() == pytest.approx(0, abs=1e-5)
    assert mesh.vertices[:, 2].max() == pytest.approx(2, abs=1e-5)


@pytest.mark.parametrize(
    "name", ["cone", "swallowtail"]
)  # at the cone's apex all walls are shorter than the weld
def test_faces_are_triangles_that_neighbouring_members_bound(name: str) -> None:
    mesh = surface(name)
    assert all(len({*face}) == 3 for face in mesh.faces.tolist())
    members = mesh.member[mesh.faces]
    assert set((members.max(axis=1) - members.min(axis=1)).tolist()) == {1}
    # of two members' vertices a triangle has two of one and one of the other: sheets are closed
    # between them
    edges: dict[tuple[int, int], int] = {}
    for face in mesh.faces.tolist():
        for edge in zip(face, (*face[1:], face[0]), strict=True):
            edges[min(edge), max(edge)] = edges.get((min(edge), max(edge)), 0) + 1
    window = [[float(axis.low), float(axis.high)] for axis in maps(name).axes]

    def is_at_side(vertex: int) -> bool:
        return any(
            min(abs(mesh.vertices[vertex][k] - end) for end in window[k]) < 1e-3 for k in (0, 1)
        )

    loose = [edge for edge, number in edges.items() if number == 1]
    inner = [
        (a, b)
        for a, b in loose
        if mesh.member[a] != mesh.member[b] and not (is_at_side(a) and is_at_side(b))
    ]
    # where the surface crosses itself or has a cusp its sheets meet, and an edge belongs to both:
    # none is loose
    assert not inner


@pytest.mark.parametrize("first", ["a", "b"])
def test_a_plane_is_a_sheet_over_either_axis(first: str) -> None:
    axes = {name: [-1, 1] for name in sorted("ab", reverse=first == "b")}
    found = ptmcad.family(
        of("u^2 - (a - c)*(b^2 + 1)", "-1/2", "1/2", axes), areas=False, changes=True
    )
    mesh = found.boundary_surface()
    place = found.axes[0].name != "a"
    assert len(mesh.faces) >= 2
    assert mesh.vertices[:, int(place)] == pytest.approx(mesh.vertices[:, 2], abs=1e-6)


@pytest.mark.slow
def test_where_elimination_is_out_of_reach_that_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("ptmcad.ask.changes.critical_values", lambda *_: "for a reason")
    found = ptmcad.family(BOWL, areas=False, changes=True)
    mesh = found.boundary_surface("1/50")
    assert not mesh.complete
    assert "not proved" in mesh.words()
    assert "(not proved that nothing changes between them)" in [
        t.get_text() for t in found.plot(surface=mesh).texts
    ]


def test_a_family_of_which_the_changes_are_not_known_is_refused() -> None:
    found = replace(maps("cone"), changes=None)
    with pytest.raises(ConfigError, match="find them first"):
        found.boundary_surface()
    with pytest.raises(ConfigError, match="is not between 0 and 1"):
        maps("cone").boundary_surface(2)
    with pytest.raises(ConfigError, match="two members"):
        maps("cone").boundary_surface(max_members=1)
    with pytest.raises(LimitReached):
        maps("cone").boundary_surface(timeout=1e-6)


def test_the_record_and_the_stored_maps_give_the_same_surface() -> None:
    found = maps("cone")
    assert found.changes is not None
    again = asking.surface_of(in_common(family_from(CONE)), found.changes)
    mesh = surface("cone")
    assert again.members == mesh.members
    assert np.array_equal(again.vertices, mesh.vertices)
    assert np.array_equal(again.faces, mesh.faces)


def test_obj_and_ply_hold_the_mesh() -> None:
    mesh = surface("swallowtail")
    obj = mesh.to_obj().splitlines()
    points = [tuple(map(float, line.split()[1:])) for line in obj if line.startswith("v ")]
    faces = [[int(n) - 1 for n in line.split()[1:]] for line in obj if line.startswith("f ")]
    assert np.array_equal(points, mesh.vertices)
    assert np.array_equal(faces, mesh.faces)
    groups = [line for line in obj if line.startswith("g ")]
    assert (
        groups[0]
        == f"g sheet-0-between-{'-and-'.join(str(key[0]) for key in mesh.sheets[0].counts)}"
    )
    assert len(groups) == len(set(mesh.sheet.tolist()))
    head, _, body = mesh.to_ply().partition("end_header\n")
    assert head.startswith("ply\nformat ascii 1.0\n")
    assert f"element vertex {len(points)}\n" in head
    assert f"element face {len(faces)}\n" in head
    rows = [line.split() for line in body.splitlines()]
    assert np.array_equal(
        [[float(v) for v in row[:3]] for row in rows[: len(points)]], mesh.vertices
    )
    for row, face, sheet in zip(
        rows[len(points) :], mesh.faces.tolist(), mesh.sheet.tolist(), strict=True
    ):
        counts = [key[0] for key in mesh.sheets[sheet].counts]
        assert [int(v) for v in row] == [3, *face, sheet, *counts]
