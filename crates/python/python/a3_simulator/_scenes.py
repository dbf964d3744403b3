"""Scenes and methods: what there is, and what users give."""

from __future__ import annotations

import json
import math
import os
from typing import Any, Dict, List, Mapping, NamedTuple, Optional, Tuple, Union

from . import _a3
from ._errors import InputError
from ._own import System

#: A scene: the name of a built-in one, the path of a file, a text in TOML, the table of its keys, or a system.
SceneLike = Union[str, "os.PathLike[str]", Mapping[str, Any], System]


class MethodInfo(NamedTuple):
    """A row of the table of methods."""

    name: str
    #: `None` for a method of one's own.
    letter: Optional[str]
    title: str
    order: int
    adaptive: bool
    #: Default step (s), or default relative tolerance of an adaptive method.
    setting: float


def scenes() -> List[str]:
    """Returns the names of the built-in scenes."""
    return _a3.scenes()


def methods() -> List[MethodInfo]:
    """Returns the table of methods: names, letters, orders, and default steps (s) or tolerances."""
    return [MethodInfo(*row) for row in _a3.methods()]


def scene(scene: SceneLike) -> Dict[str, Any]:
    """Returns the table of the keys of a scene, to be changed and given to `Simulation`.

    docs/scenes.md explains the keys. `scene("chain")["chain"]`, for example, lists the chains of that scene.
    """
    given = origin(scene)
    if isinstance(given, System):
        raise InputError("a system has no keys: change what it is made of")
    return json.loads(_a3.table(*given))


def origin(scene: SceneLike) -> Union[Tuple[str, str], System]:
    """Returns the kind of a scene, which is "named", "toml" or "table", and its name or text; a system as it is."""
    if isinstance(scene, System):
        return scene
    if isinstance(scene, Mapping):
        return "table", json.dumps(plain(scene, ""))
    if isinstance(scene, os.PathLike):
        return "named", os.fspath(scene)
    if not isinstance(scene, str):
        raise InputError(
            "a scene is a name, a file, a text in TOML, a dict of its keys, or an a3.System, not " + type(scene).__name__
        )
    # A name or a path has no equals sign with a line of its own around it; a text in TOML has.
    is_text = "\n" in scene or "=" in scene and not os.path.exists(scene)
    return ("toml" if is_text else "named"), scene


def plain(value: Any, key: str) -> Any:
    """Returns a value of a table as JSON has it: numbers of numpy become those of Python, arrays become lists."""
    if isinstance(value, Mapping):
        return {str(k): plain(v, f"{key}.{k}".lstrip(".")) for k, v in value.items()}
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, (list, tuple)):
        return [plain(v, key) for v in value]
    if isinstance(value, float) and not math.isfinite(value):
        raise InputError(f"{key}: a number of a scene is finite, not {value}")
    if value is None or isinstance(value, (bool, int, float, str)):
        return value
    raise InputError(f"{key}: a scene has numbers, texts, lists and tables, not {type(value).__name__}")
