"""A study: error against run time of several methods on one slice, as it is stored and compared.

Guarantee: figures of error are rounded outwards, so that bounds stay bounds; everything but times, memory and the
machine is the same whenever the study is made again with the same seed.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction

from ptmcad.studies.bench.error import MapError
from ptmcad.studies.bench.harness import Times
from ptmcad.text.numerals import decimal

FORMAT = "ptmcad-bench/1"
DIGITS = 6
SEEN_SHARE = 0.99
"""A grid sees a region when it shows this share of it, at least, with its count."""
Bounds = tuple[float, float]


@dataclass(frozen=True, slots=True)
class Figures:
    """The error of a map for one count, see `ptmcad.studies.bench.error.MapError`; None where there is no such
    figure."""

    wrong: Bounds
    undetermined: float
    wrong_centres: int | None = None
    regions: int | None = None
    missed: int | None = None
    faintest: Bounds | None = None
    distance: Bounds | None = None


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
        return int(self.setting.removeprefix("N = ")) if self.setting.startswith("N = ") else None


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


def figures(error: MapError) -> Figures:
    """The figures of an error, rounded outwards."""
    return Figures(
        wrong=outward(error.wrong),
        undetermined=_rounded(error.undetermined, up=True),
        wrong_centres=error.wrong_centres,
        regions=error.regions,
        missed=error.missed,
        faintest=outward(error.faintest),
        distance=None
        if error.distance is None
        else outward((Fraction(error.distance.largest[0]), Fraction(error.distance.largest[1]))),
    )


def outward(bounds: tuple[Fraction, Fraction]) -> Bounds:
    """Both bounds in six digits, the lower rounded down and the upper rounded up."""
    return _rounded(bounds[0], up=False), _rounded(bounds[1], up=True)


def _rounded(value: Fraction, up: bool) -> float:
    return float(decimal(value, up=up, digits=DIGITS))


def main_figures(measurement: Measurement) -> Figures | None:
    """The figures for the finest count that the method gives."""
    found = measurement.figures or {}
    return next((found[count] for count in ("index", "total", "stable", "admissible") if count in found), None)


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
            found = f.faintest is not None and f.faintest[0] >= SEEN_SHARE if seen else f.missed == 0
            fit += [m.grid] if found else []
    return min(fit, default=None)


def grids(study: Study, method: str) -> tuple[int, ...]:
    """The grids that a method was measured on."""
    return tuple(sorted(m.grid for m in study.measurements if m.method == method and m.grid and m.figures))
