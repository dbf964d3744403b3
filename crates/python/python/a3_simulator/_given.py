"""Scenes with their options, as the compiled part takes them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Sequence, Tuple, Union

from ._own import Forces, System
from ._scenes import SceneLike, origin


@dataclass(frozen=True)
class Given:
    """A scene with its options."""

    source: Union[Tuple[str, str], System]
    grid: "Tuple[int, int] | None" = None
    wind: bool = False
    swing: bool = False
    self_collision: bool = False
    forces: Sequence[Forces] = ()


def given(scene: SceneLike, **options: object) -> Given:
    """Returns a scene with its options, which are those of `Simulation`."""
    forces = options.pop("forces", ())
    return Given(origin(scene), forces=list(forces), **options)
