"""The documentation site (`make docs`): Sphinx on the Markdown pages and docstrings of the whole repository.

The source folder is the repository itself, so that a link in a page leads to the same file on the site, in an editor
and on a code host. Nothing is loaded from the network when a page is viewed: fonts are the reader's, formulas MathML.
"""

from __future__ import annotations

import sys
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT), str(Path(__file__).parent / "extensions")]

project = "pfemcut"
release = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["version"]
language = "en"

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx.ext.viewcode",
    "mathml",
    "modules_of",
    "whole_site",
]
root_doc = "docs/index"
include_patterns = [
    "docs/*.md",
    "docs/api/*.md",
    "demos/*/README.md",
    "tests/verification/*/README.md",
    "CHANGELOG.md",
]
myst_enable_extensions = ["dollarmath", "amsmath"]
myst_heading_anchors = 4
math_numfig = False
math_eqref_format = "({number})"
html_math_renderer = "mathml"

autodoc_typehints = "signature"
autodoc_type_aliases = {name: name for name in ("Array", "IntArray", "BoolArray")}
add_module_names = False
autodoc_member_order = "bysource"
autodoc_default_options = {
    "members": True,
    "show-inheritance": True,
    "ignore-module-all": True,
    "no-value": True,
    "exclude-members": "model_config",
}
napoleon_google_docstring = False
napoleon_use_rtype = False
napoleon_attr_annotations = False
# Several modules have a class of the same name; a bare name in an annotation is not looked up further.
suppress_warnings = ["ref.python"]

html_theme = "furo"
html_static_path = ["static"]
html_css_files = ["site.css"]
html_title = f"pfemcut {release}"
html_show_sphinx = False
html_show_copyright = False
html_copy_source = False
