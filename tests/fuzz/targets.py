"""What the fuzzer runs on an input, and how it makes one.

Guarantee: a case is bytes, made from its kind and a seed, the same in every process; `run` answers
with one word for what became of it, and raises whatever must not happen: an exception that is no
`PtmcadError`, or a message that is too long or has characters that a terminal obeys.
"""

from __future__ import annotations

import json
import tempfile
from collections.abc import Callable
from fractions import Fraction
from functools import cache
from itertools import islice
from pathlib import Path
from random import Random

import ptmcad
from fuzz import records as grammar
from fuzz.damage import damaged_bytes, damaged_tokens, damaged_tree, nasty
from fuzz.records import expression
from fuzz.seeds import CONFIGS, records, results
from ptmcad.cli.locate import rows_of
from ptmcad.cli.storedresults import read_result
from ptmcad.errors import PtmcadError
from ptmcad.question.config import MAX_DEGREE, slice_from_options
from ptmcad.question.slice import Slice
from ptmcad.show.report import page

MAX_MESSAGE = 1200


class BadMessageError(AssertionError):
    """A refusal that is no clear message."""


# ------------------------------------------------------------------------------------------------------- results


def make_result(seed: int) -> bytes:
    """A damaged result file."""
    rng = Random(f"result {seed}")
    data = rng.choice(results())
    kind = rng.randrange(10)
    if kind <= 1:
        return damaged_bytes(data, rng, rng.choice(results()))
    if kind <= 4:
        return damaged_tokens(data.decode(), rng).encode("utf-8", "surrogatepass")
    return damaged_tree(json.loads(data), rng).encode("utf-8", "surrogatepass")


@cache
def first_result() -> ptmcad.RegionMap:
    """An honest result."""
    return ptmcad.RegionMap.from_json(results()[0].decode())


def try_result(data: bytes) -> str:
    """Read, ask for points and a table, write a report, verify."""
    with tempfile.NamedTemporaryFile(suffix=".json") as file:
        file.write(data)
        file.flush()
        result = read_result(Path(file.name))
    first, second = result.slice.axes
    middle = {a.name: (a.low + a.high) / 2 for a in (first, second)}
    answers = []
    for point in (
        middle,
        {first.name: first.low + Fraction(1, 10**9), second.name: second.high - Fraction(1, 7)},
        {first.name: "1e300", second.name: "-1e-300"},
        dict(result.cells[-1].sample) if result.cells else {},
    ):
        answers.append(_refusable(lambda point=point: result.locate(**point).status.name))  # type: ignore[misc]
    result.table()
    if (
        len(data) % 8 == 0
    ):  # a page takes some tenths of a second, a case without it some milliseconds
        answers.append(_refusable(lambda: page(result)[:9]))
    report = ptmcad.verify(result)
    report.table()
    check_message(str(report.violation))
    return "verified" if report.ok else "violated"


def _refusable(question: Callable[[], str]) -> str:
    try:
        return question()
    except PtmcadError as error:
        check_message(str(error))
        return "refused"


# ------------------------------------------------------------------------------------------------------- records


def make_record(seed: int) -> bytes:
    """A record: a shipped one after damage, or one that a grammar has grown, with or without
    damage.
    """
    rng = Random(f"record {seed}")
    data = rng.choice(records())
    kind = rng.randrange(10)
    if kind <= 1:
        return damaged_bytes(data, rng, rng.choice(records()))
    if kind <= 4:
        return damaged_tokens(data.decode(), rng).encode("utf-8", "surrogatepass")
    text = grammar.record(rng, rng.choice((0.0, 0.02, 0.1)))
    return (damaged_tokens(text, rng) if kind >= 9 else text).encode("utf-8", "surrogatepass")


def try_record(data: bytes) -> str:
    """Everything that ``ptmcad classify CONFIG`` does before it computes."""
    with tempfile.NamedTemporaryFile(suffix=".yaml") as file:
        file.write(data)
        file.flush()
        return _sound(slice_from_options(file.name))


def make_options(seed: int) -> bytes:
    """Options of ``ptmcad classify`` as JSON."""
    return json.dumps(grammar.options(Random(f"options {seed}"))).encode()


def try_options(data: bytes) -> str:
    """Everything that ``ptmcad classify`` with these options does before it computes."""
    options = json.loads(data)
    if "config" in options:
        options["config"] = sorted(CONFIGS.glob("*.yaml"))[options["config"]]
    return _sound(slice_from_options(**options))


def _sound(slice: Slice) -> str:
    """That a slice is what its class promises."""
    for axis in slice.axes:
        assert axis.low < axis.high
    for value in slice.parameters.values():
        assert value.degree <= MAX_DEGREE
        value.to_text(slice.axis_names)
    assert slice.heading.isprintable() or slice.title
    return "accepted"


def make_small(seed: int) -> bytes:
    """A record that is cheap to classify."""
    return grammar.tame_record(Random(f"small {seed}")).encode()


def try_small(data: bytes) -> str:
    """Classify; a limit of time may stop it, but must do so before the watchdog."""
    with tempfile.NamedTemporaryFile(suffix=".yaml") as file:
        file.write(data)
        file.flush()
        slice = slice_from_options(file.name)
    result = ptmcad.classify(slice, timeout=1, area_tolerance="1/100")
    assert ptmcad.RegionMap.from_json(result.to_json()) == result
    result.table()
    return "classified"


# ------------------------------------------------------------------------------------------------------- points


def make_points(seed: int) -> bytes:
    """A CSV file of points after damage."""
    rng = Random(f"points {seed}")
    rows = [
        f"{rng.choice(('a', 'b', nasty(rng)))},{expression(rng, ())},{rng.choice(('1', '3/2', '2'))}"
        for _ in range(4)
    ]
    text = "\n".join(["name,rho,L2", *rows]) + "\n"
    if rng.random() < 0.5:
        return damaged_bytes(text.encode("utf-8", "surrogatepass"), rng, b'"rho",L2\r\n1,"2')
    return damaged_tokens(text, rng).encode("utf-8", "surrogatepass")


def try_points(data: bytes) -> str:
    """Everything that ``ptmcad locate --csv`` does with the first rows."""
    with tempfile.NamedTemporaryFile(suffix=".csv") as file:
        file.write(data)
        file.flush()
        result = first_result()
        for row in islice(rows_of(Path(file.name), result), 50):
            result.locate(**row[1])
    return "located"


# ------------------------------------------------------------------------------------------------------- all


def check_message(text: str) -> None:
    """Raise unless the text is one line of bounded length that a terminal shows as it is."""
    if len(text) > MAX_MESSAGE:
        raise BadMessageError(f"a message of {len(text)} characters: {text[:200]!r}")
    if not text.isprintable():
        raise BadMessageError(f"a message with control characters: {text[:500]!r}")


Kind = tuple[Callable[[int], bytes], Callable[[bytes], str]]
KINDS: dict[str, Kind] = {
    "record": (make_record, try_record),
    "options": (make_options, try_options),
    "small": (make_small, try_small),
    "points": (make_points, try_points),
    "result": (make_result, try_result),
}


def make(kind: str, seed: int) -> bytes:
    """The case of a seed."""
    return KINDS[kind][0](seed)


def run(kind: str, data: bytes) -> str:
    """What became of a case."""
    try:
        return KINDS[kind][1](data)
    except PtmcadError as error:
        check_message(str(error))
        return "refused"
