"""Bodies, torsion springs, moments, weights; what a whole description proves; all faults of a
record at once.
"""

from __future__ import annotations

import time
from copy import deepcopy
from fractions import Fraction
from math import cos, pi, sin
from pathlib import Path
from typing import Any

import pytest
import yaml
from flint import fmpq
from support.cases import cases
from support.signatures import count_by_isolation, count_by_signature

from ptmcad import RegionMap, classify, slice_from_mapping
from ptmcad.errors import MAX_FAULTS, ConfigError, Faults
from ptmcad.exact.models.modelsystem import system_from
from ptmcad.model import Mechanism, described, described_system, ptm, recognised, work
from ptmcad.model.builtinmechanisms import RECORD
from ptmcad.model.closed import without_loops
from ptmcad.model.proofs import check_bars, check_unknowns

CONFIGS = Path(__file__).resolve().parents[2] / "configs" / "mechanisms"

PLATFORM: dict[str, Any] = yaml.safe_load("""
name: platform
parameters:
  L: {kind: length, default: 1}
  a: {kind: length, default: 1/2}
  b: {kind: length, default: 3/10}
  k: {kind: stiffness, default: 1}
  c: {kind: stiffness, default: 2}
  W: {kind: force}
  M: {default: 0}
unknowns: {th: angle, phi: angle, x: length}
points: {O: [x, 0], P: [x + L*cos(th), L*sin(th)], A: [1, 2], B: [-1, 1/3]}
bodies:
  plate: {at: P, angle: th + phi, points: {Q: [a, 0], R: [a/2, b]}}
  tip: {at: R, angle: -phi, points: {T: [0, b]}}
bars: [[O, P], [P, R], [Q, R], [R, T]]
springs: [{between: [A, Q], k: k}, {between: [B, T], k: 2*k + c}]
torsion: [{angle: phi - th, k: c, rest: {cos: 3/5, sin: 4/5}}]
loads: {R: {weight: W}, T: [W/2, 0]}
moments: {th: M, x: 2*W}
""")


def energy(at: dict[str, float]) -> float:
    """The platform's, written out by hand in floating point."""
    x, th, phi, a, b = (at[name] for name in ("x", "th", "phi", "a", "b"))

    def turned(angle: float, u: float, v: float) -> complex:
        return complex(u * cos(angle) - v * sin(angle), u * sin(angle) + v * cos(angle))

    p = complex(x + at["L"] * cos(th), at["L"] * sin(th))
    q, r = p + turned(th + phi, a, 0), p + turned(th + phi, a / 2, b)
    t = r + turned(-phi, 0, b)
    springs = (
        at["k"] / 2 * abs(q - (1 + 2j)) ** 2
        + (2 * at["k"] + at["c"]) / 2 * abs(t - (-1 + 1j / 3)) ** 2
    )
    torsion = at["c"] * (1 - (cos(phi - th) * 0.6 + sin(phi - th) * 0.8))
    return springs + torsion + at["W"] * r.imag - at["W"] / 2 * t.real


def value(p: Any, at: dict[str, float]) -> float:
    """An element of a system's ring in floating point."""
    names = [str(name) for name in p.context().names()]
    values = {**at, **{f"{f.__name__}_{u}": f(at[u]) for u in ("th", "phi") for f in (cos, sin)}}
    total = 0.0
    for exponents, c in p.terms():
        term = int(c.p) / int(c.q)
        for name, e in zip(names, exponents, strict=True):
            term *= values[name] ** int(e)
        total += term
    return total


PENDULUM: dict[str, Any] = yaml.safe_load("""
parameters: {W: {kind: force, default: 1}, M: {default: 0}}
unknowns: {th: angle}
points: {O: [0, 0], P: [cos(th), sin(th)]}
bars: [[O, P]]
loads: {P: {weight: W}}
moments: {th: M}
""")


@pytest.mark.parametrize(
    "count", [count_by_isolation, count_by_signature], ids=lambda f: f.__name__
)
def test_a_pendulum_holds_a_moment_up_to_its_weight(count: Any) -> None:
    """W cos th = M: two equilibria, one of them stable, where |M| < W, none beyond."""
    system = system_from(described(PENDULUM))
    assert count(system, {"W": fmpq(1), "M": fmpq(1, 2)}).index == (1, 1)
    assert count(system, {"W": fmpq(1), "M": fmpq(3, 2)}).index == (0, 0)


def test_a_moment_that_depends_on_its_own_unknown_has_a_potential() -> None:
    """W cos th = M sin th cos th: cos th = 0 or sin th = W/M, so four where M > W; those of cos
    th = 0 are stable.
    """
    m = described({**PENDULUM, "moments": {"th": "M*sin(th)*cos(th)"}})
    assert "stable" in m.criterion.counts
    system = system_from(m)
    found = [
        count(system, {"W": fmpq(1), "M": fmpq(2)})
        for count in (count_by_isolation, count_by_signature)
    ]
    assert [(c.total, c.stable, c.index) for c in found] == [(4, 2, (2, 2))] * 2


def test_a_moment_that_depends_on_another_unknown_has_no_potential() -> None:
    """The same at th, and at another angle s that its spring holds at 0 or pi: nothing says which
    are stable.
    """
    further = {"unknowns": {"th": "angle", "s": "angle"}, "torsion": [{"angle": "s", "k": 1}]}
    m = described({**PENDULUM, **further, "moments": {"th": "M*sin(th)*cos(th)*cos(s)"}})
    assert "stable" not in m.criterion.counts
    system = system_from(m)
    found = [
        count(system, {"W": fmpq(1), "M": fmpq(2)})
        for count in (count_by_isolation, count_by_signature)
    ]
    assert [(c.total, c.stable, c.index) for c in found] == [(8, None, None)] * 2


def test_a_moment_that_is_too_large_to_be_integrated_is_refused(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(work, "MAX_WORK", 10)
    moment = "*".join(f"(M + W*cos(th) + {n}*sin({n}*th))" for n in range(1, 4))
    with pytest.raises(
        ConfigError, match="moments: they have no energy: the expressions are too large"
    ):
        described({**PENDULUM, "moments": {"th": moment}})


@pytest.mark.parametrize(
    ("rest", "angle"),
    [
        (0, 0),
        ("0", 0),
        ("pi", pi),
        ("pi/2", pi / 2),
        ("-pi/2", -pi / 2),
        ("3*pi/2", -pi / 2),
        ("- pi", pi),
    ],
)
def test_rests_that_are_named(rest: Any, angle: float) -> None:
    m = described({**PENDULUM, "torsion": [{"angle": "th", "k": 1, "rest": rest}]})
    assert [float(x) for x in m.torsion[0].rest] == pytest.approx([cos(angle), sin(angle)])


def change(record: dict[str, Any], *path: Any) -> dict[str, Any]:
    """The record with the last of the path at the place of the others, or without it for None."""
    changed = deepcopy(record)
    place: Any = changed
    for key in path[:-2]:
        place = place[key]
    place[path[-2]] = path[-1]
    if path[-1] is None:
        del place[path[-2]]
    return changed


BASES = {"ptm": RECORD, "platform": PLATFORM, "pendulum": PENDULUM}


@pytest.mark.parametrize(("base", "path", "value", "key", "part"), cases("reader", "descriptions"))
def test_what_is_wrong_is_named_with_its_key(
    base: str, path: list[Any], value: Any, key: str, part: str
) -> None:
    record = change(BASES[base], *path, value)
    start = time.perf_counter()
    with pytest.raises(ConfigError) as caught:
        described(record)
    assert time.perf_counter() - start < 1
    assert caught.value.key == key
    assert part in caught.value.message


def test_all_faults_are_found_at_once_and_none_follows_from_another() -> None:
    record = change(PLATFORM, "points", "A", ["1/(L)", 2])
    record["parameters"]["b"]["kind"] = "size"
    record["springs"][0]["between"] = ["A", "Z"]
    record["springs"][1]["k"] = "2*K"
    record["bars"].append(["O", "O"])
    record["more"] = 1
    with pytest.raises(ConfigError) as caught:
        described(record)
    assert [fault.key for fault in caught.value.faults] == [
        "more", "parameters.b.kind", "points.A.1", "bars.5", "springs.1.between", "springs.2.k",
    ]  # fmt: skip
    system = {
        "unknowns": {"x": "real", "y": "turn"},
        "equations": ["x +", "z*y", True],
        "stable": 1,
        "odd": 2,
    }
    with pytest.raises(ConfigError) as caught:
        described_system(system)
    assert [f.key for f in caught.value.faults] == [
        "odd", "unknowns.y", "equations.1", "equations.3", "stable", "equations",
    ]  # fmt: skip


def test_after_many_faults_no_more_are_looked_for() -> None:
    record = {**PENDULUM, "springs": [{"between": ["O", f"Q{n}"], "k": "z"} for n in range(399)]}
    with pytest.raises(ConfigError) as caught:
        described(record)
    assert MAX_FAULTS <= len(caught.value.faults) <= MAX_FAULTS + 2


def test_the_built_in_ones_are_proved() -> None:
    faults = Faults()
    check_bars(ptm(), faults)
    check_unknowns(ptm(), faults)
    assert faults.found == []


TITLES: list[tuple[object, str]] = [
    (3, "title: 3 is no text"),
    (None, "title: has no value"),
    ("a" * 301, "title: the text is longer than 300 characters"),
    ("a\u202eb", "title: the title has a character that cannot be printed, U\\+202E"),
]


@pytest.mark.parametrize(("title", "said"), TITLES)
def test_titles_are_one_line_of_text(title: object, said: str) -> None:
    with pytest.raises(ConfigError, match=said):
        described({**PENDULUM, "title": title})
    with pytest.raises(ConfigError, match=said):
        described_system(
            {"unknowns": {"x": "real"}, "equations": ["x^3 - a*x + b"], "title": title}
        )


@pytest.mark.parametrize("name", ["inverted-pendulum", "slider-crank", "x-joint"])
def test_a_title_is_one_line(name: str) -> None:
    """Also of what its loops and X-joints make of it."""
    record = yaml.safe_load((CONFIGS / f"{name}.yaml").read_text(encoding="utf-8"))
    model = without_loops(described({**record["mechanism"], "title": "a title\n  of two lines\n"}))
    assert model.title == "a title of two lines"


def test_a_built_in_name_is_not_taken_by_another() -> None:
    without = {key: entry for key, entry in RECORD.items() if key != "symmetries"}
    assert recognised(described(without)) is ptm()
    with pytest.raises(ConfigError, match="name: 'ptm' is the name of a built-in mechanism"):
        recognised(described({**without, "springs": RECORD["springs"][:2], "parameters": {  # type: ignore[index]
            **RECORD["parameters"], "k": {"kind": "stiffness", "alias": ["k1", "k2"]},  # type: ignore[dict-item]
            "l0": {"kind": "free length", "alias": ["l0_1", "l0_2"]}}}))  # fmt: skip


def test_stiffnesses_that_cancel_leave_an_unknown_loose() -> None:
    """Two springs whose energies add up to a constant: exact, not a matter of a sample."""
    record = yaml.safe_load("""
        parameters: {k: {kind: stiffness}}
        unknowns: {th: angle}
        points: {A: [1, 0], B: [-1, 0], P: [cos(th), sin(th)]}
        springs: [{between: [A, P], k: k}, {between: [B, P], k: k}]
    """)
    with pytest.raises(ConfigError, match="no equation holds"):
        described(record)
    record["springs"][0]["free"] = Fraction(1, 2)
    assert isinstance(described(record), Mechanism)


def test_a_stored_result_keeps_the_description() -> None:
    """Bodies, torsion springs and moments are there again when it is read, and the text is the
    same.
    """
    record = {
        "name": "turned",
        "mechanism": {
            **PENDULUM,
            "bodies": {"rod": {"at": "P", "angle": "th", "points": {"Q": ["1/2", 0]}}},
            "torsion": [{"angle": "th", "k": "1/2", "rest": "pi"}],
            "loads": {"Q": {"weight": "W"}},
        },
        "axes": {"W": [0, 2], "M": [-1, 1]},
    }
    result = classify(slice_from_mapping(record))
    text = result.to_json(timings=False)
    again = RegionMap.from_json(text)
    assert again.slice == result.slice
    assert again.slice.model.source == {"name": "mechanism", **result.slice.model.source}
    assert again.to_json(timings=False) == text
    assert {(region.total, region.stable) for region in result.regions} == {(0, 0), (2, 1)}


NEWCOMERS: dict[str, tuple[dict[str, Any], str]] = {
    "a parameter as a number": ({"parameters": {"c": 1}}, "such as {kind: length, default: 1}"),
    "unknowns as a list": ({"unknowns": ["x"]}, "such as {th: angle, x: real}"),
    "an equation as a text": (
        {"equations": "x^2 - 1"},
        'expected a list, such as ["x^3 - a*x + b"]',
    ),
    "an equation with its sign": (
        {"equations": ["x^2 = 2"]},
        "write the left side less the right side",
    ),
    "an inequality with its sign": ({"positive": ["x > 0"]}, "write what has to be positive alone"),
}


@pytest.mark.parametrize("name", NEWCOMERS)
def test_what_newcomers_write_is_refused_with_what_to_write(name: str) -> None:
    change, remedy = NEWCOMERS[name]
    with pytest.raises(ConfigError) as caught:
        described_system({"unknowns": {"x": "real"}, "equations": ["x^2 - 2"], **change})
    assert any(remedy in str(fault) for fault in caught.value.faults)


def test_conditions_beside_a_potential_are_a_fault_also_where_this_is_one() -> None:
    record = {"unknowns": {"t": "angle"}, "potential": "t + a", "stable": ["a"]}
    with pytest.raises(ConfigError) as caught:
        described_system(record)
    assert [fault.key for fault in caught.value.faults] == ["potential", "stable"]
