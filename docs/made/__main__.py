"""Write what is made of the documentation: ``PYTHONPATH=docs python -m made``, with names of pictures only those."""

from __future__ import annotations

from made.command_heads import FOLDER, NAMES, with_head


def write_heads() -> None:
    """Put today's head on every command's page."""
    for name in NAMES:
        page = FOLDER / f"{name}.md"
        page.write_text(with_head(page.read_text() if page.exists() else "", name), encoding="utf-8")


write_heads()
