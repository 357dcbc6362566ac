"""A region map as a JSON document, and back: the stored result with its certificate.

Guarantee: reading what was written gives an equal map. A document that is not one is refused with the place of the
first fault: every key must be known and present, every value of its type and within limits, and no key may occur twice.
Whether what it claims is true is not asked here; `ptmcad.verify` does that.

The schema is published as docs/region-map.schema.json; its version is part of `writing.FORMAT`.
"""
