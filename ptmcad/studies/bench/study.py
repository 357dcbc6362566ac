"""A study: error against run time of several methods on one slice, as it is stored, read back and listed.

Guarantee: figures of error are rounded outwards, so that bounds stay bounds; everything but times,
memory and the machine is the same whenever the study is made again with the same seed.
`read_study(write_study(s))` equals s; a file that is not such a document is refused with the place
of the fault. ``docs/bench.schema.json`` is its schema.
"""

from __future__ import annotations

import csv
import json
from collections.abc import Mapping
from dataclasses import dataclass
from io import StringIO
from pathlib import Path

from ptmcad.studies.bench.error import Figures
from ptmcad.studies.bench.harness import Times
from ptmcad.text.codec import TEXT, TRUTH, Codec, Key, line, listed, named, optional, record
from ptmcad.text.node import Node
from ptmcad.text.textfile import read_as

FORMAT = "ptmcad-bench/1"
MAX_BYTES = 10_000_000
MAX_COUNTED = 10**12
SEEN_SHARE = 0.99
"""A grid sees a region when it shows this share of it, at least, with its count."""
_COLUMNS = (
    "slice", "method", "setting", "seconds_median", "seconds_min", "seconds_max", "runs", "computing_median",
    "peak_mib", "count", "wrong_low", "wrong_high", "undetermined", "wrong_centres", "regions", "missed",
    "faintest_low", "faintest_high", "distance_low", "distance_high", "area_width", "reason",
)  # fmt: skip


@dataclass(frozen=True, slots=True)
class Measurement:
    """One method at one setting.

    Attributes
    ----------
    seconds : of whole processes, start-up included; None when it was not run to its end.
    computing : of the computation in them, where the process reports them.
    peak : largest resident set in MiB.
    reason : why there are no times; empty when there are.
    note : what the figures rest on, where it is not a measurement of ours.
    figures : by count.
    area_width : of the widest bounds of the area of all points with one count, as a share of the window.
    """

    method: str
    setting: str
    seconds: Times | None
    computing: Times | None = None
    peak: float | None = None
    reason: str = ""
    note: str = ""
    figures: Mapping[str, Figures] | None = None
    area_width: float | None = None

    @property
    def grid(self) -> int | None:
        """Pixels along each side, for a grid."""
        number = self.setting.removeprefix("N = ")
        return int(number) if number != self.setting else None

    @property
    def main_figures(self) -> Figures | None:
        """The figures for the finest count that the method gives."""
        found = self.figures or {}
        finest = ("index", "total", "stable", "admissible")
        return next((found[count] for count in finest if count in found), None)


@dataclass(frozen=True, slots=True)
class Study:
    """All measurements on one slice.

    Attributes
    ----------
    verified : whether the exact map that errors are measured against passed `ptmcad.verify`; None without such a map.
    floor : of the reference job that each round runs too, by which machines are compared.
    """

    slice: str
    heading: str
    machine: Mapping[str, str]
    versions: Mapping[str, str]
    seed: int
    rounds: int
    time_limit: float
    quick: bool
    verified: bool | None
    floor: Times
    measurements: tuple[Measurement, ...]


def smallest_grid(study: Study, method: str, count: str, seen: bool) -> int | None:
    """The smallest grid that finds every region of a count, or that sees every one; None when none of them does.

    Parameters
    ----------
    seen : ask for grids that see every region (see `SEEN_SHARE`), and not just find some pixel of it.
    """
    fit = []
    for m in study.measurements:
        f = (m.figures or {}).get(count)
        if m.method == method and m.grid is not None and f is not None:
            shown = f.faintest is not None and f.faintest[0] >= SEEN_SHARE
            if shown if seen else f.missed == 0:
                fit.append(m.grid)
    return min(fit, default=None)


def write_study(study: Study) -> str:
    """The study as JSON text."""
    return json.dumps(_STUDY.write(study), indent=1, ensure_ascii=False) + "\n"


def write_table(study: Study) -> str:
    """The study as CSV, one row for each measurement and count."""
    text = StringIO()
    table = csv.writer(text, lineterminator="\n")
    table.writerow(_COLUMNS)
    none = (None,)
    for m in study.measurements:
        s = m.seconds
        start = (
            study.slice, m.method, m.setting, *((s.median, s.minimum, s.maximum, s.runs) if s else none * 4),
            m.computing.median if m.computing else None, m.peak,
        )  # fmt: skip
        if not m.figures:
            table.writerow((*start, *(none * 11), m.area_width, m.reason))
        for count, f in (m.figures or {}).items():
            table.writerow((
                *start, count, *f.wrong, f.undetermined, f.wrong_centres, f.regions, f.missed,
                *(f.faintest or none * 2), *(f.distance or none * 2), m.area_width, m.reason,
            ))  # fmt: skip
    return text.getvalue()


def read_study(path: Path) -> Study:
    """Read a study's JSON file.

    Raises
    ------
    ConfigError
        When the file is missing or is no such document.
    """
    return read_as(path, MAX_BYTES, FORMAT, study_of)


def study_of(text: str) -> Study:
    """The study that `write_study` wrote.

    Raises
    ------
    ValueError
        When the text is not such a document; the message names the place.
    """
    node = Node(json.loads(text), "")
    if (found := node.mapping().get("format")) is not None and found.text() != FORMAT:
        raise found.fault(f"is not {FORMAT!r}")
    return _STUDY.read(node)


def _whole(node: Node) -> int:
    """Of pixels or regions, a seed: what nobody can count is not one."""
    if type(node.value) is not int:
        raise node.fault("is not a whole number")
    if node.value > MAX_COUNTED:
        raise node.fault(f"is more than {MAX_COUNTED}")
    return node.value


def _positive(node: Node) -> float:
    seconds = node.number()
    if not seconds > 0:
        raise node.fault("is not a positive number of seconds")
    return seconds


_WHOLE: Codec[int] = Codec(lambda value: value, _whole)
_NUMBER: Codec[float] = Codec(lambda value: value, Node.number)
_SECONDS: Codec[float] = Codec(lambda value: value, _positive)
_PAIR = listed(_NUMBER, 2)
_TIMES = record(Times, runs=_WHOLE, median=_SECONDS, minimum=_SECONDS, maximum=_SECONDS)
_FIGURES = record(
    Figures, wrong=_PAIR, undetermined=_NUMBER, wrong_centres=optional(_WHOLE), regions=optional(_WHOLE),
    missed=optional(_WHOLE), faintest=optional(_PAIR), distance=optional(_PAIR),
)  # fmt: skip
_MEASUREMENT = record(
    Measurement, method=line(60), setting=line(60), seconds=optional(_TIMES), computing=optional(_TIMES),
    peak=optional(_NUMBER), reason=line(1000), note=line(1000), figures=optional(named(_FIGURES)),
    area_width=optional(_NUMBER),
)  # fmt: skip
_STUDY = record(
    lambda format, **values: Study(**values), format=Key(TEXT, lambda _: FORMAT), slice=line(200), heading=line(1000),
    machine=named(line(300)), versions=named(line(300)), seed=_WHOLE, rounds=_WHOLE, time_limit=_NUMBER, quick=TRUTH,
    verified=optional(TRUTH), floor=_TIMES, measurements=listed(_MEASUREMENT),
)  # fmt: skip
