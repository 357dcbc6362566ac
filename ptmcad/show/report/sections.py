"""The page's sections below the map: the question, regions, what was left out, times, how to do it
again.

Guarantee: whatever comes from the result goes through `html.escape`, also what the reader of
results has let pass.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from html import escape

from ptmcad.answer.plan import own_steps
from ptmcad.answer.regionmap import Component, RegionMap, Status
from ptmcad.answer.words import count_words, index_words, several
from ptmcad.show.polynomial_text import Style, polynomial_text, symbols
from ptmcad.show.render.axes import named, symbol
from ptmcad.show.render.colours import Fill, fill_of
from ptmcad.show.render.legend import Entry, entries, hidden_entries
from ptmcad.show.report.equilibria import both, distinct_parameters
from ptmcad.show.report.mapsvg import counts_text, paints
from ptmcad.show.report.reproduction import reproduction
from ptmcad.show.table import NOT_COMPUTED, area_digits, areas_are_known, stability_in_words
from ptmcad.show.units import area_unit, unit, with_unit
from ptmcad.text.numerals import certified_digits, decimal, integer_text, percent, text_of

_STATUS = {
    Status.EXACT: "Exact: every point of the window off the boundary curves is in a region, and the counts are proved.",
    Status.CERTIFIED: "Certified: counts are proved wherever one is given.",
    Status.UNDECIDED: "Undecided: the result gives no counts.",
    Status.PARTIAL: "Partial: a limit stopped the computation before its end.",
}
Row = Iterable[str]


def table(head: Row, rows: Iterable[Row], label: str, stacked: bool = False) -> str:
    """A table of markup in a box that scrolls by itself; a stacked one has its entries below each
    other on phones.
    """
    names = tuple(head)
    kind = ' class="stacked"' if stacked else ""
    above = "".join(f'<th scope="col">{name}</th>' for name in names)
    body = "".join(f"<tr>{''.join(map(_entry, names, row))}</tr>" for row in rows)
    return (
        f'<div class="scroll" role="region" tabindex="0" aria-label="{escape(label)}"><table{kind}>'
        f"<thead><tr>{above}</tr></thead><tbody>{body}</tbody></table></div>"
    )


def _entry(name: str, entry: str) -> str:
    """An entry with its column's name, which takes its place before it where the screen is narrow."""
    return f'<td data-label="{escape(name)}"><div>{entry}</div></td>'


def copied(text: str, label: str) -> str:
    """A text in a box with a button that copies it."""
    return (
        f'<div class="copied"><button type="button" class="copy">Copy {escape(label)}</button>'
        f'<pre tabindex="0" aria-label="{escape(label)}"><code>{escape(text)}</code></pre></div>'
    )


def swatch(fill: Fill) -> str:
    """A small square of a fill."""
    painted = "".join(f'<rect width="30" height="18" fill="{paint}"/>' for paint in paints(fill))
    return f'<svg class="swatch" viewBox="0 0 30 18" aria-hidden="true">{painted}</svg>'


def banner(result: RegionMap) -> str:
    """A warning above everything for a result that is not whole."""
    if result.status is Status.EXACT and result.undetermined == 0:
        return ""
    text = _STATUS.get(result.status, "The result is of an unusual kind.")
    if result.cover is not None:
        text += f" Undetermined: {percent(result.undetermined)} of the window, drawn in grey."
    elif result.undetermined:
        text += f" The undecided fraction of the window is {both(result.undetermined)}."
    if result.status is Status.PARTIAL:
        text += " What is missing below was not computed; what is there is proved, but areas may not be known yet."
    return f'<p class="banner" role="status"><strong>{escape(result.status.value.capitalize())} result.</strong> ' \
           f"{escape(text)}</p>"  # fmt: skip


def question(result: RegionMap) -> str:
    """What was asked: mechanism, axes, parameters, count."""
    slice = result.slice
    axes = "; ".join(
        f"{symbol(a.name)} from {both(a.low)} to {both(a.high)}{f' {unit(slice, k)}' if slice.units else ''}"
        for k, a in enumerate(slice.axes)
    )
    names = slice.axis_names
    values = [
        (symbol(n), named(e.to_text(names), names))
        for n, e in distinct_parameters(slice.parameters, slice.model).items() if n not in names
    ]  # fmt: skip
    shown = ", ".join(f"{n} = {v}" for n, v in values if v != "0")
    zero = ", ".join(n for n, v in values if v == "0")
    counted_by = count_words(slice.count.kind.page, slice.model)
    items = [
        (slice.model.record_key.capitalize(), slice.model.title or slice.mechanism),
        ("Axes", axes),
        ("Parameters", shown + (f"{'; ' if shown else ''}zero: {zero}" if zero else "") or "none"),
        ("Count", f"regions are distinguished by {counted_by}"),
        ("Answer", answer(result)),
        *(("Stable", words) for words in [stability_in_words(result)] if words),
    ]
    return "<dl>" + "".join(f"<dt>{escape(a)}</dt><dd>{escape(b)}</dd>" for a, b in items) + "</dl>"


def answer(result: RegionMap) -> str:
    """The result in one line."""
    cells, regions = len(result.cells), len(result.regions)
    if not cells:
        return f"no cells were computed; {result.status.value}"
    if result.cover is not None:
        return (
            f"{several(regions, 'region')}, {percent(result.undetermined)} of the window undetermined; "
            f"{result.status.value}"
        )
    curves = sum(c.separates for c in result.components)
    return (
        f"{several(regions, 'region')} in {several(cells, 'cell')}, parted by {several(curves, 'curve')}; "
        f"{result.status.value}"
    )


def legend(result: RegionMap, thin_walls: bool, hidden: int) -> str:
    """What colours and lines mean, in words."""
    parts = []
    for entry in [*entries(result, thin_walls), *hidden_entries(hidden)]:
        match entry.mark:
            case Fill() as fill:
                head, rest = (
                    entry.lines[0],
                    " ".join(entry.lines[1:]),
                )  # a count, and what is said of its regions
                parts.append(
                    f"<li>{swatch(fill)}<span>{escape(f'{head}: {rest}' if rest else head)}</span></li>"
                )
            case float(width):
                parts.append(_line_entry('"wall strong"' if width > 1 else '"wall"', entry))
            case _ if callable(entry.mark):  # of curves on which solutions are not isolated
                parts.append(_line_entry('"wall strong" stroke-dasharray="6 4"', entry))
            case _ if entry.lines:
                parts.append(f"<li><b>{escape(' '.join(entry.lines))}</b></li>")
    return f'<ul class="legend" aria-label="Legend">{"".join(parts)}</ul>'


def _line_entry(look: str, entry: Entry) -> str:
    line = f'<path class={look} d="M0 9H30"/>'
    mark = f'<svg class="swatch line" viewBox="0 0 30 18" aria-hidden="true">{line}</svg>'
    return f"<li>{mark}<span>{escape(' '.join(entry.lines))}</span></li>"


def regions(result: RegionMap) -> str:
    """Every region with counts, area and cells."""
    rows, known = [], areas_are_known(result)
    for number, region in enumerate(result.regions):
        index = "-".join(map(str, region.index)) if region.index else ""
        buttons = "".join(f'<button class="chip">{n}</button>' for n in region.cells)
        low, high = region.area
        middle = area_digits(result, region.area)
        if not known:
            middle, bounds = NOT_COMPUTED, ""
        elif result.cover is not None:
            bounds = (
                f"proved: {decimal(low, up=False, digits=7)} to {decimal(high, up=True, digits=7)}"
            )
        elif low == high:
            bounds = f"exactly {text_of(low)}"
        else:
            width = certified_digits((high - low, high - low), 1)
            bounds = f"bounds {width} apart"
        sample = ", ".join(
            f"{escape(symbol(n))} = {escape(both(region.sample[n]))}" for n in region.sample.names
        )
        rows.append(
            (
                f"{swatch(fill_of(region, result.slice.count))} {number}",
                escape(counts_text(region, result.slice.model))
                + (f" ({escape(index)})" if index else ""),
                f"{middle}<br><small>{bounds}</small>" if bounds else middle,
                sample,
                f'<span class="chips">{buttons}</span>',
            )
        )
    if not rows:
        return "<p>No regions are known yet.</p>"
    words = index_words(len(result.slice.model.unknowns) + 1)
    note = "" if all(r.index is None for r in result.regions) else f"<p>In brackets: {words}.</p>"
    return (
        table(
            (
                "region",
                "count",
                escape(with_unit("area", area_unit(result.slice))),
                "sample",
                "cells",
            ),
            rows,
            "Regions",
            stacked=True,
        )
        + note
    )


def left_out(result: RegionMap) -> str:
    """The plan: what was done and what was not, and why."""
    steps = own_steps(result.plan)
    done = [s for s in steps if s.done]
    saved = [s for s in steps if not s.done]

    def listed(steps: Iterable[tuple[str, str]]) -> str:
        return (
            "<ul>"
            + "".join(f"<li>{escape(a)} <small>({escape(b)})</small></li>" for a, b in steps)
            + "</ul>"
        )

    parts = []
    if saved:
        parts.append("<h3>Left out</h3>" + listed((s.what, s.reason) for s in saved))
    if done:
        parts.append("<h3>Computed</h3>" + listed((s.what, s.reason) for s in done))
    return "".join(parts) or "<p>The result holds no plan.</p>"


def times_and_precision(result: RegionMap, timings: bool) -> Iterator[str]:
    """Seconds by stage, the bits that were needed, and versions."""
    if timings and result.timings:
        rows = [(escape(name), f"{seconds:.4f}") for name, seconds in result.timings.items()]
        yield table(("stage", "seconds"), rows, "Times")
    if result.precision:
        bits = ", ".join(f"{name} {value} bits" for name, value in result.precision.items())
        yield f"<p>Precision that was needed: {escape(bits)}.</p>"
    if result.versions:
        versions = ", ".join(f"{name} {value}" for name, value in result.versions.items())
        yield f"<p>Computed with {escape(versions)}.</p>"


def again(result: RegionMap) -> Iterator[str]:
    """How to compute the result anew and how to check it."""
    name = result.slice.name
    record, command = reproduction(result.slice)
    if record is None:
        yield "<p>No problem record gives this slice: the result was not made by ptmcad classify, or was changed.</p>"
    else:
        yield f"<p>Save this problem record as <code>{escape(name)}.yaml</code>:</p>"
        yield copied(record, "the record")
        yield "<p>and run</p>"
        yield copied(f"ptmcad classify {name}.yaml", "the command")
    if command is not None:
        yield "<p>Without a record, the same slice under another name:</p>"
        yield copied(command, "the whole command")
    if result.cover is None:
        yield (
            "<p>Two runs give the same result, times apart. Only the bounds of areas depend on a further option, "
            "<code>--area-tolerance</code>.</p><h3>Check it</h3><p>The result carries its proof. This checks it by "
            "methods that share no code with those that made it:</p>"
        )
    else:
        yield (
            "<p>The option <code>--tolerance</code> says how much may stay undetermined; a longer run goes on from "
            "this result with <code>--resume</code>.</p><h3>Check it</h3><p>This proves the counts again, and a random "
            "sample of what encloses the curves, by other interval methods:</p>"
        )
    yield copied(f"ptmcad verify {name}.json", "the check")
    yield "<p>For one point:</p>"
    sample = result.regions[0].sample if result.regions else None
    first, second = result.slice.axes
    at = (sample[0], sample[1]) if sample else (first.middle(), second.middle())
    point = ",".join(
        f"{axis.name}={text_of(v)}" for axis, v in zip(result.slice.axes, at, strict=True)
    )
    yield copied(f"ptmcad locate {name}.json --at {point}", "the question")


MAX_FORMULA = 100_000
"""Characters of a formula that the page holds in all its forms."""
_PROGRAMS = {
    Style.TEXT: "text",
    Style.SYMPY: "SymPy",
    Style.MAPLE: "Maple",
    Style.MATHEMATICA: "Mathematica",
    Style.LATEX: "LaTeX",
}


def curves(result: RegionMap) -> str:
    """Every curve that the decomposition uses, with its formula in the forms that programs read."""
    used = [(n, c) for n, c in enumerate(result.components) if not c.left_out]
    if not used:
        return "<p>There is no boundary curve in the window.</p>"
    known = bool(result.cells)
    return "".join(_curve(n, c, result.slice.axis_names, known) for n, c in used)


def _curve(number: int, component: Component, names: tuple[str, str], known: bool) -> str:
    p = component.polynomial
    role = "separates regions" if component.separates else "separates nothing"
    if not known:
        role = "what it separates was not computed"
    title = (
        f"Curve {number}: {component.kind.value}, degree {p.degrees[0]} in {names[0]}, {p.degrees[1]} in {names[1]}, "
        f"{p.total_degree} in all, {several(len(p.terms), 'term')}; {role}"
    )
    return f"<details><summary>{escape(title)}</summary>{_formula(component, names)}</details>"


def _formula(component: Component, names: tuple[str, str]) -> str:
    p = component.polynomial
    if sum(len(integer_text(c)) + 20 for _, _, c in p.terms) > MAX_FORMULA:
        return "<p>The formula is too long for this page; the result has it.</p>"
    parts = ["<p>The curve is where this polynomial is zero.</p>"]
    for style, program in _PROGRAMS.items():
        text = polynomial_text(p, names, style)
        if style is Style.SYMPY:
            x, y = symbols(names, style)
            text = f'import sympy\n\n{x}, {y} = sympy.symbols("{names[0]} {names[1]}")\np = {text}'
        parts.append(copied(text, f"as {program}"))
    return "".join(parts)
