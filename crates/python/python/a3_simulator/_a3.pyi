"""The compiled part. Its users are the modules beside it."""

from typing import Callable, List, Optional, Sequence, Tuple

import numpy as np
import numpy.typing as npt

from ._given import Given

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

def main(args: Sequence[str]) -> int:
    """Runs the program with these arguments, of which the first is its name, and returns its exit code."""

def scenes() -> List[str]: ...
def methods() -> List[Tuple[str, Optional[str], str, int, bool, float]]: ...
def table(kind: str, text: str) -> str: ...

def add_method(
    name: str, step: Callable[..., npt.ArrayLike], order: int, evaluations: int, default_step: float
) -> None: ...

def add_adaptive(
    name: str, step: Callable[..., npt.ArrayLike], order: int, evaluations: int, degree: int
) -> None: ...

def add_tableau(
    name: str, a: List[List[float]], b: List[float], b_hat: Optional[List[float]], within: List[List[float]]
) -> int: ...

def add_foreign(name: str, solve: Callable[..., npt.ArrayLike]) -> None: ...

class Derivative:
    """The function f that a step gets."""

    def __call__(self, t: float, y: npt.ArrayLike) -> Floats:
        """Returns the derivative f(t, y) of the state y at time t (s), (n,)."""

class Monitor:
    """Companion of long work, which another thread watches and can stop."""

    def __new__(cls) -> "Monitor": ...
    def stop(self) -> None: ...
    def threads(self) -> List[int]: ...
    def look(self) -> Tuple[str, float, List[str]]: ...

class Chart:
    def json(self) -> str: ...
    def table(self) -> str: ...
    def winners(self) -> List[Tuple[float, int]]: ...
    def too_costly(self) -> List[str]: ...
    def about(self) -> Tuple[str, float, bool]: ...
    def drawn(self, kind: str, size: Tuple[int, int]) -> bytes: ...

class Stability:
    def json(self) -> str: ...
    def table(self) -> str: ...
    def complete(self) -> bool: ...
    def fastest(self) -> List[Optional[Tuple[float, float]]]: ...
    def about(self) -> Tuple[Optional[float], float]: ...
    def drawn(self, kind: str, size: Tuple[int, int], step: Optional[float]) -> bytes: ...

def chart(
    given: Given,
    methods: Sequence[str],
    monitor: Monitor,
    until: Optional[float],
    error: Optional[str],
    particle: Optional[int],
    at_end: bool,
    timed: bool,
    spread: bool,
    stiffness: Sequence[float],
) -> Chart: ...
def choose(
    given: Given,
    methods: Sequence[str],
    monitor: Monitor,
    error: Optional[float],
    budget: Optional[float],
    of: Optional[str],
    until: Optional[float],
    particle: Optional[int],
    at_end: bool,
    timed: bool,
) -> Tuple[List[Tuple[str, float, float, float, float, str, Optional[str]]], float, float, List[float], str]: ...
def stability(given: Given, methods: Sequence[str], monitor: Monitor) -> Stability: ...
def compare(
    given: Given,
    runs: Sequence[Tuple[str, Optional[float]]],
    monitor: Monitor,
    until: float,
    frames: int,
) -> Tuple[Floats, List[Tuple[str, float, Floats, Floats, float, Optional[str], Optional[float]]], int, int]: ...

def judge(
    given: Given,
    monitor: Monitor,
    file: Optional[str],
    archive: Optional[Tuple[str, bytes]],
    until: Optional[float],
    step: Optional[float],
    within: Optional[float],
) -> Tuple[str, str]: ...

class Simplified:
    def has_chart(self) -> bool: ...
    def text(self) -> str: ...
    def json(self) -> str: ...
    def drawn(self, kind: str, size: Tuple[int, int]) -> bytes: ...

def simplify(
    given: Given,
    monitor: Monitor,
    error: float,
    of: str,
    until: Optional[float],
    particle: Optional[int],
    at_end: bool,
    data: Optional[str],
    chart: bool,
) -> Simplified: ...

class Run:
    """The run of a scene by a method."""

    def __new__(
        cls,
        given: Given,
        method: Optional[str],
        step: Optional[float],
        tolerance: Optional[float],
        absolute: Optional[float],
        max_step: Optional[float],
    ) -> "Run": ...
    def step(self, count: int = 1) -> None:
        """Takes steps. If the present time is within a step, that step is finished first, and counts."""
    def advance(self, time: float, progress: Optional[Callable[[float], object]] = None) -> None: ...
    def advance_until(
        self, function: Callable[[float, Floats], float], time: float, direction: int = 0
    ) -> bool: ...
    def set_state(self, state: Sequence[float], time: Optional[float] = None) -> None: ...
    def reset(self) -> None:
        """Goes back to the beginning, and mends torn springs."""
    def checkpoint(self) -> bytes:
        """Returns the run as it is now, to continue from with the same bits."""
    def restore(self, checkpoint: bytes) -> None:
        """Continues from a checkpoint of the same scene, also after a blow-up."""
    def toggle_pin(self, particle: int) -> bool:
        """Pins a particle where it is, or releases it; returns whether it is pinned then."""
    def grab(self, particle: int) -> None:
        """Grabs a particle with the hand."""
    def pull(self, point: Sequence[float]) -> None:
        """Moves the hand to a point (m); a critically damped spring pulls the grabbed particle there."""
    def release(self) -> None:
        """Lets go of the grabbed particle."""
    @property
    def scene(self) -> str:
        """Name of the scene."""
    @property
    def method(self) -> str:
        """Name of the method."""
    @property
    def setting(self) -> float:
        """Step (s), or relative tolerance of an adaptive method."""
    @property
    def adaptive(self) -> bool:
        """Whether the method chooses its steps to a tolerance."""
    @property
    def step_size(self) -> Optional[float]:
        """Length of the steps (s): of an adaptive method, of the last one, if there was one."""
    @property
    def duration(self) -> Optional[float]:
        """Length of a run of the scene (s), if the scene says so."""
    @property
    def time(self) -> float:
        """Simulated time (s)."""
    @property
    def steps(self) -> int:
        """Number of steps since the beginning."""
    @property
    def state(self) -> Floats:
        """State y: all x, all y and all z (m), then the velocities (m/s) in the same order; then the rotations and
        angular momenta of rigid bodies. Of a system of first order, its own numbers."""
    @property
    def positions(self) -> Floats:
        """Positions (m), (n, 3)."""
    @property
    def velocities(self) -> Floats:
        """Velocities (m/s), (n, 3)."""
    @property
    def contact_forces(self) -> Optional[Floats]:
        """Forces of obstacles and surfaces on the particles (N), (n, 3); `None` if nothing can touch."""
    @property
    def masses(self) -> Optional[Floats]:
        """Masses (kg), (n,); `None` if the scene has none."""
    @property
    def pinned(self) -> Ints:
        """Numbers of the pinned particles."""
    @property
    def triangles(self) -> Ints:
        """Corners of the triangles of surfaces, (m, 3)."""
    def work_done(self) -> Tuple[int, int, int, int, float]: ...
    def energies(self) -> Optional[List[float]]: ...
    def spring_data(self) -> Tuple[Ints, List[str], Floats, Floats, Floats]: ...
    def picture(
        self,
        width: int,
        height: int,
        *,
        colour: Optional[str] = None,
        arrows: Optional[str] = None,
        wireframe: bool = False,
        springs: bool = False,
        orthographic: bool = False,
        dark: bool = False,
        transparent: bool = False,
    ) -> bytes: ...
