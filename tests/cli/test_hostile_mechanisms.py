"""Hostile descriptions: each is refused in less than a second, with exit status 2 and clear lines."""

from __future__ import annotations

import os
import time
from pathlib import Path

import pytest

from ptmcad.cli import run
from ptmcad.errors import MAX_FAULTS

AXES = "axes: {k: [0, 1], W: [0, 1]}\n"


def record(point: str = "[cos(t), sin(t)]", more: str = "", name: str = "P") -> str:
    return (
        "mechanism:\n  parameters: {k: {kind: stiffness, default: 1}, W: {kind: force}}\n  unknowns: {t: angle}\n"
        f"  points: {{O: [0, 1], {name}: {point}}}\n  loads: {{{name}: [0, W]}}\n{more}{AXES}"
    )


def springs(number: int, ends: str = "[O, P]") -> str:
    return "  springs:\n" + f"    - {{between: {ends}, k: k}}\n" * number


def bodies(number: int) -> str:
    """Each at a point of the one before."""
    names = ["P", *(f"q{n}" for n in range(number))]
    body = "    b{}: {{at: {}, angle: t, points: {{q{}: [1, 0]}}}}\n"
    return "  bodies:\n" + "".join(body.format(n, names[n], n) for n in range(number))


def file(name: str) -> str:
    return f"mechanism: {name}\n{AXES}"


CASES = {
    "10^4 springs": (record(more=springs(10_000)), "is larger than 200000 bytes"),
    "4000 springs": (record(more=springs(4000)), "more than 10000 values"),
    "1000 springs": (record(more=springs(1000)), "1000 entries, more than the 400"),
    "400 springs to nowhere": (record(more=springs(400, "[O, Q]")), "there is no point 'Q'"),
    "cyclic aliases": ("mechanism: &m\n  points: *m\n" + AXES, "anchors (&) and aliases (*) are not accepted"),
    "a point named cos": (record(name="cos"), "'cos' has a meaning of its own"),
    "a point named sin": (record(name="sin"), "'sin' has a meaning of its own"),
    "a point named pi": (record(name="pi"), "'pi' has a meaning of its own"),
    "a point named nan": (record(name="nan"), "'nan' has a meaning of its own"),
    "10^5 levels": (record(f"['{'(' * 50_000}1{')' * 50_000}', 0]"), "characters, more than 10000"),
    "4900 levels": (record(f"['{'(' * 4900}1{')' * 4900}', 0]"), "more than 100 levels of nesting"),
    "10^5 levels of lists": (record("[" * 90_000), "levels of nesting"),
    "a bar too large to be proved": (
        record("['(k + W + cos(t) + sin(t))^14', cos(t)]", "  bars: [[O, P]]\n"), "bars.1: it is not proved that its",
    ),
    "a point of too many terms": (
        record("['(k + W + sin(t) + cos(t))^64', cos(t)]"), "points.P.1: this is too large to be multiplied out",
    ),
    "a spring of too many terms": (
        record("['(k + W + sin(t) + cos(t))^16', cos(t)]", springs(1)), "springs.1: this is too large to be multiplied",
    ),
    "equations of too many terms": (
        "system: {unknowns: {x: real, y: real}, equations: ['(k+W+x+y+1)^60', 'x-y']}\n" + AXES,
        "equations.1: this is too large to be multiplied out",
    ),
    "equations of too many terms together": (
        "system: {unknowns: {x: real, y: real}, equations: ['(k+W+x+y+1)^29', '(k-W+x-y+1)^29']}\n" + AXES,
        "equations.2: with what stands before, this is too large",
    ),
    "100 bodies on bodies": (record(more=bodies(100) + "  bars: [[O, q99]]\n" + springs(1)), "is not constant"),
    "101 bodies": (record(more=bodies(101)), "101 entries, more than the 100"),
    "a large multiple": (record("['cos(65*t)', 0]"), "at most 64"),
    "1500 names": (
        f"system: {{unknowns: {{x: real}}, equations: ['x+{'+'.join(f'a{n}' for n in range(1500))}']}}\n" + AXES,
        "1500 names of parameters, more than 400",
    ),
    "13 unknowns": (
        f"system: {{unknowns: {{{', '.join(f'x{n}: real' for n in range(13))}}}, equations: []}}\n" + AXES,
        "13 entries, more than the 12",
    ),
    "its own file": (file("record.yaml"), "the record names itself as its mechanism's file"),
    "its own file, by a detour": (file("dir.yaml/../record.yaml"), "the record names itself"),
    "its own file, by a link": (file("itself.yaml"), "the record names itself"),
    "a file that names another": (file("other.yaml"), "it does not name another one"),
    "a file outside": (file("../other.yaml"), "not in the record's folder nor below it"),
    "an absolute path": (file("/etc/other.yaml"), "not in the record's folder nor below it"),
    "a link that leads out": (file("link.yaml"), "not in the record's folder nor below it"),
    "a pipe": (file("pipe.yaml"), "is a device or a pipe"),
    "a null character": (file('"a\\0.yaml"'), "cannot name a file"),
    "a circle of links": (file("circle.yaml"), "cannot"),
    "a long name": (file("a" * 5000 + ".yaml"), "File name too long"),
    "a folder": (file("dir.yaml"), "is a folder"),
    "no file": (file("missing.yaml"), "there is no such file"),
}  # fmt: skip


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("command", ["check", "classify"])
@pytest.mark.slow_cases(
    "check-1000 springs",
    "classify-4000 springs",
    "classify-1000 springs",
    "classify-400 springs to nowhere",
    "classify-a bar too large to be proved",
    "classify-100 bodies on bodies",
    "classify-1500 names",
)
def test_hostile_descriptions(
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
    case: str,
    command: str,
) -> None:
    folder = tmp_path / "records"
    folder.mkdir()
    monkeypatch.chdir(folder)
    os.mkfifo("pipe.yaml")
    Path("dir.yaml").mkdir()
    Path("link.yaml").symlink_to(tmp_path / "other.yaml")
    Path("itself.yaml").symlink_to("record.yaml")
    Path("circle.yaml").symlink_to("circle.yaml")
    Path("other.yaml").write_text(file("record.yaml"), encoding="utf-8")
    text, part = CASES[case]
    Path("record.yaml").write_text(text, encoding="utf-8")
    start = time.process_time()  # of this process: a busy machine makes no refusal late
    assert run([command, "record.yaml"]) == 2
    assert time.process_time() - start < 1
    out, err = capsys.readouterr()
    assert out == ""
    first, *others = err.splitlines()
    assert part in first
    assert len(others) <= (MAX_FAULTS + 2 if command == "check" else 0)
    assert all(line.isprintable() and len(line) < 1100 for line in (first, *others))
