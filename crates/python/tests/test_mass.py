"""Systems M y' = f(t, y)."""

import numpy as np
import pytest
from scipy import sparse
from scipy.integrate import solve_ivp

import a3_simulator as a3


def robertson(t, y):
    slow, fast, end = 0.04 * y[0], 1e4 * y[1] * y[2], 3e7 * y[1] ** 2
    return np.array([fast - slow, slow - fast - end, y.sum() - 1.0])


def kinetics(t, y):
    slow, fast, end = 0.04 * y[0], 1e4 * y[1] * y[2], 3e7 * y[1] ** 2
    return [fast - slow, slow - fast - end, end]


@pytest.mark.parametrize("method", ["radau", "bdf"])
@pytest.mark.parametrize("mass", [[1, 1, 0], np.diag([1.0, 1.0, 0.0]), sparse.csr_array(np.diag([1.0, 1.0, 0.0]))])
def test_robertson_agrees_with_scipy(method, mass):
    system = a3.System(robertson, [1.0, 0.0, 0.0], mass=mass)
    times = [0.4, 40.0, 4000.0]
    found = a3.Simulation(system, method, tolerance=1e-8).states_at(times)
    truth = solve_ivp(kinetics, (0, 4000), [1.0, 0.0, 0.0], "Radau", times, rtol=1e-10, atol=1e-14).y.T
    assert found == pytest.approx(truth, rel=1e-4)


def test_a_large_sparse_matrix_agrees_with_scipy():
    n = 200
    h = 1 / (n + 1)
    mass = h / 6 * sparse.diags_array([1.0, 4.0, 1.0], offsets=[-1, 0, 1], shape=(n, n))
    stiffness = sparse.diags_array([1.0, -2.0, 1.0], offsets=[-1, 0, 1], shape=(n, n)) / h

    def heat(t, y):
        return stiffness @ y + h * np.exp(y)

    x = np.arange(1, n + 1) * h
    inverse = np.linalg.inv(mass.toarray())
    truth = solve_ivp(lambda t, y: inverse @ heat(t, y), (0, 0.2), np.sin(np.pi * x), "BDF", rtol=1e-9, atol=1e-11)
    jac = lambda t, y: stiffness + sparse.diags_array(h * np.exp(y))  # noqa: E731
    for options in [{}, {"jac": jac}]:
        run = a3.Simulation(a3.System(heat, np.sin(np.pi * x), mass=mass, **options), "radau", tolerance=1e-7)
        assert run.states_at([0.2])[0] == pytest.approx(truth.y[:, -1], abs=1e-6)
        assert run.work.evaluations < 1500


def test_complex_numbers_and_other_shapes_have_mass_matrices():
    # 2 z' = i z - z, and w = z squared.
    def f(t, y):
        z, w = y[0]
        return np.array([[(1j - 1) * z, w - z * z]])

    run = a3.Simulation(a3.System(f, [[1.0, 1.0 + 0j]], mass=[2, 0]), "radau", tolerance=1e-9)
    z = np.exp((1j - 1) / 2)
    assert run.states_at([1.0])[0, 0] == pytest.approx(np.array([z, z * z]), abs=1e-7)
    turned = a3.System(lambda t, z: 1j * z, [1.0 + 0j], mass=[[1j]])
    run = a3.Simulation(turned, "bdf", tolerance=1e-9)
    assert run.states_at([1.0])[0, 0] == pytest.approx(np.exp(1), abs=1e-6)


def test_back_in_time():
    # y' = -z with z = y.
    system = a3.System(lambda t, y: [-y[1], y[1] - y[0]], [1.0, 1.0], mass=[1, 0])
    run = a3.Simulation(system, "radau", tolerance=1e-9, backward=True)
    assert run.states_at([-1.0])[0] == pytest.approx([np.e, np.e], abs=1e-6)


def test_charts_and_choices_have_the_methods_that_serve():
    system = a3.System(robertson, [1.0, 0.0, 0.0], mass=[1, 1, 0])
    chart = a3.chart(system, until=40, progress=False)
    assert sorted(chart.methods) == ["bdf", "radau"]
    best = {name: np.nanmin(chart.of(name)["error"]) for name in chart.methods}
    assert best["radau"] < 1e-8 and best["bdf"] < 1e-5
    assert all(point.floor < 1e-9 for point in chart.points)
    found = a3.choose(system, error=1e-6, until=40, progress=False)
    assert found.method in ("radau", "bdf") and found.error <= 1e-6


def test_what_cannot_be_served_is_refused():
    system = a3.System(robertson, [1.0, 0.0, 0.0], mass=[1, 1, 0])
    with pytest.raises(a3.InputError, match=r"dop853|8\(5,3\).*mass matrix, M y' = f\(t, y\): use radau or bdf"):
        a3.Simulation(system)
    with pytest.raises(a3.InputError, match="runs? to tolerances alone"):
        a3.stability(system, methods=["radau"], progress=False)
    with pytest.raises(a3.InputError, match="no phase is known"):
        a3.chart(system, until=40, error="phase", progress=False)
    deep = a3.System(lambda t, y: [y[1], y[0] - np.sin(t)], [0.0, 1.0], mass=[1, 0])
    with pytest.raises(a3.InputError, match="differentiate them until they do"):
        a3.Simulation(deep, "radau").advance_to(1.0)
    for mass, why in [
        ([1.0, 1.0], r"an array of shape \(3,\) is expected"),
        (np.eye(2), r"an array of shape \(3, 3\) is expected"),
        (sparse.eye_array(2), r"a matrix of shape \(3, 3\) is expected"),
        (np.full((3, 3), np.nan), "finite numbers are expected"),
        ([[1j, 0, 0]] * 3, "real numbers are expected"),
        ("heavy", "numbers are expected"),
        ([0, 0, 0], "the matrix is 0"),
    ]:
        with pytest.raises(a3.InputError, match=f"mass: {why}"):
            a3.System(robertson, [1.0, 0.0, 0.0], mass=mass)
