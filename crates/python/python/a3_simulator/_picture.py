"""Pictures."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Optional, Tuple, Union

from ._errors import InputError
from ._scenes import SceneLike

if TYPE_CHECKING:
    from ._measures import MethodLike
    from ._simulation import Simulation


@dataclass(frozen=True)
class Picture:
    """A picture, which shows itself in a notebook."""

    #: The picture as a PNG file.
    png: bytes

    def save(self, path: Union[str, "os.PathLike[str]"]) -> None:
        """Writes the picture to a file that ends in .png."""
        if not os.fspath(path).lower().endswith(".png"):
            raise InputError(f"{os.fspath(path)}: a picture is saved as .png")
        write(path, self.png)

    def _repr_png_(self) -> bytes:
        return self.png

    def __repr__(self) -> str:
        width, height = (int.from_bytes(self.png[k : k + 4], "big") for k in (16, 20))
        return f"<Picture {width} x {height}>"


def render(
    scene: Union[SceneLike, "Simulation"],
    method: "Optional[MethodLike]" = None,
    step: Optional[float] = None,
    *,
    until: float = 0.0,
    size: Tuple[int, int] = (960, 540),
    colour: Optional[str] = None,
    arrows: Optional[str] = None,
    wireframe: bool = False,
    springs: bool = False,
    orthographic: bool = False,
    dark: bool = False,
    transparent: bool = False,
    **options: Any,
) -> Picture:
    """Draws a scene at a time.

    Args:
        scene: scene as in `Simulation`, or a run, which is drawn as it is.
        method, step, options: as in `Simulation`.
        until: time (s).
        size: width and height (px).
        colour: quantity that colours the particles: "speed", "strain", "force" or "contact".
        arrows: vectors on the particles: "velocity" or "force".
        wireframe, springs: whether the wireframe or all springs are drawn instead of the surface.
        orthographic: whether the projection is parallel.
        dark: whether the background is dark.
        transparent: whether floor and background are left out.
    """
    from ._simulation import Simulation

    run = scene if isinstance(scene, Simulation) else Simulation(scene, method, step, **options)
    if run is not scene:
        run.advance_to(until)
    return run.render(
        *size,
        colour=colour,
        arrows=arrows,
        wireframe=wireframe,
        springs=springs,
        orthographic=orthographic,
        dark=dark,
        transparent=transparent,
    )


def write(path: Union[str, "os.PathLike[str]"], data: bytes) -> None:
    """Writes a file whole: beside its place first, so that an error leaves what was there."""
    path = os.fspath(path)
    draft = f"{path}.{os.getpid()}.part"
    try:
        with open(draft, "wb") as file:
            file.write(data)
        os.replace(draft, path)
    except BaseException:
        if os.path.exists(draft):
            os.remove(draft)
        raise
