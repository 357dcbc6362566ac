"""Pictures one after the other as a file: an animated GIF, or MP4 by the program ffmpeg.

Guarantee: the same pictures give the same GIF with the same Pillow. A film begins and ends with a rest.
"""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Sequence
from io import BytesIO
from pathlib import Path

import numpy as np
from PIL import Image

from ptmcad.answer.motion import Motion
from ptmcad.errors import ConfigError
from ptmcad.show.render.printing import settings
from ptmcad.show.render.stage import Pixels, Stage
from ptmcad.show.style import Style

FORMATS = ("gif", "mp4")
REST = 0.8
"""Seconds for which the first and the last picture stand."""
COLOURS = 128


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
        _write_mp4(_frames(motion, style, dpi), path, fps)
    else:
        path.write_bytes(gif_bytes(motion, style, fps, dpi))


def gif_bytes(motion: Motion, style: Style, fps: int, dpi: int) -> bytes:
    """The motion as the content of an animated GIF, in the same colours throughout, so that nothing flickers."""
    frames = _frames(motion, style, dpi)
    chosen = np.linspace(0, len(frames) - 1, min(6, len(frames))).astype(int)
    sample = Image.fromarray(np.concatenate([frames[k] for k in chosen]))
    palette = sample.quantize(COLOURS, method=Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE)
    drawn = [Image.fromarray(frame).quantize(palette=palette, dither=Image.Dither.NONE) for frame in frames]
    pause = max(2, round(100 / fps)) * 10  # hundredths of a second are what the format knows
    durations = [pause] * len(drawn)
    durations[0] = durations[-1] = max(pause, round(1000 * REST))
    data = BytesIO()
    drawn[0].save(
        data, format="GIF", save_all=True, append_images=drawn[1:], duration=durations, loop=0, optimize=False
    )
    return data.getvalue()


def _frames(motion: Motion, style: Style, dpi: int) -> list[Pixels]:
    with settings(style):
        return list(Stage(motion, style, dpi).frames())


def program() -> str:
    """Where ffmpeg is.

    Raises
    ------
    ConfigError
        When it is not on the PATH.
    """
    found = shutil.which("ffmpeg")
    if found is None:
        raise ConfigError(
            "mp4 is made by the program ffmpeg, which is not on the PATH: install it, or ask for gif", key="--format"
        )
    return found


def _write_mp4(frames: Sequence[Pixels], path: Path, fps: int) -> None:
    tall, wide, _ = frames[0].shape
    rest = round(REST * fps)
    shown = [*[frames[0]] * rest, *frames, *[frames[-1]] * rest]
    command = [
        program(), "-loglevel", "error", "-nostats", "-y",
        "-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{wide}x{tall}", "-r", str(fps), "-i", "-",
        # sides that are even, and colours that every player knows
        "-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2:color=white", "-pix_fmt", "yuv420p", "-movflags", "+faststart",
        "-f", "mp4", str(path),
    ]  # fmt: skip
    done = subprocess.run(command, input=b"".join(frame.tobytes() for frame in shown), capture_output=True, check=False)
    if done.returncode:
        said = " ".join(done.stderr.decode(errors="replace").split())[-300:]
        raise OSError(f"ffmpeg failed with status {done.returncode}: {said}")
