"""The tests of the Python module, to be run against the installed wheel: `crates/python/check`."""

import shutil
import signal
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[3]


@pytest.fixture(scope="session")
def program() -> str:
    """The program of the same wheel."""
    found = shutil.which("a3", path=str(Path(sys.executable).parent))
    assert found, "the wheel brings no program"
    return found


@pytest.fixture(scope="session", autouse=True)
def ctrl_c() -> None:
    """Lets Ctrl-C interrupt, also if a shell that started these tests in the background ignores it."""
    signal.signal(signal.SIGINT, signal.default_int_handler)
