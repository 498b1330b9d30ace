"""The drive: one design, whose stages are computed when they are first asked for, and once."""

from __future__ import annotations

from ncgear.drive.forces import ForceStages
from ncgear.drive.stage import stage


class Drive(ForceStages):
    """A design and all that follows from it.

    Stages are attributes; each needs only the ones it is made from, so a check of power never makes a tooth.  They
    raise WrongInput or NoSuchMechanism, with the design file's key, when the stage cannot be made.

    Of a design in two stages, law and motion are those of the whole machine; pitch curves, teeth, contact and solids
    are those of the pair that ``stage`` tells, 1 or 2, and only one of ``by_stage`` has them.
    """

    def __repr__(self) -> str:
        stage = "" if self.stage is None else f", stage {self.stage}"
        speed = self.design.operation.speed_rpm
        return f"Drive({self.design.name!r}, law {self.design.motion.law}, {speed:g} r/min{stage})"

    @stage
    def by_stage(self) -> tuple[Drive, ...]:
        """The same drive for each of its pairs of gears, from the driving shaft on; one pair has itself."""
        if self.design.stages == 1 or self.stage is not None:
            return (self,)
        return tuple(Drive(self.design, number, self.loaded) for number in range(1, self.design.stages + 1))
