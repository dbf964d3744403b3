"""Scenes with their options, as the compiled part takes them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Optional, Sequence, Tuple, Union

from ._own import Forces, System
from ._scenes import SceneLike, origin


@dataclass(frozen=True)
class Given:
    """A scene with its options."""

    source: Union[Tuple[str, str], System]
    grid: Optional[Tuple[int, int]]
    wind: bool
    swing: bool
    self_collision: bool
    forces: Sequence[Forces]


def given(
    scene: SceneLike,
    *,
    grid: Optional[Tuple[int, int]] = None,
    wind: bool = False,
    swing: bool = False,
    self_collision: bool = False,
    forces: Sequence[Forces] = (),
) -> Given:
    """Returns a scene with its options, which are those of `Simulation`."""
    return Given(origin(scene), grid, wind, swing, self_collision, list(forces))
