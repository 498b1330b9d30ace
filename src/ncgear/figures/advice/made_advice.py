"""The advice about gears that a build refuses, as far as their curves and the bodies that were made show it."""

from __future__ import annotations

from ncgear.errors import DesignError
from ncgear.figures.advice.values import ONLY_TEETH, Advice, Kind, NotJudged, Remedy, Where
from ncgear.project.drive import Drive
from ncgear.project.tooth_form import require_pushing_flanks


def made(drive: Drive) -> Advice | NotJudged:
    """The refusal of the pitch curves, or of gears that were made for their inertia; else only teeth can tell."""
    try:
        require_pushing_flanks(drive.pitch, drive.gears.rack)
        # Chords out of proportion to the teeth, or to the band of their thickness, are refused
        _ = drive.chord_tolerance_mm
    except DesignError as refusal:
        # A build would try no other teeth, and has no more to say
        return _refused(refusal, _nearest(drive))
    if drive.design.masses is not None and not drive.design.motion.is_open:
        # The masses of the machine ask for bodies where they leave out the inertia of the gears
        _ = drive.masses
    refused = drive.gear_refusal
    return NotJudged(ONLY_TEETH) if refused is None else _refused(refused, (*_nearest(drive), BUILD))


def bodies(drive: Drive) -> Advice | None:
    """The refusal of the bodies of gears whose teeth are made."""
    try:
        _ = drive.finished_plans
    except DesignError as refusal:
        return _refused(refusal, (), "what is told here is of their teeth alone")
    return None


BUILD = Remedy("let ncgear build say what would help", short="ncgear build")


FIT = Remedy("let ncgear fit find the nearest pitch curve whose gears can be made", short="ncgear fit")


def _nearest(drive: Drive) -> tuple[Remedy, ...]:
    """The command that follows a drawn outline, where there is one."""
    return (FIT,) if drive.design.motion.gives_outline else ()


WITHOUT_THEM = "what is told here is the motion without them"


def _refused(refusal: DesignError, remedies: tuple[Remedy, ...], meaning: str = WITHOUT_THEM) -> Advice:
    problem = refusal.problem
    return Advice(
        Kind.MADE,
        (Where(),),
        f"a build refuses these gears: {problem}",
        meaning,
        remedies,
        brief=f"a build refuses these gears: {problem}",
    )
