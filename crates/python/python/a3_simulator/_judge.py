"""Judgements of the results of other programs."""

from __future__ import annotations

import io
import json
import os
from typing import Any, Dict, Optional, Tuple, Union

import numpy as np
import numpy.typing as npt

from . import _a3
from ._errors import InputError
from ._given import given
from ._progress import work
from ._scenes import SceneLike

#: States: a file, or arrays t (s), (times,), x (m), (times, n, 3), and perhaps v (m/s), (times, n, 3).
StatesLike = Union[str, "os.PathLike[str]", Tuple[npt.ArrayLike, ...]]


class Judgement:
    """The errors of the results of a program, and the method that they agree with.

    Printed, it is the judgement in words.

    Attributes:
        error: largest error of the positions (m), root mean square over the particles.
        error_time: its time (s).
        particle: the particle that is farthest from its place then.
        times, errors: times (s) and errors (m), (times,).
        floor: error of the reference itself (m).
        method: the method that the results agree with: its name in a3, or its title if a3 has none of it; or `None`.
        mistake: how it differs from the method, in the words of the text, such as "half the gravity" or "a step later
            in each row"; of a suspect if the results agree with no method, or `None`.
        question: the question to the author of the program, or `None`.
        constant, factor: the constant that is another, and its value over that of the scene, or `None`.
        single_precision: whether the results agree with the method in single precision.
        nearest: the nearest method, if the results agree with none but are near one, or `None`.
        start: how the first state differs from the start of the scene, in words, or `None`.
        step: step of the program (s), if it is known.
        within: whether the error is within that which was asked for; `None` if none was.
        data: all that was found, as `a3 judge --summary` writes it.
        text: the judgement in words.
    """

    def __init__(self, text: str, data: Dict[str, Any]) -> None:
        self.text, self.data = text, data
        self.times, self.errors = np.array(data["times"]), np.array(data["errors"])
        self.error: float = data["error"]
        self.error_time: float = data["error_time"]
        self.particle: int = data["particle"]
        self.floor: float = data["floor"]
        self.step: Optional[float] = data["step"]
        self.within: Optional[bool] = data["within"]
        self.start: Optional[str] = data["start"]
        self.method, self.nearest = _name(data["method"]), _name(data["nearest"])
        found = data["method"] or data["suspect"] or {}
        self.mistake: Optional[str] = found.get("mistake")
        self.question: Optional[str] = found.get("question")
        self.constant: Optional[str] = found.get("constant")
        self.factor: Optional[float] = found.get("factor")
        self.single_precision: bool = found.get("single_precision", False)

    def __str__(self) -> str:
        return self.text

    def __repr__(self) -> str:
        return f"<Judgement: error {self.error:.1e} m, {self.method or 'no known method'}>"


def _name(way: Optional[Dict[str, Any]]) -> Optional[str]:
    """Returns the name of a method in a3, or else its title."""
    return None if way is None else way["solver"] or way["title"]


def judge(
    scene: SceneLike,
    states: StatesLike,
    *,
    until: Optional[float] = None,
    step: Optional[float] = None,
    within: Optional[float] = None,
    name: str = "states",
    progress: bool = True,
    **options: Any,
) -> Judgement:
    """Judges the results of another program: how much they err, and which method they agree with.

    Args:
        scene: scene as in `Simulation`.
        states: arrays t (s), (times,), x (m), (times, n, 3), and perhaps v (m/s), (times, n, 3), or a file with them:
            .csv, .json or .npz. Times begin at 0, and particles are in the order of the scene.
        until: time up to which states are judged (s); by default as long as errors mean something.
        step: step of the program (s), if its states are not a whole number of steps apart.
        within: largest error that is accepted (m).
        name: name of the results, for messages.
        progress, options: as in `chart`.
    """
    scene_given = given(scene, **options)
    file, archive = None, None
    if isinstance(states, (str, os.PathLike)):
        file = os.fspath(states)
    else:
        archive = (name, _archive(states))
    text, data = work(
        lambda monitor: _a3.judge(scene_given, monitor, file, archive, until, step, within), progress
    )
    return Judgement(text, json.loads(data))


def _archive(states: Tuple[npt.ArrayLike, ...]) -> bytes:
    """Returns an archive of arrays t, x and perhaps v."""
    if not isinstance(states, (tuple, list)) or len(states) not in (2, 3):
        raise InputError("states are a file, or arrays t, x and perhaps v: (t, x) or (t, x, v)")
    arrays = {}
    for key, given_array in zip("txv", states):
        try:
            arrays[key] = np.array(given_array).astype(float, casting="same_kind")
        except (TypeError, ValueError):
            raise InputError(f"{key}: an array of numbers is expected, not {type(given_array).__name__}") from None
    file = io.BytesIO()
    np.savez(file, **arrays)  # type: ignore[arg-type]
    return file.getvalue()
