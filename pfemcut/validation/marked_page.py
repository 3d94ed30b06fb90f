"""Pages of which a part between two marks is written from recorded results."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Marks:
    """The marks around the part called ``name``, comments that a reader of the page does not see."""

    name: str

    @property
    def begin(self) -> str:
        """The first one."""
        return f"<!-- {self.name}:begin -->"

    @property
    def end(self) -> str:
        """The last one."""
        return f"<!-- {self.name}:end -->"

    def filled(self, text: str, content: str) -> str:
        """``text`` with ``content`` between the marks, which it has once each."""
        before, rest = text.split(self.begin)
        after = rest.split(self.end)[1]
        return f"{before}{self.begin}\n{content}\n{self.end}{after}"
