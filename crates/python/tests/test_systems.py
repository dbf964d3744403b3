"""Systems of one's own: spans of any length and direction, states of any shape, and sparse Jacobians."""

import math
import pickle

import numpy as np
import pytest

import a3_simulator as a3


def robertson(t, y):
    slow, fast, slowest = 0.04 * y[0], 1e4 * y[1] * y[2], 3e7 * y[1] * y[1]
    return [fast - slow, slow - fast - slowest, slowest]


#: The state of the published test set for initial value problem solvers at 1e11.
ROBERTSON = [0.2083340149701255e-07, 0.8333360770334713e-13, 0.9999999791665050]


@pytest.mark.parametrize("method", ["radau", "bdf"])
def test_spans_of_1e11_have_their_published_ends(method):
    run = a3.Simulation(a3.System(robertson, [1, 0, 0]), method, tolerance=1e-8)
    run.advance_to(1e11)
    assert run.state == pytest.approx(ROBERTSON, rel=1e-3, abs=1e-8)
    assert run.work.evaluations < 10_000


def test_a_choice_for_a_span_of_1e11_costs_few_calls():
    calls = 0

    def f(t, y):
        nonlocal calls
        calls += 1
        return robertson(t, y)

    system = a3.System(f, [1, 0, 0])
    choice = a3.choose(system, 1e-5, until=1e11, methods=["radau", "bdf", "dopri5", "rk4"], progress=False)
    assert choice.method in ("radau", "bdf") and choice.until == 1e11 and calls < 1_000_000
    chart = a3.chart(system, ["bdf", "dopri5", "euler"], until=1e11, progress=False)
    assert chart.too_costly == ["dopri5", "euler"]
    assert {point.method for point in chart.points if point.error < 1.0} == {"bdf"}
    assert "too many evaluations" in chart.table and "t = 0 to 1e11" in chart.table


def decay(t, y, time):
    return -y / time


@pytest.mark.parametrize("time", [2.0**-30, 2.0**36])
def test_time_has_any_unit(time):
    """All follows from the span: in another unit of time, methods take the same steps."""

    def measured(time):
        system = a3.System(decay, [1.0], args=(time,))
        chart = a3.chart(system, ["dop853", "dopri5"], until=2 * time, progress=False)
        choice = a3.choose(system, 1e-6, until=2 * time, methods=["rk4", "dopri5"], progress=False)
        assert choice.error <= 1e-6
        return [point.evaluations for point in chart.points], [point.error for point in chart.points]

    (evaluations, errors), (expected, as_well) = measured(time), measured(1.0)
    assert evaluations == expected and errors == pytest.approx(as_well, rel=1e-3, abs=1e-13)
    run = a3.Simulation(a3.System(decay, [1.0], args=(time,)), "rk4", step=time / 128)
    run.advance_to(time)
    assert run.state[0] == pytest.approx(math.exp(-1), rel=1e-9)


def test_foreign_solvers_that_never_end_are_too_costly():
    def euler(f, times, y0, tol):
        t, y, states = 0.0, y0, []
        for time in times:
            while t < time:
                t, y = t + 1e-3, y + 1e-3 * f(t, y)
            states.append(y)
        return np.array(states)

    slow = a3.foreign("endless", euler)
    chart = a3.chart(a3.System(robertson, [1, 0, 0]), ["bdf", slow], until=1e11, progress=False)
    assert chart.too_costly == ["endless"]


@pytest.mark.parametrize("until", [1e-16, 1e16, 0.0, math.nan])
def test_spans_out_of_range_are_one_clear_line(until):
    with pytest.raises(a3.InputError, match="1e-15 to 1e15"):
        a3.chart(a3.System(decay, [1.0], args=(1.0,)), ["rk4"], until=until, progress=False)


def growth(t, y):
    return np.cos(t) * y


@pytest.mark.parametrize("method", ["dopri5", "radau", "bdf"])
def test_runs_go_back_in_time(method):
    run = a3.Simulation(a3.System(growth, [1.0]), method, tolerance=1e-9, backward=True)
    assert run.states_at([-1.0, -2.0])[:, 0] == pytest.approx(np.exp(np.sin([-1.0, -2.0])), rel=1e-6)
    assert run.time == -2.0
    again = pickle.loads(pickle.dumps(run))
    again.advance_to(-3.0)
    assert again.state[0] == pytest.approx(math.exp(math.sin(-3.0)), rel=1e-6)
    assert again.advance_until(lambda t, y: t + 3.5, -10.0) and again.time == pytest.approx(-3.5)
    again.set_state([2.0], -4.0)
    assert (again.time, again.state[0]) == (-4.0, 2.0)
    with pytest.raises(a3.InputError, match="goes back in time"):
        run.advance_to(1.0)


def test_runs_that_go_back_tell_their_own_times():
    def lost():
        return a3.Simulation(a3.System(lambda t, y: -y * y, [1.0]), "dopri5", backward=True)

    for blow_up in (lambda run: run.step(1000), lambda run: run.advance(-2.0), lambda run: run.advance_to(-2.0)):
        with pytest.raises(a3.BlowUp, match="t = -") as error:
            blow_up(lost())
        assert -1.1 < error.value.time < -0.9
    no_slope = a3.System(lambda t, y: -y, [1.0], jac=lambda t, y: [[math.nan if t < -0.5 else -1.0]])
    with pytest.raises(a3.Error, match="NaN in row 0 and column 0 at t = -0[.]"):
        a3.Simulation(no_slope, "implicit", step=0.1, backward=True).advance_to(-2.0)
    run = a3.Simulation(a3.System(growth, [1.0]), "rk4", step=1e-4, backward=True)
    times = []
    run.advance(-3.0, times.append)
    assert run.time == -3.0 and times == sorted(times, reverse=True) and all(-3.0 <= time < 0.0 for time in times)
    for past in (
        lambda: run.advance_to(-1),
        lambda: run.advance(-1),
        lambda: run.states_at([-1]),
        lambda: run.advance_until(lambda t, y: 1.0, -1),
    ):
        with pytest.raises(a3.InputError, match=r"the run is at t = -3.0 s already, past -1 s: reset\(\) goes back"):
            past()
    for wrong in (math.nan, -math.inf, 1.0):
        with pytest.raises(a3.InputError, match=f"a time is from -1e15 to 0, such as -10, not {wrong}"):
            run.advance_to(wrong)
    run.set_state([1.0], -1.0)
    assert run.time == -1.0


def test_a_direction_is_as_the_run_goes():
    run = a3.Simulation(a3.System(growth, [1.0]), "dopri5", backward=True)
    assert not run.advance_until(lambda t, y: t + 1.0, -2.0, direction=1)
    run.reset()
    assert run.advance_until(lambda t, y: t + 1.0, -2.0, direction=-1) and run.time == pytest.approx(-1.0)


def test_a_jump_is_met_from_either_side():
    system = a3.System(lambda t, y: [1.0 if t >= -1.0 else 5.0], [0.0], tstops=[-1.0])
    for method in ("rk4", "dopri5"):
        run = a3.Simulation(system, method, backward=True, **{"step": 0.3} if method == "rk4" else {})
        run.advance_to(-2.0)
        assert run.state[0] == pytest.approx(-6.0, abs=1e-12)


def test_charts_and_choices_go_back_in_time():
    system = a3.System(growth, [1.0])
    chart = a3.chart(system, ["rk4", "dopri5"], until=-5.0, progress=False)
    assert chart.until == -5.0 and {run["until"] for run in chart.runs} == {-5.0}
    assert "growth backward" in chart.table
    choice = a3.choose(system, 1e-6, until=-5.0, methods=["rk4", "dopri5"], progress=False)
    assert choice.until == -5.0 and choice.error <= 1e-6
    back = a3.Simulation(system, choice.method, backward=True, **{
        "tolerance" if choice.method == "dopri5" else "step": choice.setting
    })
    back.advance_to(-5.0)
    assert back.state[0] == pytest.approx(math.exp(math.sin(-5.0)), rel=1e-5)


def springs(t, y):
    """Three particles on springs, as rows of two coordinates and two velocities."""
    assert y.shape == (3, 4)
    return np.hstack([y[:, 2:], -np.array([[1.0], [4.0], [9.0]]) * y[:, :2]])


@pytest.mark.parametrize("method", ["dop853", "radau"])
def test_states_have_the_shape_of_y0(method):
    y0 = np.hstack([np.ones((3, 2)), np.zeros((3, 2))])
    run = a3.Simulation(a3.System(springs, y0), method, tolerance=1e-10)
    assert (run.state == y0).all() and run.state.shape == (3, 4)
    states = run.states_at([0.5, 1.0])
    w = np.array([1.0, 2.0, 3.0])
    assert states.shape == (2, 3, 4)
    assert states[:, :, 0] == pytest.approx(np.cos(np.outer([0.5, 1.0], w)), abs=1e-7)
    run.set_state(2 * y0)
    assert (run.state == 2 * y0).all()
    assert run.advance_until(lambda t, y: y[2, 0], 5.0) and abs(run.state[2, 0]) < 1e-9
    both = a3.compare(a3.System(springs, y0), [(method, 1e-9), ("rk4", 0.01)], until=1.0, frames=4, progress=False)
    assert both.runs[0].states.shape == (5, 3, 4) and both.distance().max() < 1e-6
    with pytest.raises(a3.InputError, match=r"shape \(3, 4\)"):
        run.set_state(y0[0])


def turning(t, z):
    return 1j * np.array([1.0, 2.0]) * z


@pytest.mark.parametrize("jac", [None, lambda t, z: np.diag([1j, 2j])])
def test_states_may_be_complex(jac):
    system = a3.System(turning, [1.0 + 0j, 1j], jac=jac, scale=[1.0, 1.0])
    run = a3.Simulation(system, "radau", tolerance=1e-9)
    run.advance_to(3.0)
    assert run.state == pytest.approx([np.exp(3j), 1j * np.exp(6j)], abs=1e-6)
    chart = a3.chart(system, ["rk4"], until=1.0, quantity=lambda t, z: z[0], progress=False)
    assert min(point.error for point in chart.points) < 1e-9
    with pytest.raises(a3.InputError, match="quantity"):
        a3.chart(system, ["rk4"], until=1.0, component=0, progress=False)


@pytest.mark.parametrize("kind", [np.complex64, complex, np.clongdouble])
def test_quantities_may_be_complex_numbers_of_any_size(kind):
    def turned(t, z):
        return z[0].astype(kind)

    chart = a3.chart(a3.System(turning, [1.0 + 0j, 1j]), ["rk4"], until=1.0, quantity=turned, progress=False)
    found = [point.error for point in chart.points]
    assert all(error < 2.0 for error in found) and min(found) < (1e-6 if kind is np.complex64 else 1e-9)


def test_complex_numbers_of_a_real_system_are_one_clear_line():
    for y0 in (np.ones(4), np.ones((2, 2))):
        run = a3.Simulation(a3.System(lambda t, y: -y, y0))
        with pytest.raises(a3.InputError, match="state: real numbers are expected, not complex ones"):
            run.set_state(y0 + 1j)
        with pytest.raises(a3.InputError, match="scale: real numbers"):
            a3.System(lambda t, y: -y, y0, scale=y0 + 1j)


def test_a_wrong_result_of_a_watched_function_names_it():
    def radius(t, y):
        return y

    run = a3.Simulation(a3.System(lambda t, y: -y, np.ones((2, 2))), "rk4", step=0.1)
    for function, name in ((radius, "radius"), (lambda t, y: y, "the function")):
        with pytest.raises(a3.InputError, match=rf"^{name} returned an array of shape \(2, 2\)"):
            run.advance_until(function, 1.0)


def test_a_wrong_shape_is_one_clear_line():
    run = a3.Simulation(a3.System(lambda t, y: y[0], np.ones((2, 2))), "rk4", step=0.1)
    with pytest.raises(a3.InputError, match=r"returned an array of shape \(2,\), where numbers of shape \(2, 2\)"):
        run.step()
    run = a3.Simulation(a3.System(lambda t, y: 1j * y, np.ones((2, 2))), "rk4", step=0.1)
    with pytest.raises(a3.InputError, match="real numbers"):
        run.step()


def brusselator(n):
    """A Brusselator of n numbers, its start, its Jacobian as a sparse matrix, and a counter of calls."""
    sparse = pytest.importorskip("scipy.sparse")
    half = n // 2
    a = 0.02 * (half + 1) ** 2
    calls = [0]
    band = a * sparse.diags([1, -2, 1], [-1, 0, 1], shape=(half, half))

    def f(t, y):
        calls[0] += 1
        u, v = y[:half], y[half:]
        up, vp = np.concatenate([[1], u, [1]]), np.concatenate([[3], v, [3]])
        bend = [w[:-2] - 2 * w[1:-1] + w[2:] for w in (up, vp)]
        return np.concatenate([1 + u * u * v - 4 * u + a * bend[0], 3 * u - u * u * v + a * bend[1]])

    def jac(t, y):
        u, v = y[:half], y[half:]
        of_u, of_v = sparse.diags(2 * u * v - 4) + band, sparse.diags(u * u)
        return sparse.bmat([[of_u, of_v], [sparse.diags(3 - 2 * u * v), band - of_v]])

    x = np.arange(1, half + 1) / (half + 1)
    return f, np.concatenate([1 + np.sin(2 * np.pi * x), 3 * np.ones(half)]), jac, calls


@pytest.mark.parametrize("kind", ["jac", "csc", "matrix", "array", "pairs", "found"])
def test_sparse_jacobians_take_few_calls(kind):
    f, y0, jac, calls = brusselator(2000)
    pattern = jac(0.0, y0 + 1.0)
    given = {
        "jac": {"jac": jac},
        "csc": {"jac": lambda t, y: jac(t, y).tocsc()},
        "matrix": {"sparsity": pattern},
        "array": {"sparsity": pattern.toarray() != 0},
        "pairs": {"sparsity": np.column_stack(pattern.nonzero())},
        "found": {},
    }[kind]
    run = a3.Simulation(a3.System(f, y0, **given), "bdf", tolerance=1e-4)
    run.advance_to(2.0)
    print(kind, run.steps, run.work, calls)
    assert calls[0] < {"found": 20, "jac": 4, "csc": 4}.get(kind, 6) * run.steps and run.work.total < 20 * run.steps
    truth = a3.Simulation(a3.System(f, y0), "radau", tolerance=1e-7)
    truth.advance_to(2.0)
    assert run.state == pytest.approx(truth.state, abs=1e-2)


def test_a_pattern_that_misses_entries_is_completed():
    f, y0, jac, _ = brusselator(200)
    run = a3.Simulation(a3.System(f, y0, sparsity=np.eye(200, dtype=bool)), "radau", tolerance=1e-6)
    run.advance_to(1.0)
    other = a3.Simulation(a3.System(f, y0, jac=jac), "radau", tolerance=1e-6)
    other.advance_to(1.0)
    assert run.state == pytest.approx(other.state, abs=1e-5)


@pytest.mark.parametrize(
    "sparsity, words",
    [
        (np.eye(3), "an array of shape"),
        ([[0, 2]], "no row 0 and column 2"),
        ([[0, -1]], "no row 0 and column -1"),
        ([[0.5, 1.0]], "pairs of a row and a column"),
        (np.zeros((2, 2), dtype=bool), "no entry"),
        ("all", "pairs of a row and a column"),
        ([[0, 1], [1]], "pairs of a row and a column"),
        ([[0, 1], [1, 0, 1]], "pairs of a row and a column"),
    ],
)
def test_a_wrong_pattern_is_one_clear_line(sparsity, words):
    with pytest.raises(a3.InputError, match=f"sparsity: .*{words}"):
        a3.System(lambda t, y: -y, [1.0, 2.0], sparsity=sparsity)


def test_a_sparse_jacobian_of_another_shape_is_one_clear_line():
    sparse = pytest.importorskip("scipy.sparse")
    system = a3.System(lambda t, y: -y, np.ones(40), jac=lambda t, y: sparse.eye(39))
    with pytest.raises(a3.InputError, match=r"returned an array of shape \(39, 39\)"):
        a3.Simulation(system, "radau", tolerance=1e-4).step()


@pytest.mark.parametrize(
    "sparsity, places",
    [
        (np.eye(2), [(0, 0), (1, 1)]),
        (np.eye(2, dtype=bool), [(0, 0), (1, 1)]),
        ([[0, 1], [1, 0]], [(0, 1), (1, 0)]),
        ([[0, 0], [1, 1]], [(0, 0), (1, 1)]),
        ([[0, 1]], [(0, 1)]),
    ],
)
def test_patterns_of_two_numbers(sparsity, places):
    assert a3.System(lambda t, y: -y, [1.0, 2.0], sparsity=sparsity)._sparsity == places


@pytest.mark.parametrize("size", [20, 2000])
@pytest.mark.parametrize("method", ["radau", "bdf"])
def test_an_exception_of_a_jacobian_comes_out(method, size):
    def run(jac, since=0.0):
        run = a3.Simulation(a3.System(lambda t, y: -y, np.ones(size), jac=jac), method, tolerance=1e-4)
        run.set_state(np.ones(size), since)
        run.advance_to(since + 1.0)
        return run.state

    with pytest.raises(ZeroDivisionError):
        run(lambda t, y: 1 / 0)
    sparse = pytest.importorskip("scipy.sparse")
    calls = []

    def later(t, y):
        if t == 0.0:
            raise ValueError("no slope at 0")
        calls.append(t)
        return -sparse.eye(size)

    assert run(later, since=1.0) == pytest.approx(np.full(size, math.exp(-1)), abs=1e-3) and calls
    if size > 1024:
        with pytest.raises(a3.InputError, match=r"full returned an array .*, where a sparse matrix of shape"):

            def full(t, y):
                return -np.eye(size) if t > 0.0 else 1 / 0

            run(full, since=1.0)
