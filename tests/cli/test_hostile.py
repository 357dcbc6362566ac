"""Hostile input at the command line, each case in a forked process of its own whose memory is
limited.

What is asked of each: exit status 2, one message of bounded length without a character that a
terminal obeys, no code of the input run. The limit of the child's address space turns a blow-up of
memory into a failure; a hang never ends.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from support.limited import Limited

from ptmcad.cli import run

Refused = Callable[[list[str]], str]
AXES = "axes: {rho: [0, 2], L2: [0, 2]}\n"
MEMORY = 300 << 20
"""Bytes of address space, of which the interpreter and its libraries take a good part."""


@pytest.fixture(scope="session")
def limited(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Limited]:
    with Limited(MEMORY, tmp_path_factory.mktemp("limited")) as command_line:
        yield command_line


@pytest.fixture(name="refused")
def refused_fixture(limited: Limited, tmp_path: Path) -> Callable[[list[str]], str]:
    """The message with which the command line refuses its arguments, in the test's folder."""

    def refused(arguments: list[str]) -> str:
        done = limited.run(arguments, tmp_path)
        text = done.err.decode("utf-8")
        assert done.status == 2, (done.status, text[-2000:], done.out[-500:])
        assert text.startswith("error: ")
        assert text.endswith("\n")
        assert text[:-1].isprintable()
        assert len(text) < 1100
        assert not (tmp_path / "pwned").exists()
        return text

    return refused


def yaml_bomb() -> str:
    lines = ["a: &a [x, x, x, x, x, x, x, x, x]"]
    lines += [
        f"{b}: &{b} [{', '.join(['*' + a] * 9)}]"
        for a, b in zip("abcdefghijkl", "bcdefghijklm", strict=True)
    ]
    return "\n".join(lines)


def value(text: str) -> str:
    return AXES + f"parameters:\n  F3: {text}\n"


RECORDS: dict[str, tuple[str | bytes, str]] = {
    "alias bomb": (yaml_bomb(), "anchors (&) and aliases (*) are not accepted"),
    "10 MB": ("#" * 10_000_000, "is larger than 200000 bytes"),
    "10 MB in one value": (value("1" * 10_000_000), "is larger than"),
    "10^5 values": ("reference: {a: [" + "a," * 90_000 + "]}\n" + AXES, "more than 10000 values"),
    "10^5 empty lists": (
        "reference: {a: [" + "[]," * 60_000 + "]}\n" + AXES,
        "more than 10000 values",
    ),
    "10^5 keys": ("".join(f"{n}: 1\n" for n in range(20_000)), "more than 10000 values"),
    "a long key over many": (
        "reference:\n  ? "
        + "k" * 90_000
        + "\n  : {"
        + ", ".join(f"a{n}: 1" for n in range(9_000))
        + "}\n"
        + AXES,
        "a key has more than 100 characters",
    ),
    "10^5 levels of lists": ("[" * 100_000, "levels of nesting"),
    "10^5 levels of mappings": ("{a: " * 40_000, "levels of nesting"),
    "10^5 levels of blocks": ("- " * 90_000, "levels of nesting"),
    "10^5 levels of keys": ("? " * 90_000, "levels of nesting"),
    "10^4 directives": (
        "".join(f"%TAG !a{n}! b\n" for n in range(10_000)) + "---\n" + AXES,
        "starts with %",
    ),
    "10^5 documents": ("---\n" * 40_000, "a second document"),
    "a long tag": (f"title: !{'x' * 150_000} a\n" + AXES, "is not accepted: leave it out"),
    "a Python object": ("!!python/object/apply:os.system ['touch pwned']", "the tag"),
    "a Python name": (AXES + "title: !!python/name:os.system", "the tag"),
    "binary tag": (AXES + "title: !!binary aGVsbG8=", "the tag"),
    "merge key": (AXES + "<<: {count: total}", "merge keys are not accepted"),
    "duplicate key": (AXES + AXES, "the key occurs twice"),
    "10^5 digits": (value("9" * 100_000), "characters, more than 10000"),
    "9000 digits": (value("9" * 9000), "more than 2000 digits"),
    "a huge decimal exponent": (value("1e999999999"), "a decimal exponent is at most 1000"),
    "10^5 parentheses": (value("(" * 50_000 + "1" + ")" * 50_000), "characters, more than 10000"),
    "4000 parentheses": (value("(" * 4000 + "1" + ")" * 4000), "levels of nesting"),
    "4000 signs": (value("'" + "-" * 4000 + "1'"), "levels of nesting"),
    "a tower of powers": (value("((rho**9)**9)**9"), "too large"),
    "constant tower": (value("9**9**9**9"), "bits"),
    "a huge exponent": (value("rho**1000000000"), "at most 64"),
    "a degree that would take hours": (value("rho**40"), "at most 32"),
    "many terms": (value("(rho + L2 + 1)**30"), "terms"),
    "import": (value("__import__('os').system('touch pwned')"), "'_' cannot be used"),
    "call": (value("os.system('touch pwned')"), "'.' cannot be used"),
    "attribute": (value("rho.__class__.__mro__"), "'.' cannot be used"),
    "lambda": (value("'(lambda: 1)()'"), "':' cannot be used"),
    "zero denominator": (value("1/(rho - rho)"), "division by zero"),
    "pole in the window": (value("1/(rho - 1)"), "division by zero inside the window"),
    "nan": (value("nan"), "not a number"),
    "yaml nan": (value(".nan"), "is not a number"),
    "infinity": (value("-.inf"), "is not a number"),
    "hexadecimal": (value("0x10"), "side by side"),
    "0x": (value("0x"), "side by side"),
    "octal": (value("0o17"), "side by side"),
    "leading zeros": (value("017"), "leading zeros"),
    "grouped digits": (value("1_000"), "not grouped"),
    "sexagesimal": (value("1:30"), "':' cannot be used"),
    "date": (value("2001-01-01T00:00:00Z"), "side by side"),
    "boolean": (value("on"), "yes-or-no"),
    "null": (value("~"), "has no value"),
    "Cyrillic o in rho": (value("rh\u043e"), "(U+043E) cannot be used"),
    "fullwidth digit": (value("\uff11"), "(U+FF11) cannot be used"),
    "Arabic digit": (value("\u0661"), "(U+0661) cannot be used"),
    "look-alike of an axis": ("axes: {rho: [0, 2], L\u0662: [0, 2]}", "cannot name an axis"),
    "right-to-left override": (value("'1\u202e2'"), "cannot be used"),
    "no-break space": (value("1\u00a0+ 2"), "cannot be used"),
    "empty window": ("axes: {rho: [1, 1], L2: [0, 2]}", "is empty"),
    "reversed window": ("axes: {rho: [1, 1-1e-400], L2: [0, 2]}", "is reversed"),
    "infinite window": ("axes: {rho: [0, inf], L2: [0, 2]}", "not a number"),
    "1e-400 wide, of a length below zero": (
        "axes: {rho: [-1e-400, 0], L2: [0, 2]}",
        "goes below zero",
    ),
    "null characters": (AXES + "\0", "is not YAML"),
    "escape codes": (AXES + '"\\e]0;title\\a\\e[31m": 1', "unknown key"),
    "escape codes in a value": (AXES + 'count: "\\e[31m\\n"', "is none of"),
    "newline in a name": (AXES + 'name: "a\\n/../b"', "cannot name a file"),
    "slash in a name": (AXES + "name: ../../b", "cannot name a file"),
    "UTF-16": (AXES.encode("utf-16"), "is not UTF-8"),
    "UTF-16 without a mark": (AXES.encode("utf-16-le"), "is not YAML"),
    "surrogate": (b"title: \xed\xa0\x80\n" + AXES.encode(), "is not UTF-8"),
    "random bytes": (bytes(range(256)) * 50, "is not UTF-8"),
    "empty": ("", "is empty"),
}


@pytest.mark.parametrize("case", RECORDS)
def test_records(tmp_path: Path, refused: Refused, case: str) -> None:
    content, part = RECORDS[case]
    (tmp_path / "record.yaml").write_bytes(
        content if isinstance(content, bytes) else content.encode()
    )
    message = refused(["classify", "record.yaml"])
    assert message.startswith("error: record.yaml")
    assert part in message


SLICE = ["classify", "--slice", "L2,rho"]
OPTIONS: dict[str, tuple[list[str], str]] = {
    "10^3 settings": ([*SLICE, *["--set", "F3=1"] * 1000], "is given twice"),
    "10^5 settings": ([*SLICE, *["--set", "F3=1"] * 100_000], "200003 arguments"),
    "10^5 digits": ([*SLICE, "--set", "F3=" + "9" * 100_000], "characters, more than"),
    "huge exponent": ([*SLICE, "--set", "F3=rho**1000000000"], "at most 64"),
    "escape codes in a name": ([*SLICE, "--set", "\x1b[31m=1"], "unknown parameter '\\x1b[31m'"),
    "escape codes in a value": ([*SLICE, "--set", "F3=\x1b[31m"], "cannot be used"),
    "newlines": (["classify", "--slice", "L2,\n\n"], "is not X,Y"),
    "bytes that are not UTF-8": ([*SLICE, "--set", "\udcff\udcfe=1"], "unknown parameter '\\udcff\\udcfe'"),
    "a long axis": (["classify", "--slice", "L2," + "x" * 100_000], "cannot name an axis"),
    "many axes": (["classify", "--slice", "L2," * 40_000], "is not X,Y"),
    "infinite range": ([*SLICE, "--range", "rho=0:inf"], "not a number"),
    "import": ([*SLICE, "--set", "F3=__import__('os').system('touch pwned')"], "cannot be used"),
    "tiny tolerance": ([*SLICE, "--area-tolerance", "1e-999999999"], "decimal exponent"),
    "a long file name": (["classify", "x" * 100_000], "File name too long"),
    "a file name with escape codes": (["classify", "\x1b[31m\n.yaml"], "error: \\x1b[31m\\n.yaml: there is no such"),
    "a file name that is not UTF-8": (["classify", "\udcff.yaml"], "no such file"),
    "output into a device": ([*SLICE, "--out", "/dev/null"], "cannot be"),
}  # fmt: skip


@pytest.mark.parametrize("case", OPTIONS)
def test_options(refused: Refused, case: str) -> None:
    arguments, part = OPTIONS[case]
    assert part in refused(arguments)


PARSER = {
    "a long command": ["x" * 100_000],
    "a command with escape codes": ["\x1b[31m\n"],
    "a long option": ["classify", "--" + "x" * 100_000],
    "an option with escape codes": ["classify", "--\x1b[31m\nx"],
    "a long choice": [*SLICE, "--count", "x" * 100_000],
    "a long number": [*SLICE, "--jobs", "9" * 100_000],
    "a long list": [*SLICE, "--format", "x," * 50_000],
    "a long seed": ["verify", "x", "--seed", "x" * 100_000],
}


@pytest.mark.parametrize("case", PARSER)
def test_what_the_parser_of_options_refuses(case: str, capfd: pytest.CaptureFixture[str]) -> None:
    """One line, as of everything else that is refused."""
    assert run(PARSER[case]) == 2
    (line,) = capfd.readouterr().err.splitlines()
    assert line.startswith("error: ")
    assert line.isprintable() and len(line) < 1100


@cache
def good_text(shipped: Callable[..., Any]) -> str:
    return shipped("fig2").to_json()


@pytest.fixture(name="files")
def odd_files(tmp_path: Path, shipped: Callable[..., Any]) -> dict[str, str]:
    """Files that are none, by what they are; and a good result."""
    (tmp_path / "good.json").write_text(good_text(shipped), encoding="utf-8")
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "loop").symlink_to("loop")
    with (tmp_path / "sparse").open("wb") as file:
        file.truncate(10**10)
    return {
        "pipe": "pipe", "loop": "loop", "sparse": "sparse", "folder": ".", "null": "/dev/null", "zero": "/dev/zero",
        "full": "/dev/full", "missing": "missing", "file as folder": "good.json/a", "terminal": "/dev/tty",
    }  # fmt: skip


@pytest.mark.parametrize(
    "kind",
    [
        "pipe",
        "loop",
        "sparse",
        "folder",
        "null",
        "zero",
        "full",
        "missing",
        "file as folder",
        "terminal",
    ],
)
@pytest.mark.parametrize(
    "command",
    [
        ["classify", ""],
        ["verify", ""],
        ["locate", "", "--at", "rho=1,L2=1"],
        ["locate", "good.json", "--csv", ""],
    ],
    ids=["record", "verify", "locate", "points"],
)
def test_files_that_are_none(
    refused: Refused, files: dict[str, str], command: list[str], kind: str
) -> None:
    """A pipe has no writer: a plain open() would wait for one for ever."""
    message = refused([part or files[kind] for part in command])
    assert message.startswith(f"error: {files[kind]}")
    if kind in ("pipe", "null", "zero", "full"):
        assert "is a device or a pipe" in message


def result_texts() -> dict[str, str | bytes]:
    return {
        "10^6 levels": "[" * 10**6,
        "10^6 levels of objects": '{"a":' * 10**6,
        "10^6 digits": "9" * 10**6,
        "10^6 numbers": "[" + "1," * 10**6 + "1]",
        "20 MB": " " * 20_000_000,
        "null characters": "\0" * 100,
        "escape codes": '{"format": "\\u001b[31m\\n"}',
        "a long format": f'{{"format": "{"x" * 10**6}"}}',
        "UTF-16": '{"format": 1}'.encode("utf-16"),
        "NaN": "NaN",
        "not closed": '{"format": "ptmcad-region-map/1"',
    }


@pytest.mark.parametrize("case", result_texts())
@pytest.mark.parametrize(
    "command", [["verify"], ["locate", "--at", "rho=1,L2=1"]], ids=["verify", "locate"]
)
def test_results(tmp_path: Path, refused: Refused, command: list[str], case: str) -> None:
    content = result_texts()[case]
    (tmp_path / "r.json").write_bytes(content if isinstance(content, bytes) else content.encode())
    assert refused([command[0], "r.json", *command[1:]]).startswith("error: r.json")


POINTS: dict[str, tuple[str | bytes, str]] = {
    "null characters": ("rho,L2\n\0,1\n", "cannot be used"),
    "UTF-16": ("rho,L2\n1,1\n".encode("utf-16"), "is not UTF-8"),
    "not UTF-8": (b"rho,L2\n1,2\n\xff,1\n", "points.csv:3: is not UTF-8"),
    "an axis twice": ("rho,rho,L2\n1,2,3\n", "each once"),
    "a long line": ("rho,L2\n" + "1" * 10**7, "the line has more than 100000 bytes"),
    "10^6 columns": ("rho,L2" + "," * 10**6 + "\n1,1\n", "the line has more than"),
    "a quotation mark that is never closed": (
        'rho,L2\n"' + "1\n" * 10**6,
        "is a quotation mark missing?",
    ),
    "many fields in a row of many lines": (
        'rho,L2\n"' + '","\n' * 10**6,
        "is a quotation mark missing?",
    ),
    "10^5 digits": ("rho,L2\n" + "9" * 90_000 + ",1\n", "characters, more than"),
    "a huge exponent": ("rho,L2\n1e999999999,1\n", "decimal exponent"),
    "escape codes": ("rho,L2\n\x1b[31m,1\n", "cannot be used"),
    "a formula": ("rho,L2\n=1+1,1\n", "cannot be used"),
    "nan": ("rho,L2\nnan,1\n", "not a number"),
    "no rows": ("", "the first row must name"),
    "blank lines": ("\n" * 1000, "the first row must name"),
    "escape codes in the header": ("rh\x1bo,L2\n1,1\n", "the first row must name"),
}


@pytest.mark.parametrize("case", POINTS)
def test_points(tmp_path: Path, refused: Refused, files: dict[str, str], case: str) -> None:
    content, part = POINTS[case]
    (tmp_path / "points.csv").write_bytes(
        content if isinstance(content, bytes) else content.encode()
    )
    assert part in refused(["locate", "good.json", "--csv", "points.csv"])


@pytest.mark.parametrize(
    "at",
    ["rho=\x1b[31m,L2=1", "\x1b[31m\n", ",".join(f"a{n}=1" for n in range(10_000)), "rho=1,L2=\udcff", "rho=1e9999"],
    ids=["escape codes", "nothing but", "10^4 names", "not UTF-8", "huge"],
)  # fmt: skip
def test_points_as_options(refused: Refused, files: dict[str, str], at: str) -> None:
    refused(["locate", "good.json", "--at", at])
