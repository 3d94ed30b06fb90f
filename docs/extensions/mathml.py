"""Formulas as MathML, which browsers show by themselves: neither scripts nor fonts are loaded."""

from __future__ import annotations

import html
import re
from typing import Any

from docutils import nodes
from docutils.utils.math import latex2mathml
from sphinx.application import Sphinx
from sphinx.util import logging

LOGGER = logging.getLogger(__name__)

# What TeX does and the translator does not: a sub- or superscript of an accented letter stands beside it, and an
# argument without braces is one digit.
_ACCENT = re.compile(r"\\(dot|bar|hat|tilde)\s*(\\[A-Za-z]+|[A-Za-z]|\{[^{}]*\})(?=[_^])")
_DIGITS = re.compile(r"\\([td]?frac)\s*([0-9])\s*([0-9])")


def setup(app: Sphinx) -> dict[str, Any]:
    """Register the renderer ``mathml``."""
    app.add_html_math_renderer("mathml", (visit_inline, None), (visit_block, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def visit_inline(writer: Any, node: nodes.math) -> None:
    """A formula in a line."""
    writer.body.append(mathml(node, as_block=False))
    raise nodes.SkipNode


def visit_block(writer: Any, node: nodes.math_block) -> None:
    """A formula of its own, with its number and a link to itself if it has a label."""
    writer.body.append(writer.starttag(node, "div", CLASS="math"))
    writer.body.append(mathml(node, as_block=True))
    if node["number"]:
        writer.body.append(f'<span class="eqno">({html.escape(str(node["number"]))})')
        writer.add_permalink_ref(node, "Link to this equation")
        writer.body.append("</span>")
    writer.body.append("</div>\n")
    raise nodes.SkipNode


def mathml(node: nodes.Element, as_block: bool) -> str:
    """The formula as MathML; one that can't be translated is a warning, which stops the build."""
    source = _ACCENT.sub(r"{\\\1{\2}}{}", node.astext())
    source = _DIGITS.sub(r"\\\1{\2}{\3}", source)
    if as_block and "\\\\" in source and "\\begin" not in source:
        source = f"\\begin{{aligned}}{source}\\end{{aligned}}"
    try:
        return str(latex2mathml.tex2mathml(source, as_block=as_block))
    except Exception as error:
        LOGGER.warning("formula can't be translated: %s (%s)", source, error, location=node)
        return f"<code>{html.escape(source)}</code>"
