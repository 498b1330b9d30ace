"""The README as an index of packages shows it, made when a package is built: there no path leads anywhere.

With an address at ``Source`` in pyproject.toml's ``project.urls``, paths become addresses of that version below it;
without one, links become their words and pictures are left out.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from hatchling.metadata.plugin.interface import MetadataHookInterface

LINK = re.compile(r"(!?)\[([^\]]*)\]\((?!\w+:|#)([^)\s]+)\)")


def for_index(text: str, source: str | None, version: str) -> str:
    """A page whose links and pictures are addresses, or none."""

    def shown(link: re.Match[str]) -> str:
        picture, words, path = link.groups()
        if source is None:
            return "" if picture else words
        return f"{picture}[{words}]({source.rstrip('/')}/{'raw' if picture else 'blob'}/v{version}/{path})"

    return LINK.sub(shown, text)


class LongDescription(MetadataHookInterface):
    """What hatchling calls when it has read the metadata."""

    def update(self, metadata: dict[str, Any]) -> None:
        """Add the README."""
        text = (Path(self.root) / "README.md").read_text(encoding="utf-8")
        text = for_index(text, metadata.get("urls", {}).get("Source"), metadata["version"])
        metadata["readme"] = {"content-type": "text/markdown", "text": text}
