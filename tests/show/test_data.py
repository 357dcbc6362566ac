"""Maps as data frames, CSV and NPZ: read back by pandas, NumPy and the csv module."""

from __future__ import annotations

import io
import sys
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
import yaml
from support.certified_map import certified_map
from support.maps import shipped

import ptmcad
from ptmcad.cli import run
from ptmcad.errors import ConfigError
from ptmcad.show import data

pytestmark = pytest.mark.fine


def test_regions_and_cells_as_frames() -> None:
    from pandas import isna

    result = shipped("fig4")
    regions, cells = result.to_dataframe(), result.to_dataframe("cells")
    assert list(regions.stable) == [r.stable for r in result.regions]
    assert [("" if isna(t) else t) for t in regions.total] == [
        "" if r.total is None else r.total for r in result.regions
    ]
    for row, region in zip(regions.itertuples(), result.regions, strict=True):
        assert Fraction(row.area_low) <= region.area[0] < region.area[1] <= Fraction(row.area_high)
    assert (cells.groupby("region").size() == [len(r.cells) for r in result.regions]).all()
    for row in cells.itertuples():
        assert result.locate(rho=row.rho, L2=row.L2).cell == row.cell


def test_components_and_boundaries_as_frames() -> None:
    result = shipped("fig3")
    components = result.to_dataframe("components")
    assert list(components.kind) == [c.kind.value for c in result.components]
    pieces, table = result.boundaries("1/100"), result.to_dataframe("boundaries", tolerance="1/100")
    x, y = result.slice.axis_names
    for number, piece in enumerate(pieces):
        points = table[table.piece == number][[x, y]].dropna().to_numpy()
        assert (points == piece.points).all()
    assert table[x].isna().sum() == len(pieces) - 1


def test_a_grid_as_a_frame() -> None:
    result = shipped("fig4")
    grid, table = result.grid(6, 4), result.to_dataframe("grid", columns=6, rows=4)
    assert (table.stable.to_numpy().reshape(4, 6) == grid.stable).all()
    assert (table.rho.to_numpy().reshape(4, 6) == grid.x).all()
    assert (table.L2.to_numpy().reshape(4, 6) == grid.y[:, None]).all()


def test_axes_named_like_columns_keep_apart() -> None:
    record = yaml.safe_load("""
        name: clash
        system: {unknowns: {z: real}, equations: [z^2 - region*left]}
        axes: {region: [-1, 1], left: [-1, 1]}
    """)
    table = ptmcad.classify(ptmcad.slice_from_mapping(record)).to_dataframe("cells")
    assert {"region", "region_", "left_"} <= set(table.columns)


def test_arrays_of_an_exact_and_a_certified_map(tmp_path: Path) -> None:
    for result in (shipped("fig2"), certified_map()):
        pieces, grid = result.boundaries(), result.grid(8)
        content = data.npz_bytes(result, pieces, grid)
        assert content == data.npz_bytes(result, pieces, grid)
        with np.load(io.BytesIO(content)) as arrays:
            assert tuple(arrays["axes"]) == result.slice.axis_names
            assert (arrays["region"] == grid.region).all()
            lines = np.split(arrays["boundary"], np.flatnonzero(np.isnan(arrays["boundary"][:, 0])))
            assert len(lines) == len(pieces) == len(arrays["left"])
            assert all(
                (line[line.shape[0] - len(p.points) :] == p.points).all()
                for line, p in zip(lines, pieces, strict=True)
            )
            assert len(arrays["piece"]) == len(arrays["boundary"])
            assert list(arrays["region_stable"]) == [r.stable for r in result.regions]


@pytest.mark.parametrize(
    ("what", "options", "message"),
    [
        ("region", {}, "'region' is not among regions, cells, components, boundaries, grid"),
        ("cells", {"columns": 3}, "the table cells has no option 'columns'; its options: none"),
        (
            "grid",
            {"tolerance": 3},
            "the table grid has no option 'tolerance'; its options: columns, rows",
        ),
    ],
)
def test_unknown_tables_and_options_are_refused(
    what: str, options: dict[str, object], message: str
) -> None:
    with pytest.raises(ConfigError, match=message):
        shipped("fig2").to_dataframe(what, **options)


def test_without_pandas_the_message_names_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(
        ConfigError,
        match=r"needs the package pandas, which is not installed: pip install 'ptmcad\[data\]'",
    ):
        shipped("fig2").to_dataframe()


def test_commands_write_numbers(tmp_path: Path) -> None:
    """`classify` and `plot` write the same ones."""
    for arguments in (
        ["classify", "--slice", "L2,rho", "--format", "json,csv,npz", "--out", str(tmp_path / "a")],
        [
            "plot",
            str(tmp_path / "a" / "slice-L2-rho.json"),
            "--format",
            "csv,npz",
            "--out",
            str(tmp_path / "b"),
        ],
    ):
        assert run([*arguments, "--pixels", "20x10", "--boundary-tolerance", "1e-2"]) == 0
    names = {
        "slice-L2-rho-boundaries.csv",
        "slice-L2-rho-regions.csv",
        "slice-L2-rho-cells.csv",
        "slice-L2-rho.npz",
    }
    assert {p.name for p in (tmp_path / "b").iterdir()} == names
    for name in names:
        assert (tmp_path / "a" / name).read_bytes() == (tmp_path / "b" / name).read_bytes()
    with np.load(tmp_path / "a" / "slice-L2-rho.npz") as arrays:
        assert arrays["region"].shape == (10, 20)


@pytest.mark.parametrize(
    ("option", "value", "message"),
    [
        ("--pixels", "0x5", "is not a size such as 400 or 400x300"),
        ("--pixels", "400 x 3", "is not a size such as"),
        ("--pixels", "99999", "of 1 to 10000 each"),
        ("--boundary-tolerance", "1", "is not between 0 and 1"),
        ("--boundary-tolerance", "a+", "--boundary-tolerance"),
    ],
)
def test_bad_options_are_refused_before_anything_is_read(
    option: str, value: str, message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(["plot", "nowhere.json", option, value]) == 2
    assert message in capsys.readouterr().err
