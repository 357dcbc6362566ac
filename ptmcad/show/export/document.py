"""A discriminant variety as a JSON document, described by docs/variety.schema.json.

Guarantee: every number is exact; the same slice gives the same text.
"""

from __future__ import annotations

import json

from ptmcad.answer.slicevariety import SliceVariety
from ptmcad.text.numerals import text_of

FORMAT = "ptmcad-variety/1"


def document(variety: SliceVariety) -> str:
    """The variety as JSON text, one component a line."""
    names = variety.slice.axis_names
    components = [
        {
            "kind": c.kind.value,
            "left_out": c.left_out,
            "degree": c.polynomial.total_degree,
            "degrees": dict(zip(names, c.polynomial.degrees, strict=True)),
            "terms": len(c.polynomial.terms),
            "polynomial": c.polynomial.text(names),
        }
        for c in variety.components
    ]
    entries = {
        "format": FORMAT,
        "slice": {
            "name": variety.slice.name,
            "mechanism": variety.slice.mechanism,
            "axes": {a.name: [text_of(a.low), text_of(a.high)] for a in variety.slice.axes},
            "parameters": {n: e.to_text(names) for n, e in variety.slice.parameters.items()},
        },
        "complex_solutions": variety.complex_solutions,
        "system": {"unknowns": variety.system.unknowns, "polynomials": variety.system.texts()},
        "versions": dict(variety.versions),
    }
    lines = [f"  {json.dumps(key)}: {json.dumps(value, ensure_ascii=False)}" for key, value in entries.items()]
    rows = ",\n".join("    " + json.dumps(row, ensure_ascii=False) for row in components)
    lines.insert(3, f'  "components": [\n{rows}\n  ]')
    return "{\n" + ",\n".join(lines) + "\n}\n"
