"""What a caller wants of an engine beside the slice: made once, and handed down whole.

Guarantee: the name of the engine is one that there is. Whether the options fit one another and the
slice, `ptmcad.ask.classification` says before anything is computed.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from types import NoneType

from ptmcad.answer.regionmap import RegionMap
from ptmcad.errors import ConfigError, expect
from ptmcad.question.slice import Slice
from ptmcad.text.syntax import did_you_mean

ENGINES = ("auto", "exact", "certified")

Progress = Callable[[str, int, int], None]
"""Called as progress(stage, done, total); a stage that ends with "%" or "..." says itself how far
the work is.
"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Options:
    """What is wanted, and how far to go.

    Attributes
    ----------
    engine : ``"exact"``, ``"certified"``, or ``"auto"``: certified where springs have a free
        length, else exact.
    timeout : seconds that the computation may take once the engine is loaded.
    deadline : reading of `time.perf_counter` at which an engine stops; what ``timeout`` comes to
        when the clock starts.
    tolerance : the certified engine stops when at most this share of the window's area is
        undetermined; its own default when None.
    area_tolerance : largest relative width of each region's area bounds, for the exact engine; its
        own default when None.
    jobs : number of threads of the certified engine, all processors when None; the map does not
        depend on it.
    progress : called as progress(stage, done, total).
    without : names of savings to switch off, of `ptmcad.question.savings`.
    partial : called with the map after each stage that improves it.
    resume : a certified map of the same slice and count: what is outside its cover stays decided.
    areas : whether to enclose the regions' areas; without, they are known only to be at most the
        window's.
    sparing : whether the exact engine counts once for all cells that are proved to be joined off
        the variety, where counts are equal; the other cells then have no solutions, and nothing
        checks the decomposition by counting.

    Raises
    ------
    ConfigError
        For an unknown engine.
    """

    engine: str = "auto"
    timeout: float | None = None
    deadline: float | None = None
    tolerance: Fraction | None = None
    area_tolerance: Fraction | None = None
    jobs: int | None = None
    progress: Progress | None = None
    without: frozenset[str] = frozenset()
    partial: Callable[[RegionMap], None] | None = None
    resume: RegionMap | None = None
    areas: bool = True
    sparing: bool = False

    def __post_init__(self) -> None:
        expect(self.timeout, (int, float, NoneType), "timeout", "a number of seconds")
        if self.engine not in ENGINES:
            suggestion = did_you_mean(self.engine, ENGINES)
            raise ConfigError(
                f"{self.engine!r} is none of {', '.join(ENGINES)}{suggestion}", key="engine"
            )


DEFAULTS = Options()


def is_certified(slice: Slice, engine: str) -> bool:
    """Whether the choice ``"exact"``, ``"certified"`` or ``"auto"`` means the certified engine for
    a slice.
    """
    only = slice.has_free_lengths or slice.count.kind.predicate is not None
    return engine == "certified" or (engine == "auto" and only)
