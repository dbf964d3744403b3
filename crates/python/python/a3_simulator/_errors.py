"""The exceptions of a3."""

from __future__ import annotations

from typing import Optional


class Error(Exception):
    """The work failed. The message is that of the program."""


class InputError(Error, ValueError):
    """The request cannot be met: an option, a scene, a file or a result of a function is wrong. Nothing was done."""


class BlowUp(Error, ArithmeticError):
    """A run blew up. It is back at its last sound state, and takes no more steps until it is reset.

    Attributes:
        step: number of steps taken, the failed one included.
        time: time at the end of the failed step (s).
        particle: number of the particle at which it blew up, if it is known.
    """

    def __init__(self, message: str, step: int, time: float, particle: Optional[int]) -> None:
        super().__init__(message, step, time, particle)
        self.step = step
        self.time = time
        self.particle = particle

    def __str__(self) -> str:
        return self.args[0]
