"""The page: the template filled with the map, its data and the sections.

Guarantee: the policy in its head allows nothing but the page's own style sheet and script, named by
their hashes; the data cannot end the element it stands in. The same result gives the same bytes,
timings apart. The equations that the script follows are the compiled system's formulas as one list
of instructions, with constants rounded to doubles.
"""

from __future__ import annotations

import base64
import hashlib
import json
from collections.abc import Sequence
from html import escape
from importlib.resources import files
from math import isfinite
from string import Template
from typing import Any

from ptmcad.answer.consistency import check_numbers
from ptmcad.answer.regionmap import RegionMap
from ptmcad.answer.words import index_words, moments_work, untold
from ptmcad.errors import ConfigError
from ptmcad.formulas.instructions import MAX_CONSTANT, Instruction, script
from ptmcad.model import Model, Support
from ptmcad.model.compile import CompiledSystem, compiled
from ptmcad.model.criterion import critical_point
from ptmcad.model.joints import torsion_springs
from ptmcad.model.work import split_moments
from ptmcad.question.slice import Slice, relaxed_springs
from ptmcad.show.render.axes import heading_of, symbol, with_symbols
from ptmcad.show.render.colours import fill_of
from ptmcad.show.render.outline import shapes
from ptmcad.show.render.polylines import GRID
from ptmcad.show.render.view import Shapes
from ptmcad.show.report import sections
from ptmcad.show.report.equilibria import at_sample, both
from ptmcad.show.report.error_curve import ErrorCurve, error_section
from ptmcad.show.report.mapsvg import SIDE, SLACK, chart, counts_text, pattern_defs
from ptmcad.show.report.sections import curves
from ptmcad.show.table import region_area
from ptmcad.show.units import declared_units
from ptmcad.version import __version__

_POINT_DIGITS = 12
"""Of a sample's floating-point numbers: even in the thinnest cells the solutions are found from
there.
"""
SCRIPTS = (
    "theme.js",
    "mechanism.js",
    "landscape.js",
    "cells.js",
    "follow.js",
    "live.js",
    "embed.js",
)
"""In the order in which they run."""


def page(result: RegionMap, *, timings: bool = True, errors: ErrorCurve | None = None) -> str:
    """The whole page as HTML text.

    Parameters
    ----------
    timings : whether run times are shown; without them the text is the same for the same slice.
    errors : the curve of error against time, if it was measured.

    Raises
    ------
    ConfigError
        When the map is a certified one, or contradicts itself so that it cannot be drawn.
    """
    check_numbers(result)
    seen = _outline(result)
    whole, details, thin_walls, hidden = chart(seen)
    style, script = asset("page.css"), "".join(asset(name) for name in SCRIPTS)
    return template("page.html").substitute(
        policy=escape(policy_of(style, script)),
        title=escape(heading_of(result.slice)),
        name=escape(result.slice.name),
        what=_shown(result.slice.model),
        banner=sections.banner(result),
        question=sections.question(result),
        patterns=pattern_defs([fill_of(r, result.slice.count) for r in result.regions]),
        map=whole,
        details=_details(details),
        legend=sections.legend(result, thin_walls, hidden),
        regions=sections.regions(result),
        curves=_curves(result),
        plan=sections.left_out(result),
        times="".join(sections.times_and_precision(result, timings)),
        errors=error_section(errors) if errors else "",
        again="".join(sections.again(result)),
        version=escape(__version__),
        data=harmless(_data(result, seen)),
        style=style,
        script=script,
    )


def _outline(result: RegionMap) -> Shapes:
    try:
        return shapes(result)
    except (IndexError, ValueError, ArithmeticError) as error:
        raise ConfigError(
            f"the map contradicts itself ({error}); check it with ptmcad verify"
        ) from error


def _curves(result: RegionMap) -> str:
    """The section of the boundary curves; a certified map knows only rectangles that hold them."""
    if result.cover is not None:
        return ""
    return (
        '<section aria-labelledby="h-curves"><h2 id="h-curves">Boundary curves</h2>'
        + curves(result)
        + "</section>"
    )


def _shown(model: Model) -> str:
    """What a cell's button shows."""
    if model.drawable is None:
        return "its solutions"
    return " and its ".join(("its poses", *model.criterion.numbers[:1]))


def _details(pictures: Sequence[str]) -> str:
    """The views of thin regions below the map."""
    if not pictures:
        return ""
    views = "".join(
        f"<figure>{picture}<figcaption>{chr(ord('A') + k)}, zoomed</figcaption></figure>"
        for k, picture in enumerate(pictures)
    )
    return f'<div class="details" role="group" aria-label="Views of thin regions">{views}</div>'


def asset(name: str) -> str:
    """A file of this package as text."""
    return (files("ptmcad.show.report") / name).read_text(encoding="utf-8")


def template(name: str) -> Template:
    """A page: the head that all have, and its own body."""
    return Template(asset("head.html") + asset(name))


def policy_of(style: str, script: str) -> str:
    """What a page may do: use this style sheet and run this script."""
    return (
        f"default-src 'none'; style-src '{_hash(style)}'; script-src '{_hash(script)}'; base-uri 'none'; "
        "form-action 'none'"
    )


def _hash(text: str) -> str:
    return "sha256-" + base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()


def harmless(data: object) -> str:
    """JSON that neither closes nor opens an element, nor is cut by an old line separator."""
    text = json.dumps(data, ensure_ascii=False, separators=(",", ":"), allow_nan=False)
    for character in "<>&\u2028\u2029":
        text = text.replace(character, f"\\u{ord(character):04x}")
    return text


def drawing_of(model: Model) -> dict[str, Any]:
    """What the script draws of a mechanism, by the numbers of its points; of a system only the
    unknowns' names.
    """
    unknowns = {"unknowns": [symbol(name) for name in model.sorted_unknowns]}
    mechanism = model.drawable
    if mechanism is None:
        empty = ("points", "rods", "springs", "loaded", "moving", "pinned", "sliding", "rising")
        return unknowns | dict.fromkeys(empty, ())
    number = {name: n for n, name in enumerate(mechanism.points)}

    def held(support: Support) -> list[int]:
        return [number[name] for name, kind in mechanism.supports.items() if kind is support]

    # a mechanism without torsion springs says nothing of them
    torsion = [
        {
            "name": with_symbols(spring.name),
            "at": [number[name] for name in joint if name] if joint else [],
        }
        for spring, joint in torsion_springs(mechanism)
    ]
    return unknowns | {
        "points": [symbol(name) for name in mechanism.points],
        "rods": [[number[a], number[b]] for a, b in mechanism.bars],
        "springs": [[number[a], number[b]] for a, b in mechanism.spring_ends],
        "loaded": [number[name] for name in mechanism.loaded],
        "moving": [number[name] for name in mechanism.moving],
        "pinned": held(Support.PIN),
        "sliding": held(Support.SLIDER_X),
        "rising": held(Support.SLIDER_Y),
        **({"torsion": torsion} if torsion else {}),
    }


def _work(model: Model) -> str:
    """What the energies of poses leave out, where moments work; empty where there are none, or no
    energies.
    """
    if model.drawable is None or model.coupled:
        return ""
    return moments_work(model, [moment.unknown for moment in split_moments(model)[0]])


def _declared(slice: Slice) -> dict[str, Any]:
    """The units that the record declares of lengths, forces and energies, and of each unknown."""
    if slice.model.drawable is None:
        return {}
    unknowns = [
        "".join(slice.units.get(part, "") for part in slice.model.unit_of(name))
        for name in slice.model.sorted_unknowns
    ]
    return {**declared_units(slice.model, slice.units), "unknowns": unknowns}


def _data(result: RegionMap, seen: Shapes) -> dict[str, Any]:
    """What the script shows and draws."""
    names, model = result.slice.axis_names, result.slice.model
    return {
        "side": SIDE,
        "grid": GRID,
        "slack": 0 if result.cover is None else SLACK,
        "base": result.base,
        "axes": [symbol(name) for name in names],
        "drawable": model.drawable is not None,
        "units": _declared(result.slice),
        "told": model.criterion.is_told,
        "untold": untold(model),
        "work": _work(model),
        "landscape": len(model.angles) == model.criterion.order == 2,
        "index": index_words(len(model.unknowns) + 1),
        "mechanism": drawing_of(model),
        "follow": tape(result),
        "regions": [
            {
                "area": region_area(result, number),
                "counts": counts_text(r, model),
            }
            for number, r in enumerate(result.regions)
        ],
        "stacks": [list(s.cells) for s in result.stacks],
        "names": list(names),
        "cells": [
            {
                "at": [round(x * SIDE, 2), round((1 - y) * SIDE, 2)],
                "stack": cell.stack,
                "level": cell.level,
                "region": cell.region,
                "counts": counts_text(cell, model),
                "index": list(cell.index) if cell.index else None,
                "stable": cell.stable,
                "total": cell.total,
                "point": [float(f"{float(value):.{_POINT_DIGITS}g}") for value in cell.sample],
                "sample": [both(cell.sample[name]) for name in names],
                **at_sample(result, cell),
            }
            for cell in result.cells
            for x, y in [seen.view.approximate_position(cell.sample)]
        ],
    }


MAX_OPERATIONS = 2000
"""The script runs through them for each step of each solution."""


def tape(result: RegionMap) -> dict[str, Any] | None:
    """What the script needs to follow solutions over the map; None where nothing can be followed.

    That is where no cell has solutions, a parameter has no value or a number is too large for
    doubles; and with free lengths in closed loops, whose roots are in no equation of the
    description.
    """
    slice = result.slice
    model, system = slice.model, compiled(slice.model)
    relaxed = relaxed_springs(model, slice.parameters)
    if relaxed and system.tangent:
        return None
    if not any(cell.solutions for cell in result.cells) or not _fits(slice):
        return None
    names = [name for name in model.variables if name in slice.parameters]
    instructions, places = script(_formulas(system, relaxed), _sources(system, names))
    constants = [instruction[1] for instruction in instructions if instruction[0] == "="]
    if len(instructions) > MAX_OPERATIONS or not all(map(isfinite, constants)):
        return None
    n = len(model.unknowns)
    return {
        **places,
        "moments": list(places["moments"].items()),
        "points": list(places["points"].values()),
        "operations": instructions,
        "parameters": [
            [[[i, j, float(c)] for i, j, c in side] for side in (e.numerator, e.denominator)]
            for e in (slice.parameters[name] for name in names)
        ],
        "angles": len(model.angles),
        "unknowns": n,
        "window": [[float(axis.low), float(axis.high)] for axis in slice.axes],
        "kinds": ["stable", *(critical_point(k, n) for k in range(1, n + 1))],
        "stableOnly": result.only_stable,
    }


def _formulas(system: CompiledSystem, relaxed: Sequence[int]) -> dict[str, Any]:
    """What the script draws and follows; what a model does not have is empty."""
    return {
        "force": system.stored(relaxed) if system.are_slopes else None,
        "energy": system.potential(relaxed),
        "equations": () if system.are_slopes else system.equations,
        "conditions": system.inequalities,
        "stability": system.stability,
        "moments": system.acting,
        "points": system.shown.points,
        "loads": system.shown.loads,
    }


def _sources(system: CompiledSystem, names: Sequence[str]) -> dict[int, Instruction]:
    """Where the script has variables from; a free length that is not there is zero."""
    unknowns = {number: ("u", k) for k, number in enumerate(system.unknowns)}
    return {
        number: unknowns.get(number, ("p", names.index(name)) if name in names else ("=", 0.0))
        for number, name in enumerate(system.names)
    }


def _fits(slice: Slice) -> bool:
    coefficients = [
        c for e in slice.parameters.values() for side in (e.numerator, e.denominator) for _, _, c in side
    ]  # fmt: skip
    ends = [end for axis in slice.axes for end in (axis.low, axis.high)]
    return all(name in slice.parameters for name in slice.model.without_free_lengths) and all(
        abs(value) < MAX_CONSTANT for value in (*coefficients, *ends)
    )
