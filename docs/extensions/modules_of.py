"""Directive ``modules-of``: the documentation of a package and of every module in it, found by itself."""

from __future__ import annotations

import importlib
import pkgutil
from typing import Any, ClassVar

from docutils import nodes
from docutils.parsers.rst import directives
from docutils.statemachine import StringList
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective


class ModulesOf(SphinxDirective):
    """``.. modules-of:: package``: what the package says of itself, and a section for each module below it.

    With ``:top:`` only the modules that are in no sub-package.
    """

    required_arguments = 1
    has_content = False
    option_spec: ClassVar[dict[str, Any]] = {"top": directives.flag}

    def run(self) -> list[nodes.Node]:
        """A section a module."""
        package = self.arguments[0]
        head = nodes.container()
        self._parse(package, head)
        sections: list[nodes.Node] = [head]
        for name in module_names(package, top="top" in self.options):
            section = nodes.section(ids=[nodes.make_id(name)], names=[name])
            section += nodes.title(text=name)
            self._parse(name, section)
            sections.append(section)
        return sections

    def _parse(self, name: str, into: nodes.Element) -> None:
        lines = StringList([f".. automodule:: {name}"], source=self.get_source_info()[0])
        self.state.nested_parse(lines, self.content_offset, into)


def module_names(package: str, top: bool) -> list[str]:
    """Names of all modules below the package, in order; with ``top`` only of those in no sub-package."""
    path = importlib.import_module(package).__path__
    below = (
        (entry for entry in pkgutil.iter_modules(path, f"{package}.") if not entry.ispkg)
        if top
        else pkgutil.walk_packages(path, f"{package}.")
    )
    return sorted(entry.name for entry in below if not entry.name.endswith("__main__"))


def without_substitutions(
    app: Sphinx, what: str, name: str, thing: Any, options: Any, lines: list[str]
) -> None:
    """Bars in docstrings are magnitudes, not substitutions; in backquotes they are left alone."""
    for number, line in enumerate(lines):
        parts = line.split("`")
        parts[::2] = [part.replace("|", "\\|") for part in parts[::2]]
        lines[number] = "`".join(parts)


def setup(app: Sphinx) -> dict[str, Any]:
    """Register the directive."""
    app.add_directive("modules-of", ModulesOf)
    app.connect("autodoc-process-docstring", without_substitutions, priority=900)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
