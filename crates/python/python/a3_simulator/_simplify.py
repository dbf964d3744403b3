"""What a scene can do without."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass
from typing import Any, Dict, List, Optional, Tuple, Union

from . import _a3
from ._errors import InputError
from ._given import given
from ._measures import _Drawn
from ._progress import work
from ._scenes import SceneLike


@dataclass(frozen=True)
class ModelEffect:
    """The effect of a part that is left out, or of another grid, compared with the whole scene."""

    #: Name of the part, or the grid.
    model: str
    #: Change of the quantity that is compared, in its unit; `None` if it was not measured.
    change: Optional[float]
    #: Computing time over that of the whole scene.
    time: Optional[float]
    #: Work over that of the whole scene, in evaluations of each.
    work: Optional[float]
    #: Whether the lean scene has this change.
    in_lean: bool
    #: Verdict, or the reason why it was not measured.
    verdict: str


@dataclass(frozen=True)
class LeanScene:
    """The leanest scene for an error."""

    #: Scene file in TOML, with its solver and step; `a3.Simulation` takes it.
    scene: str
    #: Names of the parts that are left out.
    parts: List[str]
    #: Factor by which the cells of its grids are shorter; below 1 for coarser grids.
    factor: float
    #: Name of its solver.
    method: str
    #: Step (s), or relative tolerance of an adaptive method.
    setting: float
    #: Error of model and time steps together, in the unit of the quantity.
    error: float
    #: Error of the model alone.
    model_error: float
    #: Computing time of the whole scene at that error, over that of the lean scene.
    times_cheaper: float


class Simplified(_Drawn):
    """What a scene can do without for an error.

    Printed, it is the table of `a3 simplify`. With `chart=True`, a notebook shows the chart of models.

    Attributes:
        models: effects of all parts and grids.
        lean: the leanest scene.
        grid_error: estimated error (m) of the scene's grid, or `None` if it is not known.
        grid_order: observed order of that error, or `None`.
        of, unit: the quantity that is compared, and its unit.
        motion: its change in the run of the whole scene.
        uncertainty: error of the runs by which the models are compared.
        until: end of the runs (s).
        data: all that was found.
        text: the same in words.
    """

    def __init__(self, source: _a3.Simplified, size: Tuple[int, int], chart: bool) -> None:
        self._source, self._size, self._forms = source, size, {}
        self._has_chart = chart and source.has_chart()
        self.text = source.text()
        self.data: Dict[str, Any] = json.loads(source.json())
        self.models = [ModelEffect(**model) for model in self.data["models"]]
        self.grid_error: Optional[float] = self.data["grid_error"]
        self.grid_order: Optional[float] = self.data["grid_order"]
        self.of: str = self.data["of"]
        self.unit: str = self.data["unit"]
        self.motion: float = self.data["motion"]
        self.uncertainty: float = self.data["uncertainty"]
        self.until: float = self.data["until"]
        lean = self.data["lean"]
        self.lean = LeanScene(
            lean["scene"],
            lean["parts"],
            lean["factor"],
            lean["lean"]["solver"],
            lean["lean"]["setting"],
            lean["lean"]["error"],
            lean["model_error"],
            lean["whole"]["seconds"] / lean["lean"]["seconds"],
        )

    def __getitem__(self, model: str) -> ModelEffect:
        for effect in self.models:
            if effect.model == model:
                return effect
        raise KeyError(model)

    def _repr_svg_(self) -> Optional[str]:  # type: ignore[override]
        return self.svg if self._has_chart else None

    def __getstate__(self) -> Dict[str, Any]:
        return super().__getstate__() if self._has_chart else {**self.__dict__, "_source": None}

    def __str__(self) -> str:
        return self.text

    def __repr__(self) -> str:
        return f"<Simplified: {self.lean.times_cheaper:.1f} times cheaper at {self.lean.error:.1e} {self.unit}>"


def simplify(
    scene: SceneLike,
    error: float,
    *,
    of: str = "position",
    until: Optional[float] = None,
    particle: Optional[int] = None,
    at_end: bool = False,
    data: Optional[Union[str, "os.PathLike[str]"]] = None,
    chart: bool = False,
    size: Tuple[int, int] = (800, 560),
    progress: bool = True,
    **options: Any,
) -> Simplified:
    """Finds what a scene can do without for an error: parts that hardly change its motion, and finer grids.

    Args:
        scene: scene as in `Simulation`, but no `System`.
        error: largest error of model and time steps together, in m, or in J for `of="energy"`.
        of: quantity that is compared: "position", "centre" (of mass) or "energy".
        until: end of the runs (s), from 0.01 to 1000; by default as long as errors mean something on the scene.
        particle: the only particle whose position counts.
        at_end: whether the error at the end counts, instead of the largest one.
        data: file for the effects, ending in .csv or .json; what it holds is not measured again.
        chart: whether the chart of models is measured, too.
        size: width and height of its picture (px, 96 to the inch).
        progress: whether a bar shows the progress, if `tqdm` is installed.
        options: grid, wind, swing and self_collision, as in `Simulation`.
    """
    scene_given = given(scene, **options)
    file = None if data is None else os.fspath(data)
    source = work(
        lambda monitor: _a3.simplify(
            scene_given, monitor, float(error), of, until, particle, at_end, file, chart
        ),
        progress,
    )
    if json.loads(source.json())["lean"] is None:
        raise InputError("interrupted before the leanest scene was found")
    return Simplified(source, size, chart)
