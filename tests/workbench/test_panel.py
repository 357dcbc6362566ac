"""Sliders: which parameters, between which ends; slices at their values; what is refused."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import pytest
import yaml
from support.maps import CONFIGS

import ptmcad
from ptmcad import extras
from ptmcad.cli import run
from ptmcad.errors import ConfigError
from ptmcad.options import Options
from ptmcad.question.config import load, record_from_options, slice_from_mapping
from ptmcad.question.config.typed import Typed
from ptmcad.text.entry import plain_data
from ptmcad.text.yamltree import read_text
from ptmcad.workbench.explore.jobs import Tasks
from ptmcad.workbench.explore.panel import SliderPanel, panel_of


def panel(name: str, ranges: tuple[str, ...] = ()) -> SliderPanel:
    return panel_of(record_from_options(Typed(CONFIGS / f"{name}.yaml")), ranges)


def ends(found: SliderPanel) -> dict[str, tuple[Fraction, Fraction, Fraction]]:
    return {s.name: (s.low, s.value, s.high) for s in found.sliders}


def test_a_family_has_its_free_parameter_first() -> None:
    found = panel("families/equal-loads")
    assert [(s.name, s.free) for s in found.sliders[:3]] == [
        ("F", True),
        ("L1", False),
        ("k", False),
    ]
    assert ends(found)["F"] == (-40, -20, 0)
    assert not {"F3", "F4", "rho", "L2", "k1"} & ends(found).keys()  # expressions, axes, aliases


def test_a_record_without_a_free_parameter_has_those_that_are_numbers() -> None:
    found = panel("fig4")
    assert ends(found)["F3"] == (-30, -10, 0)
    assert {s.name for s in found.sliders} >= {"L1", "k", "F3", "F4"}
    assert all(s.low <= s.value <= s.high and not s.free for s in found.sliders)
    assert all(s.low > 0 for s in found.sliders if s.name in ("L1", "k"))


def test_springs_with_one_free_length_have_one_slider() -> None:
    found = panel("free02")
    assert ends(found)["l0"] == (0, Fraction(1, 5), 1)
    assert not any(name.startswith("l0_") for name in ends(found))
    changed = found.slice(found.values({"l0": "1/4"}))
    assert {changed.parameters[f"l0_{k}"].constant() for k in (1, 2, 3)} == {Fraction(1, 4)}


RECORDS = sorted(
    path.relative_to(CONFIGS).with_suffix("").as_posix() for path in CONFIGS.rglob("*.yaml")
)


def test_every_shipped_record_has_sliders_at_round_positions() -> None:
    for name in RECORDS:
        found = panel(name)
        assert found.slice(found.start()).axes
        for slider in found.sliders:
            assert slider.low <= slider.value <= slider.high
            assert 150 <= (slider.high - slider.low) / slider.step <= 400, (name, slider)
            assert str(slider.step * 10**6).strip("0") in ("1", "2", "5")


def test_ends_may_be_given() -> None:
    assert ends(panel("fig4", ("k=50:150",)))["k"] == (50, 100, 150)
    for wrong, said in (
        ("k=5:1", "empty or reversed"),
        ("k", "NAME=LO:HI"),
        ("F=1:2", "has no slider"),
        ("k=a:b", "k"),
    ):
        with pytest.raises(ConfigError, match=said):
            panel("fig4", (wrong,))


def test_slices_at_values_are_those_that_one_would_write() -> None:
    found = panel("families/equal-loads")
    values = found.values({"F": "-33/2", "k": "90.5"})
    alone = ptmcad.family(yaml.safe_load("""
        axes: {rho: [0, 2], L2: [0, 2]}
        parameters: {k: 181/2, F3: F, F4: F}
        free: {F: [-40, 0]}
    """), values=["-33/2"], areas=False).members[0]  # fmt: skip
    assert dict(found.slice(values).parameters) == dict(alone.slice.parameters)
    assert found.slice(values).name == "equal-loads-k-181_2-F-33_2"
    assert found.slice(found.start()).title.startswith("The slice of fig. 4")


def test_without_a_change_the_slice_is_the_record_s_own() -> None:
    found = panel("fig4")
    assert found.slice(found.start()) == load(CONFIGS / "fig4.yaml")


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"F": "-41"}, "between -40 and 0"),
        ({"F": "inf"}, "no number"),
        ({"F": "nan"}, "no number"),
        ({"F": "1e999999999"}, "no number"),
        ({"F": "9" * 200}, "more than 80 characters"),
        ({"F": "F"}, "no number"),
        ({"F": "__import__('os')"}, "no number"),
        ({"F": ""}, "no number"),
        ({"rho": "1"}, "has no slider"),
        ({"k": "0"}, "between"),
    ],
)
def test_what_is_no_value_is_refused(given: dict[str, str], said: str) -> None:
    with pytest.raises(ConfigError, match=said):
        panel("families/equal-loads").values(given)


def test_a_family_is_computed_once_for_all_values_of_its_free_parameter() -> None:
    found = panel("families/equal-loads")
    common = Tasks(found, Path()).common
    first = common(found.values({"F": "-3"}), Options())
    assert common(found.values({"F": "-30"}), Options()) is first
    other = common(found.values({"F": "-3", "k": "50"}), Options())
    assert other is not first and other.variety is not None
    assert common(found.values({"F": "-4"}), Options()) is first


def tasks(name: str, folder: Path = Path()) -> Tasks:
    return Tasks(panel(name), folder)


@pytest.mark.parametrize(
    ("name", "values"),
    [
        ("families/equal-loads", {"F": "-16.5"}),
        ("families/equal-loads", {"F": "-7", "k": "80"}),
        ("fig4", {"F3": "-3"}),
    ],
)
@pytest.mark.slow_cases("families/equal-loads-values1")
def test_maps_are_those_of_classify(name: str, values: dict[str, str]) -> None:
    task = tasks(name)
    alone = ptmcad.classify(task.panel.slice(task.panel.values(values)), areas=False)
    for fine in (False, True) if name == "fig4" else (False,):
        shown = task.found({"kind": "map", "values": values, "fine": fine, "framed": True})
        assert shown["digest"] == [[r.stable, r.total, len(r.cells)] for r in alone.regions]
        assert shown["frame"]["svg"].startswith("<rect") and not shown["certified"]
        areas = [region["area"] for region in shown["regions"]]
        assert [not area for area in areas] == [not fine] * len(areas)


@pytest.mark.parametrize("values", [{"F": "-16.5"}, {"F": "-1/3", "k": "80"}])
@pytest.mark.slow_cases("values1")
def test_the_record_and_the_commands_make_the_figure(
    values: dict[str, str],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    task = tasks("families/equal-loads")
    shown = task.found({"kind": "map", "values": values, "fine": False, "framed": False})
    made = task.found({"kind": "record", "values": values})
    monkeypatch.chdir(tmp_path)
    Path(f"{made['name']}.yaml").write_text(made["record"], encoding="utf-8")
    assert "mechanism: ptm\n" in made["record"]
    alone = slice_from_mapping(plain_data(read_text(made["record"])))
    for command in (made["command"], made["alone"]):
        words = [*command.split()[1:], "--format", "json", "--no-areas"]
        assert run(words) == 0
        (file,) = tmp_path.glob("*.json")
        found = ptmcad.RegionMap.from_json(file.read_text(encoding="utf-8"))
        file.unlink()
        assert [[r.stable, r.total, len(r.cells)] for r in found.regions] == shown["digest"]
        assert dict(found.slice.parameters) == dict(alone.parameters)
    capsys.readouterr()


def test_saved_files_are_a_whole_set_and_nothing_is_written_over(tmp_path: Path) -> None:
    task = tasks("families/equal-loads", tmp_path)
    job = {"kind": "save", "values": {"F": "-5"}, "name": "mine", "formats": ["svg", "exe"]}
    assert task.found(job)["files"] == ["mine.yaml", "mine.svg", "mine.json"]
    result = ptmcad.RegionMap.from_json((tmp_path / "mine.json").read_text(encoding="utf-8"))
    assert all(cell.solutions for cell in result.cells)  # it proves what any result does
    assert (
        result.slice.name == "mine"
        and load(tmp_path / "mine.yaml").parameters == result.slice.parameters
    )
    with pytest.raises(ConfigError, match=r"mine.yaml is there already"):
        task.found(job)
    for name in ("../mine", "a/b", "", ".", "..", "CON", "a\\b", "-x", "a" * 101):
        with pytest.raises(ConfigError):
            task.found({**job, "name": name})
    assert len(list(tmp_path.iterdir())) == 3


def test_points_are_solved_and_those_beyond_are_refused() -> None:
    task = tasks("families/equal-loads")
    job = {"kind": "point", "values": {"F": "-10"}, "at": {"rho": "0.7", "L2": "1.5"}}
    found = task.found(job)
    poses = ptmcad.solve(rho="0.7", L2="1.5", F3=-10, F4=-10)
    assert (found["total"], found["stable"]) == (len(poses.equilibria), poses.stable) == (6, 2)
    assert [pose["energy"] for pose in found["equilibria"]] == [
        p.known_energy.text(7) for p in poses.equilibria
    ]
    for at in (
        {"rho": "3", "L2": "1"},
        {"rho": "1"},
        {"rho": "1", "L2": "1", "F": "1"},
        {"rho": "1", "L2": "x"},
    ):
        with pytest.raises(ConfigError):
            task.found({**job, "at": at})
    with pytest.raises(ConfigError, match="L2 is 0 there"):
        task.found({**job, "at": {"rho": "1", "L2": "0"}})


def test_without_aiohttp_the_message_names_the_extra(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(extras, "find_spec", lambda name: None)
    assert run(["explore", str(CONFIGS / "fig4.yaml")]) == 2
    assert "pip install 'ptmcad[explore]'" in capsys.readouterr().err
