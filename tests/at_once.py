"""Cases that say one thing, as one test that tells every case that fails.

pytest takes some milliseconds for each of its tests, which is more than most of thousands of cases need.  Cases keep
tests of their own (``pytest.mark.parametrize``) where they belong to different tiers or take long.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterable, Sequence
from functools import wraps
from typing import Any

import pytest

Test = Callable[..., None]


def at_once(names: str | Sequence[str], values: Iterable[Any]) -> Callable[[Test], Test]:
    """Give a test all values of some arguments, as ``pytest.mark.parametrize`` does, and fail with all that fail."""
    given = [names] if isinstance(names, str) else list(names)
    cases = [dict(zip(given, [value] if isinstance(names, str) else value, strict=True)) for value in values]

    def decorated(test: Test) -> Test:
        @wraps(test)
        def whole(**others: Any) -> None:
            faults: list[BaseException] = []
            for case in cases:
                try:
                    test(**others, **case)
                except (Exception, pytest.fail.Exception) as fault:
                    fault.add_note(f"with {', '.join(f'{name} = {value!r}' for name, value in case.items())}")
                    faults.append(fault)
            if faults:
                raise BaseExceptionGroup(f"{len(faults)} of {len(cases)} cases", faults)

        own = inspect.signature(test)
        left = [parameter for name, parameter in own.parameters.items() if name not in given]
        whole.__signature__ = own.replace(parameters=left)  # type: ignore[attr-defined]
        return whole

    return decorated
