"""The program: what the script `a3` and `python -m a3_simulator` run."""

import sys

from ._a3 import main as _main


def main() -> int:
    """Runs the command of the command line, and returns the exit code."""
    return _main(["a3", *sys.argv[1:]])
