"""Progress bars, if tqdm is there, and long work that Ctrl-C ends."""

from __future__ import annotations

import ctypes
import threading
import warnings
from contextlib import contextmanager
from typing import Any, Callable, Iterator, List, Optional, TypeVar

import numpy as np

from . import _a3

T = TypeVar("T")

#: Time (s) between two looks at long work.
_PERIOD = 0.05
#: Time (s) that work has to end by itself after Ctrl-C, before an exception is raised within its functions.
_GRACE_PERIOD = 0.5
#: Number of times that functions are interrupted: after one of them has ended, the work may call another.
_ATTEMPTS = 8


def _tqdm(**options: Any) -> Any:
    """Returns a bar, or `None` without tqdm."""
    try:
        from tqdm.auto import tqdm  # type: ignore[import-untyped]
    except ImportError:
        return None
    return tqdm(**options)


@contextmanager
def progress_bar(wanted: bool, begin: float, end: float) -> Iterator[Optional[Callable[[float], None]]]:
    """Returns a function that reports the simulated time (s), or `None` if there is no bar."""
    form = "{l_bar}{bar}| {n:.2f}/{total:.2f} s [{elapsed}<{remaining}]"
    bar = _tqdm(total=end - begin, bar_format=form) if wanted else None
    if bar is None:
        yield None
        return
    with bar:

        def report(time: float) -> None:
            bar.update(time - begin - bar.n)

        yield report
        bar.update(end - begin - bar.n)


def work(function: Callable[[_a3.Monitor], T], progress: bool) -> T:
    """Runs long work in a thread of its own, while this one shows its progress and looks for Ctrl-C.

    Warnings of the work are raised as warnings of Python. Numbers that overflow in functions of users are no warnings:
    runs with steps that are too long blow up, and that is what is measured.
    """
    monitor = _a3.Monitor()
    results: List[T] = []
    errors: List[BaseException] = []
    done = threading.Event()

    def run() -> None:
        try:
            with np.errstate(all="ignore"):
                results.append(function(monitor))
        except BaseException as error:
            errors.append(error)
        finally:
            done.set()

    thread = threading.Thread(target=run, daemon=True)
    form = "{desc:<14}{percentage:3.0f}%|{bar}| [{elapsed}<{remaining}]"
    bar = _tqdm(total=1.0, bar_format=form, leave=False) if progress else None
    thread.start()
    try:
        # A join that Ctrl-C interrupts leaves a thread that is taken for one that has ended.
        while not done.wait(_PERIOD):
            if bar is not None:
                stage, share, _ = monitor.look()
                bar.set_description_str(stage, refresh=False)
                bar.update(max(0.0, share - bar.n))
    except BaseException:
        monitor.stop()
        for _ in range(_ATTEMPTS):
            if done.wait(_GRACE_PERIOD):
                break
            for ident in monitor.threads():
                # It is in a function that takes long, or never ends.
                ctypes.pythonapi.PyThreadState_SetAsyncExc(ctypes.c_ulong(ident), ctypes.py_object(KeyboardInterrupt))
        raise
    finally:
        if bar is not None:
            bar.close()
    for line in monitor.look()[2]:
        warnings.warn(line.removeprefix("warning: "), stacklevel=3)
    if errors:
        raise errors[0]
    return results[0]
