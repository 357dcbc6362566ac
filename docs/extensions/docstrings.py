"""The house style of docstrings, made into what the napoleon extension reads.

In the code a parameter's line is ``name : what it means``, because its type stands in the
signature. Napoleon takes what follows the colon for the type, so here it goes to a line of its own.
"""

from __future__ import annotations

import re

from docutils import nodes
from sphinx.application import Sphinx

_ENTRY = re.compile(r"^(\w+(?:, \w+)*) : (.*)$", re.MULTILINE)
BEFORE_NAPOLEON = 400


def rewrite(
    _app: Sphinx, _what: str, _name: str, _object: object, _options: object, lines: list[str]
) -> None:
    """Rewrite the lines in place; only parameters and attributes have such lines."""
    lines[:] = _ENTRY.sub(r"\1\n    \2", "\n".join(lines)).split("\n")


def use_dashes(_app: Sphinx, doctree: nodes.document) -> None:
    """Between a name and its meaning Sphinx puts two hyphens and trusts the typographer, who would
    spoil options.
    """
    for text in list(doctree.findall(nodes.Text)):
        if str(text) == " -- ":
            text.parent.replace(text, nodes.Text(" \u2013 "))


def setup(app: Sphinx) -> dict[str, bool]:
    """What Sphinx calls."""
    app.connect("autodoc-process-docstring", rewrite, priority=BEFORE_NAPOLEON)
    app.connect("doctree-read", use_dashes)
    return {"parallel_read_safe": True}
