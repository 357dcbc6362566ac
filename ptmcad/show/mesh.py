"""A boundary surface as a mesh for other programs: Wavefront OBJ and Stanford PLY, as text.

Guarantee: the same surface gives the same text. Floats are written so that they are read back as
they are.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from itertools import groupby

from ptmcad.answer.boundarysurface import BoundarySurface


def obj_text(surface: BoundarySurface) -> str:
    """Wavefront OBJ: each sheet is a group, named by its number and the counts that it parts."""
    return "\n".join(_obj_lines(surface)) + "\n"


def _obj_lines(surface: BoundarySurface) -> Iterator[str]:
    yield f"# boundary surface over {', '.join(surface.names)}: {surface.words()}"
    yield from ("v " + " ".join(map(repr, point)) for point in surface.vertices.tolist())
    pairs = zip(surface.sheet.tolist(), surface.faces.tolist(), strict=True)
    for sheet, faces in groupby(pairs, key=lambda pair: pair[0]):
        counts = "-and-".join("_".join(map(str, key)) for key in surface.sheets[sheet].counts)
        yield f"g sheet-{sheet}-between-{counts}"
        yield from ("f " + " ".join(str(n + 1) for n in face) for _, face in faces)


def ply_text(surface: BoundarySurface) -> str:
    """Stanford PLY in ASCII: a vertex has its member's number, a face its sheet's and the counts on
    both sides.

    Where counts are by index, they are given as places in a comment's list.
    """
    kinds = sorted({key for sheet in surface.sheets for key in sheet.counts})
    plain = all(len(key) == 1 for key in kinds)
    number = {key: key[0] if plain else place for place, key in enumerate(kinds)}
    head = [
        "ply",
        "format ascii 1.0",
        f"comment boundary surface over {', '.join(surface.names)}",
        f"comment {surface.words()}",
        *(
            []
            if plain
            else [f"comment count {n} is {'-'.join(map(str, key))}" for key, n in number.items()]
        ),
        f"element vertex {len(surface.vertices)}",
        *(f"property double {name}" for name in "xyz"),
        "property int member",
        f"element face {len(surface.faces)}",
        "property list uchar int vertex_indices",
        *(f"property int {name}" for name in ("sheet", "low_count", "high_count")),
        "end_header",
    ]
    points = (
        " ".join(map(repr, point)) + f" {member}"
        for point, member in zip(surface.vertices.tolist(), surface.member.tolist(), strict=True)
    )
    sides = [" ".join(str(number[key]) for key in sheet.counts) for sheet in surface.sheets]
    faces = (
        f"3 {a} {b} {c} {sheet} {sides[sheet]}"
        for (a, b, c), sheet in zip(surface.faces.tolist(), surface.sheet.tolist(), strict=True)
    )
    return "\n".join((*head, *points, *faces)) + "\n"


MESHES: Mapping[str, Callable[[BoundarySurface], str]] = {"obj": obj_text, "ply": ply_text}
"""The formats."""
