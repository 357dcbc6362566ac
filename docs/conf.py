"""How Sphinx makes the pages; `make docs` runs it."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent / "extensions"))

from ptmcad import __version__

project = "ptmcad"
author = "the ptmcad authors"
copyright = author
version = release = __version__

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx_click",
    "docstrings",
    "generated_pages",
]
exclude_patterns = ["extensions"]

html_theme = "furo"
html_title = f"ptmcad {version}"
html_static_path = ["style"]
html_css_files = ["ptmcad.css"]
html_copy_source = False
html_show_sphinx = False

myst_enable_extensions = ["deflist"]
myst_heading_anchors = 3

smartquotes = False  # it would make one dash of the two before an option
default_role = "py:obj"
autodoc_member_order = "bysource"
autodoc_typehints = "signature"
napoleon_google_docstring = False
napoleon_use_param = False
napoleon_use_rtype = False
napoleon_use_ivar = True
napoleon_custom_sections = ["Guarantee", "Not guaranteed"]
