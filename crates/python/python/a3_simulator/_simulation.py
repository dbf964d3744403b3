"""Runs of scenes."""

from __future__ import annotations

import contextlib
import re
from typing import TYPE_CHECKING, Any, Callable, Dict, Iterator, NamedTuple, Optional, Sequence, Tuple, Union

import numpy as np

from . import _a3
from ._errors import BlowUp, Error, InputError
from ._given import given
from ._own import Forces, Method, System, _name, _numbers, method_name
from ._progress import progress_bar
from ._scenes import SceneLike

if TYPE_CHECKING:
    from ._picture import Picture


class Energy(NamedTuple):
    """Energy of a state by kind (J)."""

    kinetic: float
    #: Of springs, bent arcs, solids and compressed fluid.
    elastic: float
    #: Of the repulsion of surfaces that are nearer than their thickness.
    contact: float
    #: Zero at the origin.
    gravitational: float

    @property
    def total(self) -> float:
        """Sum of all kinds (J)."""
        return sum(self)


class Work(NamedTuple):
    """Cost of the steps of a run."""

    #: Evaluations of f(t, y) or of the forces.
    evaluations: int
    #: Linear systems solved.
    solves: int
    #: Matrices factorised.
    factorizations: int
    #: Steps of an adaptive method that were rejected.
    rejections: int
    #: Total cost with the linear algebra, in evaluations: the same number on every machine.
    total: float


class Springs(NamedTuple):
    """All m springs of a run."""

    #: Particles at both ends, (m, 2).
    ends: np.ndarray
    #: "structural", "shear" or "bend", (m,).
    kind: np.ndarray
    #: k (N/m), (m,).
    stiffness: np.ndarray
    #: r (m), (m,).
    rest_length: np.ndarray
    #: c (N s/m), (m,).
    damping: np.ndarray
    #: L (m), (m,).
    length: np.ndarray
    #: Pull k (L - r) + c L' (N), (m,): above 0 where a spring pulls its ends together.
    force: np.ndarray

    @property
    def strain(self) -> np.ndarray:
        """L / r - 1, (m,)."""
        with np.errstate(divide="ignore", invalid="ignore"):
            return self.length / self.rest_length - 1.0


class Simulation(_a3.Run):
    """The run of a scene by a method.

    Args:
        scene: name of a built-in scene (`a3.scenes()` lists them), path of a file (TOML, JSON or a mesh), text in
            TOML, dict of the keys of a scene file (`a3.scene(name)` returns one), or `a3.System`.
        method: name or letter of a method (`a3.methods()` lists them), or an `a3.Method`; by default that of the
            scene, or else the explicit trapezoid. For a system, it is "dop853".
        step: length of the steps (s); by default that of the scene or of the method.
        tolerance: relative tolerance of an adaptive method, in place of a step.
        grid: rows and columns of the first cloth, in place of its own.
        wind, swing, self_collision: whether the wind blows, the pins swing, and surfaces touch one another and
            themselves, in a scene that has them and in which they are off at the start.
        absolute: error of positions (m) that a step of an adaptive method may make; by default the tolerance times
            the radius of the scene.
        max_step: longest step of an adaptive method (s).
        forces: functions of one's own, each of the time t (s), the positions x (m), (n, 3), and the velocities v
            (m/s), (n, 3), that return forces (N), (n, 3), to be added to those of the scene. They depend on t, x and
            v alone. Implicit methods hold them constant within an iteration.
        backward: whether a system y' = f(t, y) goes back in time: its times are then 0 and below.

    Raises:
        InputError: there is no such scene or method, a key of the scene has a fault, or the method does not support
            the scene.

    The run computes whole steps. If a time is within a step, the state there is interpolated, so how often a run is
    read changes no bit of it. The global lock is free while it computes.
    """

    #: The arguments, to make the run again.
    _given: Tuple[tuple, Dict[str, Any]]
    #: -1 of a run that goes back in time, otherwise 1.
    _sign: int
    #: How the state is an array of flat numbers; `None` if it is one.
    _layout: Any

    def __new__(  # type: ignore[misc]
        cls,
        scene: SceneLike,
        method: Union[str, Method, None] = None,
        step: Optional[float] = None,
        tolerance: Optional[float] = None,
        *,
        grid: Optional[Tuple[int, int]] = None,
        wind: bool = False,
        swing: bool = False,
        self_collision: bool = False,
        absolute: Optional[float] = None,
        max_step: Optional[float] = None,
        forces: Sequence[Forces] = (),
        backward: bool = False,
    ) -> "Simulation":
        name = None if method is None else method_name(method)
        run_scene = scene
        if backward:
            if not isinstance(scene, System):
                raise InputError("backward: only a system y' = f(t, y) goes back in time")
            run_scene = scene._reversed("backward")
        given_scene = given(
            run_scene, grid=grid, wind=wind, swing=swing, self_collision=self_collision, forces=forces
        )
        kind = _Backward if backward and cls is Simulation else cls
        run: Any = super().__new__(kind, given_scene, name, step, tolerance, absolute, max_step)
        options = {
            "grid": grid,
            "wind": wind,
            "swing": swing,
            "self_collision": self_collision,
            "absolute": absolute,
            "max_step": max_step,
            "forces": forces,
            "backward": backward,
        }
        run._sign, run._layout = -1 if backward else 1, getattr(scene, "_layout", None)
        run._given = (scene, method, step, tolerance), options
        return run

    def __reduce__(self) -> Any:
        given, options = self._given
        return _restored, (given, options, self.checkpoint())

    def advance_to(self, time: float, progress: bool = False) -> None:
        """Advances to a time (s).

        Args:
            time: from the present time of the run on (s).
            progress: whether a bar shows the progress, if `tqdm` is installed.

        Raises:
            BlowUp: the run blew up. It is then back at its last sound state.
            InputError: the run is past that time, or the time is not finite.
        """
        ends = self._passed(self.time), self._ahead(time)
        with progress_bar(progress, *ends) as report, self._told():
            super().advance(ends[1], report)

    def advance(self, time: float, progress: Optional[Callable[[float], object]] = None) -> None:
        """Advances to a time (s). A function `progress` is called with the time now and then."""
        sign = self._sign

        def report(gone: float) -> object:
            return progress(sign * gone) if progress else None

        with self._told():
            super().advance(self._ahead(time), progress if sign > 0 or not callable(progress) else report)

    def advance_until(self, function: Callable[[float, Any], float], time: float, direction: int = 0) -> bool:
        """Advances to the first time at which a function of t and the state passes through 0, or else to a time (s).

        The time is found on the method's own polynomial, to rounding. Returns whether it was found; the state is then
        that just after it. A direction above 0 is a passage from below, one below 0 from above: as the run goes, also
        where it goes back in time.
        """
        layout, sign = self._layout, self._sign

        def seen(t: float, y: Any) -> float:
            return function(sign * t, layout.shaped(y) if layout else y)

        seen.__name__ = _name(function, "the function")
        is_as_seen = layout is None and sign > 0 or not callable(function)
        with self._told():
            return super().advance_until(function if is_as_seen else seen, self._ahead(time), direction)

    def set_state(self, state: Any, time: Optional[float] = None) -> None:
        """Continues from another state of a system of one's own, at another time or this one."""
        layout = self._layout
        if layout:
            flat = layout.flat(_numbers("state", state, layout.shape, layout.kind.type))
        else:
            flat = _numbers("state", state, (-1,))
        super().set_state(flat, None if time is None else self._passed(time))

    @property
    def time(self) -> float:
        """The simulated time (s)."""
        return self._sign * super().time + 0.0

    @property
    def state(self) -> Any:
        """State y: all x, all y and all z (m), then the velocities (m/s) in the same order; then the rotations and angular
        momenta of rigid bodies. Of a system of first order, its own numbers, in their shape."""
        flat = super().state
        return self._layout.shaped(flat) if self._layout else flat

    def _passed(self, time: float) -> float:
        """Returns how far a time is from 0, in the direction of the run."""
        if self._sign < 0 and not -1e15 <= time <= 0:
            raise InputError(f"the run goes back in time: a time is from -1e15 to 0, such as -10, not {time}")
        return self._sign * time

    def _ahead(self, time: float) -> float:
        """Returns how far a time is from 0, to which the run can advance."""
        passed = self._passed(time)
        if self._sign < 0 and time > self.time:
            raise InputError(
                f"the run is at t = {self.time} s already, past {time} s: reset() goes back to its beginning"
            )
        return passed

    @contextlib.contextmanager
    def _told(self) -> Iterator[None]:
        """Tells the time of a failure as that of the run."""
        try:
            yield
        except Error as lost:
            if self._sign > 0 or type(lost) not in (BlowUp, Error):
                raise
            # A time of 0 has no sign.
            words = re.sub(r"\bt = (?=[0.]*[1-9])", "t = -", str(lost), count=1)
            if isinstance(lost, BlowUp):
                raise BlowUp(words, lost.step, -lost.time, lost.particle) from None
            raise Error(words) from None

    def states_at(self, times: Sequence[float], progress: bool = False) -> np.ndarray:
        """Advances to each of these times (s), and returns the states there, (times, numbers); for a state of another
        shape, (times, ...) of it.

        Args:
            times: in their order, from the present time of the run on (s).
            progress: whether a bar shows the progress, if `tqdm` is installed.

        Raises:
            BlowUp, InputError: as `advance_to` does.
        """
        states = []
        for time in times:
            self.advance_to(time, progress)
            states.append(self.state)
        return np.array(states).reshape(len(states), *self.state.shape)

    @property
    def energy(self) -> Optional[Energy]:
        """Energy by kind (J); `None` if the scene has no forces."""
        energies = self.energies()
        return None if energies is None else Energy(*energies)

    @property
    def work(self) -> Work:
        """Cost of the steps so far."""
        return Work(*self.work_done())

    @property
    def springs(self) -> Springs:
        """All springs as they are now; broken ones are left out."""
        ends, kind, stiffness, rest_length, damping = self.spring_data()
        x, v = self.positions, self.velocities
        i, j = ends[:, 0], ends[:, 1]
        apart, moving = x[j] - x[i], v[j] - v[i]
        length = np.linalg.norm(apart, axis=1)
        with np.errstate(divide="ignore", invalid="ignore"):
            rate = np.where(length > 0.0, np.einsum("ij,ij->i", apart, moving) / length, 0.0)
        force = stiffness * (length - rest_length) + damping * rate
        return Springs(ends, np.array(kind, dtype="U10"), stiffness, rest_length, damping, length, force)

    def render(self, width: int = 960, height: int = 540, **look: Any) -> "Picture":
        """Draws the run as it is. `a3.render` lists the options of its look."""
        from ._picture import Picture

        return Picture(self.picture(width, height, **look))

    def _repr_png_(self) -> bytes:
        return self.render().png

    def __repr__(self) -> str:
        setting = "tolerance" if self.adaptive else "step"
        return f"<Simulation {self.scene} by {self.method}, {setting} {self.setting:g}: t = {self.time:g} s>"


class _Backward(Simulation):
    """A run that goes back in time. Others take their steps without this call, which short steps would feel."""

    def step(self, count: int = 1) -> None:
        """Takes steps. If the present time is within a step, that step is finished first, and counts."""
        with self._told():
            super().step(count)


def _restored(given: tuple, options: Dict[str, Any], checkpoint: bytes) -> Simulation:
    """Makes a pickled run again, which continues with the same bits."""
    run = Simulation(*given, **options)
    run.restore(checkpoint)
    return run
