"""The command line. Numerical libraries are imported inside the commands, so that help and usage errors come at once.

Results go to stdout, everything else to stderr. Exit status: 0 done, 1 a fault in ncgear, 2 wrong input, 3 no such
mechanism, 130 ended by Ctrl-C (143 by ``kill``, 129 as its terminal was closed).
"""

from ncgear.cli.run import main

__all__ = ["main"]
