"""``ncgear new``: a design file to begin with, from options or from a person's answers at a terminal."""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Annotated

import typer

from ncgear.cli.progress import steps_shown
from ncgear.design.laws.registry import DEFAULT_LAW, LawName, design_law
from ncgear.design.machines import MachineName, machine_template
from ncgear.design.naming import NAME_RULE, is_name
from ncgear.design.reading.text import plain_value, whole
from ncgear.errors import DesignError, WrongInput

BUILDABLE = ("check", "designed_contact", "solids")
"""Steps of a drive that prove a design: they compute all other steps that could refuse a build."""


def new(
    name: Annotated[str | None, typer.Argument(metavar="NAME", help=f"Name of the design: {NAME_RULE}.")] = None,
    law: Annotated[
        LawName | None, typer.Option(help="The motion law to begin with.", show_default=DEFAULT_LAW.value)
    ] = None,
    machine: Annotated[
        MachineName | None, typer.Option(help="Begin with a whole machine: its sizes, loads, masses, gears and wishes.")
    ] = None,
    stroke_mm: Annotated[float | None, typer.Option(help="Stroke of the slider; twice the crank.")] = None,
    crank_mm: Annotated[float | None, typer.Option(help="Length of the crank.")] = None,
    rod_mm: Annotated[float | None, typer.Option(help="Length of the connecting rod.")] = None,
    speed_rpm: Annotated[float | None, typer.Option(help="Speed of the driving gear.")] = None,
    teeth: Annotated[int | None, typer.Option(help="Teeth of the driving gear.")] = None,
    module_mm: Annotated[float | None, typer.Option(help="Module.")] = None,
    face_width_mm: Annotated[float | None, typer.Option(help="Face width of the gears.")] = None,
    yes: Annotated[
        bool, typer.Option("--yes", "-y", help="Ask nothing; take the template for what is left out.")
    ] = False,
) -> None:
    """Write NAME.yaml, a commented design file to begin with, into the current folder.

    At a terminal it asks for what is left out. A file with sizes of its own is written only once its gears can be made.
    """
    sizes = {
        "stroke_mm": stroke_mm,
        "crank_mm": crank_mm,
        "rod_mm": rod_mm,
        "speed_rpm": speed_rpm,
        "teeth": teeth,
        "module_mm": module_mm,
        "face_width_mm": face_width_mm,
    }
    given = _sound({answer: value for answer, value in sizes.items() if value is not None})
    if machine is not None:
        if given or law is not None:
            raise WrongInput("a machine has its own law and sizes; change them in its file", key="--machine")
        _create(_free(name), machine_template(name or "", machine))
        return
    person_can_answer = sys.stdin.isatty() and sys.stderr.isatty()
    if person_can_answer and not yes:
        _ask_and_write(name, law, given)
    else:
        _write(_free(name), law or DEFAULT_LAW, given)


def _sound(given: dict[str, float]) -> dict[str, float]:
    """The given sizes; raises WrongInput for sizes that no design can have."""
    if not given:
        return {}
    from ncgear.design.beginning import fault_of, fault_together

    sizes = {answer: whole(value) for answer, value in given.items()}
    for answer, value in sizes.items():
        if problem := fault_of(answer, value):
            raise WrongInput(problem, key=f"--{answer.replace('_', '-')}")
    if problem := fault_together(sizes):
        raise WrongInput(problem)
    return sizes


def _ask_and_write(name: str | None, law: LawName | None, given: dict[str, float]) -> None:
    """Ask until gears can be made from the answers, and write the design."""
    path = _free(name or _asked_name())
    law, sizes = law or _asked_law(), given
    while True:
        sizes = _asked_sizes(law, given, sizes)
        try:
            return _write(path, law, sizes)
        except DesignError as error:
            typer.echo(f"{error}; other answers are needed", err=True)


def _free(name: str | None) -> Path:
    """The path of a new design file; raises WrongInput for a wrong name, and where there is a file already."""
    if name is None:
        raise WrongInput("missing; `ncgear new NAME` is right", key="NAME")
    if not is_name(name):
        raise WrongInput(f"{name!r} cannot name a design; {NAME_RULE}, without .yaml, is right", key="NAME")
    path = Path(f"{name}.yaml")
    if path.exists():
        raise _taken(path)
    return path


def _taken(path: Path) -> WrongInput:
    """The error about a path at which there is a file."""
    return WrongInput("exists already; choose another name, or remove it", location=str(path))


def _write(path: Path, law: LawName, sizes: dict[str, float]) -> None:
    """Write a design that can be built; raises WrongInput or NoSuchMechanism where it cannot."""
    _create(path, _buildable(path.stem, law, sizes))


def _create(path: Path, text: str) -> None:
    """Write a new file and say its name."""
    try:
        # Mode x: a file that is already there is refused even if it appears at this very moment.
        with path.open("x", encoding="utf-8") as file:
            file.write(text)
    except FileExistsError as error:
        raise _taken(path) from error
    typer.echo(path)


def _buildable(name: str, law: LawName, sizes: dict[str, float]) -> str:
    """The text of a design; if its sizes are not those of the template, its gears are made once as a proof."""
    if not sizes:
        from ncgear.design.template import template

        return template(name, law)
    from ncgear.design.beginning import begun
    from ncgear.design.reading.design_file import parsed
    from ncgear.project.drive import Drive

    text = begun(name, law, sizes)
    drive = Drive(parsed(text, Path(f"{name}.yaml")).design)
    with steps_shown(len(BUILDABLE)) as on_step:
        for step in BUILDABLE:
            on_step(step.replace("_", " "))
            getattr(drive, step)
    return text


# The questions.

QUESTIONS = {
    "stroke_mm": "stroke of the slider in mm",
    "crank_mm": "length of the crank in mm",
    "rod_mm": "length of the connecting rod in mm",
    "speed_rpm": "speed of the driving gear in r/min",
    "teeth": "teeth of the driving gear",
    "module_mm": "module in mm",
    "face_width_mm": "face width of the gears in mm",
}


def _asked_name() -> str:
    """A name that a design can have."""
    return _asked("name of the design", "mine", lambda name: None if is_name(name) else f"{NAME_RULE}, are right")


def _asked_law() -> LawName:
    """One of the laws, by its number or its name."""
    for number, law in enumerate(LawName, 1):
        typer.echo(f"  {number}  {law:<22}{design_law(law).choice}", err=True)
    laws = {str(number): law for number, law in enumerate(LawName, 1)} | {law.value: law for law in LawName}
    return laws[_asked("motion law", "1", lambda told: None if told in laws else "its number or its name is right")]


def _asked_sizes(law: LawName, given: Mapping[str, float], before: Mapping[str, float]) -> dict[str, float]:
    """All sizes; only those that are not ``given`` are asked for.

    The likely answer to a question is the one in ``before``, or else the one that follows from the answers so far.
    """
    from ncgear.design.beginning import proportioned

    lengths = "stroke_mm", "crank_mm"
    # Stroke and crank give each other, so that only one of them is asked for.
    first = [] if set(lengths) & set(given) else [design_law(law).asked_length]
    found = dict(given)
    for answer in [*first, *(one for one in QUESTIONS if one not in lengths and one not in given)]:
        found[answer] = _asked_number(answer, before.get(answer, proportioned(found)[answer]), found)
    return found


def _asked_number(answer: str, likely: float, found: Mapping[str, float]) -> float:
    from ncgear.design.beginning import fault_of, fault_together

    def fault(text: str) -> str | None:
        value = plain_value(text)
        return fault_of(answer, value) or fault_together({**found, answer: float(text)})

    return whole(float(_asked(QUESTIONS[answer], f"{likely}", fault)))


def _asked(question: str, likely: str, fault: Callable[[str], str | None]) -> str:
    """The first answer without a fault; after a fault its text is shown, and the question is asked again."""
    while True:
        try:
            answer = str(typer.prompt(question, default=likely, err=True)).strip()
        except typer.Abort as error:
            raise KeyboardInterrupt from error
        wrong = fault(answer)
        if wrong is None:
            return answer
        typer.echo(f"  {wrong}", err=True)
