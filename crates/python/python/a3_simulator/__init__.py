"""a3 in Python: mass-spring systems, rigid bodies, solids and fluids, and how fast and accurate solvers are on them.

    import a3_simulator as a3

    run = a3.Simulation("flag", "rk4", step=0.01)
    run.advance_to(1.0)
    run.positions                       # numpy, (n, 3), m

Positions are in metres, times in seconds, masses in kilograms. Arrays are of numpy, of 64-bit numbers.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, List

if TYPE_CHECKING:
    from ._errors import BlowUp as BlowUp
    from ._errors import Error as Error
    from ._errors import InputError as InputError
    from ._judge import Judgement as Judgement
    from ._judge import judge as judge
    from ._measures import Chart as Chart
    from ._measures import Choice as Choice
    from ._measures import Comparison as Comparison
    from ._measures import Limits as Limits
    from ._measures import Motion as Motion
    from ._measures import Point as Point
    from ._measures import Stability as Stability
    from ._measures import Winner as Winner
    from ._measures import chart as chart
    from ._measures import choose as choose
    from ._measures import compare as compare
    from ._measures import stability as stability
    from ._own import Method as Method
    from ._own import System as System
    from ._own import foreign as foreign
    from ._picture import Picture as Picture
    from ._picture import render as render
    from ._scenes import MethodInfo as MethodInfo
    from ._scenes import methods as methods
    from ._scenes import scene as scene
    from ._scenes import scenes as scenes
    from ._simplify import LeanScene as LeanScene
    from ._simplify import ModelEffect as ModelEffect
    from ._simplify import Simplified as Simplified
    from ._simplify import simplify as simplify
    from ._simulation import Energy as Energy
    from ._simulation import Simulation as Simulation
    from ._simulation import Springs as Springs
    from ._simulation import Work as Work

# The module of each name. They are loaded when they are first used, so that the program, which needs none of them,
# starts without numpy.
_MODULES = {
    "BlowUp": "_errors",
    "Error": "_errors",
    "InputError": "_errors",
    "Judgement": "_judge",
    "judge": "_judge",
    "Chart": "_measures",
    "Choice": "_measures",
    "Comparison": "_measures",
    "Limits": "_measures",
    "Motion": "_measures",
    "Point": "_measures",
    "Stability": "_measures",
    "Winner": "_measures",
    "chart": "_measures",
    "choose": "_measures",
    "compare": "_measures",
    "stability": "_measures",
    "Method": "_own",
    "System": "_own",
    "foreign": "_own",
    "Picture": "_picture",
    "render": "_picture",
    "MethodInfo": "_scenes",
    "methods": "_scenes",
    "scene": "_scenes",
    "scenes": "_scenes",
    "LeanScene": "_simplify",
    "ModelEffect": "_simplify",
    "Simplified": "_simplify",
    "simplify": "_simplify",
    "Energy": "_simulation",
    "Simulation": "_simulation",
    "Springs": "_simulation",
    "Work": "_simulation",
}

__all__ = list(_MODULES)


def __getattr__(name: str) -> object:
    if name == "__version__":
        from importlib.metadata import version

        return version("a3-simulator")
    module = _MODULES.get(name)
    if module is None:
        raise AttributeError(f"module 'a3_simulator' has no attribute {name!r}")
    value = getattr(importlib.import_module(f".{module}", __name__), name)
    globals()[name] = value
    return value


def __dir__() -> List[str]:
    return sorted([*__all__, "__version__", *(name for name in globals() if name.startswith("__"))])
