"""Write what is made of the documentation: ``PYTHONPATH=docs python -m made``; with ``pictures`` these as well."""

from __future__ import annotations

import json
import sys
from dataclasses import asdict

from made.command_heads import FOLDER, NAMES, with_head
from made.conditions_page import NAME as CONDITIONS
from made.conditions_page import conditions_page
from made.figures_page import NAME as FIGURES
from made.figures_page import figures_page
from made.gallery import NAME as GALLERY
from made.gallery import gallery_page
from made.key_pages import key_pages
from made.kinds_page import NAME as KINDS
from made.kinds_page import kinds_page
from made.material_page import NAME as MATERIALS
from made.material_page import material_page
from ncgear.cli.arguments import FileKind, model_of
from ncgear.design.reference import told_keys_of
from ncgear.design.told_keys import FILE as TOLD_KEYS

DOCS = FOLDER.parent


def write_pages() -> None:
    """Put today's head on every command's page, and write the pages of keys and of materials, and the keys in words."""
    for name in NAMES:
        page = FOLDER / f"{name}.md"
        page.write_text(with_head(page.read_text(encoding="utf-8") if page.exists() else "", name), encoding="utf-8")
    for file, text in key_pages().items():
        (DOCS / file).write_text(text, encoding="utf-8")
    (DOCS / MATERIALS).write_text(material_page(), encoding="utf-8")
    (DOCS / CONDITIONS).write_text(conditions_page(), encoding="utf-8")
    (DOCS / FIGURES).write_text(figures_page(), encoding="utf-8")
    (DOCS / GALLERY).write_text(gallery_page(), encoding="utf-8")
    (DOCS / KINDS).write_text(kinds_page(), encoding="utf-8")
    TOLD_KEYS.write_text(told_keys_text(), encoding="utf-8")


def told_keys_text() -> str:
    """The keys of both kinds of files in words, a line for each."""
    told = {
        kind: [
            json.dumps({name: one for name, one in asdict(key).items() if name != "kinds" or one})
            for key in told_keys_of(model_of(kind))
        ]
        for kind in FileKind
    }
    kinds = [f'"{kind}": [\n' + ",\n".join(rows) + "\n]" for kind, rows in told.items()]
    return "{\n" + ",\n".join(kinds) + "\n}\n"


if __name__ == "__main__":
    write_pages()
    if sys.argv[1:] == ["pictures"]:
        from made.figures import make_pictures

        make_pictures()
