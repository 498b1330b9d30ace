"""What a return must join, and how it is refused."""

from __future__ import annotations

from dataclasses import dataclass, replace

from ncgear.errors import NoSuchMechanism
from ncgear.numerics.angles import in_words


@dataclass(frozen=True)
class ReturnEnds:
    """What the return must join: driving angles, the driven angle to cover, ratio and its slope at both ends."""

    start_rad: float
    end_rad: float
    start_driven_rad: float
    end_driven_rad: float
    start_ratio: float
    start_ratio_slope: float
    end_ratio: float
    end_ratio_slope: float

    @property
    def length_rad(self) -> float:
        """Driving angle of the return."""
        return self.end_rad - self.start_rad

    @property
    def driven_length_rad(self) -> float:
        """Driven angle of the return."""
        return self.end_driven_rad - self.start_driven_rad

    def inverted(self) -> ReturnEnds:
        """The same ends for 1/i12 in place of i12."""
        return replace(
            self,
            start_ratio=1.0 / self.start_ratio,
            start_ratio_slope=-self.start_ratio_slope / self.start_ratio**2,
            end_ratio=1.0 / self.end_ratio,
            end_ratio_slope=-self.end_ratio_slope / self.end_ratio**2,
        )


def not_positive(at_rad: float, ends: ReturnEnds) -> NoSuchMechanism:
    """The refusal of a ratio that is zero, negative or infinite at a driving angle in rad."""
    return NoSuchMechanism(
        f"the return's ratio passes through zero or infinity, or comes too near to it, at phi1 = "
        f"{in_words(at_rad)}; {remedy(ends)}",
        key="motion.return",
    )


def remedy(ends: ReturnEnds) -> str:
    """What brings the ratio at theta4, which goes with 1/sqrt(-a1), nearer to the mean that the return must have."""
    mean = ends.length_rad / ends.driven_length_rad
    towards = "farther from" if ends.start_ratio > mean else "nearer to"
    return (
        f"the ratio is {ends.start_ratio:.4g} where it begins and must be {mean:.4g} in the mean: an a1 {towards} zero "
        "brings the two together, another theta4, e or basis of the return may help"
    )
