"""Reading text files, which may be missing, a folder, huge or no text; meaning of plain words; values in messages.

A YAML scalar has the meaning of the core schema of YAML 1.2: ``1e-3`` is a number, and ``no``, ``on`` and dates are
text.
"""

from __future__ import annotations

import re
from math import inf, isfinite, nan
from pathlib import Path

from ncgear.errors import WrongInput

BYTES_PER_MB = 1_000_000


TRAIN = re.compile(r"^[\"']?train[\"']?[ \t]*:", re.MULTILINE)
"""The line with which the group of a train of gears begins."""


def has_train(text: str) -> bool:
    """Whether a design file describes a train of gears."""
    return TRAIN.search(text) is not None


def read_text(path: Path, *, limit_mb: int) -> str:
    """The text of ``path``; raises WrongInput if it cannot be read.  The size is checked before reading."""
    return _decoded(read_bytes(path, limit_mb=limit_mb), path)


def read_bytes(path: Path, *, limit_mb: int) -> bytes:
    """The content of ``path``; raises WrongInput if it cannot be read.  The size is checked before reading."""
    try:
        _refuse_unfit(path, limit_mb)
        return path.read_bytes()
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise WrongInput(f"cannot be read: {reason}; give an existing, readable file", location=str(path)) from error


def _refuse_unfit(path: Path, limit_mb: int) -> None:
    status = path.stat()
    if path.is_dir():
        raise WrongInput("is a folder; give a file", location=str(path))
    # The size of pipes and devices cannot be checked before reading.
    if not path.is_file():
        raise WrongInput("is no regular file; give one on disk", location=str(path))
    size_mb = status.st_size / BYTES_PER_MB
    if size_mb > limit_mb:
        raise WrongInput(f"holds {size_mb:.1f} MB; at most {limit_mb} MB is right", location=str(path))


def _decoded(content: bytes, path: Path) -> str:
    try:
        # utf-8-sig, because some editors write a byte order mark first.
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        before = content[: error.start]
        line = before.count(b"\n") + 1
        column = error.start - (before.rfind(b"\n") + 1) + 1
        problem = f"byte 0x{content[error.start]:02x} is not UTF-8 text; save the file as UTF-8"
        raise WrongInput(problem, location=f"{path}:{line}:{column}") from error


_INTEGER = re.compile(r"[-+]?[0-9]+")
_FLOAT = re.compile(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?")
_WORDS: dict[str, bool | float | None] = {
    **dict.fromkeys(("", "~", "null", "Null", "NULL")),
    **dict.fromkeys(("true", "True", "TRUE"), True),
    **dict.fromkeys(("false", "False", "FALSE"), False),
    **dict.fromkeys((".nan", ".NaN", ".NAN"), nan),
    **{sign + word: inf for word in (".inf", ".Inf", ".INF") for sign in ("", "+")},
    **{"-" + word: -inf for word in (".inf", ".Inf", ".INF")},
}

# Python refuses to read integers with thousands of digits, even if nearly all of them are leading zeros.
_LONGEST_INTEGER = 400
_LONGEST_SHOWN = 40


def plain_value(text: str) -> object:
    """The value of a scalar without quotes: nothing, a truth value, a number, or text."""
    if text in _WORDS:
        return _WORDS[text]
    number = plain_number(text)
    return text if number is None else number


def plain_number(text: str) -> int | float | None:
    """``text`` as a decimal number, infinite if it exceeds floating point; None if it is not a number."""
    if not _FLOAT.fullmatch(text):
        return None
    number = float(text)
    whole_number = _INTEGER.fullmatch(text) and len(text) <= _LONGEST_INTEGER and isfinite(number)
    return int(text) if whole_number else number


def beyond_numbers(text: str) -> bool:
    """Whether ``text`` is a decimal number that is too large or too small for floating point."""
    digits = _FLOAT.fullmatch(text) and re.split("[eE]", text)[0].strip("+-.0")
    return bool(digits) and not 0.0 < abs(float(text)) < inf


def whole(value: float) -> float:
    """The number, as an integer if it is whole, so that a file shows it without a point."""
    return int(value) if isinstance(value, int) or value.is_integer() else value


def quoted(value: object) -> str:
    """``value`` as messages quote it: short, and in the form of the file."""
    if value is None:
        return "nothing"
    if isinstance(value, dict):
        return "a group of keys"
    if isinstance(value, list | tuple):
        return "a list"
    if isinstance(value, str):
        return repr(shortened(value))
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, float) and not isfinite(value):
        return f"{value}".replace("nan", ".nan").replace("inf", ".inf")
    if isinstance(value, float):
        return f"{value:g}" if float(f"{value:g}") == value else repr(whole(value))
    return shortened(repr(value))


def shortened(text: str, longest: int = _LONGEST_SHOWN) -> str:
    """A text, or its beginning if it is long."""
    return text if len(text) <= longest else text[:longest] + "..."
