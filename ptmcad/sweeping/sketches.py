"""Small drawings of a sweep's maps, made from the stored results by this machine's processes.

Guarantee: each drawing is of the file that the index names.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from ptmcad.errors import OutputError
from ptmcad.options import Progress
from ptmcad.sweeping.index import read_sweep
from ptmcad.sweeping.member import Failed
from ptmcad.sweeping.pool import Pool
from ptmcad.sweeping.run import processors

if TYPE_CHECKING:
    from ptmcad.show.report.atlas import Thumbnail


@dataclass(frozen=True, slots=True)
class Drawing:
    """The task of drawing members of the sweep in a folder."""

    folder: Path
    timeout: float | None = None

    def answer(self, number: int) -> Thumbnail:
        """The drawing of a member."""
        from ptmcad.show.report.atlas import sketch

        return sketch(read_sweep(self.folder).result(number))


def sketches(
    folder: Path, numbers: Sequence[int], jobs: int | None, progress: Progress | None = None
) -> Iterator[tuple[int, Thumbnail]]:
    """The drawings of members, in any order.

    Raises
    ------
    OutputError
        When one cannot be drawn.
    """
    pool = Pool(Drawing(folder), min(jobs or processors(), max(1, len(numbers) // 4)))
    left = iter(numbers)
    done = 0
    try:
        while True:
            while pool.room and (number := next(left, None)) is not None:
                pool.submit(number)
            if not pool.busy:
                return
            for number, drawn in pool.answers(None):
                if isinstance(drawn, Failed):
                    raise OutputError(f"member {number} cannot be drawn: {drawn.error}")
                done += 1
                if progress is not None:
                    progress("drawings", done, len(numbers))
                yield number, drawn
    finally:
        pool.close()
