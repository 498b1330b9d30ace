"""Loaded where studios that only save are forked, so that the models of keys are built once for all of them."""

from drives import DESIGNS
from ncgear.design.reading.yaml import read_yaml
from ncgear.studio.form import form

form(read_yaml((DESIGNS / "ellipse.yaml").read_text(encoding="utf-8"), "ellipse.yaml").data)
