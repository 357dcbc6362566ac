"""Pictures one after the other as a file: an animated GIF, or MP4 by the program ffmpeg.

Guarantee: the same pictures give the same GIF with the same Pillow. A film begins and ends with a rest.
"""

from __future__ import annotations

import subprocess
import tempfile
from contextlib import suppress
from io import BytesIO
from pathlib import Path
from subprocess import DEVNULL, PIPE

import numpy as np
from PIL import Image

from ptmcad.answer.motion import Motion
from ptmcad.errors import ConfigError
from ptmcad.process.extras import require_ffmpeg
from ptmcad.show.render.printing import settings
from ptmcad.show.render.stage import Stage
from ptmcad.show.style import Style

FORMATS = ("gif", "mp4")
REST = 0.8
"""Seconds for which the first and the last picture stand."""
COLOURS, SAMPLES = 128, 6
"""Of a GIF, chosen from so many of its pictures."""


def save_film(motion: Motion, path: Path, style: Style, fps: int, dpi: int) -> None:
    """Write the motion as a file, whose suffix gives the format.

    Raises
    ------
    ConfigError
        For a system that cannot be drawn, another suffix, a size that is too small, or MP4 without ffmpeg.
    OSError
        When the file cannot be written.
    """
    suffix = path.suffix.lower().removeprefix(".")
    if suffix not in FORMATS:
        raise ConfigError(f"{path.name}: the format {suffix!r} is not among {', '.join(FORMATS)}", key="--format")
    if suffix == "mp4":
        _write_mp4(motion, style, path, fps, dpi)
    else:
        path.write_bytes(gif_bytes(motion, style, fps, dpi))


def gif_bytes(motion: Motion, style: Style, fps: int, dpi: int) -> bytes:
    """The motion as the content of an animated GIF, in the same colours throughout, so that nothing flickers."""
    with settings(style):
        stage = Stage(motion, style, dpi)
        number = len(motion.steps)
        chosen = sorted({round(k * (number - 1) / (SAMPLES - 1)) for k in range(SAMPLES)})
        sample = Image.fromarray(np.concatenate([stage.frame(k) for k in chosen]))
        palette = sample.quantize(COLOURS, method=Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE)
        drawn = [Image.fromarray(frame).quantize(palette=palette, dither=Image.Dither.NONE) for frame in stage.frames()]
    pause = max(2, round(100 / fps)) * 10  # hundredths of a second are what the format knows
    durations = [pause] * len(drawn)
    durations[0] = durations[-1] = max(pause, round(1000 * REST))
    data = BytesIO()
    drawn[0].save(
        data, format="GIF", save_all=True, append_images=drawn[1:], duration=durations, loop=0, optimize=False
    )
    return data.getvalue()


def _write_mp4(motion: Motion, style: Style, path: Path, fps: int, dpi: int) -> None:
    """Give ffmpeg one picture after the other."""
    program, rest = require_ffmpeg(), round(REST * fps)
    with settings(style), tempfile.TemporaryFile() as said:
        stage = Stage(motion, style, dpi)
        tall, wide, _ = stage.frame(0).shape
        command = [
            program, "-loglevel", "error", "-nostats", "-y",
            "-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{wide}x{tall}", "-r", str(fps), "-i", "-",
            # sides that are even, and colours that every player knows
            "-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2:color=white", "-pix_fmt", "yuv420p", "-movflags", "+faststart",
            "-f", "mp4", str(path),
        ]  # fmt: skip
        last = len(motion.steps) - 1
        numbers = [*[0] * rest, *range(last + 1), *[last] * rest]
        process = subprocess.Popen(command, stdin=PIPE, stdout=DEVNULL, stderr=said)
        assert process.stdin is not None  # a pipe
        with suppress(BrokenPipeError), process:  # where it has ended before, its status tells
            for number in numbers:
                process.stdin.write(stage.frame(number).tobytes())
        if process.returncode:
            said.seek(0)
            words = " ".join(said.read().decode(errors="replace").split())[-300:]
            raise OSError(f"ffmpeg failed with status {process.returncode}: {words}")
