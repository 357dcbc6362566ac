"""The stamp that binds a picture to the JSON it was written with."""

import re
from hashlib import sha256
from pathlib import Path

import numpy as np
import pytest
from matplotlib.image import imread

from ptmcad.cli import run

FORMATS = ("png", "svg", "pdf", "eps")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    where = tmp_path_factory.mktemp("stamped")
    formats = ",".join(("json", "csv", *FORMATS))
    assert run(["classify", "fig2", "--out", str(where), "--format", formats]) == 0
    return where


@pytest.mark.parametrize("suffix", FORMATS)
def test_a_picture_carries_the_hash_of_its_json(folder: Path, suffix: str) -> None:
    (found,) = re.findall(
        rb"sha256 of fig2\.json: ([0-9a-f]{64})", (folder / f"fig2.{suffix}").read_bytes()
    )
    assert found.decode() == sha256((folder / "fig2.json").read_bytes()).hexdigest()


def test_readers_pass_over_the_stamp(folder: Path, tmp_path: Path) -> None:
    import xml.etree.ElementTree as ET

    from ptmcad.process.output import stamp

    ET.parse(folder / "fig2.svg")
    before = imread(folder / "fig2.png")
    again, voucher = tmp_path / "a.png", tmp_path / "a -- b.json"
    again.write_bytes((folder / "fig2.png").read_bytes())
    drawn = tmp_path / "a.svg"
    drawn.write_bytes((folder / "fig2.svg").read_bytes())
    voucher.write_text("{}")
    stamp([again, drawn], voucher)
    assert np.array_equal(before, imread(again))
    ET.parse(drawn)
    assert (folder / "fig2.pdf").read_bytes().rstrip().endswith(b"%%EOF")
