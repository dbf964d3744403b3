"""Runs the program: `python -m a3_simulator`."""

import sys

from ._program import main

sys.exit(main())
