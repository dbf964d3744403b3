"""Own systems, methods and forces: their results, and what they may do wrong."""

import copy
import math
import pickle
import re
import signal
import threading
import os
import time

import numpy as np
import pytest

import a3_simulator as a3


def oscillator(t, y):
    return np.array([y[1], -y[0]])


def heun(f, t, y, h):
    a = f(t, y)
    b = f(t + h, y + h * a)
    return y + h / 2 * (a + b)


def rk4(f, t, y, h):
    a = f(t, y)
    b = f(t + h / 2, y + h / 2 * a)
    c = f(t + h / 2, y + h / 2 * b)
    d = f(t + h, y + h * c)
    return y + h / 6 * (a + 2 * b + 2 * c + d)


def test_a_system_of_first_order_has_its_exact_solution():
    run = a3.Simulation(a3.System(oscillator, [1.0, 0.0]), "dop853", tolerance=1e-11)
    run.advance_to(10.0)
    assert run.state == pytest.approx([math.cos(10), -math.sin(10)], abs=1e-9)
    assert run.positions.shape == (0, 3) and run.scene == "oscillator"


def spiral(t, y, rate, decay):
    return [rate * y[1] - decay * y[0], -rate * y[0] - decay * y[1]]


def test_a_function_has_further_arguments():
    system = a3.System(spiral, [1.0, 0.0], args=(2.0, 0.5))
    assert system.name == "spiral"
    run = a3.Simulation(system, "dop853", tolerance=1e-11)
    states = pickle.loads(pickle.dumps(run)).states_at([0.0, 0.5, 3.0])
    times = np.array([0.0, 0.5, 3.0])
    expected = np.exp(-0.5 * times) * [np.cos(2 * times), -np.sin(2 * times)]
    assert states == pytest.approx(expected.T, abs=1e-9)
    assert run.states_at([]).shape == (0, 2)

    def pull(t, x, v, stiffness):
        return -stiffness * x

    particles = a3.System.of_particles(pull, [1.0], [[1, 0, 0]], args=[4.0])
    run = a3.Simulation(particles, "dop853", tolerance=1e-11)
    assert run.states_at([1.0])[0, 0] == pytest.approx(math.cos(2), abs=1e-9)


def kinetics(t, y, rate=3e7):
    slow, fast, end = 0.04 * y[0], 1e4 * y[1] * y[2], rate * y[1] ** 2
    return [fast - slow, slow - fast - end, end]


def slopes(t, y, rate=3e7):
    return [
        [-0.04, 1e4 * y[2], 1e4 * y[1]],
        [0.04, -1e4 * y[2] - 2 * rate * y[1], -1e4 * y[1]],
        [0, 2 * rate * y[1], 0],
    ]


@pytest.mark.parametrize("method", ["radau", "bdf"])
def test_a_jacobian_spares_calls_of_f(method):
    def calls(**jac):
        count = [0]

        def f(t, y, rate):
            count[0] += 1
            return kinetics(t, y, rate)

        system = a3.System(f, [1.0, 0.0, 0.0], args=(3e7,), **jac)
        run = a3.Simulation(system, method, tolerance=1e-6)
        return run.states_at([40.0])[0], count[0]

    own, few = calls(jac=slopes)
    differences, many = calls()
    # Hairer, Wanner: 0.7158, 9.185e-6, 0.2842 at 40 s.
    assert own == pytest.approx([0.71582, 9.1855e-6, 0.28417], rel=1e-4)
    assert differences == pytest.approx(own, rel=1e-5)
    assert few < many


def test_a_jacobian_may_have_any_order_in_memory():
    calls = [0, 0]

    def of(order):
        def f(t, y):
            calls[order] += 1
            return [-1e3 * (y[0] - y[1]) + y[2], -1e2 * (y[1] - 2 * y[2]), -y[2]]

        def jac(t, y):
            slopes = np.array([[-1e3, 1e3, 1], [0, -1e2, 2e2], [0, 0, -1.0]])
            return np.asfortranarray(slopes) if order else slopes

        return a3.Simulation(a3.System(f, [1.0, 1.0, 1.0], jac=jac), "bdf", tolerance=1e-6).states_at([5.0])

    assert (of(0) == of(1)).all() and calls[0] == calls[1]


def test_a_jacobian_of_another_shape_is_refused():
    wrong = a3.System(kinetics, [1.0, 0.0, 0.0], jac=lambda t, y: [1.0, 2.0, 3.0])
    with pytest.raises(a3.InputError, match=r"shape \(3,\), where an array of shape \(3, 3\) is expected"):
        a3.Simulation(wrong, "radau", tolerance=1e-6).advance_to(1.0)
    with pytest.raises(a3.InputError, match="a function is expected, not list"):
        a3.Simulation(a3.System(kinetics, [1.0, 0.0, 0.0], jac=[[1.0]]), "radau")


def test_a_large_stiff_system_takes_few_calls():
    n = 2000

    def heat(t, y):
        wall = np.concatenate([[0.0], y, [0.0]])
        calls[0] += 1
        return (n + 1) ** 2 * np.diff(wall, 2)

    calls = [0]
    x = np.arange(1, n + 1) / (n + 1)
    run = a3.Simulation(a3.System(heat, np.sin(np.pi * x)), "bdf", tolerance=1e-6)
    rate = -4 * (n + 1) ** 2 * np.sin(np.pi / 2 / (n + 1)) ** 2
    assert run.states_at([0.1])[0] == pytest.approx(np.exp(rate * 0.1) * np.sin(np.pi * x), abs=1e-5)
    assert calls[0] < 600


def test_the_version_is_that_of_the_package():
    assert re.fullmatch(r"\d+\.\d+\.\d+.*", a3.__version__) and "__version__" in dir(a3)


def test_a_system_of_particles_has_masses_and_forces():
    masses = np.array([2.0, 1.0])

    def pull(t, x, v):
        assert x.shape == v.shape == (2, 3)
        return -8.0 * x * masses[:, None] / masses[0]

    system = a3.System.of_particles(pull, masses, [[1, 0, 0], [0, 2, 0]], [[0, 0, 0], [0, 0, 2]], positional=True)
    run = a3.Simulation(system, "verlet", step=1e-3)
    run.advance_to(1.0)
    expected = [[math.cos(2), 0, 0], [0, 2 * math.cos(2), math.sin(2)]]
    assert run.positions == pytest.approx(np.array(expected), abs=1e-5)


def test_a_method_of_ones_own_has_the_results_of_the_same_method_of_a3():
    own = a3.Method("my-rk4", rk4)
    assert own.order == 4 and "my-rk4" in repr(own)
    for scene in ["chain", "flag", a3.System(oscillator, [1.0, 0.0])]:
        runs = [a3.Simulation(scene, method, step=0.005) for method in (own, "rk4", "my-rk4")]
        for run in runs:
            run.advance_to(0.5)
        assert runs[0].state == pytest.approx(runs[1].state, abs=1e-9)
        assert np.array_equal(runs[0].state, runs[2].state)
        assert runs[0].work.evaluations == runs[1].work.evaluations


def test_the_order_of_a_method_is_measured():
    assert a3.Method("my-heun", heun).order == 2
    assert a3.Method("my-euler", lambda f, t, y, h: y + h * f(t, y)).order == 1
    assert a3.Method("my-other", heun, order=3).order == 3


def test_forces_are_added_to_those_of_a_scene():
    still = a3.Simulation("chain", "rk4", step=0.005)
    masses = still.masses[:, None]
    times = []

    def lift(t, x, v):
        times.append(t)
        return masses * [0, 9.8, 0]

    run = a3.Simulation("chain", "rk4", step=0.005, forces=[lift])
    text = a3.scene("chain")
    text["gravity"] = [0, 0, 0]
    free = a3.Simulation(text, "rk4", step=0.005)
    for each in (run, free):
        each.advance_to(1.0)
    assert run.positions == pytest.approx(free.positions, abs=1e-12)
    assert min(times) == 0 and max(times) <= 1.0


def test_forces_act_with_contact_and_pins():
    run = a3.Simulation("mit-sphere", "rk4", step=0.01, forces=[lambda t, x, v: 0.01 * np.cos(t) * np.ones_like(x)])
    run.advance_to(2.0)
    distance = np.linalg.norm(run.positions - [1, -4, 0], axis=1)
    assert distance.min() > 1.49
    assert run.pinned.size == 2


class Broken(Exception):
    pass


def fails(*arguments):
    raise Broken("at the second call")


@pytest.mark.parametrize("method", ["euler", "rk4", "dopri5", "dop853", "implicit", "implicit-midpoint", "bdf"])
def test_an_exception_of_f_comes_out_as_it_is_and_stops_the_run_at_once(method):
    calls = []

    def f(t, y):
        calls.append(t)
        if t > 0.1:
            fails()
        return -y

    run = a3.Simulation(a3.System(f, [1.0]), method)
    with pytest.raises(Broken, match="at the second call") as error:
        run.advance_to(1.0)
    assert error.traceback[-1].name == "fails"
    assert sum(t > 0.1 for t in calls) == 1
    count = len(calls)
    assert np.isfinite(run.state).all()
    with pytest.raises(Broken):
        run.advance_to(1.0)
    assert len(calls) > count


def test_an_exception_of_a_step_comes_out_as_it_is():
    def step(f, t, y, h):
        if t > 0.5:
            fails()
        return y + h * f(t, y)

    a3.Method("my-broken", step, order=1)
    run = a3.Simulation("simple", "my-broken", step=0.01)
    with pytest.raises(Broken):
        run.advance_to(1.0)


def test_an_exception_of_a_force_comes_out_as_it_is():
    with pytest.raises(Broken):
        a3.Simulation("cloth", "verlet", forces=[fails]).step()
    run = a3.Simulation("cloth", "verlet", forces=[lambda t, x, v: fails() if t > 0.1 else 0 * x])
    with pytest.raises(Broken):
        run.advance_to(1.0)


def test_an_exception_of_f_within_a_step_of_ones_own_comes_out_as_it_is():
    a3.Method("my-inner", rk4)
    run = a3.Simulation(a3.System(lambda t, y: fails() if t > 0.5 else -y, [1.0]), "my-inner", step=0.1)
    with pytest.raises(Broken):
        run.advance_to(1.0)


@pytest.mark.parametrize(
    "f, words",
    [
        (lambda t, y: None, "the function returned NoneType, where an array of shape (2,) is expected"),
        (lambda t, y: [1.0], "returned an array of shape (1,), where an array of shape (2,)"),
        (lambda t, y: np.zeros((2, 2)), "returned an array of shape (2, 2)"),
        (lambda t, y: 3.0, "returned an array of shape ()"),
        (lambda t, y: "ab", "returned str"),
        (lambda t, y: [[1.0], [2.0, 3.0]], "returned list"),
        (lambda t, y: np.array([1j, 2j]), "returned ndarray"),
    ],
)
def test_a_wrong_result_of_f_is_one_clear_line(f, words):
    run = a3.Simulation(a3.System(f, [1.0, 0.0]), "rk4")
    with pytest.raises(a3.InputError) as error:
        run.step()
    assert words in str(error.value) and "\n" not in str(error.value)


@pytest.mark.parametrize("result", [lambda y: y.tolist(), tuple, lambda y: y.astype(np.float32), lambda y: np.stack([y, y], 1)[:, 0]])
def test_results_may_be_of_other_kinds(result):
    run = a3.Simulation(a3.System(lambda t, y: result(np.array([y[1], -y[0]])), [1.0, 0.0]), "rk4", step=0.01)
    run.advance_to(1.0)
    assert run.state == pytest.approx([math.cos(1), -math.sin(1)], abs=1e-6)


def test_a_number_that_is_not_finite_is_a_blow_up():
    run = a3.Simulation(a3.System(lambda t, y: y * (np.nan if t > 0.5 else 1.0), [1.0]), "rk4", step=0.1)
    with pytest.raises(a3.BlowUp, match="not finite"):
        run.advance_to(1.0)


@pytest.mark.parametrize(
    "step, words",
    [
        (lambda f, t, y, h: None, "what the step of my-wrong returned: numbers are expected, not NoneType"),
        (lambda f, t, y, h: y[:1], "an array of shape (2,) is expected, not (1,)"),
        (lambda f, t, y, h: y * np.nan, "finite numbers are expected"),
        (None, "a function of f, t, y and h is expected"),
    ],
)
def test_a_wrong_step_is_refused_when_the_method_is_made(step, words):
    with pytest.raises(a3.InputError) as error:
        a3.Method("my-wrong", step)
    assert words in str(error.value)


def test_a_wrong_shape_later_is_one_clear_line():
    a3.Method("my-late", lambda f, t, y, h: y[: 2 if t < 0.2 else 1] + 0.0, order=1)
    run = a3.Simulation(a3.System(oscillator, [1.0, 0.0]), "my-late", step=0.1)
    with pytest.raises(a3.InputError, match=r"returned an array of shape \(1,\), where an array of shape \(2,\)"):
        run.advance_to(1.0)


@pytest.mark.parametrize(
    "make, words",
    [
        (lambda: a3.Method("rk4", heun), "the name rk4 stands for"),
        (lambda: a3.Method("two words", heun), "a word"),
        (lambda: a3.Method("my-0", heun, order=0), "order"),
        (lambda: a3.Method("my-step", heun, default_step=-1), "default_step"),
        (lambda: a3.System(oscillator, []), "y0: a system has at least one number"),
        (lambda: a3.System(oscillator, [1, np.inf]), "y0: finite numbers"),
        (lambda: a3.System(oscillator, "y"), "y0: numbers are expected"),
        (lambda: a3.Simulation(a3.System(3, [1.0])), "a function is expected, not int"),
        (lambda: a3.System.of_particles(fails, [1.0, 2.0], [[0, 0, 0]]), "positions: an array of shape (2, 3)"),
        (lambda: a3.Simulation(a3.System.of_particles(fails, [-1.0], [[0, 0, 0]])), "mass 0"),
        (lambda: a3.Simulation(a3.System(oscillator, [1.0, 0.0]), "verlet"), "needs forces and masses"),
        (lambda: a3.Simulation(a3.System(oscillator, [1.0, 0.0]), grid=(3, 3)), "has no grid"),
        (lambda: a3.Simulation("simple", forces=[fails]), "has no masses"),
        (lambda: a3.Simulation("chain", forces=[3]), "a function is expected, not int"),
        (lambda: a3.scene(a3.System(oscillator, [1.0, 0.0])), "has no keys"),
        (lambda: a3.Simulation("chain", method=3), "a method is a name"),
    ],
)
def test_what_cannot_be_is_refused(make, words):
    with pytest.raises(a3.InputError) as error:
        make()
    assert words in str(error.value) and "\n" not in str(error.value)


def test_f_of_a_step_cannot_be_called_later():
    kept = []

    def step(f, t, y, h):
        kept.append(f)
        return y + h * f(t, y)

    a3.Method("my-keeper", step, order=1)
    a3.Simulation("simple", "my-keeper", step=0.1).step()
    with pytest.raises(a3.InputError, match="only while its step is being taken"):
        kept[-1](0.0, np.zeros(3))


def test_f_of_a_step_checks_what_it_gets():
    def step(f, t, y, h):
        return y + h * f(t, y[:2] if len(y) == 3 else y)

    a3.Method("my-short", step, order=1)
    with pytest.raises(a3.InputError, match="the state has 2 numbers, but the system needs 3"):
        a3.Simulation("simple", "my-short", step=0.1).step()


def test_a_run_within_a_function_of_another_run():
    def f(t, y):
        inner = a3.Simulation("simple", "rk4", step=0.1)
        inner.advance_to(0.5)
        return -y * (1.0 + 0.0 * inner.state[0])

    run = a3.Simulation(a3.System(f, [1.0]), "rk4", step=0.1)
    run.advance_to(1.0)
    assert run.state[0] == pytest.approx(math.exp(-1), abs=1e-6)


def test_a_function_cannot_advance_its_own_run():
    def f(t, y):
        if run is not None:
            run.step()
        return -y

    run = None
    run = a3.Simulation(a3.System(f, [1.0]), "rk4", step=0.1)
    with pytest.raises(a3.InputError, match="this run is being advanced"):
        run.step()


@pytest.mark.skipif(os.name == "nt", reason="signals of POSIX")
def test_ctrl_c_ends_a_step_that_never_ends():
    def step(f, t, y, h):
        while t > 0.5:
            pass
        return y + h * f(t, y)

    a3.Method("my-endless", step, order=1)
    run = a3.Simulation("simple", "my-endless", step=0.1)
    threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT)).start()
    with pytest.raises(KeyboardInterrupt):
        run.advance_to(1.0)


def test_runs_of_own_functions_in_threads():
    def work(results, k):
        run = a3.Simulation(a3.System(oscillator, [1.0, float(k)]), "rk4", step=0.01)
        run.advance_to(3.0)
        results[k] = run.state

    results = {}
    threads = [threading.Thread(target=work, args=(results, k)) for k in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for k in range(4):
        assert results[k] == pytest.approx(
            [math.cos(3) + k * math.sin(3), -math.sin(3) + k * math.cos(3)], abs=1e-7
        )


def test_a_run_of_a_system_is_pickled():
    run = a3.Simulation(a3.System(oscillator, [1.0, 0.0]), "dopri5")
    run.advance_to(1.0)
    again = pickle.loads(pickle.dumps(run))
    for each in (run, again):
        each.advance_to(2.0)
    assert np.array_equal(run.state, again.state)


def test_numbers_of_mixed_size_have_errors_of_their_own():
    def pair(t, y):
        return np.array([y[1], -y[0], 4 * y[3], -4 * y[2]])

    for scale, most in [(None, 1e-8), ([1, 1, 1e-6, 1e-6], 1e-8), (1.0, 1.0)]:
        system = a3.System(pair, [1.0, 0.0, 1e-6, 0.0], scale=scale)
        run = a3.Simulation(system, "dopri5", tolerance=1e-6)
        run.advance_to(20.0)
        off = abs(run.state[2] - 1e-6 * math.cos(80))
        assert off < most and (scale != 1.0 or off > 1e-8)
    for wrong in [[1, 1, 1], 0.0, [1, 1, 1, -1], "small"]:
        with pytest.raises(a3.InputError, match="scale"):
            a3.System(pair, [1.0, 0.0, 1e-6, 0.0], scale=wrong)


def test_one_number_counts_alone():
    """A slow number needs longer steps than a fast one beside it."""

    def two(t, y):
        return np.array([-y[0], 20 * y[2], -20 * y[1]])

    system = a3.System(two, [1.0, 1.0, 0.0])
    chosen = [
        a3.choose(system, 1e-4, methods=["rk4"], until=2.0, component=k, progress=False) for k in (0, 1, None)
    ]
    slow, fast, both = (choice.setting for choice in chosen)
    assert slow > 3 * fast and slow > 2 * both and chosen[0].error < 1e-4
    run = a3.Simulation(system, "rk4", step=slow)
    run.advance_to(2.0)
    assert abs(run.state[0] - math.exp(-2)) < 1e-4 < abs(run.state[1] - math.cos(40))
    for wrong, words in [
        ({"component": 3}, "has no number 3: its numbers are 0 to 2"),
        ({"particle": 0}, "give component=0"),
        ({"component": -1}, "a number from 0"),
    ]:
        with pytest.raises(a3.InputError, match=words):
            a3.chart(system, ["rk4"], until=2.0, progress=False, **wrong)
    with pytest.raises(a3.InputError, match="give particle=2"):
        a3.choose("chain", 1e-3, component=2)


def test_a_choice_tells_where_its_error_holds():
    """Between the ends of the long steps of a stiff system, a run shows straight lines."""

    def follow(t, y):
        return -1e4 * (y - np.cos(t))

    with pytest.warns(UserWarning, match="the error holds at the ends of steps; between them"):
        choice = a3.choose(a3.System(follow, [1.0]), 1e-3, methods=["tr-bdf2"], until=3.0, progress=False)
    assert choice.error <= 1e-3 and choice.error_at_steps <= 1e-3
    times = np.linspace(0, 3, 961)
    states = a3.Simulation(a3.System(follow, [1.0]), "tr-bdf2", step=choice.setting).states_at(times)
    worst = np.abs(states[:, 0] - np.cos(times)).max()
    assert 10 * choice.error < worst == pytest.approx(choice.error_anywhere, rel=0.05)


@pytest.mark.parametrize("longest", [0.0, -1.0, math.nan])
def test_a_longest_step_is_above_0(longest):
    with pytest.raises(a3.InputError, match="the longest step"):
        a3.Simulation(a3.System(lambda t, y: -y, [1.0]), "dopri5", max_step=longest)


def test_a_function_of_the_state_counts():
    """The radius of a turn falls by |1 + z + z^2 / 2 + z^3 / 6 + z^4 / 24|, z = ih, in each step of RK4."""

    def turn(t, y):
        return np.array([y[1], -y[0]])

    def radius(t, y):
        return math.hypot(*y)

    system = a3.System(turn, [1.0, 0.0])
    chart = a3.chart(system, ["rk4"], until=5.0, quantity=radius, at_end=True, progress=False)
    checked = 0
    for point in chart.points:
        z, steps = 1j * point.setting, 5.0 / point.setting
        shrinks = 1 - abs(1 + z + z**2 / 2 + z**3 / 6 + z**4 / 24) ** steps
        if abs(steps - round(steps)) < 1e-9 and shrinks > 1e-9:
            assert abs(point.error / shrinks - 1) < 0.01, (point, shrinks)
            checked += 1
    assert checked >= 2, [point.setting for point in chart.points]
    # Both numbers together: the phase, which is wrong by h^5 / 120 a step, does not count.
    chosen = [
        a3.choose(system, 1e-6, methods=["rk4"], until=5.0, progress=False, **only)
        for only in ({"quantity": radius}, {"quantity": lambda t, y: [radius(t, y), 2.0]}, {})
    ]
    assert chosen[0].setting > 1.3 * chosen[2].setting and chosen[1].setting >= chosen[0].setting
    for wrong, words in [
        ({"quantity": 3}, "a function is expected"),
        ({"quantity": lambda t, y: []}, "at least one quantity"),
        ({"quantity": radius, "component": 1}, "no quantity 1"),
    ]:
        with pytest.raises(a3.InputError, match=words):
            a3.chart(system, ["rk4"], until=2.0, progress=False, **wrong)
    with pytest.raises(ZeroDivisionError):
        a3.chart(system, ["rk4"], until=2.0, progress=False, quantity=lambda t, y: 1 / 0 if t > 1 else y)
    with pytest.raises(a3.InputError, match="has particles"):
        a3.choose("chain", 1e-3, quantity=radius)


def test_the_energy_of_an_own_system_is_charted():
    """Verlet's energy of an oscillator swings by h^2 / 8 of it, and does not drift."""
    system = a3.System.of_particles(
        lambda t, x, v: -x,
        [1.0],
        [[1.0, 0.0, 0.0]],
        positional=True,
        energy=lambda t, x, v: 0.5 * float((x * x).sum() + (v * v).sum()),
    )
    for until in (10.0, 40.0):
        chart = a3.chart(system, ["verlet"], error="energy", until=until, progress=False)
        found = [point for point in chart.points if 0.001 < point.setting < 0.02]
        assert found
        for point in found:
            assert 0.9 < point.error / (point.setting**2 / 8) < 1.1, point
    assert a3.choose(system, 1e-6, of="energy", until=10.0, progress=False).error < 1e-6
    plain = a3.System.of_particles(lambda t, x, v: -x, [1.0], [[1.0, 0.0, 0.0]])
    with pytest.raises(a3.InputError, match="neither energy"):
        a3.chart(plain, ["verlet"], error="energy", until=1.0, progress=False)
    wrong = a3.System.of_particles(lambda t, x, v: -x, [1.0], [[1.0, 0.0, 0.0]], energy=lambda t, x, v: x)
    with pytest.raises(a3.InputError, match="where a number is expected"):
        a3.chart(wrong, ["verlet"], error="energy", until=1.0, progress=False)


#: Weights of the pair of Dormand and Prince.
PRINCE = [
    [0, 0, 0, 0, 0, 0],
    [1 / 5, 0, 0, 0, 0, 0],
    [3 / 40, 9 / 40, 0, 0, 0, 0],
    [44 / 45, -56 / 15, 32 / 9, 0, 0, 0],
    [19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729, 0, 0],
    [9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656, 0],
]
ENDS = [35 / 384, 0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84]
OTHERS = [5179 / 57600, 0, 7571 / 16695, 393 / 640, -92097 / 339200, 187 / 2100, 1 / 40]


def test_tableaux_are_methods():
    def orbit(t, y):
        r = math.hypot(y[0], y[1]) ** 3
        return [y[2], y[3], -y[0] / r, -y[1] / r]

    y0 = [0.5, 0.0, 0.0, math.sqrt(3.0)]
    pair = a3.Method.tableau("my-prince", PRINCE, ENDS, OTHERS, c=[0, 0.2, 0.3, 0.8, 8 / 9, 1])
    fixed = a3.Method.tableau("my-prince-fixed", PRINCE, ENDS)
    assert (pair.order, fixed.order) == (5, 5)
    runs = [a3.Simulation(a3.System(orbit, y0), method, tolerance=1e-8) for method in (pair, "dopri5")]
    for run in runs:
        run.advance_to(20.0)
    assert runs[0].steps == runs[1].steps and runs[0].work.evaluations == runs[1].work.evaluations
    assert np.allclose(runs[0].state, runs[1].state, rtol=0, atol=1e-4)
    errors = []
    for count in (200, 400):
        run = a3.Simulation(a3.System(orbit, y0), fixed, step=2 * math.pi / count)
        run.advance_to(2 * math.pi)
        errors.append(np.abs(run.state - y0).max())
    assert 4.5 < math.log2(errors[0] / errors[1]) < 6.5, errors
    chart = a3.chart(a3.System(orbit, y0), [pair, "dopri5"], until=5.0, progress=False)
    assert set(chart.methods) == {"my-prince", "dopri5"}
    assert copy.copy(pair).name == pickle.loads(pickle.dumps(pair)).name
    implicit = [[0.5]]
    for wrong, words in [
        ((implicit, [1.0]), "stage 0 of the tableau depends on stage 0"),
        ((PRINCE, ENDS[:5]), "a row of A for each weight"),
        ((PRINCE, ENDS, OTHERS[:5]), "as many weights as b"),
        ((PRINCE, [0.2] * 6), "sum to 1"),
        ((PRINCE, ENDS, ENDS), "estimates no error"),
        ((PRINCE, ENDS, OTHERS, [0, 0.2, 0.3, 0.8, 0.9, 1]), "stage 4 is at 0.9"),
        (([[math.nan]], [1.0]), "finite"),
    ]:
        with pytest.raises(a3.InputError, match=words):
            a3.Method.tableau("my-wrong", *wrong)


def test_a_jacobian_that_is_not_finite_is_named():
    for method, control in (("bdf", {"tolerance": 1e-5}), ("radau", {"tolerance": 1e-5}), ("implicit", {"step": 0.01})):
        system = a3.System(lambda t, y: -y, [1.0, 2.0], jac=lambda t, y: [[-1.0, 0.0], [math.nan, -1.0]])
        with pytest.raises(a3.Error, match="Jacobian is NaN in row 1 and column 0 at t = 0"):
            a3.Simulation(system, method, **control).advance_to(1.0)


class Bashforth:
    """Adams and Bashforth's method of order 2, which keeps the last derivative; a step that does not go on is Heun's."""

    begun = 0

    def __init__(self):
        Bashforth.begun += 1
        self.next, self.last = None, None

    def __call__(self, f, t, y, h):
        k, last, goes_on = f(t, y), self.last, self.next is not None and np.allclose(self.next, (t, h), 1e-9, 1e-12)
        self.next, self.last = (t + h, h), k
        if not goes_on:
            return y + h / 2 * (k + f(t + h, y + h * k))
        return y + h * (1.5 * k - 0.5 * last)


class Bashforth3(Bashforth):
    """Adams and Bashforth's method of order 3, which starts with two steps of order 2."""

    def __init__(self):
        self.past = []

    def __call__(self, f, t, y, h):
        k = f(t, y)
        self.past = [k, *self.past[:2]]
        if len(self.past) < 3:
            return y + h / 2 * (k + f(t + h, y + h * k))
        a, b, c = self.past
        return y + h / 12 * (23 * a - 16 * b + 5 * c)


def test_classes_begin_with_each_run():
    assert a3.Method("my-bashforth-3", Bashforth3).order == 3
    method = a3.Method("my-bashforth", Bashforth)
    assert method.order == 2
    errors, begun = [], Bashforth.begun
    for count, numbers in ((200, 1), (400, 1), (400, 3)):
        run = a3.Simulation(a3.System(lambda t, y: -y, [1.0] * numbers), method, step=1 / count)
        run.advance_to(1.0)
        errors.append(abs(run.state[0] - math.exp(-1)))
    assert errors[1] == errors[2] and 3.9 < errors[0] / errors[1] < 4.1, errors
    assert Bashforth.begun >= begun + 3
    chart = a3.chart(a3.System(lambda t, y: [y[1], -y[0]], [1.0, 0.0]), [method, "rk4"], until=3, progress=False)
    assert "my-bashforth" in chart.methods

    class Broken:
        def __init__(self):
            raise ValueError("no memory")

    broken = a3.Method("my-broken", Broken, order=2)
    with pytest.raises(ValueError, match="no memory"):
        a3.Simulation(a3.System(lambda t, y: -y, [1.0]), broken, step=0.1).advance_to(1.0)


def shampine(f, t, y, h):
    """The pair of Bogacki and Shampine."""
    k1 = f(t, y)
    k2 = f(t + h / 2, y + h / 2 * k1)
    k3 = f(t + 0.75 * h, y + 0.75 * h * k2)
    end = y + h / 9 * (2 * k1 + 3 * k2 + 4 * k3)
    return end, h / 72 * (-5 * k1 + 6 * k2 + 8 * k3 - 9 * f(t + h, end))


def test_steps_with_estimates_are_chosen_to_a_tolerance():
    method = a3.Method("my-shampine", shampine, adaptive=True)
    assert method.order == 3 and pickle.loads(pickle.dumps(method)).order == 3
    system = a3.System(lambda t, y: [y[1], -y[0]], [1.0, 0.0])
    steps = []
    for tolerance in (1e-5, 1e-8):
        run = a3.Simulation(system, method, tolerance=tolerance)
        run.advance_to(5.0)
        assert abs(run.state[0] - math.cos(5.0)) < 30 * tolerance
        steps.append(run.steps)
    # Of order 3, a thousandth of the error takes ten times the steps.
    assert 8 < steps[1] / steps[0] < 12, steps
    chosen = a3.choose(system, error=1e-5, until=3, methods=[method], progress=False)
    chart = a3.chart(system, [method, "dopri5"], until=3, progress=False)
    assert chosen.method == "my-shampine" and "my-shampine" in chart.methods
    for step, words in ((lambda f, t, y, h: y, "shape"), (lambda f, t, y, h: 1 / 0, "division")):
        wrong = a3.Method("my-wrong", step, order=2, adaptive=True)
        with pytest.raises((a3.InputError, ZeroDivisionError), match=words):
            a3.Simulation(system, wrong, tolerance=1e-4).advance_to(1.0)
    with pytest.raises(a3.InputError, match="not a class"):
        a3.Method("my-class", Bashforth, adaptive=True)
    with pytest.raises(a3.InputError, match="takes a tolerance"):
        a3.Method("my-step", shampine, adaptive=True, default_step=0.1)


def test_events_are_located():
    """A ball that bounces: times of its bounces by all kinds of methods, against the closed form."""
    g, kept = 9.81, 0.8
    for method, control in (
        ("dopri5", {"tolerance": 1e-9}),
        ("radau", {"tolerance": 1e-9}),
        ("rk4", {"step": 0.013}),
        ("dop853", {"tolerance": 1e-9}),
    ):
        run = a3.Simulation(a3.System(lambda t, y: [y[1], -g], [1.0, 0.0]), method, **control)
        times = []
        while run.advance_until(lambda t, y: y[0], 3.0):
            assert abs(run.state[0]) < 1e-9
            times.append(run.time)
            run.set_state([0.0, -kept * run.state[1]])
        fall = math.sqrt(2 / g)
        right = [fall * (1 + 2 * sum(kept**j for j in range(1, k + 1))) for k in range(20)]
        right = [t for t in right if t < 3.0]
        assert len(times) == len(right) and run.time == 3.0, (method, times, right)
        assert np.allclose(times, right, rtol=0, atol=1e-8), (method, times, right)
    # Passages one by one, also without a change; the run itself is as without them.
    plain = a3.Simulation(a3.System(lambda t, y: [y[1], -y[0]], [1.0, 0.0]), "dop853", tolerance=1e-10)
    asked = a3.Simulation(a3.System(lambda t, y: [y[1], -y[0]], [1.0, 0.0]), "dop853", tolerance=1e-10)
    found = {0: [], 1: [], -1: []}
    for direction, times in found.items():
        asked.reset()
        while asked.advance_until(lambda t, y: y[0], 10.0, direction):
            times.append(asked.time)
    assert np.allclose(found[0], [math.pi * (k + 0.5) for k in range(3)], atol=1e-8)
    assert found[-1] == found[0][::2] and found[1] == found[0][1::2]
    plain.advance_to(10.0)
    assert (plain.state == asked.state).all()
    asked.reset()
    for wrong, error in [
        (lambda t, y: y, a3.InputError),
        (lambda t, y: math.nan, a3.InputError),
        (lambda t, y: 1 / 0, ZeroDivisionError),
        (3, a3.InputError),
    ]:
        with pytest.raises(error):
            asked.advance_until(wrong, 1.0)
    for wrong in ([1.0], [math.nan, 0.0]):
        with pytest.raises(a3.InputError):
            asked.set_state(wrong)
    with pytest.raises(a3.InputError, match="one's own"):
        a3.Simulation("chain").set_state([0.0])


def test_a_pulse_from_rest_is_not_missed():
    def pulse(t, y):
        return [1.0 if 5.0 <= t < 5.001 else 0.0]

    for method, control in (("dopri5", {"tolerance": 1e-6}), ("bdf", {"tolerance": 1e-6}), ("rk4", {"step": 0.3})):
        run = a3.Simulation(a3.System(pulse, [0.0], tstops=[5.001, 5.0]), method, **control)
        run.advance_to(9.9)
        assert abs(run.state[0] - 1e-3) < 1e-9, (method, run.state)
    for wrong in ([math.nan], "soon", [[1.0]]):
        with pytest.raises(a3.InputError, match="tstops"):
            a3.System(pulse, [0.0], tstops=wrong)


def test_a_solver_of_another_library_is_charted():
    integrate = pytest.importorskip("scipy.integrate")

    def rk45(f, times, y0, tol):
        return integrate.solve_ivp(f, (0, times[-1]), y0, "RK45", times, rtol=tol, atol=tol).y.T

    def end(f, times, y0, tol):
        return integrate.solve_ivp(f, (0, times[-1]), y0, "DOP853", rtol=tol, atol=tol).y[:, -1]

    system = a3.System(lambda t, y: np.array([y[1], -y[0]]), [1.0, 0.0])
    scipy, whole = a3.foreign("SciPy RK45", rk45), a3.foreign("SciPy DOP853", end)
    chart = a3.chart(system, ["dopri5", scipy], until=5.0, progress=False)
    assert chart.methods == ["dopri5", "SciPy RK45"] and "SciPy RK45" in chart.table
    runs = chart.of(scipy)
    calls = []

    def counted(t, y):
        calls.append(t)
        return [y[1], -y[0]]

    k = np.flatnonzero(runs["error"] < 1e-4)[0]
    times = np.linspace(0, 5, 301)[1:]
    states = rk45(counted, times, [1.0, 0.0], runs["setting"][k])
    off = np.sqrt(((states - np.array([np.cos(times), -np.sin(times)]).T) ** 2).mean(axis=1)).max()
    assert runs["work"][k] == len(calls)
    assert runs["error"][k] == pytest.approx(off, rel=0.05)
    # The same formulas, with errors of the same size at the same cost.
    own = chart.of("dopri5")
    by_work = np.argsort(own["work"])
    near = np.interp(np.log(runs["work"][k]), np.log(own["work"][by_work]), np.log(own["error"][by_work]))
    assert abs(near - np.log(off)) < np.log(20)
    at_end = a3.chart(system, [whole], until=5.0, at_end=True, progress=False)
    assert at_end.of(whole)["error"].min() < 1e-8
    # Its Jacobian comes from columns of a matrix.
    implicit = a3.foreign(
        "SciPy BDF",
        lambda f, times, y0, tol: integrate.solve_ivp(f, (0, times[-1]), y0, "BDF", times, rtol=tol, atol=tol).y.T,
    )
    assert a3.chart(system, [implicit], until=5.0, progress=False).of(implicit)["error"].min() < 1e-4
    gives_up = a3.foreign("gives up", lambda f, times, y0, tol: rk45(f, times, y0, tol)[: -1 if tol > 1e-5 else None])
    found = a3.chart(system, [gives_up], until=5.0, progress=False).of(gives_up)
    assert np.isnan(found["error"][found["setting"] > 1e-5]).all()
    assert np.isfinite(found["error"][found["setting"] < 1e-5]).all()
    with pytest.raises(a3.InputError, match="for the end alone, chart with at_end=True"):
        a3.chart(system, [whole], until=5.0, progress=False)
    with pytest.raises(a3.InputError, match="a choice is among"):
        a3.choose(system, 1e-4, methods=[scipy], until=5.0, progress=False)
    with pytest.raises(a3.Error, match="takes no steps"):
        a3.Simulation(system, scipy, tolerance=1e-6)
    with pytest.raises(a3.Error, match="networks"):
        a3.chart("chain", [scipy], progress=False)
    with pytest.raises(a3.InputError, match="a function of f"):
        a3.foreign("none", 3)
