"""Pictures one after the other as a file, an animated GIF or MP4 by the program ffmpeg: of a motion,
or of a sweep's maps.

Guarantee: the same pictures give the same GIF with the same Pillow. A film begins and ends with a
rest. Of a sweep's maps the frame, the colours and the legend are the same in all pictures, so that
only the regions move; the values above a map are exact.
"""

from __future__ import annotations

import subprocess
import tempfile
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from io import BytesIO
from pathlib import Path
from subprocess import DEVNULL, PIPE
from typing import Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from PIL import Image

from ptmcad.answer.motion import Motion
from ptmcad.answer.regionmap import RegionMap
from ptmcad.errors import ConfigError
from ptmcad.extras import require_ffmpeg
from ptmcad.show.render.axes import dress, symbol
from ptmcad.show.render.colours import INK, Fill, fills_by_count, paint_of
from ptmcad.show.render.inches import axes_at, write
from ptmcad.show.render.legend import Entry, draw_legend, head_of
from ptmcad.show.render.outline import shapes
from ptmcad.show.render.painting import paint_map
from ptmcad.show.render.printing import settings
from ptmcad.show.render.stage import Pixels, Stage
from ptmcad.show.style import DEFAULT, PictureStyle
from ptmcad.show.table import in_order
from ptmcad.text.numerals import fraction_of, shortest_text

FORMATS = ("gif", "mp4")
REST = 0.8
"""Seconds for which the first and the last picture stand."""
COLOURS, SAMPLES = 128, 6
"""Of a GIF, chosen from so many of its pictures."""


def save_film(motion: Motion, path: Path, style: PictureStyle, fps: int, dpi: int) -> None:
    """Write the motion as a file, whose suffix gives the format.

    Raises
    ------
    ConfigError
        For a system that cannot be drawn, another suffix, a size that is too small, or MP4 without
        ffmpeg.
    OSError
        When the file cannot be written.
    """
    save_pictures(lambda: Stage(motion, style, dpi), path, style, fps)


def save_pictures(
    make: Callable[[], Stage | SweepFilm], path: Path, style: PictureStyle, fps: int
) -> None:
    """Write pictures one after the other as a file, whose suffix gives the format.

    Parameters
    ----------
    make : gives the pictures, within the style's settings.

    Raises
    ------
    ConfigError
        For another suffix, or MP4 without ffmpeg, or what ``make`` refuses.
    OSError
        When the file cannot be written.
    """
    suffix = path.suffix.lower().removeprefix(".")
    if suffix not in FORMATS:
        raise ConfigError(
            f"{path.name}: the format {suffix!r} is not among {', '.join(FORMATS)}", key="--format"
        )
    with settings(style):
        if suffix == "mp4":
            _write_mp4(make(), path, fps)
        else:
            path.write_bytes(_gif(make(), fps))


def gif_bytes(motion: Motion, style: PictureStyle, fps: int, dpi: int) -> bytes:
    """The motion as the content of an animated GIF."""
    with settings(style):
        return _gif(Stage(motion, style, dpi), fps)


def _gif(pictures: Stage | SweepFilm, fps: int) -> bytes:
    """The content of an animated GIF, in the same colours throughout, so that nothing flickers."""
    number = len(pictures)
    chosen = sorted({round(k * (number - 1) / (SAMPLES - 1)) for k in range(SAMPLES)})
    sample = Image.fromarray(np.concatenate([pictures.frame(k) for k in chosen]))
    palette = sample.quantize(COLOURS, method=Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE)
    frames = (Image.fromarray(pictures.frame(k)) for k in range(number))
    drawn = [frame.quantize(palette=palette, dither=Image.Dither.NONE) for frame in frames]
    pause = max(2, round(100 / fps)) * 10  # hundredths of a second are what the format knows
    durations = [pause] * len(drawn)
    durations[0] = durations[-1] = max(pause, round(1000 * REST))
    data = BytesIO()
    drawn[0].save(
        data,
        format="GIF",
        save_all=True,
        append_images=drawn[1:],
        duration=durations,
        loop=0,
        optimize=False,
    )
    return data.getvalue()


def _write_mp4(pictures: Stage | SweepFilm, path: Path, fps: int) -> None:
    """Give ffmpeg one picture after the other."""
    program, rest = require_ffmpeg(), round(REST * fps)
    with tempfile.TemporaryFile() as said:
        tall, wide, _ = pictures.frame(0).shape
        command = [
            program, "-loglevel", "error", "-nostats", "-y",
            "-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{wide}x{tall}", "-r", str(fps), "-i", "-",
            # sides that are even, and colours that every player knows
            "-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2:color=white", "-pix_fmt", "yuv420p", "-movflags", "+faststart",
            "-f", "mp4", str(path),
        ]  # fmt: skip
        last = len(pictures) - 1
        numbers = [*[0] * rest, *range(last + 1), *[last] * rest]
        process = subprocess.Popen(command, stdin=PIPE, stdout=DEVNULL, stderr=said)
        assert process.stdin is not None  # a pipe
        with suppress(BrokenPipeError), process:  # where it has ended before, its status tells
            for number in numbers:
                process.stdin.write(pictures.frame(number).tobytes())
        if process.returncode:
            said.seek(0)
            words = " ".join(said.read().decode(errors="replace").split())[-300:]
            raise OSError(f"ffmpeg failed with status {process.returncode}: {words}")


SIZE, _DPI = (7.0, 5.2), 100
"""Inches of a picture."""
_CHART, _HEAD, _KEY = (0.77, 0.63, 4.34, 3.95), (0.77, 4.7), (5.25, 4.58)
"""The map's place, the left end of the head's middle, and the legend's upper left corner."""
_MAX_LENGTH = 90
"""Characters of the values above a map."""


class SweepFilm:
    """The pictures; to be used within `printing.settings`.

    Parameters
    ----------
    maps : gives each map when it is drawn, so that only one of them is in memory.
    values : of what is swept, for each map.
    """

    def __init__(
        self, maps: Callable[[int], RegionMap], values: Sequence[Mapping[str, str]]
    ) -> None:
        self.maps, self.values = maps, values
        fills: dict[str, Fill] = {}
        head: tuple[str, ...] = ("",)
        for number in range(len(values)):
            result = maps(number)
            fills |= fills_by_count(paint_of(DEFAULT, result), result)
            head = head_of(result.slice)[:1]
        entries = (Entry((text,), fills[text]) for text in sorted(fills, key=in_order))
        self.legend = [Entry(head, strong=True), *entries]

    def __len__(self) -> int:
        return len(self.values)

    def frame(self, number: int) -> Pixels:
        figure = Figure(figsize=SIZE, dpi=_DPI, facecolor="white")
        result = self.maps(number)
        text = ",  ".join(
            f"{symbol(n)} = {shortest_text(fraction_of(v))}" for n, v in self.values[number].items()
        )
        head = text if len(text) <= _MAX_LENGTH else f"{text[:_MAX_LENGTH]}…"
        axes, seen = axes_at(figure, _CHART), shapes(result)
        paint_map(axes, seen, "", paint_of(DEFAULT, result))
        dress(axes, result.slice, seen.view.x, seen.view.y)
        write(figure, _HEAD, head, 12, color=INK)
        draw_legend(figure, self.legend, *_KEY)
        canvas: Any = FigureCanvasAgg(figure)
        canvas.draw()
        return np.asarray(canvas.buffer_rgba())[..., :3].copy()
