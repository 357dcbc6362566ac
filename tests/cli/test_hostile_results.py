"""Stored results and records with characters that no terminal, page or picture can take.

A JSON file may spell half of a surrogate pair, a control character or a mark that turns the writing
direction as an escape, in every text and key. What is asked: the reader refuses each with its
place, and every command that reads a result says so in one printable line; texts that are only
unusual stay as they are.
"""

from __future__ import annotations

import copy
import json
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from support.certified_maps import circle
from support.maps import shipped
from support.replacing import replace

from ptmcad.answer.regionmap import RegionMap
from ptmcad.cli import run
from ptmcad.errors import ConfigError, shown_path
from ptmcad.question.config import load

RECORD = (
    "mechanism: ptm\nparameters: {L1: 1, F3: -10, F4: -10}\naxes: {rho: [2/5, 2/3], L2: [3/4, 1]}\n"
)
HIDDEN = {
    "half of a pair": "\ud800",
    "escape": "\x1b[31m",
    "direction": "\u202e",
    "null": "\0",
    "line": "\u2028",
}
Place = tuple[str | int, ...]


@pytest.fixture(name="stored", scope="module")
def small_map(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """A map of one cell, with a reference, as the JSON document that is stored."""
    from ptmcad.ask.classification import classify

    file = tmp_path_factory.mktemp("record") / "small.yaml"
    file.write_text(
        RECORD + 'reference: {source: "fig. 4,\\u00a0\\ttwo\\nlines", deep: {a: [b]}}\n',
        encoding="utf-8",
    )
    document: dict[str, Any] = json.loads(classify(load(file)).to_json())
    return document


def texts(value: Any, place: Place = ()) -> Iterator[tuple[Place, bool]]:
    """The places of all texts, and of all keys (True); of a list's entries, the first."""
    if isinstance(value, dict):
        for key, entry in value.items():
            yield (*place, key), True
            yield from texts(entry, (*place, key))
    elif isinstance(value, list):
        if value:
            yield from texts(value[0], (*place, 0))
    elif isinstance(value, str):
        yield place, False


def with_text(document: dict[str, Any], place: Place, is_key: bool, more: str) -> dict[str, Any]:
    """The document with a text or key made longer."""
    changed = copy.deepcopy(document)
    holder: Any = changed
    for step in place[:-1]:
        holder = holder[step]
    if is_key:
        holder[f"{place[-1]}{more}"] = holder.pop(place[-1])
    else:
        holder[place[-1]] += more
    return changed


@pytest.mark.parametrize("kind", HIDDEN)
@pytest.mark.fast_cases("half of a pair")
def test_no_text_of_a_result_has_a_hidden_character(stored: dict[str, Any], kind: str) -> None:
    """In a reference, which is stored and never shown, directions and separators of lines are the
    citation's affair.
    """
    places = list(texts(stored))
    assert len(places) > 100
    for place, is_key in places:
        if place[:2] == ("slice", "reference") and len(place) > 2 and kind in ("direction", "line"):
            continue
        with pytest.raises(ValueError):
            RegionMap.from_json(json.dumps(with_text(stored, place, is_key, HIDDEN[kind])))


def test_unusual_texts_stay(stored: dict[str, Any]) -> None:
    """A no-break space and line breaks in a citation, a tab in an expression."""
    assert (
        RegionMap.from_json(json.dumps(stored)).slice.reference["source"]
        == "fig. 4,\u00a0\ttwo\nlines"
    )
    stored = with_text(stored, ("slice", "text", "F3"), False, "\t")
    assert RegionMap.from_json(json.dumps(stored)).slice.text["F3"].endswith("\t")


@pytest.mark.parametrize("where", ['{source: "a\\a"}', '{a: {b: ["\\e[31m"]}}', '{a: {"b\\0": 1}}'])
def test_a_record_has_no_reference_that_its_result_could_not_store(
    tmp_path: Path, where: str
) -> None:
    """Otherwise the run's own result would be refused."""
    file = tmp_path / "r.yaml"
    file.write_text(RECORD + f"reference: {where}\n", encoding="utf-8")
    with pytest.raises(ConfigError, match="which a result cannot store") as refusal:
        load(file)
    assert refusal.value.line == 4


def test_what_a_run_stores_it_can_read(stored: dict[str, Any], shipped: Callable[..., Any]) -> None:
    for result in (RegionMap.from_json(json.dumps(stored)), shipped("fig4")):
        odd = replace(result.slice, reference={"a": "\u202e\u2028\u00a0\n"})
        whole = replace(result, slice=odd)
        assert RegionMap.from_json(whole.to_json()) == whole


@pytest.mark.parametrize(
    "command", [["report"], ["plot", "--format", "svg"]], ids=lambda command: command[0]
)
def test_paths_are_printed_so_that_no_terminal_obeys_them(
    stored: dict[str, Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, command: list[str]
) -> None:
    """click removes escape codes when the output is no terminal, so what is asked is what click is
    given.
    """
    result, folder, said = tmp_path / "r.json", tmp_path / "a\x1b[31m\u202eb", list[str]()
    result.write_text(json.dumps(stored), encoding="utf-8")
    monkeypatch.setattr("click.echo", lambda text, **_: said.append(str(text)))
    assert run([*command[:1], str(result), *command[1:], "--out", str(folder)]) == 0
    assert any(r"a\x1b[31m\u202eb" in text for text in said)
    assert all(text.isprintable() for text in said)


def test_a_long_path_is_shown_whole() -> None:
    path = Path("/", *["x" * 100] * 35)
    assert shown_path(path) == str(path)


@pytest.mark.parametrize("name", ["fig4", "certified"])
@pytest.mark.parametrize(
    "command",
    [["plot"], ["map", "--pixels", "5"], ["locate", "--at", "rho=1/2,L2=1/3"], ["report"],
     ["animate", "--path", "rho=3/4:6/5,L2=3/2", "--frames", "3"]],
    ids=lambda command: command[0],
)  # fmt: skip
def test_a_map_whose_regions_are_missing_is_refused(
    command: list[str], name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """By all commands that ask something of it, alike; `verify` says it of the claim."""
    whole = shipped("fig4") if name == "fig4" else circle(5)
    file = tmp_path / "damaged.json"
    file.write_text(json.dumps(json.loads(whole.to_json()) | {"regions": []}), encoding="utf-8")
    asked = [command[0], str(file), *command[1:]]
    assert run([*asked, *([] if command[0] == "locate" else ["--out", str(tmp_path)])]) == 2
    told = capsys.readouterr()
    assert told.out == "" and told.err == (
        f"error: {file}: the map contradicts itself: cell 0 names region 0, which is not there; check it with ptmcad "
        "verify\n"
    )
    assert [path.name for path in tmp_path.iterdir()] == ["damaged.json"]
    assert run(["verify", str(file)]) == 1
