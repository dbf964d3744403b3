"""Progress bars, if tqdm is there."""

from __future__ import annotations

from contextlib import contextmanager
from typing import Callable, Iterator, Optional


@contextmanager
def progress_bar(wanted: bool, begin: float, end: float) -> Iterator[Optional[Callable[[float], None]]]:
    """Returns a function that reports the simulated time (s), or `None` if there is no bar."""
    if not wanted:
        yield None
        return
    try:
        from tqdm.auto import tqdm
    except ImportError:
        yield None
        return
    with tqdm(total=end - begin, unit="s", bar_format="{l_bar}{bar}| {n:.2f}/{total:.2f} s [{elapsed}<{remaining}]") as bar:

        def report(time: float) -> None:
            bar.update(time - begin - bar.n)

        yield report
        bar.update(end - begin - bar.n)
