"""Own systems and own methods: functions that a3 calls."""

from __future__ import annotations

import copy
import functools
import math
from typing import Any, Callable, Optional, Sequence, Tuple, Type, Union

import numpy as np
import numpy.typing as npt

from . import _a3
from ._errors import InputError

#: Most numbers of a state whose Jacobian may be an array: of more, a3 takes a sparse matrix or differences.
_MOST_FULL = 1024

Floats = npt.NDArray[np.float64]
#: f(t, y): the derivative of the state y at time t, of the shape of y.
Derivative = Callable[[float, Floats], npt.ArrayLike]
#: F(t, x, v): the forces (N), (n, 3), at time t (s) on particles at x (m), (n, 3), that move at v (m/s), (n, 3).
Forces = Callable[[float, Floats, Floats], npt.ArrayLike]
#: E(t, x, v): the total energy (J).
Energy = Callable[[float, Floats, Floats], float]
#: step(f, t, y, h): the state at t + h, of the shape of y, from the state y at time t (s).
Step = Callable[[Callable[[float, npt.ArrayLike], Floats], float, Floats, float], npt.ArrayLike]
#: solve(f, times, y0, tol): the states at these times, a row for each, from the state y0 at time 0.
Solve = Callable[[Callable[[float, npt.ArrayLike], Floats], Floats, Floats, float], npt.ArrayLike]


class System:
    """A system of first order, y' = f(t, y) or M y' = f(t, y), with the state from which it starts.

    Args:
        f: function of the time t and the state y, an array (n,), that returns y', an array (n,). The result depends on
            t and y alone.
        y0: state at t = 0, (n,), or an array of any other shape, also of complex numbers: y and y' have that shape
            then, and so have the states of runs.
        name: name, for charts and errors; by default that of f.
        scale: least size to which the errors of adaptive methods are relative, one for all numbers or (n,). By default
            an error is relative to the largest size that its number has had, and a billionth of that of the largest
            number of y0 is allowed besides.
        jac: function of t and y that returns the Jacobian df/dy, (n, n), for stiff methods and stability: an array or,
            of any number of numbers, a sparse matrix of SciPy. Of y0 of another shape, n is its size, and numbers are
            in C order. Without it, differences of f are taken; in place of an array of a system of more than 1024
            numbers they are, too. Of complex numbers, `jac` is df/dz, an array, for f that has one (not of |z| or
            conj(z)); real and imaginary parts are compared as numbers of their own.
        sparsity: which numbers act on which, so that few differences are taken: a sparse matrix of SciPy or an array,
            (n, n), that is 0 where the Jacobian always is, or pairs of rows and columns, (k, 2); of two numbers,
            integers are pairs. By default it is found by some evaluations, of which it spares most.
        mass: constant matrix M of a system M y' = f(t, y), (n, n), an array or a sparse matrix of SciPy, or its diagonal,
            (n,). It may be singular: the equations without a derivative then determine the numbers that the others
            leave open (index 1). Only "radau" and "bdf" solve such systems. Where y0 does not satisfy the equations
            without a derivative, the first step starts from near values that do, with the same M y.
        args: further arguments of f and jac, after t and y.
        tstops: times at which f or one of its derivatives jumps: a step of each of a3's methods ends there.
            f at such a time is that after the jump, so compare t with the same numbers.

    Where a scene is expected, a system can stand. Arrays that f gets are its own: it may keep or change them. Methods of
    one's own and of other libraries get states as flat real numbers: the real and the imaginary part of each in turn.
    """

    #: How the state is an array of flat real numbers; `None` if it is one.
    _layout: Optional["_Layout"] = None
    #: Whether runs go back in time.
    _backward = False
    #: Masses (kg), (n,), of a system of particles.
    masses: Optional[Floats] = None
    #: Whether forces depend on positions and time alone.
    positional = False
    #: Function that returns the energy, if there is one.
    _energy: Optional[Energy] = None
    #: Function that returns the Jacobian, if there is one.
    _jac: Optional["_Full"] = None
    #: Least size of each number to which errors are relative; empty where it is derived.
    _scales: Sequence[float] = ()
    #: Row and column of each entry of the Jacobian that may differ from 0; empty where they are found.
    _sparsity: Sequence[Tuple[int, int]] = ()
    #: Row, column and value of each entry of the mass matrix; empty where it is 1.
    _mass: Sequence[Tuple[int, int, float]] = ()
    #: Times at which f jumps.
    _jumps: Sequence[float] = ()
    #: Number of quantities by which states are compared, and the function that returns them; 0 for the state's numbers.
    _quantities: Tuple[int, Optional[Derivative]] = (0, None)

    def __init__(
        self,
        f: Derivative,
        y0: npt.ArrayLike,
        *,
        name: Optional[str] = None,
        scale: Optional[npt.ArrayLike] = None,
        jac: Optional[Derivative] = None,
        sparsity: Any = None,
        mass: Any = None,
        args: Sequence[Any] = (),
        tstops: npt.ArrayLike = (),
    ) -> None:
        self.f: Union[Derivative, Forces] = _with(args, f)
        if jac is not None and not callable(jac):
            raise InputError(f"jac: a function is expected, not {type(jac).__name__}")
        slopes = None if jac is None else _with(args, jac)
        kind = complex if np.iscomplexobj(y0) else float
        self.y0 = _numbers("y0", y0, None, kind)
        if self.y0.size == 0:
            raise InputError("y0: a system has at least one number")
        self.name = name or _name(f, "system")
        self._state = self.y0
        if self.y0.ndim != 1 or kind is complex:
            self._layout = layout = _Layout(self.y0)
            self._state = layout.flat(self.y0)
            self.f = _OfState(self.f, layout, layout.flat)
            slopes = slopes and _OfState(slopes, layout, layout.square)
        self._jac = slopes and _Full(slopes)
        self._jumps = _numbers("tstops", tstops, (-1,))
        if sparsity is not None:
            self._sparsity = _places(sparsity, self.y0.size, self._state.size // self.y0.size)
        if mass is not None:
            self._mass = _mass_entries(mass, self.y0.size, kind)
        if scale is not None:
            same = np.broadcast_to(scale, self.y0.shape) if np.ndim(scale) == 0 else scale
            self._scales = _numbers("scale", same, self.y0.shape).repeat(self._state.size // self.y0.size)
            if not (self._scales > 0).all():
                raise InputError("scale: a size is a number above 0")

    @classmethod
    def of_particles(
        cls,
        forces: Forces,
        masses: npt.ArrayLike,
        positions: npt.ArrayLike,
        velocities: Optional[npt.ArrayLike] = None,
        *,
        positional: bool = False,
        energy: Optional[Energy] = None,
        name: Optional[str] = None,
        args: Sequence[Any] = (),
    ) -> "System":
        """Returns a system of second order, M x'' = F(t, x, v).

        Args:
            forces: function of the time t (s), the positions x (m), (n, 3), and the velocities v (m/s), (n, 3), that
                returns the forces (N), (n, 3).
            masses: masses (kg), (n,).
            positions: positions at t = 0 (m), (n, 3).
            velocities: velocities at t = 0 (m/s), (n, 3); by default 0.
            positional: whether the forces do not depend on v. Verlet's and Nystroem's methods then take fewer
                evaluations.
            energy: function of t, x and v that returns the total energy (J), for charts and choices of its error.
            name: name, for charts and errors; by default that of `forces`.
            args: further arguments of `forces` and `energy`, after t, x and v.
        """
        system = cls.__new__(cls)
        system.f = _with(args, forces)
        system.masses = _numbers("masses", masses, (-1,))
        shape = (system.masses.size, 3)
        x = _numbers("positions", positions, shape)
        v = np.zeros(shape) if velocities is None else _numbers("velocities", velocities, shape)
        system.positional = positional
        system._energy = None if energy is None else _with(args, energy)
        system.name = name or _name(forces, "system")
        system.y0 = system._state = np.concatenate([x.T.ravel(), v.T.ravel()])
        return system

    def _entries(self) -> Optional["_Entries"]:
        """Returns the Jacobian as a function that returns rows, columns and values, if it is a sparse matrix."""
        jac: Any = self._jac
        size = self._state.size
        try:
            is_sparse = hasattr(jac.function(0.0, self._state.copy()), "tocoo")
        except Exception:
            # It will come out where the Jacobian is used: beyond this size, only a sparse one is.
            is_sparse = size > _MOST_FULL
        return _Entries(jac.function, size) if is_sparse else None

    def _measured_by(self, quantity: Derivative) -> "System":
        """Returns this system with states that are compared by a number, or an array, of t and y."""
        if not callable(quantity):
            raise InputError(f"quantity: a function is expected, not {type(quantity).__name__}")

        def ravel(found: npt.ArrayLike, name: str) -> Floats:
            flat = np.ravel(found)
            return flat.astype(complex).view(float) if np.iscomplexobj(flat) else flat

        flat = _OfState(quantity, self._layout, ravel, "quantity")
        measured = copy.copy(self)
        measured._quantities = (flat(0.0, self._state.copy()).size, flat)
        return measured

    def _reversed(self, what: str) -> "System":
        """Returns this system with the time reversed: its time t is -t of this one. `what` asks for that."""
        if self.masses is not None:
            raise InputError(f"{what}: only a system y' = f(t, y) goes back in time: {self.name} has particles")
        back = copy.copy(self)
        back._backward, back.name = True, f"{self.name} backward"
        return back

    def __repr__(self) -> str:
        return f"<System {self.name} of {self.y0.size} numbers>"


class Method:
    """A method of one's own, which charts and runs take where a name of a method is expected.

    Args:
        name: a word that no method of a3 has.
        step: function of f, the time t (s), the state y, (n,), and the step h (s), that returns the state at t + h,
            (n,). f(t, y) is the derivative, (n,); it may be called at any time and state. For particles the state is
            all x, all y, all z (m), and then the velocities (m/s) in the same order.
            A class is called without arguments when a run begins, and its instance is the step of that run: a
            multistep method keeps its past there. It has to see whether t and h go on from its last step: a3 takes a
            step again where an event or a shown state lies within it, and `stability` measures single steps.
        order: the error of a run falls as h to this power. By default it is measured, by a few steps of logistic
            growth.
        default_step: step of runs for which none is given (s).
        adaptive: whether `step` is a function that returns the state at t + h and an estimate of its error, each (n,).
            The method then chooses its steps to a tolerance; between their ends, states are on the cubic through both.
        degree: degree d of the method's own polynomial within a step, in place of that cubic: `step` then returns
            besides the arrays q_1, ..., q_d, so (2 + d, n) in all, with which the state at t + theta h is
            y + theta q_1 + theta^2 q_2 + ... . Their sum is the change of y in the step.

        def step(f, t, y, h):
            k = f(t, y)
            return y + h * f(t + h / 2, y + h / 2 * k)

        a3.chart("pendulum", methods=["rk4", a3.Method("mine", step)])
    """

    def __init__(
        self,
        name: str,
        step: Union[Step, Type[Step]],
        order: Optional[int] = None,
        *,
        default_step: float = 1e-3,
        adaptive: bool = False,
        degree: int = 0,
    ) -> None:
        if not callable(step):
            raise InputError(f"step: a function of f, t, y and h is expected, not {type(step).__name__}")
        if not (math.isfinite(default_step) and default_step > 0):
            raise InputError(f"default_step is a number of seconds above 0, such as 0.01, not {default_step}")
        if adaptive and default_step != 1e-3:
            raise InputError("default_step: a method with adaptive=True takes a tolerance")
        if adaptive and isinstance(step, type):
            raise InputError("step: with adaptive=True a function is expected, not a class")
        if degree < 0 or degree and not adaptive:
            raise InputError(f"degree is at least 1, of a method with adaptive=True, not {degree}")
        self.name, self.step = name, step
        self._options = {"default_step": default_step, "adaptive": adaptive, "degree": degree}
        rows = 2 + degree if adaptive else 0
        self.order, evaluations = _measure(step, name, rows) if order is None else (order, order)
        if adaptive:
            _a3.add_adaptive(name, step, self.order, evaluations, degree)
        else:
            _a3.add_method(name, step, self.order, evaluations, default_step)

    @staticmethod
    def tableau(
        name: str,
        A: npt.ArrayLike,
        b: npt.ArrayLike,
        b_hat: Optional[npt.ArrayLike] = None,
        c: Optional[npt.ArrayLike] = None,
        P: Optional[npt.ArrayLike] = None,
    ) -> "Method":
        """Returns the explicit Runge-Kutta method of a Butcher tableau, as fast as those of a3.

        Args:
            name: a word that no method of a3 has.
            A: weights of the stages, (s, s), 0 from the diagonal on.
            b: weights of the result, (s,).
            b_hat: weights of another result, (s,), or (s + 1,) with that of f at the end of the step. The difference
                of both estimates the error, and the method chooses its steps to a tolerance.
            c: times of the stages, (s,), which are the sums of the rows of A.
            P: weights of the powers of theta, from the first on, in the state at t + theta h, (s, d) or (s + 1, d), as
                SciPy's solvers have them: y + h sum of P_ij theta^j k_i. Without them, states between the ends of a
                step are on the cubic through both.

        The order follows from the tableau.
        """
        return _Tableau(name, A, b, b_hat, c, P)

    def __reduce__(self) -> Any:
        make = functools.partial(Method, **self._options)
        return make, (self.name, self.step, self.order)

    def __repr__(self) -> str:
        return f"<Method {self.name} of order {self.order}>"


class _Tableau(Method):
    """An explicit Runge-Kutta method of a tableau."""

    def __init__(
        self,
        name: str,
        A: npt.ArrayLike,
        b: npt.ArrayLike,
        b_hat: Optional[npt.ArrayLike],
        c: Optional[npt.ArrayLike],
        P: Optional[npt.ArrayLike],
    ) -> None:
        rows, weights = _numbers("A", A, (-1, -1)), _numbers("b", b, (-1,))
        other = None if b_hat is None else _numbers("b_hat", b_hat, (-1,))
        if c is not None:
            times, sums = _numbers("c", c, (len(rows),)), rows.sum(axis=1)
            if (wrong := np.abs(times - sums) > 1e-9).any():
                i = int(wrong.argmax())
                raise InputError(f"c: stage {i} is at {times[i]}, but row {i} of A sums to {sums[i]}")
        within = [] if P is None else _numbers("P", P, (-1, -1)).tolist()
        self.name, self._given = name, (A, b, b_hat, c, P)
        hat = None if other is None else other.tolist()
        self.order = _a3.add_tableau(name, rows.tolist(), weights.tolist(), hat, within)

    def __reduce__(self) -> Any:
        return Method.tableau, (self.name, *self._given)


class _Foreign(Method):
    """A solver of another library."""

    def __init__(self, name: str, solve: Solve) -> None:
        if not callable(solve):
            raise InputError(f"solve: a function of f, times, y0 and tol is expected, not {type(solve).__name__}")
        self.name, self.step = name, solve
        _a3.add_foreign(name, self._states)

    def _states(self, f: Any, times: Floats, y0: Floats, tol: float) -> Floats:
        found = np.asarray(self.step(f, times, y0, tol))
        one = found[np.newaxis] if found.ndim == 1 and len(times) == 1 else found
        if one.ndim == 2 and one.shape[1] == len(y0) and len(one) < len(times):
            # The solver gave up before the end.
            one = np.concatenate([one, np.full((len(times) - len(one), len(y0)), np.nan)])
        if one.shape != (len(times), len(y0)):
            ends = found.shape == y0.shape and "; for the end alone, chart with at_end=True" or ""
            raise InputError(
                f"{self.name} returned an array of shape {found.shape}, where a row of {len(y0)} numbers for each of "
                f"{len(times)} times is expected{ends}"
            )
        return one.ravel()

    def __reduce__(self) -> Any:
        return foreign, (self.name, self.step)

    def __repr__(self) -> str:
        return f"<Method {self.name} of another library>"


def foreign(name: str, solve: Solve) -> Method:
    """Returns a solver of another library as a method, which `chart` measures beside others.

    Args:
        name: name in legends and tables.
        solve: function of f, times (s), the state y0 at t = 0, (n,), and a relative tolerance tol, that returns the
            states at these times, (times, n). f(t, y) is the derivative, (n,), and counts its calls. With
            `chart(..., at_end=True)` there is one time, the end. Fewer rows than times are of a run that gave up.

    The other work of the solver, such as linear algebra, is not counted: `chart(..., work="time")` has it.

        def rk45(f, times, y0, tol):
            return solve_ivp(f, (0, times[-1]), y0, "RK45", times, rtol=tol, atol=tol).y.T

        a3.chart(system, methods=["dopri5", a3.foreign("SciPy RK45", rk45)])
    """
    return _Foreign(name, solve)


def method_name(method: Union[str, Method]) -> str:
    """Returns the name of a method."""
    if isinstance(method, str):
        return method
    if isinstance(method, Method):
        return method.name
    raise InputError(f"a method is a name or a letter, or an a3.Method, not {type(method).__name__}")


def _with(args: Sequence[Any], function: Any) -> Any:
    """Returns a function that takes further arguments, with these."""
    return _With(function, tuple(args)) if args else function


class _With:
    """A function with its last arguments. It can be pickled, as its parts can."""

    def __init__(self, function: Any, args: "tuple[Any, ...]") -> None:
        self.function, self.args = function, args

    def __call__(self, *args: Any) -> Any:
        return self.function(*args, *self.args)


class _Layout:
    """How an array of a shape, perhaps of complex numbers, is one of flat real numbers."""

    def __init__(self, like: Any) -> None:
        self.shape, self.kind = like.shape, like.dtype

    def shaped(self, flat: Floats) -> Any:
        """Returns the array, or an array of such arrays, of flat real numbers."""
        return flat.view(self.kind).reshape(flat.shape[:-1] + self.shape)

    def flat(self, array: npt.ArrayLike, name: str = "y") -> Floats:
        """Returns the flat real numbers of an array, which a function of this name returned."""
        return self._read(array, name, self.shape).reshape(-1).view(float)

    def square(self, jacobian: Any, name: str) -> Any:
        """Returns a Jacobian, (n, n), for the flat real numbers."""
        is_sparse = hasattr(jacobian, "tocoo")
        size = math.prod(self.shape)
        full = jacobian if is_sparse else self._read(jacobian, name, (size, size))
        if self.kind != complex:
            return full
        if is_sparse:
            raise InputError(f"{name} returned a sparse matrix, which is of real numbers only: return an array")
        parts = np.array([[full.real, -full.imag], [full.imag, full.real]])
        return parts.transpose(2, 0, 3, 1).reshape(2 * size, 2 * size)

    def _read(self, array: npt.ArrayLike, name: str, shape: Sequence[int]) -> Any:
        found = np.asarray(array)
        if found.shape != tuple(shape) or not np.can_cast(found.dtype, self.kind, "same_kind"):
            what = f"an array of shape {found.shape}" if found.dtype.kind in "biufc" else type(array).__name__
            kind = "real " if found.dtype.kind == "c" else ""
            raise InputError(f"{name} returned {what}, where {kind}numbers of shape {tuple(shape)} are expected")
        return np.ascontiguousarray(found, self.kind)


class _OfState:
    """A function of t and an array of a layout, as one of t and flat real numbers. `read` reads its result."""

    def __init__(self, function: Any, layout: Optional[_Layout], read: Any, otherwise: str = "the function") -> None:
        self.function, self.layout, self.read = function, layout, read
        self.__name__ = _name(function, otherwise)

    def __call__(self, t: float, y: Floats) -> Any:
        return self.read(self.function(t, self.layout.shaped(y) if self.layout else y), self.__name__)


class _Full:
    """A function that returns a Jacobian, which is an array here also where it returns a sparse matrix of SciPy."""

    def __init__(self, function: Any) -> None:
        self.function, self.__name__ = function, _name(function, "jac")

    def __call__(self, t: float, y: Floats) -> Any:
        found = self.function(t, y)
        return found.tocoo().toarray() if hasattr(found, "tocoo") else found


class _Entries:
    """The rows, columns and values of a function that returns a sparse matrix of SciPy, (3, k)."""

    def __init__(self, function: Any, size: int) -> None:
        self.function, self.size, self.__name__ = function, size, _name(function, "jac")

    def __call__(self, t: float, y: Floats) -> Floats:
        found = self.function(t, y)
        if not hasattr(found, "tocoo") or found.shape != (self.size, self.size):
            what = f"an array of shape {found.shape}" if hasattr(found, "shape") else type(found).__name__
            shape = (self.size, self.size)
            raise InputError(f"{self.__name__} returned {what}, where a sparse matrix of shape {shape} is expected")
        entries = found.tocoo()
        return np.array([entries.row, entries.col, entries.data], dtype=float)


def _places(sparsity: Any, size: int, parts: int) -> Sequence[Tuple[int, int]]:
    """Returns the rows and columns of a pattern: a matrix, sparse or not, or an array of them. Each number has parts."""
    if hasattr(sparsity, "tocoo"):
        entries, shape = sparsity.tocoo(), sparsity.shape
        places = np.column_stack([entries.row, entries.col])[entries.data != 0]
    else:
        try:
            array = np.asarray(sparsity)
        except ValueError:
            # A ragged list is refused below.
            array = np.asarray(None)
        # Integers (2, 2) of two numbers are pairs.
        is_matrix = array.dtype == bool or array.shape == (size, size) and (size != 2 or array.dtype.kind == "f")
        shape, places = (array.shape, np.argwhere(array)) if is_matrix else ((size, size), array)
    if shape != (size, size) or places.ndim != 2 or places.shape[1] != 2 or places.dtype.kind not in "iu":
        raise InputError(
            f"sparsity: a sparse matrix or an array of shape {(size, size)}, or pairs of a row and a column are expected"
        )
    if places.size == 0:
        raise InputError("sparsity: no entry may differ from 0: leave it out where f does not depend on y")
    if (wrong := (places < 0) | (places >= size)).any():
        row, column = places[wrong.any(axis=1)][0]
        raise InputError(f"sparsity: there is no row {row} and column {column} of {size} numbers: they begin at 0")
    of_parts = [(i, j) for i in range(parts) for j in range(parts)]
    return [(parts * int(row) + i, parts * int(column) + j) for row, column in places for i, j in of_parts]


def _mass_entries(mass: Any, size: int, kind: Type[Any]) -> Sequence[Tuple[int, int, float]]:
    """Returns the rows, columns and values of a mass matrix, sparse or not, or a diagonal, for flat real numbers."""
    if hasattr(mass, "tocoo"):
        found, shape = mass.tocoo(), mass.shape
        rows, columns, values = found.row, found.col, _numbers("mass", found.data, (-1,), kind)
    else:
        array = np.diag(_numbers("mass", mass, (size,), kind)) if np.ndim(mass) == 1 else mass
        array = _numbers("mass", array, (size, size), kind)
        shape, (rows, columns) = array.shape, np.nonzero(array)
        values = array[rows, columns]
    if shape != (size, size):
        raise InputError(f"mass: a matrix of shape {(size, size)} is expected, not {shape}")
    if not values.any():
        raise InputError("mass: the matrix is 0: then no equation has a derivative")
    entries = [(int(i), int(j), value) for i, j, value in zip(rows, columns, values)]
    if kind is not complex:
        return [(i, j, float(value)) for i, j, value in entries]
    parts = [(0, 0, 1.0), (0, 1, 1j), (1, 0, -1j), (1, 1, 1.0)]
    return [(2 * i + a, 2 * j + b, (turn * value).real) for i, j, value in entries for a, b, turn in parts]


def _name(function: Any, otherwise: str) -> str:
    name = getattr(function, "__name__", otherwise)
    return otherwise if name == "<lambda>" else name


def _numbers(what: str, given: npt.ArrayLike, shape: Optional[Sequence[int]], kind: Type[Any] = float) -> Floats:
    """Returns an array of its own, of finite numbers of a kind. A length of -1 is any, as is a shape of `None`."""
    found = None
    try:
        found = np.array(given)
        array = found.astype(kind, order="C", casting="same_kind")
    except (TypeError, ValueError):
        if np.iscomplexobj(found):
            raise InputError(f"{what}: real numbers are expected, not complex ones") from None
        raise InputError(f"{what}: numbers are expected, not {type(given).__name__}") from None
    if shape is not None and (array.ndim != len(shape) or any(n not in (-1, m) for n, m in zip(shape, array.shape))):
        wanted = ", ".join("n" if n < 0 else str(n) for n in shape) + ("," if len(shape) == 1 else "")
        raise InputError(f"{what}: an array of shape ({wanted}) is expected, not {array.shape}")
    if not np.isfinite(array).all():
        raise InputError(f"{what}: finite numbers are expected, not {array[~np.isfinite(array)][0]}")
    return array


def _measure(step: Any, name: str, rows: int) -> "tuple[int, int]":
    """Measures the order of a method and its evaluations in a step, on logistic growth y' = y (1 - y) in two numbers.

    An adaptive method returns rows, of which the first is the state."""
    count = 0

    def f(t: float, y: npt.ArrayLike) -> Floats:
        nonlocal count
        count += 1
        y = np.asarray(y, dtype=float)
        return y * (1.0 - y)

    def error(n: int) -> float:
        y, h = np.array([0.1, 0.3]), 2.0 / n
        taken = step() if isinstance(step, type) else step
        exact = 1.0 / (1.0 + (1.0 / y - 1.0) * np.exp(-2.0))
        for k in range(n):
            found = taken(f, k * h, y, h)
            if rows:
                found = _numbers(f"what the step of {name} returned", found, (rows, 2))[0]
            y = _numbers(f"what the step of {name} returned", found, (2,))
        return float(np.abs(y - exact).max())

    # Starting steps of a multistep method are of another order.
    steps = (32, 64) if isinstance(step, type) else (4, 8)
    errors = [error(n) for n in steps]
    evaluations = max(1, round(count / sum(steps)))
    if errors[1] < 1e-13 or errors[1] >= errors[0]:
        return 1, evaluations
    return min(max(round(math.log2(errors[0] / errors[1])), 1), 12), evaluations
