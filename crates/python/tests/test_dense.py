"""States between the ends of steps, on polynomials of one's own methods."""

import math
import pickle

import numpy as np
import pytest
from scipy.integrate import RK45

import a3_simulator as a3


def turn(t, y):
    return np.array([y[1], -y[0]])


def circle(times):
    return np.column_stack([np.cos(times), -np.sin(times)])


def rk45(name, P):
    b_hat = np.append(RK45.B, 0.0) - RK45.E
    return a3.Method.tableau(name, RK45.A, RK45.B, b_hat, RK45.C, P)


def taylor(f, t, y, h):
    """A step of Taylor's series of a linear system without t, of order 13, with its polynomial."""
    term, terms = y, []
    for j in range(1, 14):
        term = h / j * f(t, term)
        terms.append(term)
    return [y + sum(terms), terms[-1], *terms]


def test_a_tableau_has_the_polynomial_of_scipy():
    system, times = a3.System(turn, [1.0, 0.0]), np.linspace(0, 10, 200)
    errors = {}
    for name, P in [("own-dense", RK45.P), ("own-cubic", None)]:
        run = a3.Simulation(system, rk45(name, P), tolerance=1e-9)
        steps = run.states_at(times)
        errors[name] = np.abs(steps - circle(times)).max()
        ends = run.work.evaluations
        whole = a3.Simulation(system, rk45(name, P), tolerance=1e-9)
        whole.advance_to(10.0)
        # States at given times cost nothing.
        assert whole.work.evaluations == ends
    dopri5 = a3.Simulation(system, "dopri5", tolerance=1e-9).states_at(times)
    own = np.abs(dopri5 - circle(times)).max()
    assert errors["own-dense"] < 2 * own < errors["own-cubic"]


def test_a_step_may_return_its_polynomial():
    dense = a3.Method("taylor-13", taylor, 13, adaptive=True, degree=13)
    assert pickle.loads(pickle.dumps(dense))._options["degree"] == 13
    cubic = a3.Method("taylor-13-cubic", lambda f, t, y, h: taylor(f, t, y, h)[:2], 13, adaptive=True)
    system, times = a3.System(turn, [1.0, 0.0]), np.linspace(0, 10, 100)
    misses, steps = [], []
    for method in (dense, cubic):
        run = a3.Simulation(system, method, tolerance=1e-10)
        misses.append(np.abs(run.states_at(times) - circle(times)).max())
        steps.append(run.steps)
    assert steps[0] == steps[1] < 20
    assert misses[0] < 1e-8 and misses[1] > 1e-4
    # So a chart shows the method's own errors.
    chart = a3.chart(system, methods=[dense, cubic], until=10, progress=False)
    assert np.nanmin(chart.of(dense)["error"]) < 1e-9
    # A pickled run goes on within its step.
    run = a3.Simulation(system, dense, tolerance=1e-10)
    run.advance_to(0.1)
    again = pickle.loads(pickle.dumps(run))
    for it in (run, again):
        it.advance_to(0.2)
    assert (run.state == again.state).all()
    assert run.state[0] == pytest.approx(math.cos(0.2), abs=1e-9)


def test_wrong_polynomials_are_refused():
    system = a3.System(turn, [1.0, 0.0])
    with pytest.raises(a3.InputError, match="P: an array of shape"):
        rk45("own-p", [1.0, 2.0])
    with pytest.raises(a3.InputError, match="P has as many rows as b has weights, 6, or one more"):
        rk45("own-p", np.ones((3, 4)))
    with pytest.raises(a3.InputError, match="row 0 of P sums to 2"):
        rk45("own-p", np.full((7, 4), 0.5))
    with pytest.raises(a3.InputError, match="without b_hat takes fixed steps"):
        a3.Method.tableau("own-p", [[0.0]], [1.0], P=[[1.0]])
    with pytest.raises(a3.InputError, match="degree is at least 1, of a method with adaptive=True"):
        a3.Method("own-p", taylor, 13, degree=3)
    wrong = a3.Method("own-wrong", lambda f, t, y, h: [*taylor(f, t, y, h)[:2], y], 13, adaptive=True, degree=1)
    with pytest.raises(a3.Error, match="own-wrong returned do not sum to the change of its step"):
        a3.Simulation(system, wrong).advance_to(1.0)
    few = a3.Method("own-few", taylor, 13, adaptive=True, degree=5)
    with pytest.raises(a3.InputError, match=r"shape \(15, 2\), where an array of shape \(7, 2\) is expected"):
        a3.Simulation(system, few).advance_to(1.0)
