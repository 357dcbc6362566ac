"""Slices from records and options; each kind of bad input with its file, line and key."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import pytest
from support.cases import cases

from ptmcad.errors import ConfigError
from ptmcad.model import ptm
from ptmcad.question.config import load, point_from_mapping, slice_from_options
from ptmcad.question.config.designkey import design_from
from ptmcad.question.shipped import record_tree
from ptmcad.question.slice import Count
from ptmcad.text.entry import plain_data
from ptmcad.text.expressions import axis, constant

CONFIGS = sorted((Path(__file__).resolve().parents[2] / "configs").glob("*.yaml"))
SHIPPED = ["fig2", "fig3", "fig4", "fig5-caption", "fig5-text", "forces", "free-l0-L1", "free-l0-L32", "free-load",
           "free02-unloaded", "free02", "free05", "free08", "horizontal", "rods", "stiffness",
           "unequal-springs"]  # fmt: skip
AXES = "axes: {rho: [0, 2], L2: [0, 2]}\n"


def write(folder: Path, text: str) -> Path:
    path = folder / "record.yaml"
    path.write_text(text, encoding="utf-8")
    return path


def test_all_records_are_shipped() -> None:
    assert [path.stem for path in CONFIGS] == SHIPPED


@pytest.mark.parametrize("path", CONFIGS, ids=lambda path: path.stem)
def test_shipped_records_load(path: Path) -> None:
    slice = load(path)
    assert slice.name == path.stem
    assert slice.title
    assert slice.reference["source"]
    assert slice.has_free_lengths == path.stem.startswith("free")


def test_numbers_are_exact(tmp_path: Path) -> None:
    digits = "3.141592653589793238462643383279502884197"
    slice = load(
        write(
            tmp_path,
            AXES + f"parameters: {{L1: {digits}, F3: -0.1, F4: 1e-30, k: '3/4', F3x: -1/10}}",
        )
    )
    values = {name: slice.parameters[name].constant() for name in ("L1", "F3", "F4", "k", "F3x")}
    assert values["L1"] == Fraction(digits)
    assert values["F3"] == values["F3x"] == Fraction(-1, 10)
    assert values["F4"] == Fraction(1, 10**30)
    assert values["k"] == Fraction(3, 4)


def test_expressions_and_defaults(tmp_path: Path) -> None:
    text = "axes: {rho: [0, 2], F: [-1e1, 0]}\nparameters: {F3: F, F4: F3, L2: 2*rho, k2: 2*k}\ncount: index\n"
    slice = load(write(tmp_path, text))
    assert slice.name == "record"
    assert slice.count is Count.INDEX
    assert slice.axis_names == ("rho", "F")
    assert slice.parameters["F3"] == slice.parameters["F4"] == axis(1)
    assert slice.parameters["L2"] == 2 * axis(0)
    assert slice.parameters["k1"] == constant(100)
    assert slice.parameters["k2"] == constant(200)
    assert slice.text["F4"] == "F3"
    assert list(slice.parameters) == [
        "L1",
        "L2",
        "rho",
        "k",
        "k1",
        "k2",
        "k3",
        "F3",
        "F4",
        "F3x",
        "F4x",
    ]


def test_a_free_length_of_zero_is_accepted(tmp_path: Path) -> None:
    assert "l0" not in load(write(tmp_path, AXES + "parameters: {l0: 0, l0_1: 0.0}")).parameters


def test_free_lengths_fixed_as_axes_and_as_expressions(tmp_path: Path) -> None:
    fixed = load(write(tmp_path, AXES + "parameters: {l0: 1/5, l0_2: 2*l0}\ncount: admissible\n"))
    assert fixed.count is Count.ADMISSIBLE
    assert fixed.has_free_lengths
    assert [fixed.parameters[n].constant() for n in ptm().free_lengths] == [
        Fraction(1, 5),
        Fraction(2, 5),
        Fraction(1, 5),
    ]
    assert list(fixed.parameters)[-3:] == list(ptm().free_lengths)
    assert "l0" not in fixed.parameters
    assert [fixed.text[n] for n in ptm().free_lengths] == ["1/5", "2*l0", "1/5"]
    window = slice_from_options(slice="rho,l0", sets=["F3=-10"])
    assert (window.axes[1].low, window.axes[1].high) == (0, 1)
    assert [window.parameters[n] for n in ptm().free_lengths] == [axis(1)] * 3
    one = slice_from_options(slice="l0_3,rho", ranges=["l0_3=1/10:1/2"])
    assert [one.parameters[n] for n in ptm().free_lengths] == [constant(0), constant(0), axis(0)]
    varying = load(write(tmp_path, AXES + "parameters: {l0: rho/10, l0_1: (rho-1)^2/4}"))
    assert varying.parameters["l0_2"] == axis(0) * Fraction(1, 10)
    assert (
        varying.parameters["l0_1"].evaluate(Fraction(1), Fraction(1)) == 0
    )  # zero inside the window is a length too


def test_free_lengths_that_cancel_leave_an_exact_slice(tmp_path: Path) -> None:
    exact, cancelled = (
        load(write(tmp_path, AXES + text)) for text in ("", "parameters: {l0_1: rho - rho, l0: 0}")
    )
    assert not cancelled.has_free_lengths
    assert cancelled == exact


def test_a_heading_names_the_free_length_once() -> None:
    assert "l0 = 1/5" in slice_from_options(slice="rho,L2", sets=["l0=1/5"]).heading
    assert "l0_2 = 1/5" in slice_from_options(slice="rho,L2", sets=["l0_2=1/5"]).heading
    assert "l0" not in slice_from_options(slice="rho,l0").heading


@pytest.mark.parametrize(("text", "line", "key", "part"), cases("config", "records"))
def test_bad_records_are_refused_with_their_place(
    tmp_path: Path, text: str, line: int | None, key: str | None, part: str
) -> None:
    path = write(tmp_path, text)
    with pytest.raises(ConfigError) as caught:
        load(path)
    error = caught.value
    assert part in error.message
    assert (error.file, error.line, error.key) == (str(path), line, key)
    assert "\n" not in str(error)


@pytest.mark.parametrize("file", ["con.yaml", "Aux.v2.yaml", "COM1.yaml"])
def test_a_record_whose_name_is_a_device_has_to_give_another(tmp_path: Path, file: str) -> None:
    """Its results would have names that Windows cannot read."""
    (tmp_path / file).write_text(AXES)
    with pytest.raises(ConfigError, match="Windows keeps") as caught:
        load(tmp_path / file)
    assert (caught.value.key, caught.value.file) == ("name", str(tmp_path / file))
    (tmp_path / file).write_text(f"name: mine\n{AXES}")
    assert load(tmp_path / file).name == "mine"


def test_options_alone() -> None:
    slice = slice_from_options(slice="L2,rho")
    assert slice.name == "slice-L2-rho"
    assert [(a.name, a.low, a.high) for a in slice.axes] == [("L2", 0, 4), ("rho", 0, 4)]
    assert slice.parameters["F3"] == constant(0)
    forces = slice_from_options(slice="F3,k", ranges=["k=1/2:1e2"], sets=["L2=3/2"], count="total")
    assert [(a.low, a.high) for a in forces.axes] == [(-30, 0), (Fraction(1, 2), 100)]
    assert forces.count is Count.TOTAL


def test_options_over_a_record() -> None:
    path = next(path for path in CONFIGS if path.stem == "fig5-text")
    swapped = slice_from_options(path, slice="F4,rho")
    assert swapped.axis_names == ("F4", "rho")
    assert [(a.low, a.high) for a in swapped.axes] == [(-30, 0), (0, 2)]
    other = slice_from_options(path, slice="rho,L2", sets=["F4=-20"], ranges=["rho=0:1"])
    assert other.parameters["F3"] == constant(-10)
    assert other.parameters["F4"] == constant(-20)
    assert other.axes[0].high == 1
    assert not other.reference
    assert slice_from_options(path, count="index").reference


@pytest.mark.parametrize(
    ("options", "key", "part"),
    cases("config", "options"),
)
def test_bad_options_name_the_option(
    options: dict[str, object], key: str | None, part: str
) -> None:
    if "config" in options:
        options = options | {
            "config": next(path for path in CONFIGS if path.stem == options["config"])
        }
    with pytest.raises(ConfigError) as caught:
        slice_from_options(**options)  # type: ignore[arg-type]
    assert caught.value.key == key
    assert part in caught.value.message


def test_every_parameter_can_be_an_axis() -> None:
    for name, parameter in ptm().parameters.items():
        if name != "L1":
            assert parameter.window is not None
            low, high = parameter.window
            assert (
                slice_from_options(slice=f"L1,{name}").axes[1].low == Fraction(low) < Fraction(high)
            )


@pytest.mark.parametrize(
    "title",
    [
        "title: >\n  Two lines\n  folded",
        "title: |\n  Two lines\n  folded",
        'title: "Two\\tlines\\u00a0folded"',
    ],
)
def test_titles_of_several_lines_become_one(tmp_path: Path, title: str) -> None:
    """Their results were refused by every command that reads one."""
    path = tmp_path / "title.yaml"
    path.write_text(f"name: t\n{title}\naxes: {{rho: [3, 4], L2: [0, 1]}}\n", encoding="utf-8")
    assert load(path).title == "Two lines folded"


def test_a_title_with_a_hidden_character_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "title.yaml"
    path.write_text(
        'name: t\ntitle: "a\\u202Eb"\naxes: {rho: [3, 4], L2: [0, 1]}\n', encoding="utf-8"
    )
    with pytest.raises(ConfigError, match="U\\+202E"):
        load(path)


@pytest.mark.parametrize(
    ("shorthand", "names"), [("k", ("k1", "k2", "k3")), ("l0", ptm().free_lengths)]
)
def test_a_value_for_all_springs_that_none_takes_is_refused_at_points_too(
    shorthand: str, names: tuple[str, ...]
) -> None:
    given = dict.fromkeys(names, "1")
    assert point_from_mapping(given)[names[0]] == 1
    with pytest.raises(
        ConfigError, match=f"{names[0]}, {names[1]} and {names[2]} are all given: leave it out"
    ) as caught:
        point_from_mapping(given | {shorthand: "2"})
    assert caught.value.key == shorthand
    assert point_from_mapping(given | {shorthand: "2", names[2]: f"{shorthand}/2"})[names[2]] == 1


@pytest.mark.parametrize("name", ["four-bar-free", "two-dof-tensegrity"])
def test_springs_of_mechanisms_with_loops_may_be_asked_to_be_in_tension(name: str) -> None:
    """They were refused as systems, which have no springs."""
    axes = load(name).axes
    over = {axis.name: [axis.low, axis.high] for axis in axes}
    record = {
        **plain_data(record_tree(name)),
        "design": {"maximise": "th1", "over": over, "where": {"tension": True}},
    }
    assert design_from(record).tension


def test_springs_of_a_system_are_not_asked_for() -> None:
    design = {"maximise": "x", "over": {"a": [0, 1], "b": [0, 1]}, "where": {"tension": True}}
    with pytest.raises(ConfigError, match="a system has no springs that would be in tension"):
        design_from({**plain_data(record_tree("cubic")), "design": design})
