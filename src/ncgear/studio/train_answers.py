"""The answers about the file of a train of gears: its picture, and what ``ncgear check`` tells of it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict
from typing import TYPE_CHECKING

from ncgear.drawings.page.data import paces
from ncgear.drawings.page.train_page import train_advices, train_facts
from ncgear.drawings.page.train_scene import train_scene
from ncgear.figures.trains import NOT_BUILT, train_answer
from ncgear.studio.messages import Answer

if TYPE_CHECKING:
    from ncgear.design.reading.design_file import LoadedTrain


def train_answers(loaded: LoadedTrain) -> Iterator[Answer]:
    """``scene``, ``motion``, ``figures`` and ``verdict`` of a train, as a machine has them."""
    file, train = loaded.file, loaded.file.train.train()
    yield "scene", train_scene(train)
    running = {"loop": train.cycle_rad, "swings": False, "paces": [asdict(one) for one in paces(abs(train.speed_rpm))]}
    yield "motion", {**running, "shafts": [], "charts": [], "handles": []}
    told = train_answer(file.name, file.description, train, (*train.told.conditions, *NOT_BUILT), "")
    yield "figures", {"facts": train_facts(told), "crank": "", "achieved": [], "tables": []}
    advices = train_advices(told)
    yield "verdict", {"advices": advices, "good": "" if advices else told.good, "not_judged": told.not_judged}
    yield "best", None
