"""``ncgear new``: a design file to begin with, from options or from answers at a terminal."""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping, Sequence
from enum import StrEnum
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, TypeVar

import typer

from ncgear.cli.progress import steps_shown
from ncgear.design.laws.registry import DEFAULT_LAW, LawName, law_keys
from ncgear.design.reading.text import plain_value, whole
from ncgear.design.template import CHOICES, MachineName, machine_template
from ncgear.design.words import NAME_RULE, is_name
from ncgear.errors import DesignError, WrongInput

if TYPE_CHECKING:
    from ncgear.design.beginning import Beginning

BUILDABLE = ("motion_wishes", "check", "designed_contact", "solids")
"""Steps of a drive that prove a design: they compute all other steps that could fail in a build."""

WISHABLE = ("motion_wishes",)
"""Steps that prove the wishes of a design with the usual sizes."""


def examples_to_complete(incomplete: str) -> list[str]:
    """Examples whose name begins with the typed text."""
    from ncgear.design.template import examples

    return [name for name in examples() if name.startswith(incomplete)]


def new(
    name: Annotated[str | None, typer.Argument(metavar="NAME", help=f"Name of the design: {NAME_RULE}.")] = None,
    law: Annotated[
        LawName | None, typer.Option(help="The motion law to begin with.", show_default=DEFAULT_LAW.value)
    ] = None,
    machine: Annotated[
        MachineName | None, typer.Option(help="Begin with a whole machine: its sizes, loads, masses, gears and wishes.")
    ] = None,
    example: Annotated[
        str | None,
        typer.Option(
            metavar="EXAMPLE",
            help="Begin with a worked design as it is, and the files that it names; `ncgear examples` lists them.",
            autocompletion=examples_to_complete,
        ),
    ] = None,
    shape: Annotated[
        str | None,
        typer.Option(
            metavar="heart|square|star|FILE",
            help="Begin with a pair of gears to print, of a shape or a drawing: SVG, DXF, PNG, JPEG, CSV of points.",
        ),
    ] = None,
    design: Annotated[
        bool, typer.Option("--design", help="Begin a machine for ncgear design, which finds law, gears and flywheel.")
    ] = False,
    wish: Annotated[
        list[str] | None,
        typer.Option(metavar="KEY: VALUE", help="A wish of the motion, as under `wishes` in the file; again for more."),
    ] = None,
    stroke_mm: Annotated[float | None, typer.Option(help="Stroke of the slider; twice the crank.")] = None,
    crank_mm: Annotated[float | None, typer.Option(help="Length of the crank.")] = None,
    rod_mm: Annotated[float | None, typer.Option(help="Length of the connecting rod.")] = None,
    speed_rpm: Annotated[float | None, typer.Option(help="Speed of the driving gear.")] = None,
    teeth: Annotated[int | None, typer.Option(help="Teeth of the driving gear.")] = None,
    module_mm: Annotated[float | None, typer.Option(help="Module.")] = None,
    face_width_mm: Annotated[float | None, typer.Option(help="Face width of the gears.")] = None,
    application_factor: Annotated[
        float | None, typer.Option(help="Shocks beyond the load: 1 none, 1.25 light, 1.5 moderate, 1.75 heavy.")
    ] = None,
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
        "application_factor": application_factor,
    }
    asked = {"design": design or None, "wish": wish}
    if example is not None:
        _require_alone("example", example, {**asked, "law": law, "machine": machine, "shape": shape, **sizes})
        _write_example(example, name)
        return
    if shape is not None:
        _require_alone("shape", shape, {**asked, "law": law, "machine": machine, **sizes})
        _write_shape(shape, _free(name))
        return
    if design:
        _write_asked(name, machine, law, sizes, wish or [], yes=yes)
        return
    if machine is not None and law is not None:
        raise WrongInput("a machine begins with its own law; give --machine or --law", key="--machine")
    beginning, wishes = machine or law, wish or []
    _require_wishes(wishes)
    given = _sound({answer: value for answer, value in sizes.items() if value is not None})
    if _person_can_answer() and not yes:
        _ask_and_write(name, beginning, given, wishes)
    else:
        _write(_free(name), beginning or DEFAULT_LAW, given, wishes)


def _person_can_answer() -> bool:
    return sys.stdin.isatty() and sys.stderr.isatty()


def _write_asked(
    name: str | None,
    machine: MachineName | None,
    law: LawName | None,
    sizes: Mapping[str, float | None],
    wishes: Sequence[str],
    *,
    yes: bool,
) -> None:
    """Write a file for the search of a whole machine, from ten answers; with ``yes`` the likely ones of its kind."""
    from ncgear.design.beginning import QUESTIONS as OF_MACHINE
    from ncgear.design.beginning import asked_text, begun, fault_of_answer, likely_answers, wishes_told
    from ncgear.design.reading.design_file import parsed
    from ncgear.project.drive import Drive

    sought = {"law": law, **{key: value for key, value in sizes.items() if key not in ASKED_OF_MACHINES}}
    for option, value in sought.items():
        if value is not None:
            problem = "given with --design, which finds it; leave it out"
            raise WrongInput(problem, key=f"--{option.replace('_', '-')}")
    _require_wishes(wishes)
    given = _sound({answer: value for answer, value in sizes.items() if value is not None})
    ask = _person_can_answer() and not yes
    path = _free((name or _asked_name()) if ask else name)
    kind = machine or (_asked_machine() if ask else MachineName.PUSHER)
    # The question of the force asks for the shocks, too
    own = _asked_sizes(kind, given, given, SIZES_OF_MACHINES) if ask else given
    told = wishes_told(wishes or (_asked_wishes() if ask else []))
    text = begun(path.stem, kind, own)
    answers = likely_answers(text)
    if ask:
        for asked_name, question in OF_MACHINE.items():
            answers[asked_name] = _asked(question, answers[asked_name], partial(fault_of_answer, asked_name, text))
    made = asked_text(path.stem, kind, own, answers, told)
    # The wishes are checked against the mechanism once
    Drive(parsed(made, path).design).motion_wishes  # noqa: B018
    _create(path, made)


def _require_alone(alone: str, chosen: str, given: Mapping[str, object]) -> None:
    """Raise WrongInput for anything given beside ``alone``: an example or the pair of a shape is complete."""
    for option, value in given.items():
        if value is not None and value != []:
            problem = f"given with --{alone} {chosen}, which has its own; leave it out, and change it in the file"
            raise WrongInput(problem, key=f"--{option.replace('_', '-')}")


def _write_example(example: str, name: str | None) -> None:
    """Write the files of an example; raises WrongInput, before writing, where one would replace another file."""
    from ncgear.design.template import example_files

    if name is not None:
        _require_name(name)
    files = {Path(place): content for place, content in example_files(example, name).items()}
    first = next(iter(files))
    for path, content in files.items():
        # A file of points from another example may be there already
        if path.exists() and (path == first or path.read_bytes() != content):
            raise _taken(path)
    for path, content in files.items():
        if not path.exists():
            _create(path, content.decode())


def _write_shape(shape: str, path: Path) -> None:
    """Write the design of a pair of gears with a shape; name a remedy where its teeth cannot be made as drawn."""
    from ncgear.design.template import SHAPES, shape_template

    text = shape_template(path.stem, shape)
    if shape not in SHAPES:
        from ncgear.design.drawn import as_read

        text = as_read(text, path)
    _create(path, text)
    if shape in SHAPES:
        return
    from ncgear.cli.arguments import pasted
    from ncgear.project.mending import refusal_of_teeth
    from ncgear.project.opened import loads

    try:
        refusal = refusal_of_teeth(loads(text, str(path)))
    except DesignError as error:
        refusal = error
    if refusal is not None:
        typer.echo(f"As it is drawn, no teeth can be made: {refusal.problem}.", err=True)
        if not isinstance(refusal, WrongInput):
            typer.echo(f"The nearest pair that can be made: ncgear fit {pasted(path)}", err=True)


def _require_name(name: str) -> None:
    if not is_name(name):
        raise WrongInput(f"{name!r} cannot name a design; {NAME_RULE}, without .yaml, is right", key="NAME")


def _require_wishes(wishes: Sequence[str]) -> None:
    if wishes:
        from ncgear.design.beginning import wishes_told

        wishes_told(wishes)


def _sound(given: dict[str, float]) -> dict[str, float]:
    """The given sizes; raises WrongInput for sizes that are not possible in a design."""
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


def _ask_and_write(
    name: str | None, beginning: Beginning | None, given: dict[str, float], wishes: Sequence[str]
) -> None:
    """Ask until gears can be made from the answers, and write the design."""
    path = _free(name or _asked_name())
    beginning, sizes = beginning or _asked_beginning(), given
    while True:
        sizes = _asked_sizes(beginning, given, sizes, ASKED_OF_MACHINES)
        told = wishes or _asked_wishes()
        try:
            return _write(path, beginning, sizes, told)
        except DesignError as error:
            typer.echo(f"{error}; other answers are needed", err=True)


def _free(name: str | None) -> Path:
    """The path of a new design file; raises WrongInput for a wrong name, and where the file already exists."""
    if name is None:
        raise WrongInput("missing; `ncgear new NAME` is right", key="NAME")
    _require_name(name)
    path = Path(f"{name}.yaml")
    if path.exists():
        raise _taken(path)
    return path


def _taken(path: Path) -> WrongInput:
    return WrongInput("exists already; choose another name, or remove it", location=str(path))


def _write(path: Path, beginning: Beginning, sizes: dict[str, float], wishes: Sequence[str]) -> None:
    """Write a design that can be built; raises WrongInput or NoSuchMechanism where it cannot."""
    _create(path, _buildable(path.stem, beginning, sizes, wishes))


def _create(path: Path, text: str) -> None:
    """Write a new file and print its name."""
    from ncgear.files.one_file import put_at_free_place

    try:
        # A file that already exists is refused even if it appears at this very moment.
        put_at_free_place(path, text.encode())
    except FileExistsError as error:
        raise _taken(path) from error
    typer.echo(path)


def _buildable(name: str, beginning: Beginning, sizes: dict[str, float], wishes: Sequence[str]) -> str:
    """The text of a design; with given sizes its gears are made once as a proof, with wishes only these are read."""
    if not sizes and not wishes:
        from ncgear.design.template import template

        return template(name, beginning) if isinstance(beginning, LawName) else machine_template(name, beginning)
    from ncgear.design.beginning import begun, wishes_told

    text = begun(name, beginning, sizes, wishes_told(wishes))
    from ncgear.design.reading.design_file import parsed
    from ncgear.project.drive import Drive

    drive = Drive(parsed(text, Path(f"{name}.yaml")).design)
    steps = BUILDABLE if sizes else WISHABLE
    with steps_shown(len(steps)) as on_step:
        for step in steps:
            on_step(step.replace("_", " "))
            getattr(drive, step)
    return text


# Questions at a terminal.

NO_MORE = "none"

SIZES_OF_MACHINES = ("stroke_mm", "speed_rpm")
"""Sizes of a machine for which a person is asked."""

ASKED_OF_MACHINES = (*SIZES_OF_MACHINES, "application_factor")

QUESTIONS = {
    "stroke_mm": "stroke of the slider in mm",
    "crank_mm": "length of the crank in mm",
    "rod_mm": "length of the connecting rod in mm",
    "speed_rpm": "speed of the driving gear in r/min",
    "teeth": "teeth of the driving gear",
    "module_mm": "module in mm",
    "face_width_mm": "face width of the gears in mm",
    "application_factor": "factor of shocks beyond the load: 1 none, 1.25 light, 1.5 moderate, 1.75 heavy",
}


def _asked_name() -> str:
    return _asked("name of the design", "mine", lambda name: None if is_name(name) else f"{NAME_RULE}, are right")


def _asked_beginning() -> Beginning:
    choices: dict[Beginning, str] = {law: law_keys(law).CHOICE for law in LawName} | CHOICES
    return _asked_of("motion law or machine", choices)


def _asked_machine() -> MachineName:
    return _asked_of("kind of machine", CHOICES)


One = TypeVar("One", bound=StrEnum)


def _asked_of(question: str, choices: Mapping[One, str]) -> One:
    for number, (name, choice) in enumerate(choices.items(), 1):
        typer.echo(f"  {number:>2}  {name:<22}{choice}", err=True)
    told = {str(number): name for number, name in enumerate(choices, 1)} | {choice.value: choice for choice in choices}
    fault = "its number or its name is right"
    return told[_asked(question, "1", lambda answer: None if answer in told else fault)]


def _asked_sizes(
    beginning: Beginning, given: Mapping[str, float], before: Mapping[str, float], of_machine: Sequence[str]
) -> dict[str, float]:
    """All sizes of a law's design, ``of_machine`` of a machine; a person is asked for what is not ``given``.

    The likely answer to a question is the answer in ``before``, or else follows from the answers so far.
    """
    from ncgear.design.beginning import proportioned

    lengths = "stroke_mm", "crank_mm"
    if isinstance(beginning, MachineName):
        asked = list(of_machine)
    else:
        sizes = (question for question in QUESTIONS if question not in (*lengths, "application_factor"))
        asked = [law_keys(beginning).ASKED_LENGTH, *sizes]
    # Stroke and crank determine each other, so only one of them is asked for.
    known = {*given, *(lengths if set(lengths) & set(given) else ())}
    found = dict(given)
    for answer in (question for question in asked if question not in known):
        likely = before.get(answer, proportioned(found, beginning)[answer])
        found[answer] = _asked_number(answer, likely, found, beginning)
    return found


def _asked_number(answer: str, likely: float, found: Mapping[str, float], beginning: Beginning) -> float:
    from ncgear.design.beginning import fault_of, fault_together

    def fault(text: str) -> str | None:
        value = plain_value(text)
        return fault_of(answer, value) or fault_together({**found, answer: float(text)}, beginning)

    return whole(float(_asked(QUESTIONS[answer], f"{likely}", fault)))


def _asked_wishes() -> list[str]:
    """Wishes of the motion, one after the other, until there are no more."""
    from ncgear.design.beginning import EXAMPLE, wishes_told

    found: list[str] = []

    def fault(text: str) -> str | None:
        try:
            wishes_told([*found, text])
        except WrongInput as error:
            return str(error)
        return None

    question = f"a wish of the motion, as {EXAMPLE}, or {NO_MORE}"
    while (answer := _asked(question, NO_MORE, lambda text: None if text == NO_MORE else fault(text))) != NO_MORE:
        found.append(answer)
    return found


def _asked(question: str, likely: str, fault: Callable[[str], str | None]) -> str:
    """The first answer without a fault; after a fault its text is shown, and the question is repeated."""
    while True:
        try:
            answer = str(typer.prompt(question, default=likely, err=True)).strip()
        except typer.Abort as error:
            raise KeyboardInterrupt from error
        wrong = fault(answer)
        if wrong is None:
            return answer
        typer.echo(f"  {wrong}", err=True)
