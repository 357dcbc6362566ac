"""What commands do with families: compute and write their members, read them again, and draw them
together.

Guarantee: a member's file is written as soon as its map is complete, so that an interrupted run
leaves whole maps.
"""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ptmcad.answer.family import FamilyMap
from ptmcad.answer.regionmap import RegionMap
from ptmcad.cli.commonoptions import Formats
from ptmcad.cli.drawing import DATA, MESHES, PICTURES, DrawingOptions, Output, writer
from ptmcad.cli.progress import ProgressBar
from ptmcad.cli.slices import Third
from ptmcad.cli.storedresults import read_other, read_result
from ptmcad.errors import ConfigError, LimitReached, PtmcadError, shown_path
from ptmcad.options import Options
from ptmcad.process.output import Writer, check_writable, text_writer, write_files
from ptmcad.question.config import Family, fault_of_member
from ptmcad.show import render
from ptmcad.show.document.familydocument import FORMAT, read_family, write_family
from ptmcad.text.numerals import text_of

if TYPE_CHECKING:
    from ptmcad.answer.boundarysurface import BoundarySurface

SOLID = "-3d"
"""Behind a family's name, in that of its picture in three dimensions."""
_FIGURES = ("", SOLID)


def family_to_files(
    family: Family, options: Options, wanted: Output, third: Third
) -> tuple[FamilyMap, BoundarySurface | None]:
    """Classify the members one by one, write each, then the family's own files.

    Returns the maps, and the boundary surface where that is wanted.

    Raises
    ------
    LimitReached
        When the time is over, saying how many members are complete and written.
    PtmcadError
        Any other of its kinds, naming the member.
    """
    files = names_of_family(family.name, wanted.formats)
    check_writable(wanted.out, tuple(files))
    members: list[RegionMap] = []
    with ProgressBar() as progress:
        from ptmcad.ask.members import member_map
        from ptmcad.workbench.familymaps import prepared, together

        progress("variety of the family", 0, 1)
        begun = time.monotonic()

        def left() -> Options:
            """The options with the time that is left."""
            if options.timeout is None:
                return options
            return replace(options, timeout=max(begun + options.timeout - time.monotonic(), 0.01))

        drawn = bool(wanted.among(MESHES)) or (third.surface and bool(wanted.among(PICTURES)))
        common, changes = prepared(
            family,
            replace(options, progress=progress),
            changes=drawn or third.changes,
            between=third.between,
        )
        values = common.family.values
        for number, value in enumerate(values):
            progress("members", number, len(values))
            try:
                found = member_map(common, value, left())
            except LimitReached as stop:
                written = f"; the maps of {number} of {len(values)} members are in {shown_path(wanted.out)}"
                raise LimitReached(
                    f"{stop} of {family.free.name} = {text_of(value)}{written}"
                ) from stop
            except PtmcadError as error:
                raise _at(error, f"{family.free.name} = {text_of(value)}") from error
            _write_member(found, wanted)
            members.append(found)
        surface = None
        if drawn and changes is not None:
            from ptmcad.workbench.boundarymesh import surface_of

            surface = surface_of(common, changes, options=replace(left(), progress=progress))
    result = together(family, common, tuple(members), changes)
    if files:
        write_files(
            wanted.out, family_writers(result, files, wanted.drawing, surface, third.surface)
        )
    return result, surface


def _at(error: PtmcadError, place: str) -> PtmcadError:
    """The same error, saying at which member."""
    if isinstance(error, ConfigError):
        return error.place.error(f"{error.message} (at {place})")
    return type(error)(f"{error} (at {place})")


def names_of_family(stem: str, formats: Formats) -> dict[str, str]:
    """The family's own files, each with what it has: one of `_FIGURES`, or a text of some format."""
    drawn = [kind for kind in formats if kind in PICTURES]
    texts = [*(kind for kind in formats if kind in MESHES), *["json"] * ("json" in formats)]
    return {f"{stem}{part}.{kind}": part for kind in drawn for part in _FIGURES} | {
        f"{stem}.{kind}": kind for kind in texts
    }


def _write_member(found: RegionMap, wanted: Output) -> None:
    name = found.slice.name
    writers = wanted.drawing.writers(found, name, wanted.among(DATA))
    if "json" in wanted.formats:
        writers[f"{name}.json"] = text_writer(wanted.text(found))
    if writers:
        write_files(wanted.out, writers)


def family_writers(
    result: FamilyMap,
    files: Mapping[str, str],
    drawing: DrawingOptions,
    surface: BoundarySurface | None,
    solid: bool,
) -> dict[str, Writer]:
    """For each of a family's own files a function that writes it.

    Parameters
    ----------
    files : as of `names_of_family`.
    surface : what meshes are of.
    solid : whether pictures show it, instead of the stack of maps.
    """
    how = {"dpi": drawing.dpi, "style": drawing.style}

    def draw(part: str) -> Any:
        if part not in _FIGURES:
            return _text(result, part, surface)
        if part == SOLID:
            return render.solid_figure(result, *how.values(), surface if solid else None)
        return render.multiples_figure(result, *how.values())

    return {name: writer(name, partial(draw, part), **how) for name, part in files.items()}


def _text(result: FamilyMap, kind: str, surface: BoundarySurface | None) -> str:
    if kind == "json":
        return write_family(result)
    from ptmcad.show.mesh import MESHES as KNOWN

    assert surface is not None
    return KNOWN[kind](surface)


def read_family_file(path: Path, *, whole: bool = True) -> FamilyMap:
    """The family in a JSON file, with its members' maps, which are in files beside it.

    Parameters
    ----------
    whole : as of `read_result`.

    Raises
    ------
    ConfigError
        When one of the files cannot be read, or is not what it should be.
    """
    stored, files = read_other(path, read_family, FORMAT)
    members = tuple(read_result(path.parent / file, whole=whole) for file in files)
    for value, file, member in zip(stored.values, files, members, strict=True):
        if member.slice.axes != members[0].slice.axes:
            raise ConfigError(
                "its members are not of one family: their axes differ", file=str(path)
            )
        if fault := fault_of_member(member.slice, stored.text, stored.free.name, value):
            place = f"{stored.free.name} = {text_of(value)}"
            raise ConfigError(
                f"is not the member at {place} that {path.name} names: {fault}",
                file=str(path.parent / file),
            )
    return replace(stored, members=members)
