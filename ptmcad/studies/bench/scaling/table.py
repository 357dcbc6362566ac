"""The scaling measurement as a Markdown page: one table of exponents, and one of medians for each family."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from statistics import median
from typing import Any

from ptmcad.studies.tables import markdown, measured_with, page

MANY = 1000
_NAMES = {"seconds": "processor time", "wall": "wall time", "memory": "memory", "boxes": "boxes treated"}


_INTRODUCTION = """
Exponents p of cost = c x^p, by least squares in logarithms, with 5 % and 95 % bounds from resampled runs.
Lower and upper are the slopes over the two halves of the range; where they differ, one exponent says little;
where cost = a + c x^p fits, the fixed cost a is given, and the exponent beyond it with its bounds.
Seconds are processor time unless they are called wall time; memory is the growth of the resident set.
[What grows and why](../scaling.md) explains it. Written by `python -m ptmcad.studies.bench.scaling`.
"""


def to_markdown(report: Mapping[str, Any]) -> str:
    """The page."""
    blocks: list[str | list[str]] = []
    for family in report["families"]:
        blocks += [f"## {family['title']}", f"Along {family['axis']}. Expected: {family['expected']}."]
        blocks += [_fits(family), _runs(family)]
        blocks += [f"Size {size} has no figures: {reason}." for size, reason in family["reasons"].items()]
    rounds = f"Rounds: {report['rounds']}, seed {report['seed']}."
    return page("# Scaling", _INTRODUCTION, rounds, *measured_with(report), *blocks)


def grouped(family: Mapping[str, Any]) -> dict[float, list[Any]]:
    """A family's runs, as data, by their place along it."""
    groups: dict[float, list[Any]] = {}
    for run in family["runs"]:
        place = run["size"] if family["against"] == "size" else run["found"][family["against"]]
        groups.setdefault(place, []).append(run)
    return groups


def stages_of(runs: Iterable[Mapping[str, Any]]) -> list[str]:
    """The stages of runs, as data, in their order."""
    return list(dict.fromkeys(stage for run in runs for stage in run["stages"]))


def _fits(family: Mapping[str, Any]) -> list[str]:
    rows = [
        (_NAMES.get(name, name), f"{f['first']:g} - {f['last']:g}",
         f"{f['exponent']:.2f} ({f['low']:.2f} to {f['high']:.2f})", f"{f['determination']:.3f}",
         f"{f['lower']:.2f}, {f['upper']:.2f}", f"{f['verdict']}{_beyond(f)}")
        for name, f in family["fits"].items()
    ]  # fmt: skip
    return markdown(("what", "from - to", "exponent", "R^2", "lower, upper", "verdict"), rows)


def _beyond(f: Mapping[str, Any]) -> str:
    """The fixed cost and the exponent beyond it, where there is one."""
    if not f["fixed"]:
        return ""
    fixed = f"{f['fixed']:,.0f}" if f["fixed"] >= MANY else f"{f['fixed']:.2g}"
    return f"; beyond a fixed {fixed}: {f['growth']:.2f} ({f['growth_low']:.2f} to {f['growth_high']:.2f})"


def _runs(family: Mapping[str, Any]) -> list[str]:
    """Medians by abscissa, the spread of the seconds, and what was found."""
    groups = grouped(family)
    facts = [k for k in (family["runs"][0]["found"] if family["runs"] else {}) if k != family["against"]]
    stages = stages_of(family["runs"])
    stages = stages if len(stages) > 1 else []
    rows = []
    for place, runs in sorted(groups.items()):
        seconds, walls = [run["seconds"] for run in runs], [run["wall"] for run in runs]
        memory = [max(run["memory"].values()) for run in runs if run["memory"]]
        rows.append([
            f"{place:g}",
            str(len(runs)),
            f"{_number(median(seconds))} ({_number(min(seconds))} - {_number(max(seconds))})",
            _number(median(walls)),
            *(_number(median(run["stages"].get(stage, 0.0) for run in runs)) for stage in stages),
            f"{median(memory):.1f}" if memory else "-",
            *(_range([run["found"][fact] for run in runs]) for fact in facts),
        ])  # fmt: skip
    return markdown((family["axis"], "runs", "s: median (min - max)", "wall s", *stages, "MiB", *facts), rows)


def _number(seconds: float) -> str:
    return f"{seconds:.4f}" if seconds < 0.1 else f"{seconds:.2f}"


def _range(values: list[float]) -> str:
    low, high = min(values), max(values)
    return f"{low:g}" if low == high else f"{low:g} - {high:g}"
