"""One member of a sweep, from its number to its result's text and what an index holds of it.

Guarantee: `compute` is the only way to a member's result, in this process, another one or on a
cluster; the text is that of the member classified alone, timings left out.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from dataclasses import dataclass, fields, replace
from fractions import Fraction
from functools import partial
from time import perf_counter
from typing import Any

from ptmcad.answer.regionmap import RegionMap
from ptmcad.answer.sweep import Bounds, CountedArea, State, Summary, Widest
from ptmcad.answer.widths import overall
from ptmcad.ask.classification import region_map
from ptmcad.errors import ConfigError, HypothesisError, LimitReached, PtmcadError
from ptmcad.options import Options
from ptmcad.question.config.sweeps import Sweeping
from ptmcad.question.slice import Slice
from ptmcad.show.table import areas_by_key
from ptmcad.text.codec import listed, row_of
from ptmcad.text.numerals import decimal, text_of
from ptmcad.version import __version__


@dataclass(frozen=True, slots=True)
class Wanted:
    """What is wanted of each member.

    Attributes
    ----------
    along : the axis along which the widest operation range is found; empty for none.
    timeout : seconds that a member may take.
    """

    engine: str = "auto"
    tolerance: Fraction | None = None
    area_tolerance: Fraction | None = None
    areas: bool = True
    along: str = ""
    timeout: float | None = None

    @property
    def options(self) -> Options:
        """The engine's options; a member has one thread, as there are many members."""
        named = {field.name: getattr(self, field.name) for field in fields(self)}
        del named["along"]
        return Options(jobs=1, **named)


@dataclass(frozen=True, slots=True)
class Outcome:
    """What became of a member: a result, or the reason why there is none.

    Attributes
    ----------
    state : refused where another attempt would end in the same way, failed where it may not.
    text : the result's document without timings.
    summary : what an index holds of it.
    """

    state: State
    error: str = ""
    text: str = ""
    summary: Summary | None = None
    seconds: float | None = None


_ONE_AT_A_TIME = threading.Lock()
"""FLINT's precision belongs to the process: a cluster's worker with several threads computes one
member at a time.
"""


def computing(question: Sweeping, wanted: Wanted) -> Callable[..., Outcome]:
    """What computes members by their numbers, in whatever process."""
    return partial(compute, question, wanted, __version__)


def compute(
    question: Sweeping, wanted: Wanted, version: str, number: int, _check: object = None
) -> Outcome:
    """Classify a member.

    Errors that are no answer about the member (a bug, memory) are raised.

    Parameters
    ----------
    version : of the process that asks.
    """
    if version != __version__:
        why = f"this process has ptmcad {__version__}, and the sweep was asked with {version}"
        return Outcome(State.FAILED, why)
    with _ONE_AT_A_TIME:
        started = perf_counter()
        try:
            result = region_map(question.slice(number), wanted.options)
            summary = summary_of(result, wanted)
        except LimitReached:
            return Outcome(State.FAILED, out_of_time(wanted.timeout))
        except PtmcadError as error:
            return Outcome(State.REFUSED, reason(error), seconds=perf_counter() - started)
        text = result.to_json(timings=False)
        return Outcome(State.DONE, "", text, summary, perf_counter() - started)


def reason(error: PtmcadError) -> str:
    """Why values are refused, without the place of the record, which may be moved."""
    if isinstance(error, ConfigError):
        return str(ConfigError(error.message, key=error.key))
    return str(error)


def out_of_time(timeout: float | None) -> str:
    """What is said of a member that took too long, wherever that was noticed."""
    return f"the member's time limit of {timeout:g} s was reached"


def summary_of(result: RegionMap, wanted: Wanted) -> Summary:
    """What an index holds of a map."""
    return Summary(
        status=result.status.value,
        cells=len(result.cells),
        regions=len(result.regions),
        undetermined=text_of(result.undetermined),
        areas=tuple(_areas(result, known=wanted.areas or result.cover is not None)),
        widest=_widest(result.slice, wanted.along) if wanted.along else None,
    )


def _areas(result: RegionMap, known: bool) -> Iterator[CountedArea]:
    """The regions by the count that distinguishes them, in increasing order."""
    for count, (number, area) in areas_by_key(result).items():
        text = "?" if count == (-1,) else "-".join(map(str, count))
        yield CountedArea(text, number, bounds(*area) if known else ("", ""))


def bounds(low: Fraction, high: Fraction) -> Bounds:
    """Decimals of 18 digits that bound an enclosed number.

    >>> bounds(Fraction(-1, 3), Fraction(1, 2))
    ('-0.333333333333333334', '0.5')
    """
    return decimal(low, up=False), decimal(high, up=True)


def _widest(slice: Slice, along: str) -> Widest:
    """The widest operation range, or why that is not known."""
    from ptmcad.exact.ranges.rangestrips import strips
    from ptmcad.exact.ranges.width import widest

    try:
        maxima = widest(slice, along, strips(slice, along))
    except (ConfigError, HypothesisError) as error:
        return Widest(along, remark=str(error))
    if not maxima:
        return Widest(along)
    over = next(name for name in slice.axis_names if name != along)
    return Widest(
        along,
        # each of the maxima may be the largest width
        bounds(max(m.width.low for m in maxima), max(m.width.high for m in maxima)),
        tuple(bounds(m.at.low, m.at.high) for m in maxima),
        "; ".join(m.words(over) for m in maxima),
        attainment=overall(maxima).value,
    )


def _width_from(*values: Any) -> Widest:
    """A width; an index from before attainment was recorded says of limits that they are
    attained.
    """
    found = Widest(*values)
    return found if len(values) > 5 or not found.proof else replace(found, proof=found.attainment)


AREAS = listed(row_of(CountedArea))
WIDEST = row_of(Widest, _width_from)
"""How these are written in an index."""
