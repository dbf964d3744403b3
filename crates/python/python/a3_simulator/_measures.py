"""Charts, choices, limits and comparisons."""

from __future__ import annotations

import copy
import functools
import json
import os
import warnings
from dataclasses import dataclass, field
from typing import Any, Dict, List, NamedTuple, Optional, Sequence, Tuple, Union

import numpy as np

from . import _a3
from ._errors import InputError
from ._given import given
from ._own import Derivative, Method, System, method_name
from ._picture import write
from ._progress import work as _work
from ._scenes import SceneLike

#: A method, with or without its step or tolerance: "rk4", ("rk4", 0.01), "rk4:0.01" or an `a3.Method`.
MethodLike = Union[str, Method]

#: Units of errors.
_UNITS = {"position": "m", "energy": "J", "momentum": "kg m/s", "phase": "s", "impact": "s"}
#: Kinds of pictures, by the endings of files.
_KINDS = ("svg", "pdf", "png")


class _Drawn:
    """A result with a picture, which shows itself in a notebook and can be saved and pickled."""

    _source: Any
    _size: Tuple[int, int]
    _forms: Dict[str, bytes]

    def _draw(self, kind: str, size: Tuple[int, int]) -> bytes:
        return self._source.drawn(kind, size)

    def _form(self, kind: str, size: Optional[Tuple[int, int]] = None) -> bytes:
        if size is not None and size != self._size:
            if self._source is None:
                raise InputError("what was pickled has its pictures in one size: leave out size")
            return self._draw(kind, size)
        if kind not in self._forms:
            self._forms[kind] = self._draw(kind, self._size)
        return self._forms[kind]

    @property
    def svg(self) -> str:
        """The picture as SVG."""
        return self._form("svg").decode()

    def save(self, path: Union[str, "os.PathLike[str]"], size: Optional[Tuple[int, int]] = None) -> None:
        """Writes the picture to a file that ends in .svg, .pdf or .png.

        Args:
            path: the file.
            size: width and height (px, 96 to the inch).
        """
        kind = os.fspath(path).rpartition(".")[2].lower()
        if kind not in _KINDS:
            raise InputError(f"{os.fspath(path)}: a picture is saved as .svg, .pdf or .png")
        write(path, self._form(kind, size))

    def _repr_svg_(self) -> str:
        return self.svg

    def __getstate__(self) -> Dict[str, Any]:
        for kind in _KINDS:
            self._form(kind)
        return {**self.__dict__, "_source": None}


class Point(NamedTuple):
    """A run of a chart: a method at a step or a tolerance."""

    #: Name of the method.
    method: str
    #: Step (s), or relative tolerance of an adaptive method.
    setting: float
    #: Error against the reference, in the unit of the chart; NaN if the run blew up.
    error: float
    #: Error of the reference itself: errors below ten times this mean nothing.
    floor: float
    #: Cost of the run with its linear algebra, in evaluations of f: the same on every machine.
    work: float
    #: Evaluations of f.
    evaluations: int
    #: Computing time of the run (s); NaN if it was not measured.
    seconds: float
    #: Order between the next coarser run and this one; NaN if there is none.
    order: float
    #: Time at which the run blew up (s); NaN if it did not.
    blew_up_at: float
    #: Stiffness of the springs, over that of the scene itself.
    stiffness: float


class Winner(NamedTuple):
    """The cheapest run that keeps an error."""

    #: The error, in the unit of the chart.
    error: float
    #: The run.
    run: Point


class Chart(_Drawn):
    """Runs of methods at smaller and smaller steps or tolerances: their errors, and what they cost.

    A notebook shows it as a picture.

    Attributes:
        points: the runs, in the order in which they were measured.
        error: what counts as the error: "position", "energy", ...
        unit: unit of the errors; "" if they have none.
        until: end of the runs (s).
        complete: whether all runs were measured.
        too_costly: names of the methods whose runs take too many evaluations on a system of one's own: their ladders of
            steps or tolerances end early.
        table: the cost of each method for each error, as text.
        winners: a `Winner` for each error of the table that says something, by computing time if that was asked for,
            or else by work.
        runs: all that was measured of each run, as `a3 chart --data` writes it.
    """

    def __init__(self, source: _a3.Chart, size: Tuple[int, int], sign: int) -> None:
        self._source, self._size, self._forms = source, size, {}
        self.error, until, self.complete = source.about()
        self.until = sign * until
        self.unit = _UNITS.get(self.error, "")
        self.too_costly: List[str] = source.too_costly()
        self.table = source.table()
        self.runs: List[Dict[str, Any]] = json.loads(source.json())
        for run in self.runs:
            run.update({key: sign * run[key] for key in ("until", "lost_at") if run[key] is not None})
        points = [self._point(run) for run in self.runs]
        self.points = [point for point, run in zip(points, self.runs) if run.get("beside") is None]
        self.winners = [Winner(error, points[k]) for error, k in source.winners()]

    def _point(self, run: Dict[str, Any]) -> Point:
        def number(key: str) -> float:
            value = run.get(key)
            return float("nan") if value is None else value

        return Point(
            run["solver"],
            run["setting"],
            number(f"error_{self.error}"),
            number(f"floor_{self.error}"),
            run["work"],
            run["evaluations"],
            number("seconds"),
            number("order"),
            number("lost_at"),
            run["stiffness"],
        )

    @property
    def methods(self) -> List[str]:
        """Names of the methods."""
        return list(dict.fromkeys(point.method for point in self.points))

    def of(self, method: MethodLike) -> Dict[str, np.ndarray]:
        """Returns the runs of a method: an array for each field of `Point`."""
        name = method_name(method)
        points = [point for point in self.points if point.method == name]
        if not points:
            raise InputError(f"the chart has no runs of {name}: it has those of {', '.join(self.methods)}")
        return {key: np.array([getattr(point, key) for point in points]) for key in Point._fields}

    def to_pandas(self) -> Any:
        """Returns the points as a `pandas.DataFrame`."""
        import pandas  # type: ignore[import-untyped]

        return pandas.DataFrame(self.points, columns=Point._fields)

    def __str__(self) -> str:
        return self.table

    def __repr__(self) -> str:
        return f"<Chart of {len(self.points)} runs of {', '.join(self.methods)} until {self.until:g} s>"


@dataclass(frozen=True)
class Choice:
    """A method that serves best, with its step or tolerance."""

    #: Name of the method.
    method: str
    #: Step (s), or relative tolerance of an adaptive method.
    setting: float
    #: Error of its run, in the unit of the error that counts.
    error: float
    #: Cost of its run, in evaluations of f, with linear algebra.
    work: float
    #: Computing time of a frame of 1/60 s (ms).
    milliseconds: float
    #: Why the setting is not larger: "accuracy", "stability" or "nothing", which was tried.
    set_by: str
    #: Command line that runs the scene so; `None` for scenes and methods that the program does not know.
    command: Optional[str]
    #: End of the run (s).
    until: float
    #: Error of the reference itself.
    floor: float
    #: The methods that are next best.
    others: List["Choice"] = field(default_factory=list, repr=False)
    #: Largest error at the ends of fixed steps, and of the states that a run returns at any time; `None` for `others`.
    error_at_steps: Optional[float] = None
    error_anywhere: Optional[float] = None


class Limits(NamedTuple):
    """The largest steps of a method on a scene (s); infinite if every step is stable, NaN where it is not known."""

    method: str
    #: By the modes at rest: with a longer step, a small motion about the rest grows.
    at_rest: float
    #: In runs from the start: the longest step that stayed bounded.
    in_motion: float
    #: The longest step of an accurate run.
    accurate: float


class Motion(NamedTuple):
    """A motion back and forth."""

    #: Angular frequency (rad/s).
    frequency: float
    #: Damping over that at which a push no longer swings back.
    damping_ratio: float


class Stability(_Drawn):
    """The largest steps of methods on a scene. A notebook shows the stable regions of the methods.

    Attributes:
        limits: a row for each method.
        fastest: the fastest motion at the start, a `Motion`; `None` if nothing moves back and forth.
        fastest_at_rest: the same at rest; `None` also where no state of rest is known.
        feedback: rate (1/s) at which errors of constraints decay; `None` without constraints.
        predictable: time (s) up to which the motion can be predicted; accurate steps are those of runs until then.
        table: the limits as text.
        complete: whether all was measured.
        data: all that was measured, as `a3 stability --data` writes it.
    """

    def __init__(self, source: _a3.Stability, size: Tuple[int, int], step: Optional[float]) -> None:
        self._source, self._size, self._step, self._forms = source, size, step, {}
        self.table = source.table()
        self.complete = source.complete()
        self.feedback, self.predictable = source.about()
        self.fastest, self.fastest_at_rest = (motion and Motion(*motion) for motion in source.fastest())
        self.data: List[Dict[str, Any]] = json.loads(source.json())
        self.limits = [self._limits(row) for row in self.data]

    @staticmethod
    def _limits(row: Dict[str, Any]) -> Limits:
        def seconds(value: Union[None, float, str]) -> float:
            return float("nan" if value is None else "inf" if value == "any" else value)

        moving = row["moving_bounded"]
        return Limits(
            row["solver"],
            seconds(row["rest_bounded"]),
            seconds(moving and moving["longest_held"]),
            seconds(row["moving_accurate"]),
        )

    def _draw(self, kind: str, size: Tuple[int, int]) -> bytes:
        return self._source.drawn(kind, size, self._step)

    def __getitem__(self, method: MethodLike) -> Limits:
        name = method_name(method)
        for limits in self.limits:
            if limits.method == name:
                return limits
        raise KeyError(name)

    def __str__(self) -> str:
        return self.table

    def __repr__(self) -> str:
        return f"<Stability of {', '.join(limits.method for limits in self.limits)}>"


@dataclass(frozen=True)
class ComparedRun:
    """A run of a comparison."""

    method: str
    #: Step (s), or relative tolerance of an adaptive method.
    setting: float
    #: States at the times of the comparison, up to a blow-up, (times, numbers), or (times, ...) of the shape of y0.
    states: np.ndarray
    #: Total energy (J) at these times, (times,); empty for scenes without forces.
    energies: np.ndarray
    #: Cost, in evaluations of f, with linear algebra.
    work: float
    #: Message of the blow-up, if there was one.
    blow_up: Optional[str]
    #: Its time (s).
    blew_up_at: Optional[float]
    _particles: int = 0

    @property
    def positions(self) -> np.ndarray:
        """Positions (m), (times, n, 3)."""
        n = self._particles
        return self.states[:, : 3 * n].reshape(-1, 3, n).transpose(0, 2, 1)


@dataclass(frozen=True)
class Comparison:
    """Runs of a scene at the same times."""

    #: Times (s), (frames + 1,).
    times: np.ndarray
    runs: List[ComparedRun]
    _particles: int = 0

    def distance(self, a: int = 0, b: int = 1) -> np.ndarray:
        """Returns the distance of run a from run b at each time that both reached: the root mean square over the
        particles (m) or, without particles, over the numbers of the state."""
        a_states, b_states = (run.states.reshape(len(run.states), -1) for run in (self.runs[a], self.runs[b]))
        frames = min(len(a_states), len(b_states))
        n = self._particles
        coordinates, count = (3 * n, n) if n else (a_states.shape[1], a_states.shape[1])
        apart = a_states[:frames, :coordinates] - b_states[:frames, :coordinates]
        return np.sqrt(np.sum(np.abs(apart) ** 2, axis=1) / count)

    def to_pandas(self) -> Any:
        """Returns the runs as a `pandas.DataFrame`: a row for each run and time, with method, setting, time (s), energy
        (J), and the numbers of the state as y0, y1, ..."""
        import pandas

        tables = []
        for run in self.runs:
            flat = run.states.reshape(len(run.states), -1)
            numbers = {f"y{k}": flat[:, k] for k in range(flat.shape[1])}
            energies = run.energies if len(run.energies) else np.full(len(run.states), np.nan)
            head = {"method": run.method, "setting": run.setting, "time": self.times[: len(run.states)]}
            tables.append(pandas.DataFrame({**head, "energy": energies, **numbers}))
        return pandas.concat(tables, ignore_index=True)

    def __repr__(self) -> str:
        names = ", ".join(f"{run.method} {run.setting:g}" for run in self.runs)
        return f"<Comparison of {names} until {self.times[-1]:g} s>"


def chart(
    scene: SceneLike,
    methods: Sequence[MethodLike] = (),
    *,
    until: Optional[float] = None,
    error: Optional[str] = None,
    particle: Optional[int] = None,
    component: Optional[int] = None,
    quantity: Optional[Derivative] = None,
    at_end: bool = False,
    work: str = "evaluations",
    spread: bool = False,
    stiffness: Sequence[float] = (1.0,),
    size: Tuple[int, int] = (800, 560),
    progress: bool = True,
    **options: Any,
) -> Chart:
    """Measures how accurate and how expensive methods are on a scene.

    Args:
        scene: scene as in `Simulation`.
        methods: names or letters, or `a3.Method`; by default all that support the scene.
        until: end of the runs (s), from 0.01 to 1000, or from 1e-15 to 1e15 for a system; below 0 for one of first
            order that goes back in time. By default as long as errors mean something on the scene.
        error: what counts as the error: "position" (m, root mean square over the particles), "energy" (J), "strain",
            "momentum" (kg m/s), "phase" (s), "penetration", "impact" (s); "state" of systems without particles.
        particle: the only particle whose position counts.
        component: the only number that counts, of a system without particles.
        quantity: function of t and y that returns a number, or an array, whose errors count in place of those of the
            state, of a system without particles; each is relative to the largest size that it has had.
        at_end: whether the error at the end counts, instead of the largest one.
        work: what counts as the cost: "evaluations" of f, the same on every machine, or "time" on this one.
        spread: whether adaptive methods also run at neighbouring tolerances, to show how much their errors vary.
        stiffness: factors of the stiffness of all springs, with a panel of the chart for each.
        size: width and height of the picture (px, 96 to the inch).
        progress: whether a bar shows the progress, if `tqdm` is installed.
        options: grid, wind, swing, self_collision and forces, as in `Simulation`.
    """
    names = _names(methods)
    measured, end, sign = _span(_measured(scene, quantity), until)
    scene_given = given(measured, **options)
    one = _only(scene, particle, component)
    timed = _timed(work)
    source = _work(
        lambda monitor: _a3.chart(
            scene_given, names, monitor, end, error, one, at_end, timed, spread, list(stiffness)
        ),
        progress,
    )
    return Chart(source, size, sign)


def choose(
    scene: SceneLike,
    error: Optional[float] = None,
    *,
    budget: Optional[float] = None,
    methods: Sequence[MethodLike] = (),
    of: Optional[str] = None,
    until: Optional[float] = None,
    particle: Optional[int] = None,
    component: Optional[int] = None,
    quantity: Optional[Derivative] = None,
    at_end: bool = False,
    work: str = "evaluations",
    progress: bool = True,
    **options: Any,
) -> Choice:
    """Chooses the cheapest method for an error, or the most accurate one for a budget.

    Args:
        scene: scene as in `Simulation`.
        error: largest error, in m or the unit of `of`.
        budget: computing time of a frame of 1/60 s (ms), in place of an error.
        methods: methods to choose among; by default all that support the scene.
        of: what counts as the error, as `error` of `chart`.
        until, particle, component, quantity, at_end, work, progress, options: as in `chart`.
    """
    names = _names(methods)
    measured, end, sign = _span(_measured(scene, quantity), until)
    scene_given = given(measured, **options)
    one = _only(scene, particle, component)
    timed = _timed(work)
    found, end, floor, shown, words = _work(
        lambda monitor: _a3.choose(
            scene_given, names, monitor, error, budget, of, end, one, at_end, timed
        ),
        progress,
    )
    if words:
        warnings.warn(words.strip(), stacklevel=2)
    others = [Choice(*row, sign * end, floor) for row in found[1:]]
    return Choice(*found[0], sign * end, floor, others, *shown)


def stability(
    scene: SceneLike,
    methods: Sequence[MethodLike] = (),
    *,
    step: Optional[float] = None,
    size: Tuple[int, int] = (800, 560),
    progress: bool = True,
    **options: Any,
) -> Stability:
    """Measures the largest stable and the largest accurate steps of methods on a scene.

    Args:
        scene: scene as in `Simulation`.
        methods: names or letters, or `a3.Method`; by default all that support the scene.
        step: step (s) for which the picture shows the motions of the scene; by default that in which the fastest one
            turns by a radian.
        size, progress, options: as in `chart`.
    """
    names = _names(methods)
    scene_given = given(_quiet(scene), **options)
    source = _work(lambda monitor: _a3.stability(scene_given, names, monitor), progress)
    return Stability(source, size, step)


def compare(
    scene: SceneLike,
    runs: Sequence[Union[MethodLike, Tuple[MethodLike, float]]],
    *,
    until: float,
    frames: int = 100,
    progress: bool = True,
    **options: Any,
) -> Comparison:
    """Runs a scene by several methods, and records their states at the same times.

    Args:
        scene: scene as in `Simulation`.
        runs: methods, or pairs of a method and its step (s) or tolerance.
        until: end of the runs (s).
        frames: number of equal parts of the time, at whose ends states are recorded.
        progress, options: as in `chart`.
    """
    asked = []
    for run in runs:
        method, value = run if isinstance(run, tuple) else (run, None)
        asked.append((_names([method])[0], value))
    scene_given = given(scene, **options)
    times, compared, particles, length = _work(
        lambda monitor: _a3.compare(scene_given, asked, monitor, until, frames), progress
    )
    layout = getattr(scene, "_layout", None)
    shaped = layout.shaped if layout else np.asarray
    of_runs = [
        ComparedRun(method, setting, shaped(states.reshape(-1, length)), energies, cost, blow_up, time, particles)
        for method, setting, states, energies, cost, blow_up, time in compared
    ]
    return Comparison(times, of_runs, particles)


def _quiet(scene: SceneLike) -> SceneLike:
    """Returns a system whose f warns of no overflow. Limits are sought by several threads, of which each has its own
    treatment of overflows, and runs that blow up are what is sought."""
    if not isinstance(scene, System):
        return scene
    quiet, f = copy.copy(scene), scene.f

    @functools.wraps(f)
    def called(*arguments: Any) -> Any:
        with np.errstate(all="ignore"):
            return f(*arguments)

    quiet.f = called
    return quiet


def _names(methods: Sequence[MethodLike]) -> List[str]:
    if isinstance(methods, (str, Method)):
        methods = [methods]
    return [method_name(method) for method in methods]


def _only(scene: SceneLike, particle: Optional[int], component: Optional[int]) -> Optional[int]:
    """Returns the only particle or number whose error counts."""
    is_plain = isinstance(scene, System) and scene.masses is None
    wrong, right = ("particle", "component") if is_plain else ("component", "particle")
    for name, value in (("particle", particle), ("component", component)):
        if value is not None and name == wrong:
            kind = "plain numbers" if is_plain else "particles"
            raise InputError(f"{wrong}: {getattr(scene, 'name', scene)} has {kind}: give {right}={value}")
        if isinstance(value, bool) or value is not None and value < 0:
            raise InputError(f"{name}: a number from 0 is expected, not {value}")
    if component is not None and np.iscomplexobj(getattr(scene, "y0", None)):
        raise InputError(f"component: the numbers are complex: give quantity=lambda t, y: y[{component}]")
    return component if is_plain else particle


def _measured(scene: SceneLike, quantity: Optional[Derivative]) -> SceneLike:
    """Returns a scene whose states are compared by a quantity, if there is one."""
    if quantity is None:
        return scene
    if not isinstance(scene, System) or scene.masses is not None:
        raise InputError(f"quantity: {getattr(scene, 'name', scene)} has particles: give error=, or particle=")
    return scene._measured_by(quantity)


def _span(scene: SceneLike, until: Optional[float]) -> Tuple[SceneLike, Optional[float], int]:
    """Returns a scene, the length of its runs, and -1 if they go back in time, otherwise 1."""
    if until is None or not until < 0 or not isinstance(scene, System):
        return scene, until, 1
    return scene._reversed("until"), -until, -1


def _timed(work: str) -> bool:
    if work not in ("evaluations", "time"):
        raise InputError(f"work is evaluations or time, not {work}")
    return work == "time"
