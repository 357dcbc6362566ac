"""A discriminant variety as a JSON document, described by docs/variety.schema.json.

Guarantee: every number is exact; the same slice gives the same text.
"""

from __future__ import annotations

from operator import attrgetter
from typing import Any

from ptmcad.answer.regionmap import Component
from ptmcad.answer.slicevariety import EliminationSystem, SliceVariety
from ptmcad.question.slice import Slice
from ptmcad.show.document.slicedocument import polynomial_over, slice_over
from ptmcad.text.codec import (
    NATURAL,
    POSITIVE,
    TEXT,
    Codec,
    derived,
    listed,
    named,
    record_of,
)
from ptmcad.text.documents import document_text
from ptmcad.text.plane import PlanePolynomial

FORMAT = "ptmcad-variety/1"


def document(variety: SliceVariety) -> str:
    """The variety as JSON text, one component a line."""
    return document_text(FORMAT, variety_codec(variety.slice.axis_names).write(variety))


def variety_codec(names: tuple[str, str]) -> Codec[SliceVariety]:
    """The codec of a variety over axes of these names."""
    whole: dict[Any, Codec[Any]] = {PlanePolynomial: polynomial_over(names)}
    whole[Component] = record_of(
        Component, whole, separates=None, continuum=None,
        degree=derived(attrgetter("polynomial.total_degree"), POSITIVE),
        degrees=derived(lambda c: dict(zip(names, c.polynomial.degrees, strict=True)), named(NATURAL)),
        terms=derived(lambda c: len(c.polynomial.terms), POSITIVE),
    )  # fmt: skip
    whole[EliminationSystem] = record_of(
        EliminationSystem,
        axes=None,
        polynomials=derived(lambda system: system.texts(), listed(TEXT)),
    )
    left_out = dict.fromkeys(("title", "text", "count", "reference", "units", "model"))
    whole[Slice] = slice_over(names, **left_out, mechanism=derived(attrgetter("mechanism")))
    return record_of(SliceVariety, whole)
