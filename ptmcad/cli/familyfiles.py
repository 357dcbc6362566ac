"""What commands do with families: compute and write their members, read them again, and draw them
together.

Guarantee: a member's file is written as soon as its map is complete, so that an interrupted run
leaves whole maps.
"""

from __future__ import annotations

import time
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from ptmcad.answer.family import FamilyMap
from ptmcad.answer.regionmap import RegionMap
from ptmcad.cli.commonoptions import Formats
from ptmcad.cli.drawing import DATA, MESHES, PICTURES, DrawingOptions, Output, figure, names_of
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
    names = names_of_family(family.name, wanted)
    check_writable(wanted.out, names)
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
    if writers := _writers(result, surface, wanted, third.surface):
        write_files(wanted.out, writers)
    return result, surface


def _at(error: PtmcadError, place: str) -> PtmcadError:
    """The same error, saying at which member."""
    if isinstance(error, ConfigError):
        return error.place.error(f"{error.message} (at {place})")
    return type(error)(f"{error} (at {place})")


def names_of_family(name: str, wanted: Output) -> tuple[str, ...]:
    """The family's own files."""
    names = [f"{name}{end}.{kind}" for kind in wanted.among(PICTURES) for end in ("", SOLID)]
    names += [f"{name}.{kind}" for kind in wanted.among(MESHES)]
    return (*names, f"{name}.json") if "json" in wanted.formats else tuple(names)


def _write_member(found: RegionMap, wanted: Output) -> None:
    name = found.slice.name
    writers = wanted.drawing.writers(found, name, wanted.among(DATA))
    if "json" in wanted.formats:
        writers[f"{name}.json"] = text_writer(wanted.text(found))
    if writers:
        write_files(wanted.out, writers)


def _writers(
    result: FamilyMap, surface: BoundarySurface | None, wanted: Output, solid: bool
) -> dict[str, Writer]:
    name = result.name
    shown = surface if solid else None
    writers = picture_writers(result, name, wanted.among(PICTURES), wanted.drawing, shown)
    if surface is not None:
        writers |= mesh_writers(surface, name, wanted.among(MESHES))
    if "json" in wanted.formats:
        writers[f"{name}.json"] = text_writer(write_family(result))
    return writers


def picture_writers(
    result: FamilyMap,
    stem: str,
    formats: Formats,
    drawing: DrawingOptions,
    surface: BoundarySurface | None = None,
) -> dict[str, Writer]:
    """For each picture of a family a function that writes it.

    Parameters
    ----------
    surface : drawn instead of the stack of maps.
    """
    found = {}
    for kind in formats:
        for end, make in (
            ("", lambda: render.multiples_figure(result, drawing.dpi, drawing.style)),
            (SOLID, lambda: render.solid_figure(result, drawing.dpi, drawing.style, surface)),
        ):
            for file in names_of(f"{stem}{end}", (kind,)):
                found[file] = figure(file, make, dpi=drawing.dpi, style=drawing.style)
    return found


def mesh_writers(surface: BoundarySurface, stem: str, formats: Formats) -> dict[str, Writer]:
    """For each of `MESHES` a function that writes the surface."""
    from ptmcad.show.mesh import MESHES as KNOWN

    return {f"{stem}.{kind}": text_writer(KNOWN[kind](surface)) for kind in formats}


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
