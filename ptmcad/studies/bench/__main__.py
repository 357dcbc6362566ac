"""``python -m ptmcad.studies.bench STUDY``: measure, print the table, write STUDY.json.

The studies of records as whole processes: time, memory and forecasts; and what each saving is worth.

Guarantee: of an ablation every map that is timed was compared with the one that all savings made (`difference`); ratios
are medians of the ratios within a round, of processor time.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path

import pandas as pd

from ptmcad.answer.regionmap import RegionMap
from ptmcad.ask.checking import check
from ptmcad.errors import PtmcadError
from ptmcad.process.output import check_writable, text_writer, write_files
from ptmcad.question.config import load
from ptmcad.question.savings import ALL, SAVINGS
from ptmcad.question.slice import Slice
from ptmcad.studies.bench import growth
from ptmcad.studies.bench.harness import Job, classification, made_with, summary, table, turns
from ptmcad.studies.bench.stored import write_study
from ptmcad.studies.bench.study import difference

FLOOR = (sys.executable, "-c", "import flint, numpy, click, yaml")
LIMITS: tuple[str, ...] = ("--tolerance", "1/20", "--jobs", "1", "--timeout", "30")
"""Of certified runs of an ablation."""


def slices_of(given: Sequence[str]) -> dict[Path, Slice]:
    """The records that are given, else those in configs/.

    Raises
    ------
    PtmcadError
        When there are none, or one cannot be read.
    """
    found = [*map(Path, given)] or sorted(Path("configs").glob("*.yaml"))
    if not found:
        raise PtmcadError(
            "no configs/*.yaml here: name the problem records, or change to the project's folder"
        )
    return {path: load(path) for path in found}


def timed(options: argparse.Namespace) -> pd.DataFrame:
    """Whole ``ptmcad classify`` processes, with JSON only and with pictures too, against the
    machine's floor.

    Each row of a record without free lengths holds what ``ptmcad check`` foretells.
    """
    jobs, predicted = [Job("floor", "", "", FLOOR)], {}
    with tempfile.TemporaryDirectory() as folder:
        for path, slice in slices_of(options.names).items():
            if slice.has_free_lengths and not options.names:
                continue  # such a map takes as long as it is given
            predicted[len(jobs)] = check(slice).forecast
            for formats in ("json", "json,png,svg"):
                asked = classification(path, slice.name, Path(folder), "--format", formats)
                jobs.append(Job(str(path.with_suffix("")), "classify", formats, **asked))
        turns(jobs, options)
    rows = summary(jobs, "floor", "seconds")
    costs = {n: (round(c.seconds, 2), round(c.megabytes)) for n, c in predicted.items() if c}
    more = pd.DataFrame(costs.values(), [*costs], ["predicted s", "predicted MB"])
    return rows.join(more).astype({"predicted MB": "Int64"})


def ablation(options: argparse.Namespace) -> pd.DataFrame:
    """Records with each saving switched off, and with all of them; their own engine's savings, and
    "imports".
    """
    tables = []
    for path, slice in slices_of(options.names).items():
        free, turned = slice.has_free_lengths, ",".join(slice.axis_names[::-1])
        savings = [
            name
            for engine in (["certified"] if free else ["exact", "any"])
            for name in SAVINGS[engine]
        ]
        asked = [(slice.name, [*savings, ALL], LIMITS if free else ())]
        if not free:
            asked.append((f"{slice.name}, axes exchanged", ["axis-order"], ("--slice", turned)))
        for subject, names, more in asked:
            switched: dict[str, tuple[str, ...]] = {"all made": ()}
            switched |= {name: ("--without", name) for name in names}
            with tempfile.TemporaryDirectory() as folder:
                wanted = partial(
                    classification, path, slice.name, Path(folder), "--format", "json", *more
                )
                jobs = [Job(subject, "classify", n, **wanted(*off)) for n, off in switched.items()]
                jobs[0].attempt(options.timeout)  # fills caches, and compiles
                jobs[0].usages.clear()
                turns(jobs, options)
            results = [RegionMap.from_json(job.said()) if job.usages else None for job in jobs]
            rows, first = summary(jobs, "all made"), results[0]
            rows["differs"] = [difference(first, r) if first and r else None for r in results]
            tables.append(rows)
    return pd.concat(tables)


STUDIES: dict[str, tuple[str, Callable[[argparse.Namespace], pd.DataFrame], str]] = {
    "times": ("bench", timed, "time and memory of whole processes, and forecasts"),
    "ablation": ("ablation", ablation, "what each saving is worth"),
    "scaling": (
        "scaling",
        growth.measure,
        f"how cost grows, along the families {', '.join(growth.FAMILIES)}",
    ),
}
"""The name of the file, the measurement, and what it is."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a study; the exit status is 0, 1 where an answer differs, or 2 for bad input."""
    parser = argparse.ArgumentParser(
        "python -m ptmcad.studies.bench", description="Measure whole processes."
    )
    words = "; ".join(f"{name}: {what}" for name, (_, _, what) in STUDIES.items())
    parser.add_argument("study", choices=STUDIES, help=words)
    parser.add_argument("names", nargs="*", help="records, or families of scaling (default: all)")
    parser.add_argument("--out", type=Path, help="folder for the JSON file and what goes with it")
    for name, kind, default, what in (
        ("rounds", int, 3, "runs of each job"),
        ("seed", int, 1, "of all that is drawn"),
        ("timeout", float, 300, "seconds for a run"),
    ):
        parser.add_argument(
            f"--{name}", type=kind, default=default, help=f"{what} (default %(default)g)"
        )
    options = parser.parse_args(arguments)
    for name in ("rounds", "timeout"):
        if not getattr(options, name) > 0:
            parser.error(f"--{name} must be positive")
    name, measure, _ = STUDIES[options.study]
    found = {
        "format": f"ptmcad-{name}/2",
        **made_with(),
        "seed": options.seed,
        "rounds": options.rounds,
    }
    try:
        if options.out is not None:
            check_writable(options.out, (f"{name}.json",))
        rows = measure(options)
        if options.out is not None:
            found["rows"] = [row.dropna().to_dict() for _, row in rows.iterrows()]
            write_files(options.out, {f"{name}.json": text_writer(write_study(found))})
            if options.study == "scaling":
                growth.save_picture(rows, options.out)
    except (PtmcadError, OSError) as error:
        print(f"{options.study}: {error}", file=sys.stderr)
        return 2
    print(table(rows))
    return int("differs" in rows and any(rows["differs"].dropna()))


if __name__ == "__main__":
    sys.exit(main())
