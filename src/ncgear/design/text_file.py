"""Reading a text file that may be missing, a folder, huge, or no text at all."""

from __future__ import annotations

from pathlib import Path

from ncgear.errors import WrongInput

BYTES_PER_MB = 1_000_000


def read_text(path: Path, *, limit_mb: int) -> str:
    """The text of ``path``; WrongInput when there is none to be had. The size is looked at before anything is read."""
    try:
        _refuse_unfit(path, limit_mb)
        content = path.read_bytes()
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise WrongInput(f"cannot be read: {reason}; give an existing, readable file", location=str(path)) from error
    return _decoded(content, path)


def _refuse_unfit(path: Path, limit_mb: int) -> None:
    status = path.stat()
    if path.is_dir():
        raise WrongInput("is a folder; give a file", location=str(path))
    # Pipes and devices have no size that could be checked before reading.
    if not path.is_file():
        raise WrongInput("is no regular file; give one on disk", location=str(path))
    size_mb = status.st_size / BYTES_PER_MB
    if size_mb > limit_mb:
        raise WrongInput(f"holds {size_mb:.1f} MB; at most {limit_mb} MB is right", location=str(path))


def _decoded(content: bytes, path: Path) -> str:
    try:
        # utf-8-sig: some editors begin a file with a byte order mark.
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        before = content[: error.start]
        line = before.count(b"\n") + 1
        column = error.start - (before.rfind(b"\n") + 1) + 1
        problem = f"byte 0x{content[error.start]:02x} is not UTF-8 text; save the file as UTF-8"
        raise WrongInput(problem, location=f"{path}:{line}:{column}") from error
