"""Steps of two coordinates joined by a spring, against the matrix exponential and by their order."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import expm

from ncgear.numerics.oscillator_steps import Pull, Pulled, stepped, steps

LIGHT, HEAVY, RATIO = 2.0, 5.0, 1.5
"""Inertias of x and y, and the ratio of the spring's relative place y - ratio x."""


def pulled(place: complex, speed: complex, stiffness: float, damping: float, softening: float = 0.0) -> Pull:
    """A spring, a damper and a constant torque on x; a softening adds a force of the cube of the relative place."""
    relative, rate = place.imag - RATIO * place.real, speed.imag - RATIO * speed.real
    both = 1.0 / HEAVY + RATIO**2 / LIGHT
    moment = -stiffness * relative - damping * rate + softening * relative**3
    acceleration = complex(0.3 - RATIO * moment / LIGHT, moment / HEAVY)
    return Pull(acceleration, stiffness * both, damping * both, RATIO, complex(-RATIO / LIGHT, 1.0 / HEAVY) / both)


@pytest.mark.parametrize("damping", [0.0, 0.7, 20.0])
def test_a_linear_spring_is_followed_exactly_over_a_long_step(damping: float) -> None:
    place, speed, stiffness, width = 0.2 + 0.5j, 1.0 - 0.4j, 6.0, 0.9
    end = stepped(
        lambda p, v: pulled(p, v, stiffness, damping), start(place, speed, stiffness, damping), None, width
    ).end
    row, inverse = np.array([-RATIO, 1.0]), np.array([-RATIO / LIGHT, 1.0 / HEAVY])
    system = np.zeros((5, 5))
    system[:2, 2:4] = np.eye(2)
    system[2:4, :2], system[2:4, 2:4] = -stiffness * np.outer(inverse, row), -damping * np.outer(inverse, row)
    system[2, 4] = 0.3
    exact = expm(system * width) @ [place.real, place.imag, speed.real, speed.imag, 1.0]
    found = [end.place.real, end.place.imag, end.speed.real, end.speed.imag]
    np.testing.assert_allclose(found, exact[:4], rtol=1e-11, atol=1e-12)


def start(place: complex, speed: complex, stiffness: float, damping: float, softening: float = 0.0) -> Pulled:
    return Pulled(place, speed, pulled(place, speed, stiffness, damping, softening))


def test_a_spring_that_softens_is_followed_with_order_four() -> None:
    def end(count: int) -> complex:
        now, before = start(0.1 + 0.6j, 0.5 + 0.2j, 6.0, 0.2, 1.0), None
        for _ in range(count):
            before = stepped(lambda p, v: pulled(p, v, 6.0, 0.2, 1.0), now, before, 1.0 / count)
            now = before.end
        return now.place

    exact = end(320)
    errors = [abs(end(count) - exact) for count in (10, 20, 40)]
    assert np.log2(errors[0] / errors[1]) > 3.7
    assert np.log2(errors[1] / errors[2]) > 3.7


def test_a_trial_step_that_overflows_is_tried_again_in_parts() -> None:
    """Numbers end where a step of 4 leads; the next, of a fifth, is as if that were the first."""

    def found(width: float) -> tuple[list[bool], Pulled]:
        def pulling(place: complex, speed: complex) -> Pull:
            if abs(place) > 1.5:
                raise OverflowError
            return pulled(place, speed, 6.0, 0.7)

        taken, now = list[bool](), start(0.2 + 0.5j, 1.0 - 0.4j, 6.0, 0.7)
        for step in steps(pulling, now, width, lambda _: 4.0, lambda _: 1.0):
            taken.append(step is not None)
            if step is not None:
                return taken, step.end
        raise AssertionError

    assert found(4.0)[0] == [False, True]
    assert found(0.8) == ([True], found(4.0)[1])
