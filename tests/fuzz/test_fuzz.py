"""Fuzzing in the test suite: some hundred cases; all are in ``make fuzz``.

A case that takes longer than five seconds of processor time is a failure, since that is what is
asked of hostile input.
"""

from __future__ import annotations

import json
from pathlib import Path
from random import Random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support.examples import examples
from support.few import few

from fuzz import targets
from fuzz.damage import damaged_bytes, damaged_tokens, damaged_tree
from fuzz.seeds import records, results
from fuzz.watch import Tally, watched
from ptmcad.errors import PtmcadError

FAST = {"record": 60, "options": 50, "points": 25, "small": 4, "result": 20}


KINDS = list(FAST)


def assert_clean(tally: Tally, cases: int) -> None:
    assert not tally.findings, "\n".join(map(str, tally.findings))
    assert tally.cases == cases


@pytest.mark.parametrize("kind", few(KINDS, *(kind for kind in KINDS if kind != "result")))
def test_some_cases(kind: str, tmp_path: Path) -> None:
    tally = watched(kind, range(FAST[kind]), tmp_path)
    assert_clean(tally, FAST[kind])
    assert len(tally.outcomes) >= 2, "the cases are all refused or all accepted: they test nothing"


@given(
    st.binary(max_size=300)
    | st.text(max_size=300).map(lambda text: text.encode("utf-8", "surrogatepass"))
)
@settings(max_examples=examples(100))
def test_any_bytes_are_a_record_or_a_refusal(data: bytes) -> None:
    """Hypothesis shrinks what it finds."""
    assert targets.run("record", data) in ("accepted", "refused")


json_values = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=8),
    lambda inner: (
        st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=8), inner, max_size=3)
    ),
    max_leaves=8,
)


@given(st.data())
@settings(max_examples=examples(100))
def test_any_value_in_place_of_a_results_value(data: st.DataObject) -> None:
    """One entry of a result, wherever it stands, is replaced by any JSON value."""
    tree = json.loads(data.draw(st.sampled_from(results()[2:4])))
    container = tree
    while True:
        keys = sorted(container) if isinstance(container, dict) else list(range(len(container)))
        key = data.draw(st.sampled_from(keys))
        inner = container[key]
        if not isinstance(inner, dict | list) or not inner or data.draw(st.integers(0, 3)) == 0:
            break
        container = inner
    container[key] = data.draw(json_values)
    assert targets.run("result", json.dumps(tree).encode()) in ("verified", "violated", "refused")


@pytest.mark.parametrize("seed", range(3))
def test_damage_is_the_same_every_time_and_does_damage(seed: int) -> None:
    data = results()[0]

    def all_damage() -> tuple[bytes | str, ...]:
        rng = Random(seed)
        tree = json.loads(data)
        return (
            damaged_bytes(data, rng, records()[0]),
            damaged_tokens(data.decode(), rng),
            damaged_tree(tree, rng),
        )

    assert all_damage() == all_damage()
    assert all(damaged not in (data, data.decode()) for damaged in all_damage())


def wait(data: bytes) -> str:
    while True:
        data = data[:1]


# name -> what the watchdog has to say of a target that does this
BROKEN = {
    "raises": (lambda _: 1 // 0, "ZeroDivisionError"),
    "speaks in control characters": (lambda _: _refuse("\x1b[31m"), ""),
    "fills the memory": (lambda _: "x" * (10 << 30), "MemoryError"),
    "never ends": (wait, "takes longer than 0.1 s"),
    "ends the process": (lambda _: __import__("os")._exit(9), "ended the process with 9"),
}  # fmt: skip


def _refuse(message: str) -> str:
    raise PtmcadError(message)


@pytest.mark.slow
@pytest.mark.parametrize("name", BROKEN)
def test_the_watchdog_sees(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Targets that do what must not happen are reported with their input, and the next case is run
    all the same.
    """
    target, what = BROKEN[name]
    monkeypatch.setitem(targets.KINDS, name, (lambda seed: b"input %d" % seed, target))
    tally = watched(
        name, range(2), tmp_path, limit=0.1 if target is wait else 0.5, start_method="fork"
    )
    assert tally.cases == 2
    if not what:  # `PtmcadError` makes its messages printable
        assert not tally.findings
        return
    assert [what in finding.what for finding in tally.findings] == [True, True]
    assert {finding.file.read_bytes() for finding in tally.findings if finding.file} == {
        b"input 0",
        b"input 1",
    }


@pytest.mark.parametrize("text", ["a\nb", "\x1b[31m", "\u202e", "x" * 2000])
def test_a_bad_message_is_seen(text: str) -> None:
    with pytest.raises(targets.BadMessageError):
        targets.check_message(text)
