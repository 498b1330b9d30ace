"""Studios that compute nothing of their designs, so that they begin and end in a moment, and can be killed often."""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from multiprocessing import get_context
from pathlib import Path
from typing import Any
from unittest.mock import patch

from ncgear.studio import chains
from ncgear.studio.server import listening, serve
from studios import Studio

FORKS = get_context("forkserver")
# The models of all keys are built when they are first used; here by the process from which all studios are forked.
FORKS.set_forkserver_preload(["saving_only", "saving_ready"])


@contextmanager
def saving_only(path: Path) -> Iterator[Studio]:
    """A studio of a file; it may be killed, and ends by Ctrl-C if it is not."""
    here, there = FORKS.Pipe()
    process = FORKS.Process(target=_serve, args=(path, there))
    with patch.dict(os.environ, PYTHONPATH=os.pathsep.join(sys.path)):
        # The process from which all are forked does not hear of this one's path in any other way.
        process.start()
    # A studio that ends before it says its address is an error here then, and nothing waits for it.
    there.close()
    try:
        yield Studio(process, path, path.parent / "export", here.recv())
    finally:
        if process.is_alive():
            os.kill(process.pid, signal.SIGINT)
        process.join(30)
        assert process.exitcode in (0, -signal.SIGKILL)


def _serve(path: Path, said: Any) -> None:
    chains.chains_by_process = tuple
    serve(path, path.parent / "export", listening(0), said.send)
