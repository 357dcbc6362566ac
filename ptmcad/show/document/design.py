"""The best design as a JSON document, docs/design.schema.json, and back.

Guarantee: numbers are exact; reading what was written gives an equal `BestDesign`.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from fractions import Fraction
from typing import Any

from ptmcad.answer.design import BestDesign, BoundedBox, Evaluation
from ptmcad.answer.widths import Maximum
from ptmcad.mechanism import Model, built_in, described, described_system, known_of, recognised, without_loops
from ptmcad.question.slice import Axis
from ptmcad.show.document.extremes import maximum_data, maximum_from
from ptmcad.show.document.node import opened, placed
from ptmcad.text.enclosure import Enclosure
from ptmcad.text.numerals import fraction_of, text_of
from ptmcad.version import __version__

FORMAT = "ptmcad-design/1"
MAX_DOCUMENT = 60_000_000
MAX_TEXT = 10_000
_KEYS = (
    "format", "name", "model", "maximise", "along", "window", "over", "stable", "conditions", "parameters", "best",
    "value", "span", "bound", "tolerance", "proved", "reason", "seed", "points", "boxes", "versions",
)  # fmt: skip
_EXTREMES = "extremes"
"""A key that older documents do not have."""
_DIGITS = 10


def write_design(found: BestDesign) -> str:
    """The document as JSON text: an entry a line, and of designs and boxes one each."""
    data = {
        "format": FORMAT,
        "name": found.name,
        "model": _model(found.model),
        "maximise": found.maximise,
        "along": None if found.along is None else _axis(found.along),
        "window": [_axis(axis) for axis in found.fixed],
        "over": [_axis(axis) for axis in found.over],
        "stable": found.working,
        "conditions": list(found.conditions),
        "parameters": dict(found.parameters),
        "best": None if found.best is None else {name: text_of(value) for name, value in found.best.items()},
        "value": None if found.value is None else _ends(found.value),
        "span": None if found.span is None else [_ends(end) for end in found.span],
        "bound": None if found.bound is None else text_of(found.bound),
        "tolerance": text_of(found.tolerance),
        "proved": found.proved,
        "reason": found.reason,
        _EXTREMES: extremes_data(found.maxima, found.over[0].name),
        "seed": found.seed,
        "points": [
            {"at": [text_of(x) for x in point.at], "value": None if point.value is None else _ends(point.value)}
            for point in found.points
        ],
        "boxes": [
            {"ranges": [[text_of(a), text_of(b)] for a, b in box.ranges], "bound": text_of(box.bound)}
            for box in found.boxes
        ],
        "versions": {"ptmcad": __version__},
    }
    return "{\n" + ",\n".join(f"  {json.dumps(key)}: {_text(value)}" for key, value in data.items()) + "\n}\n"


def extremes_data(maxima: Iterable[Maximum], over: str) -> list[dict[str, Any]]:
    """Where ranges over a parameter are longest, as the document has it."""
    return [maximum_data(m, over, _DIGITS) for m in maxima]


def _text(value: Any) -> str:
    """JSON on one line, but for a list of objects."""
    if isinstance(value, list) and value and isinstance(value[0], dict):
        return "[\n" + ",\n".join(f"    {json.dumps(item, ensure_ascii=False)}" for item in value) + "\n  ]"
    return json.dumps(value, ensure_ascii=False)


def read_design(text: str) -> BestDesign:
    """What `write_design` wrote.

    Raises
    ------
    ValueError
        When the text is not such a document, or contradicts itself.
    """
    document = opened(text, FORMAT, MAX_DOCUMENT, "ptmcad design")
    document.record(*_KEYS, f"{_EXTREMES}?")
    with placed(document) as data:
        found = _design(data)
    _check(found)
    return found


def _design(data: Mapping[str, Any]) -> BestDesign:
    return BestDesign(
        name=_line(data["name"]),
        model=_model_from(data["model"]),
        maximise=_line(data["maximise"]),
        along=None if data["along"] is None else _axis_from(data["along"]),
        fixed=tuple(map(_axis_from, data["window"])),
        over=tuple(map(_axis_from, data["over"])),
        working=_whole(data["stable"]),
        conditions=tuple(map(_line, data["conditions"])),
        best=None if data["best"] is None else {_line(name): fraction_of(x) for name, x in data["best"].items()},
        value=None if data["value"] is None else _enclosure(data["value"]),
        span=None if data["span"] is None else _pair(*map(_enclosure, data["span"])),
        bound=None if data["bound"] is None else fraction_of(data["bound"]),
        tolerance=fraction_of(data["tolerance"]),
        proved=_truth(data["proved"]),
        reason=_line(data["reason"]),
        maxima=tuple(maximum_from(entry, data["over"][0]["name"], _DIGITS) for entry in data.get(_EXTREMES, ())),
        seed=_whole(data["seed"]),
        points=tuple(
            Evaluation(
                tuple(map(fraction_of, point["at"])), None if point["value"] is None else _enclosure(point["value"])
            )
            for point in data["points"]
        ),
        boxes=tuple(
            BoundedBox(tuple((fraction_of(a), fraction_of(b)) for a, b in box["ranges"]), fraction_of(box["bound"]))
            for box in data["boxes"]
        ),
        parameters={_line(name): _line(written) for name, written in data["parameters"].items()},
    )


def _check(found: BestDesign) -> None:
    """Refuse what contradicts itself."""
    names = [axis.name for axis in found.over]
    if (found.best is None) != (found.value is None) or (found.best is not None and list(found.best) != names):
        raise ValueError("the best design is not one of the parameters that it is over")
    if found.best is not None:
        if not all(axis.low <= found.best[axis.name] <= axis.high for axis in found.over):
            raise ValueError("the best design is not within the bounds")
        if tuple(found.best.values()) not in {point.at for point in found.points}:
            raise ValueError("the best design is not among those that were evaluated")
    low = Fraction(0) if found.value is None else found.value.low
    claimed = found.bound is not None and found.value is not None and found.bound <= (1 + found.tolerance) * low
    if found.proved != claimed:
        raise ValueError("what is said to be proved does not follow from the bound")
    if found.boxes and found.bound is not None and max(box.bound for box in found.boxes) > found.bound:
        raise ValueError("a box has a larger bound than all of them")
    if any(len(box.ranges) != len(names) for box in found.boxes):
        raise ValueError("a box has not as many ranges as there are parameters")


def _model(model: Model) -> Any:
    """The name where that says all, else the description."""
    if not model.source or model.name in built_in():
        return model.name
    return {model.record_key: {"name": model.name, **model.source}}


def _model_from(data: Any) -> Model:
    if isinstance(data, str):
        if data not in built_in():
            raise ValueError(f"{data[:40]!r} is no mechanism that is known by its name")
        return known_of(data)
    ((kind, description),) = data.items()
    return described_system(description) if kind == "system" else without_loops(recognised(described(description)))


def _axis(axis: Axis) -> dict[str, str]:
    return {"name": axis.name, "low": text_of(axis.low), "high": text_of(axis.high)}


def _axis_from(data: Any) -> Axis:
    return Axis(_line(data["name"]), fraction_of(data["low"]), fraction_of(data["high"]))


def _ends(value: Enclosure) -> list[str]:
    return [text_of(value.low), text_of(value.high)]


def _enclosure(data: Any) -> Enclosure:
    low, high = map(fraction_of, data)
    if low > high:
        raise ValueError("the ends of an interval are exchanged")
    return Enclosure(low, high)


def _pair(low: Enclosure, high: Enclosure) -> tuple[Enclosure, Enclosure]:
    return low, high


def _line(value: Any) -> str:
    if not isinstance(value, str) or not value.isprintable() or len(value) > MAX_TEXT:
        raise ValueError("expected a line of text")
    return value


def _whole(value: Any) -> int:
    if isinstance(value, bool) or not isinstance(value, int) or value < 0:
        raise ValueError("expected a whole number")
    return value


def _truth(value: Any) -> bool:
    if not isinstance(value, bool):
        raise ValueError("expected true or false")
    return value
