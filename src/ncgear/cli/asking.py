"""The questions that a new design begins with, for a person at a terminal."""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping

import typer

from ncgear.design.naming import NAME_RULE, is_name
from ncgear.design.scalars import plain_value
from ncgear.design.template import Law

QUESTIONS = {
    "stroke_mm": "stroke of the slider in mm",
    "crank_mm": "length of the crank in mm",
    "rod_mm": "length of the connecting rod in mm",
    "speed_rpm": "speed of the driving gear in r/min",
    "teeth": "teeth of the driving gear",
    "module_mm": "module in mm",
    "face_width_mm": "face width of the gears in mm",
}

LAWS = {
    Law.THREE_SEGMENT_STROKE: "the slider works in three segments: it goes, presses at constant speed, slows down",
    Law.RATIO_EXPRESSION: "the ratio of the gears as a formula of the driving angle",
    Law.HARMONIC_RATIO: "the ratio by harmonics of the driven angle",
    Law.ELLIPSE: "elliptical gears",
    Law.TABLE: "the ratio or the displacement point by point",
    Law.UNIFORM_CRANK: "circular gears",
}


def can_ask() -> bool:
    """Whether a person sees what is asked and can answer."""
    return sys.stdin.isatty() and sys.stderr.isatty()


def asked_name() -> str:
    """A name that a design can have."""
    return _asked("name of the design", "mine", lambda name: None if is_name(name) else f"{NAME_RULE}, are right")


def asked_law() -> Law:
    """One of the laws, by its number or its name."""
    for number, (law, words) in enumerate(LAWS.items(), 1):
        typer.echo(f"  {number}  {law:<22}{words}", err=True)
    laws = {str(number): law for number, law in enumerate(LAWS, 1)} | {law.value: law for law in LAWS}
    return laws[_asked("motion law", "1", lambda told: None if told in laws else "its number or its name is right")]


def asked_sizes(law: Law, given: Mapping[str, float], before: Mapping[str, float]) -> dict[str, float]:
    """All sizes, those ``given`` unasked; likely are the answers of ``before``, or what follows from those so far."""
    from ncgear.design.beginning import proportioned

    found = dict(given)
    for answer in _needed(law, given):
        found[answer] = _asked_number(answer, before.get(answer, proportioned(found)[answer]), found)
    return found


def _needed(law: Law, given: Mapping[str, float]) -> list[str]:
    """A law of the slider's motion has a stroke, the others a crank; one of them gives the other."""
    length = "stroke_mm" if law is Law.THREE_SEGMENT_STROKE else "crank_mm"
    first = [] if {"stroke_mm", "crank_mm"} & set(given) else [length]
    return [*first, *(one for one in QUESTIONS if one not in ("stroke_mm", "crank_mm") and one not in given)]


def _asked_number(answer: str, likely: float, found: Mapping[str, float]) -> float:
    from ncgear.design.beginning import fault_of, fault_together, whole

    def fault(text: str) -> str | None:
        value = plain_value(text)
        return fault_of(answer, value) or fault_together({**found, answer: float(text)})

    return whole(float(_asked(QUESTIONS[answer], f"{likely}", fault)))


def _asked(question: str, likely: str, fault: Callable[[str], str | None]) -> str:
    """The first answer without a fault; faults are told, and the question is asked again."""
    while True:
        try:
            answer = str(typer.prompt(question, default=likely, err=True)).strip()
        except typer.Abort as error:
            raise KeyboardInterrupt from error
        wrong = fault(answer)
        if wrong is None:
            return answer
        typer.echo(f"  {wrong}", err=True)
