"""`verify` at any scale: a true map is not called false, a box with two solutions is not called
true.

Solutions lie 1e-14 apart, next to a pitchfork in windows of 1e-15 and less, or in windows of 2e9. A
Newton step that fails over a box larger than that is no proof that the box is empty.
"""

from __future__ import annotations

import json
from fractions import Fraction
from typing import Any

import pytest
import yaml
from support.few import few

import ptmcad

PITCHFORK = {"unknowns": {"s": "real", "x": "real"}, "equations": ["x*s", "x + s^2 - a"]}
SLICES: dict[str, dict[str, Any]] = yaml.safe_load("""
# both roots +-1.4e-14 were in the box 0 +- 1e-12, and one of them counts
roots-1e-14-apart:
  system: {unknowns: {x: real}, equations: [1e28*x^2 - a - 2 - b], positive: [x]}
  axes: {a: [-1, 1], b: [-1, 1]}
pitchfork-1e-14:
  system: {unknowns: {s: real, x: real}, equations: [x*s, x + s^2 - a]}
  axes: {a: [-1e-14, 1e-14], b: [0, 1]}
pitchfork-1e-30:
  system: {unknowns: {s: real, x: real}, equations: [x*s, x + s^2 - a]}
  axes: {a: [-1e-30, 2e-30], b: [0, 1]}
cusp-1e13:
  system: {unknowns: {x: real}, equations: [(1e13*x)^3 - a*1e13*x - b], positive: [1e13*x + 1]}
  axes: {a: [-1, 2], b: [-1, 1]}
coefficients-1e12-and-1e-12:
  system:
    unknowns: {x: real, y: real}
    positive: [x*1e12 + y]
    equations: [1e12*x^2 - 1e-12*a*y + b, y^2*1e-12 - x - a*b]
  axes: {a: [-1, 1], b: [-1, 1]}
one-solution-is-not-positive:
  system:
    unknowns: {x: real, y: real}
    positive: [x*1e12 + y]
    equations: [1e12*x^2 - a*y + b, y^2 - x - a*b]
  axes: {a: [-1, 1], b: [-1, 1]}
window-2e9:
  system:
    unknowns: {x: real, y: real}
    equations: [2 + 3/2*a - y + (1 - 3/2*b)*x*y + (1 - a)*x^2, (-1 - 2*a)*x*y + b/2*x^2]
    positive: [1 - x^2 - y^2]
  axes: {a: [-1000000000, 999999999], b: [-1000000000, 999999999]}
# the crank points along the guide, where two poses part
slider-crank-1e-30:
  mechanism:
    parameters: {F: {kind: force}, G: {kind: force}}
    unknowns: {th: angle, x: length}
    points: {P: [-2*cos(th), -2*sin(th)], B: [3, 2], S: [x, 0]}
    springs: [{between: [P, S], k: 1}, {between: [B, S], k: 1}]
    loads: {S: [F, G]}
  parameters: {F: u, G: u + v}
  axes: {u: [-1 - 1e-30, -1 + 1e-30], v: [0, 1]}
  count: stable
""")


def stored(record: dict[str, Any], **options: Any) -> dict[str, Any]:
    """The document of the record's map."""
    document: dict[str, Any] = json.loads(
        ptmcad.classify({"name": "map", **record}, **options).to_json()
    )
    return document


def verified(document: dict[str, Any]) -> ptmcad.VerifyReport:
    return ptmcad.verify(ptmcad.RegionMap.from_json(json.dumps(document)))


@pytest.mark.parametrize(
    "name", few(SLICES, "roots-1e-14-apart", "pitchfork-1e-30", "slider-crank-1e-30")
)
def test_a_true_map_is_accepted(name: str) -> None:
    report = verified(stored(SLICES[name]))
    assert report.ok, report.violation
    assert {check.name: check.passed for check in report.checks}["solutions"]


def test_a_map_without_areas_in_a_window_whose_area_is_no_decimal() -> None:
    """The whole window's area is rounded up then."""
    record = yaml.safe_load("""
        name: cubic
        system: {parameters: {a: {}, b: {}}, unknowns: {x: real}, potential: x^4/4 + a*x^2/2 + b*x}
        axes: {a: [-1/3, 1/3], b: [-1, 1/7]}
    """)
    document = json.loads(ptmcad.classify(record, areas=False).to_json())
    report = verified(document)
    assert report.ok, report.violation


def test_a_box_has_no_other_real_solution() -> None:
    """x^2 = (2 + a + b) 1e-28 has two real roots; that which counts is alone in its box."""
    document = stored(SLICES["roots-1e-14-apart"])
    for cell in document["cells"]:
        a, b = (Fraction(cell["sample"][name]) for name in "ab")
        (solution,) = cell["solutions"]
        center, radius = Fraction(solution["center"][0]), Fraction(solution["radius"])

        def square_is_below(x: Fraction, a: Fraction = a, b: Fraction = b) -> bool:
            return x * x < (2 + a + b) / 10**28

        assert center - radius > 0
        assert square_is_below(center - radius)
        assert not square_is_below(center + radius)


def changed(document: dict[str, Any], **entries: Any) -> dict[str, Any]:
    """The document with other entries in the first box that is stored."""
    cell = next(cell for cell in document["cells"] if cell["solutions"])
    cell["solutions"][0] |= entries
    return document


@pytest.mark.parametrize("center", ["0", "1e-13"])
def test_a_box_with_a_solution_that_does_not_count_is_refused(center: str) -> None:
    """It is the document that earlier versions wrote."""
    forged = changed(stored(SLICES["roots-1e-14-apart"]), center=[center], radius="1/1000000000000")
    report = verified(forged)
    assert report.violation is not None
    assert "2 real solutions are in it" in report.violation


@pytest.mark.parametrize("name", ["pitchfork-1e-30", "cusp-1e13"])
def test_a_box_beside_a_solution_is_refused(name: str) -> None:
    """By as little as its own width."""
    document = stored(SLICES[name])
    solution = next(cell for cell in document["cells"] if cell["solutions"])["solutions"][0]
    away = [str(Fraction(x) + 3 * Fraction(solution["radius"])) for x in solution["center"]]
    report = verified(changed(document, center=away))
    assert report.violation is not None
    assert "no solution found in it" in report.violation


def test_a_wide_box_with_one_solution_is_accepted() -> None:
    """One of a pitchfork's solutions, at 1e-30, in a box of 1e-3: it is the only one over this half
    of the window.
    """
    document = stored({"system": PITCHFORK, "axes": {"a": ["-2e-30", "-1e-30"], "b": [0, 1]}})
    for center in (["0", "0"], ["1/3000", "-1/2000"]):
        report = verified(changed(document, center=center, radius="1/1000"))
        assert report.ok, report.violation
