"""What concerns the site as a whole: links to folders, the page at its top, nothing loaded from elsewhere."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from sphinx.application import Sphinx
from sphinx.errors import ExtensionError

FRONT = """\
<!doctype html>
<meta charset="utf-8">
<title>pfemcut</title>
<meta http-equiv="refresh" content="0; url=docs/index.html">
<a href="docs/index.html">pfemcut</a>
"""
_LINK = re.compile(r"\[([^\]]*)\]\(([^)#:\s]+)\)")
_LOADED = re.compile(
    r"<(?:script|link|img|source|iframe|object)\b[^>]*(?:src|href|data)=\"(?:https?:)?//[^>]*>"
)
_IMPORTED = re.compile(r"(?:@import\s|url\()\s*[\"']?(?:https?:)?//[^;)]*")


def setup(app: Sphinx) -> dict[str, Any]:
    """Register what is done when a page is read, and at the end."""
    app.connect("source-read", without_folders)
    app.connect("build-finished", finish)
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def without_folders(app: Sphinx, name: str, source: list[str]) -> None:
    """Leave the text of links to folders, which a site has no page for."""
    folder = Path(app.env.doc2path(name)).parent

    def kept(link: re.Match[str]) -> str:
        return link[1] if (folder / link[2]).is_dir() else link[0]

    source[0] = _LINK.sub(kept, source[0])


def finish(app: Sphinx, error: Exception | None) -> None:
    """Write ``index.html``, which leads to the front page, and look for what a browser would load from elsewhere.

    Raises
    ------
    ExtensionError
        If a page or a style sheet loads something from the network.
    """
    if error is not None or app.builder.name != "html":
        return
    site = Path(app.outdir)
    (site / "index.html").write_text(FRONT, encoding="utf-8")
    found = loaded_from_elsewhere(site)
    if found:
        raise ExtensionError("loaded from the network:\n" + "\n".join(found))


def loaded_from_elsewhere(site: Path) -> list[str]:
    """Each tag and import of the site's pages and style sheets that a browser would fetch from another host."""
    return [
        f"{path.relative_to(site)}: {match[0]}"
        for pattern, suffix in ((_LOADED, "html"), (_IMPORTED, "css"))
        for path in sorted(site.rglob(f"*.{suffix}"))
        for match in pattern.finditer(path.read_text(encoding="utf-8"))
    ]
