"""The commands check, build, report and animate for design files of trains of gears."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from ncgear.cli.arguments import EXPORT, pasted, prepared, tell, tell_written
from ncgear.cli.progress import counted, steps_shown
from ncgear.design.reading.text import has_train, read_text
from ncgear.errors import WrongInput, located
from ncgear.memory import keep_freed_memory

if TYPE_CHECKING:
    from collections.abc import Callable

    from ncgear.design.reading.design_file import LoadedTrain
    from ncgear.drawings.animation import AnimationFormat
    from ncgear.files.train import JudgedTrain


def is_train(design_file: Path) -> bool:
    """Whether a design file describes a train; false for an unreadable file, which is refused where it is read."""
    from ncgear.design.reading.design_file import LARGEST_MB

    try:
        return has_train(read_text(design_file, limit_mb=LARGEST_MB))
    except WrongInput:
        return False


def refuse_options(design_file: Path, options: Mapping[str, object]) -> None:
    """Refuse options that are not offered for trains; raises WrongInput with the first that is given."""
    for option, given in options.items():
        if given:
            raise WrongInput(
                "given, but not offered for a train of gears; leave it out", key=option, location=str(design_file)
            )


def check_train(design_file: Path, *, as_json: bool, verbose: bool) -> None:
    """Compute a train, and tell its figures and the judgement of its kind; nothing is written."""
    from ncgear.design.reading.design_file import load_train
    from ncgear.figures.trains import checked_conditions, train_answer, train_figures

    keep_freed_memory()
    loaded = load_train(design_file)
    file = loaded.file
    with located(loaded.source), steps_shown(1) as on_step:
        on_step("train")
        train = file.train.train()
        conditions = checked_conditions(train)
    figures = train_figures(file.name, file.description, train, conditions)
    answer = train_answer(file.name, file.description, train, conditions, f"ncgear build {pasted(design_file)}")
    tell(answer, figures, as_json=as_json, verbose=verbose)


def animated_train(
    design_file: Path, out: Path | None, kind: AnimationFormat, form: tuple[int, float, int]
) -> tuple[Path, bytes]:
    """The place and the bytes of a GIF or MP4 of a moving train; ``form`` has frames, seconds and width in pixels."""
    from ncgear.design.reading.design_file import load_train
    from ncgear.files.publish import prepare_file

    keep_freed_memory()
    loaded = load_train(design_file)
    path = out or EXPORT / loaded.file.name / "train.gif"
    prepare_file(path)

    from ncgear.drawings.animation.packing import Loop, packed
    from ncgear.drawings.train_pictures import train_frames

    with located(loaded.source):
        train = loaded.file.train.train()
    loop = Loop(*form)
    with counted("frames") as on_frame:
        return path, packed(train_frames(train, loaded.file.name, loop.width_px), kind, loop, on_frame)


def build_train(design_file: Path, out: Path | None, *, as_json: bool, verbose: bool) -> None:
    """Write all files of a train into a folder, and tell the written files and whether the train meshes."""
    from ncgear.files.train import STEPS, train_files

    with steps_shown(1 + len(STEPS)) as on_step:
        loaded, folder, judged = _judged(design_file, out, on_step)
        with located(loaded.source):
            files = train_files(loaded.file.name, judged, on_step)

    from ncgear.figures.trains import train_answer
    from ncgear.files.manifest import publish_run

    file, run = loaded.file, publish_run(folder, files, "build")
    answer = train_answer(file.name, file.description, judged.train, judged.conditions, f"open {folder / 'train.png'}")
    tell(answer, judged.figures, as_json=as_json, verbose=verbose, run=run)


def _judged(
    design_file: Path, out: Path | None, on_step: Callable[[str], None]
) -> tuple[LoadedTrain, Path, JudgedTrain]:
    """A train file, the folder for its files, and the train with the contact of its teeth."""
    from ncgear.design.reading.design_file import load_train

    keep_freed_memory()
    loaded = load_train(design_file)
    file, folder = loaded.file, prepared(out, loaded.file.name)

    from ncgear.files.train import judged_train

    with located(loaded.source):
        on_step("train")
        return loaded, folder, judged_train(file.name, file.description, file.train.train(), on_step)


def reports_as_train(design_file: Path) -> bool:
    """Whether a design file describes a train whose report shows it running: one that is no machine by itself."""
    from ncgear.design.reading.design_file import load_train

    train = load_train(design_file).file.train if is_train(design_file) else None
    return train is not None and not (train.TURNS_ALONE and train.machine())


def report_train(design_file: Path, out: Path | None, *, as_json: bool) -> None:
    """Write the page of a train as it runs, with the figures of a build."""
    from ncgear.files.train import JUDGING

    with steps_shown(1 + len(JUDGING)) as on_step:
        loaded, folder, judged = _judged(design_file, out, on_step)

    from ncgear.drawings.page import REPORT_FILE
    from ncgear.drawings.page.train_page import train_page
    from ncgear.figures.trains import train_answer
    from ncgear.files.manifest import publish_run

    answer = train_answer(loaded.file.name, loaded.file.description, judged.train, judged.conditions, "")
    page = train_page(judged.train, answer, judged.figures, design_file)
    run = publish_run(folder, {REPORT_FILE: page}, "report")
    said = f"{folder / REPORT_FILE} ({len(page) / 1e6:.1f} MB): open it in a browser"
    tell_written(said, run.kept, [judged.figures] if as_json else [])
