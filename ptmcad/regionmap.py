"""A region map: the result of a classification, independent of the engine that made it.

Guarantee: every number in it is exact or an enclosure; `RegionMap.from_json(result.to_json())` gives an equal map.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum
from fractions import Fraction
from typing import Any

from ptmcad.expressions import Expression, parse, rational
from ptmcad.expressions import axis as axis_function
from ptmcad.plane import PlanePolynomial
from ptmcad.slice import Axis, Count, Point, Slice

FORMAT = "ptmcad-region-map/1"

MorseIndex = tuple[int, int, int]
"""Numbers of minima, saddles and maxima."""


class Status(Enum):
    """How far a result, or a point's answer, is proved; a PARTIAL result was stopped by a limit."""

    EXACT = "exact"
    CERTIFIED = "certified"
    PARTIAL = "partial"
    UNDECIDED = "undecided"
    ON_VARIETY = "on the variety"
    OUTSIDE = "outside the window"


class Kind(Enum):
    """Why a curve belongs to the variety: see `ptmcad.variety`."""

    CRITICAL = "critical"
    INFINITY = "infinity"
    BOUNDARY = "boundary"


@dataclass(frozen=True, slots=True)
class Component:
    """An irreducible curve of the discriminant variety.

    Attributes
    ----------
    polynomial : primitive, in Z[x, y] for the axes in their order.
    left_out : empty when the decomposition uses the component, else the reason why it does not.
    separates : whether some wall on it separates two regions.
    """

    polynomial: PlanePolynomial
    kind: Kind
    left_out: str = ""
    separates: bool = False


@dataclass(frozen=True, slots=True)
class CriticalValue:
    """A critical value on the base axis: the only root of ``polynomial`` in [low, high]; ``origin`` tells whence.

    ``polynomial`` holds integer coefficients, constant term first.
    """

    polynomial: tuple[int, ...]
    low: Fraction
    high: Fraction
    origin: str


@dataclass(frozen=True, slots=True)
class Wall:
    """Over its stack, the graph of the ``root``-th real root (from 0, in the window) of a component."""

    component: int
    root: int


@dataclass(frozen=True, slots=True)
class Stack:
    """The cells over the open base interval between two consecutive critical values (or the window's edge).

    Attributes
    ----------
    left, right : numbers of the critical values, None at the window's edge.
    sample : rational abscissa of the stack's sample points.
    walls : from below.
    cells : numbers of its cells, from below; one more than walls.
    """

    left: int | None
    right: int | None
    sample: Fraction
    walls: tuple[Wall, ...]
    cells: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Cell:
    """An open cell with its rational sample point and the counts there, which hold in the whole cell."""

    stack: int
    level: int
    sample: Point
    region: int
    total: int | None
    stable: int | None
    index: MorseIndex | None


class Merge(Enum):
    """What joins or parts two adjacent cells."""

    PROVEN = "proven"
    EQUAL_COUNT = "equal count"
    SEPARATED = "separated"


@dataclass(frozen=True, slots=True)
class Adjacency:
    """Two cells that share an open arc.

    Attributes
    ----------
    merge : PROVEN when the arc is an artefact of the decomposition; EQUAL_COUNT when it lies on the variety and the
        counts on both sides are equal; SEPARATED when they differ.
    component : the variety's component that contains the arc; None when the arc is an artefact of the decomposition.
    segment : for cells of neighbouring stacks, (low, high, height): the open segment that joins them, free of all
        curves but a vertical line.
    """

    first: int
    second: int
    component: int | None
    segment: tuple[Fraction, Fraction, Fraction] | None
    merge: Merge


@dataclass(frozen=True, slots=True)
class Region:
    """A maximal set of cells that are joined and have equal counts.

    Attributes
    ----------
    stable, total, index : None where it varies within the region (the chosen count does not tell it).
    area : certified lower and upper bound, in the product of the axes' units.
    cells : numbers of its cells.
    sample : a point of the region of small height.
    """

    stable: int | None
    total: int | None
    index: MorseIndex | None
    area: tuple[Fraction, Fraction]
    cells: tuple[int, ...]
    sample: Point


@dataclass(frozen=True, slots=True)
class Location:
    """Where a point lies; region, cell and counts are None unless the point is decided and in a cell."""

    status: Status
    region: int | None = None
    cell: int | None = None
    total: int | None = None
    stable: int | None = None
    index: MorseIndex | None = None


@dataclass(frozen=True, slots=True)
class PlanStep:
    """One decision of the plan: what, whether it is done or left out, and why."""

    what: str
    done: bool
    reason: str

    def __str__(self) -> str:
        return f"{'computed' if self.done else 'left out'}: {self.what} ({self.reason})"


@dataclass(frozen=True, slots=True, repr=False)
class RegionMap:
    """The answer to a `Slice`.

    Attributes
    ----------
    base : the axis (0 or 1) over which the stacks stand.
    undetermined : fraction of the window's area that is not decided; 0 for the exact engine.
    complex_solutions : number of complex solutions at a generic point.
    timings : seconds by stage; not part of equality.
    """

    slice: Slice
    status: Status
    base: int
    complex_solutions: int
    components: tuple[Component, ...]
    critical_values: tuple[CriticalValue, ...]
    stacks: tuple[Stack, ...]
    cells: tuple[Cell, ...]
    adjacencies: tuple[Adjacency, ...]
    regions: tuple[Region, ...]
    plan: tuple[PlanStep, ...]
    undetermined: Fraction
    versions: Mapping[str, str]
    timings: Mapping[str, float] = field(default_factory=dict, compare=False)

    def __str__(self) -> str:
        return self.table()

    def __repr__(self) -> str:
        return f"<RegionMap {self.slice.name}: {len(self.regions)} regions, {self.status.value}>"

    def locate(self, **at: Any) -> Location:
        """The region of a rational point, exactly; names are the two axes, values numbers or text such as "7/10".

        A float stands for its shortest decimal, as in a problem record: 0.1 is 1/10.

        Raises
        ------
        ConfigError
            When the names are not the two axes, or a value is not an exact number.
        """
        from ptmcad.locate import locate

        return locate(self, at)

    def to_json(self, timings: bool = True) -> str:
        """The map as JSON text; the same text for the same slice when ``timings`` is False."""
        data = _encode(self)
        if timings:
            data["timings"] = {name: round(seconds, 6) for name, seconds in self.timings.items()}
        return _dumps(data)

    @classmethod
    def from_json(cls, text: str) -> RegionMap:
        """The map that `to_json` wrote.

        Raises
        ------
        ValueError
            When the text is not such a map.
        """
        try:
            return _decode(json.loads(text))
        except (KeyError, TypeError, IndexError, AttributeError) as error:
            raise ValueError(f"this is not a {FORMAT} file: {error!r}") from error

    def table(self) -> str:
        """Five lines for the terminal: regions, counts, areas, boundary curves, time and error."""
        from ptmcad.table import table

        return table(self)


# ---------------------------------------------------------------------------------------------------------- JSON


def _dumps(data: dict[str, Any]) -> str:
    """JSON with one record of a list per line: readable, and small differences stay small."""
    lines = []
    for key, value in data.items():
        if isinstance(value, list) and value and isinstance(value[0], dict):
            items = ",\n".join("    " + json.dumps(item, ensure_ascii=False) for item in value)
            lines.append(f"  {json.dumps(key)}: [\n{items}\n  ]")
        else:
            lines.append(f"  {json.dumps(key)}: {json.dumps(value, ensure_ascii=False)}")
    return "{\n" + ",\n".join(lines) + "\n}\n"


def _point(point: Point) -> dict[str, str]:
    return {name: str(point[name]) for name in point.names}


def _encode(result: RegionMap) -> dict[str, Any]:
    names = result.slice.axis_names
    return {
        "format": FORMAT,
        "status": result.status.value,
        "slice": {
            "name": result.slice.name,
            "title": result.slice.title,
            "mechanism": result.slice.mechanism,
            "axes": {a.name: [str(a.low), str(a.high)] for a in result.slice.axes},
            "parameters": {n: e.to_text(names) for n, e in result.slice.parameters.items()},
            "text": dict(result.slice.text),
            "count": result.slice.count.value,
            "reference": dict(result.slice.reference),
        },
        "base": names[result.base],
        "complex_solutions": result.complex_solutions,
        "undetermined": str(result.undetermined),
        "regions": [
            {
                "stable": r.stable,
                "total": r.total,
                "index": r.index,
                "area": [decimal(r.area[0], up=False), decimal(r.area[1], up=True)],
                "sample": _point(r.sample),
                "cells": r.cells,
            }
            for r in result.regions
        ],
        "components": [
            {
                "kind": c.kind.value,
                "separates": c.separates,
                "left_out": c.left_out,
                "degrees": dict(zip(names, c.polynomial.degrees, strict=True)),
                "terms": len(c.polynomial.terms),
                "polynomial": c.polynomial.text(names),
            }
            for c in result.components
        ],
        "critical_values": [
            {"polynomial": [str(c) for c in v.polynomial], "low": str(v.low), "high": str(v.high), "origin": v.origin}
            for v in result.critical_values
        ],
        "stacks": [
            {
                "left": s.left,
                "right": s.right,
                "sample": str(s.sample),
                "walls": [[w.component, w.root] for w in s.walls],
                "cells": s.cells,
            }
            for s in result.stacks
        ],
        "cells": [
            {
                "stack": c.stack,
                "level": c.level,
                "sample": _point(c.sample),
                "region": c.region,
                "total": c.total,
                "stable": c.stable,
                "index": c.index,
            }
            for c in result.cells
        ],
        "adjacencies": [
            {
                "cells": [a.first, a.second],
                "merge": a.merge.value,
                "component": a.component,
                "segment": None if a.segment is None else [str(q) for q in a.segment],
            }
            for a in result.adjacencies
        ],
        "plan": [{"what": p.what, "done": p.done, "reason": p.reason} for p in result.plan],
        "versions": dict(result.versions),
    }


def magnitude(value: Fraction) -> int:
    """The e with 10^e <= value < 10^(e+1), for a positive value."""
    # 2^10 is just above 10^3; numbers may be too long to be written out
    e = (value.numerator.bit_length() - value.denominator.bit_length()) * 3 // 10
    while value >= Fraction(10) ** (e + 1):
        e += 1
    while value < Fraction(10) ** e:
        e -= 1
    return e


def decimal(value: Fraction, up: bool, digits: int = 18) -> str:
    """A decimal text with ``digits`` significant digits that bounds a nonnegative value from the side asked for."""
    if value == 0:
        return "0"
    exponent = magnitude(value) + 1 - digits
    scaled = value / Fraction(10) ** exponent
    mantissa = -((-scaled.numerator) // scaled.denominator) if up else scaled.numerator // scaled.denominator
    text = str(mantissa)
    point = len(text) + exponent
    if -7 < point <= 0:
        return ("0." + "0" * -point + text).rstrip("0")
    if 0 < point < len(text):
        return (text[:point] + "." + text[point:]).rstrip("0").rstrip(".")
    if len(text) <= point <= 21:
        return text + "0" * (point - len(text))
    return f"{text[0]}.{text[1:].rstrip('0') or '0'}e{point - 1}"


def _index(value: Any) -> MorseIndex | None:
    if value is None:
        return None
    minima, saddles, maxima = value
    return (int(minima), int(saddles), int(maxima))


def _decode(data: Mapping[str, Any]) -> RegionMap:
    if data["format"] != FORMAT:
        raise ValueError(f"format {data['format']!r} is not {FORMAT!r}")
    head = data["slice"]
    axes = tuple(Axis(n, rational(low), rational(high)) for n, (low, high) in head["axes"].items())
    if len(axes) != 2:
        raise ValueError("a region map has two axes")
    names = (axes[0].name, axes[1].name)
    functions: dict[str, Expression] = {names[0]: axis_function(0), names[1]: axis_function(1)}

    def point(values: Mapping[str, str]) -> Point:
        return Point(names, rational(values[names[0]]), rational(values[names[1]]))

    def polynomial(text: str) -> PlanePolynomial:
        return PlanePolynomial.parse(text, names)

    return RegionMap(
        slice=Slice(
            name=head["name"],
            mechanism=head["mechanism"],
            axes=(axes[0], axes[1]),
            parameters={n: parse(text, functions) for n, text in head["parameters"].items()},
            count=Count(head["count"]),
            title=head["title"],
            text=head["text"],
            reference=head["reference"],
        ),
        status=Status(data["status"]),
        base=names.index(data["base"]),
        complex_solutions=data["complex_solutions"],
        components=tuple(
            Component(polynomial(c["polynomial"]), Kind(c["kind"]), c["left_out"], c["separates"])
            for c in data["components"]
        ),
        critical_values=tuple(
            CriticalValue(tuple(int(c) for c in v["polynomial"]), rational(v["low"]), rational(v["high"]), v["origin"])
            for v in data["critical_values"]
        ),
        stacks=tuple(
            Stack(
                s["left"],
                s["right"],
                rational(s["sample"]),
                tuple(Wall(c, k) for c, k in s["walls"]),
                tuple(s["cells"]),
            )
            for s in data["stacks"]
        ),
        cells=tuple(
            Cell(c["stack"], c["level"], point(c["sample"]), c["region"], c["total"], c["stable"], _index(c["index"]))
            for c in data["cells"]
        ),
        adjacencies=tuple(
            Adjacency(
                a["cells"][0],
                a["cells"][1],
                a["component"],
                None if a["segment"] is None else _triple(a["segment"]),
                Merge(a["merge"]),
            )
            for a in data["adjacencies"]
        ),
        regions=tuple(
            Region(
                r["stable"],
                r["total"],
                _index(r["index"]),
                (rational(r["area"][0]), rational(r["area"][1])),
                tuple(r["cells"]),
                point(r["sample"]),
            )
            for r in data["regions"]
        ),
        plan=tuple(PlanStep(p["what"], p["done"], p["reason"]) for p in data["plan"]),
        undetermined=rational(data["undetermined"]),
        versions=data["versions"],
        timings=data.get("timings", {}),
    )


def _triple(values: Any) -> tuple[Fraction, Fraction, Fraction]:
    low, high, height = (rational(v) for v in values)
    return (low, high, height)
