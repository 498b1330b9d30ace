"""The law ``ratio_expression``: the gear ratio, or the driven angle, as a formula of the driving angle."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from math import radians
from typing import TYPE_CHECKING, Any

from ncgear.design.keys.base import FORMULA, SMOOTH_LAW, Expression, Faults, fault, optional
from ncgear.design.laws.base import Begins, LawKeys, LawNumber, RangeDeg

if TYPE_CHECKING:
    from ncgear.mechanisms.mechanism import Mechanism
    from ncgear.ratio.transmission import Lobes, Transmission


def numbers_of(key: str, formula: str) -> tuple[LawNumber, ...]:
    """The numbers of a formula under a key, in their order.

    Exponents and whole multiples of the variable stay: with other numbers the law would not close, or be another law.
    """
    text = formula.strip()
    tree = ast.parse(text, mode="eval")
    kept = set(_kept(tree))
    found = [constant for constant in ast.walk(tree) if isinstance(constant, ast.Constant) and constant not in kept]
    return tuple(
        LawNumber(
            f"{text[constant.col_offset : constant.end_col_offset]} in the formula",
            key,
            float(constant.value),
            before,
            after,
        )
        for constant in sorted(found, key=lambda constant: constant.col_offset)
        if isinstance(constant.value, int | float) and constant.lineno == constant.end_lineno == 1
        for before, after in [(text[: constant.col_offset], text[constant.end_col_offset :])]
    )


def _kept(tree: ast.AST) -> Iterator[ast.AST]:
    for node in ast.walk(tree):
        if not isinstance(node, ast.BinOp):
            continue
        if isinstance(node.op, ast.Pow):
            yield node.right
        elif isinstance(node.op, ast.Mult | ast.Div) and any(
            isinstance(side, ast.Name) for side in (node.left, node.right)
        ):
            yield from (side for side in (node.left, node.right) if _is_whole(side))


def _is_whole(node: ast.AST) -> bool:
    return isinstance(node, ast.Constant) and isinstance(node.value, int)


class RatioExpression(LawKeys):
    """A law written as a formula of phi1: the transmission ratio, or the driven angle."""

    CHOICE = "the ratio of the gears as a formula of the driving angle"
    BEGINS = Begins.FORMULA
    RULES = ("one of ratio driven_angle",)

    ratio: Expression | None = optional(
        'transmission ratio i12 = dphi1/dphi2 as a formula of phi (= phi1 in rad): "1 + 0.3*cos(phi)", '
        f"{FORMULA}; {SMOOTH_LAW}"
    )
    driven_angle: Expression | None = optional(
        'driven angle phi2 in rad as a formula of phi (= phi1 in rad): "phi - 0.08*sin(2*phi)", '
        f"{FORMULA}; of its dphi2/dphi1, {SMOOTH_LAW}"
    )
    scale_to_close: bool = optional(
        "true: multiply the ratio by the constant that makes the driven gear come round", False
    )

    range_deg: RangeDeg | None = optional(
        "for gears that turn to and fro, less than once: turn of the driving gear from end to end, in degrees; left "
        "out: gears that turn on and on"
    )

    def _faults(self) -> Faults:
        if self.range_deg is not None and self.scale_to_close:
            yield fault("scale_to_close", "true, but the gears turn over range_deg and do not close; leave it out")
        if self.scale_to_close and self.ratio is None:
            yield fault("scale_to_close", "true, but there is no ratio to scale; leave it out, or give ratio")

    @property
    def is_open(self) -> bool:
        """Whether a range is given."""
        return self.range_deg is not None

    @property
    def law_numbers(self) -> tuple[LawNumber, ...]:
        """The numbers of the formula."""
        return numbers_of("ratio", self.ratio) if self.ratio else numbers_of("driven_angle", self.driven_angle or "0")

    def transmission(self, linkage: Mechanism, lobes: Lobes) -> Transmission:
        """The law by the given formula."""
        from ncgear.ratio.laws import expression

        if self.range_deg is not None:
            covered = radians(self.range_deg)
            if self.ratio is not None:
                return expression.open_ratio_law(self.ratio, covered)
            assert self.driven_angle is not None
            return expression.open_driven_angle_law(self.driven_angle, covered)
        if self.ratio is not None:
            return expression.ratio_expression_law(self.ratio, lobes, scale_to_close=self.scale_to_close)
        assert self.driven_angle is not None
        return expression.driven_angle_expression_law(self.driven_angle, lobes)

    def gentler(self, share: float, even_turn: str) -> dict[str, Any]:
        """A power of the ratio, or the same share of the driven angle's deviation from an even turn."""
        if self.driven_angle is not None:
            return {"driven_angle": f"{1.0 - share:g}*{even_turn}*phi + {share:g}*({self.driven_angle})"}
        if self.is_open:
            return {"ratio": f"({self.ratio})**{share:g}"}
        return {"ratio": f"({self.ratio})**{share:g}", "scale_to_close": True}
