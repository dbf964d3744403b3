"""Charts, choices, limits and comparisons: values, pictures, refusals, interrupts."""

import copy
import os
import pickle
import shlex
import signal
import subprocess
import threading
import time

import numpy as np
import pytest

import a3_simulator as a3

SVG, PDF, PNG = b"<svg", b"%PDF", b"\x89PNG"


def oscillator(t, y):
    return np.array([y[1], -y[0]])


def midpoint(f, t, y, h):
    return y + h * f(t + h / 2, y + h / 2 * f(t, y))


@pytest.fixture(scope="module")
def chart():
    methods = ["heun", "rk4", a3.Method("my-midpoint", midpoint)]
    return a3.chart("chain", methods, until=1, progress=False)


def test_a_chart_has_runs_of_each_method_with_their_orders(chart):
    assert set(chart.methods) == {"trapezoid", "rk4", "my-midpoint"}
    assert chart.error == "position" and chart.unit == "m" and chart.until == 1 and chart.complete
    for method, order in [("trapezoid", 2), ("my-midpoint", 2), ("rk4", 4)]:
        runs = chart.of(method)
        finest = np.argmin(runs["setting"])
        assert runs["order"][finest] == pytest.approx(order, abs=0.3)
        assert (np.diff(runs["error"][np.argsort(runs["setting"])]) > 0).sum() > len(runs["setting"]) / 2
    own, of_a3 = (chart.of(name) for name in ("my-midpoint", "trapezoid"))
    shared = set(own["setting"]) & set(of_a3["setting"])
    assert shared and set(own["evaluations"] * own["setting"]) == set(of_a3["evaluations"] * of_a3["setting"])


def test_the_winners_of_a_chart_are_values(chart):
    assert len(chart.winners) > 2
    for error, run in chart.winners:
        assert run in chart.points and run.error <= error
        assert run.work == min(point.work for point in chart.points if point.error <= error)


def test_a_chart_draws_itself(chart, tmp_path):
    assert chart._repr_svg_().startswith("<svg") or "<svg" in chart._repr_svg_()[:200]
    assert "my-midpoint" in chart.svg
    for kind, begins in [("svg", SVG), ("pdf", PDF), ("png", PNG)]:
        chart.save(tmp_path / f"chart.{kind}")
        assert begins in (tmp_path / f"chart.{kind}").read_bytes()[:200]
    chart.save(tmp_path / "wide.svg", size=(1200, 400))
    assert "1200" in (tmp_path / "wide.svg").read_text()[:300]
    assert "rk4" in str(chart) and "Chart of" in repr(chart)
    with pytest.raises(a3.InputError, match="saved as .svg, .pdf or .png"):
        chart.save(tmp_path / "chart.jpg")
    with pytest.raises(OSError):
        chart.save(tmp_path / "nowhere" / "chart.svg")
    assert sorted(file.name for file in tmp_path.iterdir()) == ["chart.pdf", "chart.png", "chart.svg", "wide.svg"]


def test_a_chart_is_pickled(chart, tmp_path):
    again = pickle.loads(pickle.dumps(chart))
    assert again.svg == chart.svg and str(again.points) == str(chart.points)
    again.save(tmp_path / "chart.pdf")
    assert copy.copy(chart).svg == chart.svg
    with pytest.raises(a3.InputError, match="leave out size"):
        again.save(tmp_path / "chart.svg", size=(1000, 400))


def test_a_chart_becomes_a_table_of_pandas(chart):
    pandas = pytest.importorskip("pandas")
    table = chart.to_pandas()
    assert isinstance(table, pandas.DataFrame)
    assert len(table) == len(chart.points) and list(table.columns) == list(a3.Point._fields)


def test_a_chart_of_a_system_of_ones_own():
    chart = a3.chart(a3.System(oscillator, [1.0, 0.0]), ["rk4", "dop853"], until=10, progress=False)
    assert chart.error == "state" and chart.unit == ""
    runs = chart.of("dop853")
    sharp = runs["setting"] < 1e-5
    assert (runs["error"][sharp] < 1e-4).all()


def test_a_chart_of_computing_times():
    chart = a3.chart("chain", "rk4", until=0.2, work="time", progress=False)
    assert all(point.seconds > 0 for point in chart.points if np.isnan(point.blew_up_at))


def test_a_choice_can_be_run(program, tmp_path):
    choice = a3.choose("chain", error=1e-4, until=1, progress=False)
    assert choice.error <= 1e-4 and choice.work > 0 and choice.others
    assert choice.work <= choice.others[0].work
    adaptive = {method.name: method.adaptive for method in a3.methods()}[choice.method]
    run = a3.Simulation("chain", choice.method, **{"tolerance" if adaptive else "step": choice.setting})
    run.advance_to(1.0)
    exact = a3.Simulation("chain", "dop853", tolerance=1e-12)
    exact.advance_to(1.0)
    assert np.sqrt(np.mean(np.sum((run.positions - exact.positions) ** 2, axis=1))) < 1.1e-4
    words = shlex.split(choice.command)
    assert words[0] == "a3" and "chain" in words
    file = tmp_path / "state.json"
    subprocess.run([program, "simulate", *words[1:], "--until", "1", "--output", file], check=True)
    assert pickle.loads(pickle.dumps(choice)) == choice


def test_a_choice_for_a_budget():
    choice = a3.choose("chain", budget=5, until=0.5, methods=["rk4", "verlet"], progress=False)
    assert choice.milliseconds <= 5 and choice.method in ("rk4", "verlet")


def test_limits_of_steps():
    limits = a3.stability("chain", ["rk4", "euler", "implicit", a3.Method("my-midpoint", midpoint)], progress=False)
    assert limits["rk4"].in_motion > limits["my-midpoint"].in_motion > limits["euler"].in_motion
    assert limits["implicit"].at_rest == np.inf
    # The fastest motion of the chain, and the limit of Runge-Kutta's method on the imaginary axis.
    stiffness = np.array([[2.0, -1, 0], [-1, 2, -1], [0, -1, 1]]) * 25
    fastest = np.sqrt(np.linalg.eigvalsh(stiffness).max())
    assert limits["rk4"].at_rest == pytest.approx(2 * np.sqrt(2) / fastest, rel=0.1)
    assert "<svg" in limits.svg[:200] and "rk4" in str(limits)
    assert pickle.loads(pickle.dumps(limits)).svg == limits.svg
    with pytest.raises(KeyError):
        limits["verlet"]


@pytest.mark.parametrize("scene", ["chain", "double-pendulum", "jelly"])
def test_limits_have_the_facts_of_their_table(scene):
    limits = a3.stability(scene, ["rk4", "verlet"], progress=False)
    head, rows = limits.table.split("\n\n", 1)
    rows = rows.splitlines()
    for fact, time in [(limits.fastest, "at the start"), (limits.fastest_at_rest, "at rest")]:
        if fact is not None:
            assert f"{fact.frequency:.1f} rad/s, damping ratio {fact.damping_ratio:.3f} {time}" in head
    assert (limits.fastest is None) == ("no motion" in head)
    assert (limits.feedback is not None) == ("errors of constraints" in head)
    assert limits.feedback is None or f"decay at {limits.feedback:.1f} / s" in head
    assert f"in the first {limits.predictable:.2f} s" in limits.table
    for row in limits.limits:
        cells = next(line for line in rows if line.startswith(row.method)).split()
        held = cells[4].split("\u2013")[-1].lstrip(">")
        for cell, fact in [(cells[1], row.at_rest), (held, row.in_motion), (cells[5], row.accurate)]:
            assert np.isnan(fact) if cell == "-" else float(cell) == pytest.approx(1000 * fact, rel=0.01)


def test_runs_are_compared():
    compared = a3.compare("chain", [("rk4", 0.01), ("dop853", 1e-10), "euler"], until=1.0, frames=10, progress=False)
    assert compared.times == pytest.approx(np.linspace(0, 1, 11))
    run = compared.runs[0]
    assert run.states.shape == (11, 24) and run.positions.shape == (11, 4, 3) and run.energies.shape == (11,)
    alone = a3.Simulation("chain", "rk4", step=0.01)
    alone.advance_to(1.0)
    assert np.array_equal(run.positions[-1], alone.positions)
    assert compared.distance(0, 1).shape == (11,) and compared.distance(0, 1)[-1] < 1e-5
    assert compared.distance(2, 1)[-1] > compared.distance(0, 1)[-1]


def test_a_comparison_becomes_a_table_of_pandas():
    pandas = pytest.importorskip("pandas")
    runs = a3.compare("chain", [("rk4", 0.01), ("dopri5", 1e-4)], until=0.1)
    table = runs.to_pandas()
    assert isinstance(table, pandas.DataFrame) and len(table) == 2 * len(runs.times)
    of_rk4 = table[table.method == "rk4"]
    assert (of_rk4.time == runs.times).all() and (of_rk4.y0 == runs.runs[0].states[:, 0]).all()
    assert (of_rk4.energy == runs.runs[0].energies).all() and (of_rk4.setting == 0.01).all()


def test_a_comparison_tells_of_a_blow_up():
    compared = a3.compare("cloth", [("euler", 0.5), "rk4"], until=5.0, frames=10, progress=False)
    assert "blew up" in compared.runs[0].blow_up and compared.runs[1].blow_up is None
    assert 0 < compared.runs[0].blew_up_at and compared.runs[1].blew_up_at is None
    assert len(compared.runs[0].states) < len(compared.runs[1].states) == 11


@pytest.mark.parametrize(
    "measure, words",
    [
        (lambda: a3.chart("chain", ["rk5"]), "did you mean rk4?"),
        (lambda: a3.chart("simple", ["verlet"]), "needs forces and masses"),
        (lambda: a3.chart("chain", ["rk4"], until=-1), "the end is a number of seconds"),
        (lambda: a3.chart("chain", ["rk4"], until=float("nan")), "the end is a number of seconds"),
        (lambda: a3.chart("chain", ["rk4"], error="smell"), "there is no error `smell`"),
        (lambda: a3.chart("chain", ["rk4"], error="impact"), "no surfaces touch"),
        (lambda: a3.chart("chain", ["rk4"], work="sweat"), "work is evaluations or time"),
        (lambda: a3.chart("chain", ["rk4"], particle=9), "has no particle 9"),
        (lambda: a3.chart("chain", ["rk4"], stiffness=[0]), "stiffness"),
        (lambda: a3.chart("chain", [None]), "a method is a name"),
        (lambda: a3.choose("chain"), "either error"),
        (lambda: a3.choose("chain", error=1e-4, budget=1), "either error"),
        (lambda: a3.choose("chain", error=-1), "an error is a number"),
        (lambda: a3.compare("chain", ["rk4"], until=0), "the end is a number of seconds above 0"),
        (lambda: a3.compare("chain", ["rk4"], until=1, frames=0), "the number of frames"),
        (lambda: a3.compare("chain", [("rk4", -1)], until=1), "a step is a number"),
        (lambda: a3.stability("nowhere"), "there is no such scene"),
    ],
)
def test_a_wrong_request_is_one_clear_line(measure, words):
    with pytest.raises(a3.InputError) as error:
        measure()
    assert words in str(error.value) and "\n" not in str(error.value)


class Broken(Exception):
    pass


def broken(t, y):
    if t > 0.3:
        raise Broken("in f")
    return -y


@pytest.mark.parametrize(
    "measure",
    [
        lambda system: a3.chart(system, ["rk4", "dopri5"], until=1, progress=False),
        lambda system: a3.choose(system, error=1e-3, until=1, progress=False),
        lambda system: a3.stability(system, ["rk4"], progress=False),
        lambda system: a3.compare(system, ["rk4", "dopri5"], until=1, progress=False),
    ],
)
def test_an_exception_of_f_comes_out_as_it_is(measure):
    with pytest.raises(Broken, match="in f") as error:
        measure(a3.System(broken, [1.0]))
    assert error.traceback[-1].name == "broken"


def test_an_exception_of_a_step_comes_out_as_it_is():
    def step(f, t, y, h):
        if h < 0.01:
            raise Broken("in a step")
        return y + h * f(t, y)

    with pytest.raises(Broken, match="in a step"):
        a3.chart("simple", [a3.Method("my-brittle", step, order=1)], until=1, progress=False)


def interrupted(measure):
    """Interrupts a measurement after a while, and returns how long it took to end (s)."""
    threading.Timer(0.5, os.kill, (os.getpid(), signal.SIGINT)).start()
    begun = time.perf_counter()
    with pytest.raises(KeyboardInterrupt):
        measure()
    return time.perf_counter() - begun


@pytest.mark.skipif(os.name == "nt", reason="signals of POSIX")
def test_ctrl_c_ends_a_chart():
    assert interrupted(lambda: a3.chart("cloth", until=3, progress=False)) < 5


@pytest.mark.skipif(os.name == "nt", reason="signals of POSIX")
def test_ctrl_c_ends_a_judgement():
    t = 0.01 * np.arange(1000)
    x = np.random.default_rng(1).normal(size=(len(t), 400, 3))
    assert interrupted(lambda: a3.judge("cloth", (t, x), progress=False)) < 5


@pytest.mark.skipif(os.name == "nt", reason="signals of POSIX")
def test_ctrl_c_ends_a_chart_of_a_step_that_never_ends():
    def step(f, t, y, h):
        while t > 0.5:
            pass
        return y + h * f(t, y)

    method = a3.Method("my-endless-chart", step, order=1)
    assert interrupted(lambda: a3.chart("simple", [method], until=1, progress=False)) < 5


@pytest.mark.skipif(os.name == "nt", reason="signals of POSIX")
def test_ctrl_c_ends_limits_of_an_f_that_never_ends():
    calls = []

    def f(t, y):
        while t > 0.5:
            calls.append(t)
        return -y

    assert interrupted(lambda: a3.stability(a3.System(f, [1.0]), ["rk4", "euler"], progress=False)) < 5
    time.sleep(0.2)
    count = len(calls)
    time.sleep(0.2)
    assert len(calls) == count


def test_several_charts_at_once():
    results = {}

    def measure(k):
        system = a3.System(lambda t, y: np.array([y[1], -(k + 1) * y[0]]), [1.0, 0.0])
        results[k] = a3.chart(system, ["rk4"], until=1, progress=False)

    threads = [threading.Thread(target=measure, args=(k,)) for k in range(3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(results) == 3 and all(results[k].points for k in range(3))


def test_a_picture_of_a_scene(tmp_path):
    try:
        pictures = [a3.render("cloth", until=until, size=(320, 240)) for until in (0, 1)]
    except a3.Error as error:
        if os.environ.get("A3_REQUIRE_GPU"):
            raise
        pytest.skip(str(error))
    assert pictures[0].png != pictures[1].png
    assert pictures[0].png.startswith(PNG) and "320 x 240" in repr(pictures[0])
    pictures[1].save(tmp_path / "cloth.png")
    assert (tmp_path / "cloth.png").read_bytes() == pictures[1].png
    run = a3.Simulation("flag")
    run.step(10)
    coloured = a3.render(run, size=(320, 240), colour="speed")
    assert coloured.png != run.render(320, 240).png
    assert run._repr_png_().startswith(PNG)
    with pytest.raises(a3.InputError, match="saved as .png"):
        pictures[0].save("cloth.jpg")


def chain(method, step, count, scene="chain"):
    """Returns the states of a chain: times (s), positions (m) and velocities (m/s)."""
    run = a3.Simulation(scene, method, step=step)
    states = [(0.0, run.positions, run.velocities)]
    for k in range(1, count + 1):
        run.step()
        states.append((k * step, run.positions, run.velocities))
    t, x, v = zip(*states)
    return np.array(t), np.array(x), np.array(v)


@pytest.mark.parametrize("method", ["euler", "trapezoid", "rk4"])
def test_results_are_judged_by_their_method(method):
    judgement = a3.judge("chain", chain(method, 0.01, 100), progress=False)
    assert judgement.method == method and judgement.step == pytest.approx(0.01)
    assert judgement.error == judgement.errors.max() and judgement.times[-1] == pytest.approx(1.0)
    assert judgement.mistake is None and "rror" in str(judgement)
    assert pickle.loads(pickle.dumps(judgement)).error == judgement.error


def test_a_judgement_has_the_facts_of_its_text():
    light = a3.scene("chain")
    light["gravity"] = [0, -9.7, 0]
    t, x, v = chain("symplectic", 0.01, 100, light)
    judgement = a3.judge("chain", (t, x, v), progress=False)
    assert judgement.method == "symplectic" and judgement.constant == "gravity"
    assert judgement.factor == pytest.approx(9.7 / 9.8, rel=1e-6)
    assert judgement.mistake in judgement.text and "9.7 m/s² in place of 9.8 m/s²" in judgement.mistake
    assert judgement.question in judgement.text
    t, x, v = chain("euler", 0.01, 100)
    late = a3.judge("chain", (t[:-1], x[1:], v[1:]), progress=False)
    assert late.method == "euler" and late.mistake == "a step later in each row"
    assert late.mistake in late.text and late.question in late.text and late.start in late.text
    single = np.float32(x).astype(float)
    for facts in (judgement, late, a3.judge("chain", (t, single), progress=False)):
        assert facts.single_precision == ("in single precision" in facts.text)
        assert (facts.method is None) == ("agrees with no solver" in facts.text)
        assert (facts.nearest is not None) == ("nearest" in facts.text)
        assert (facts.mistake is not None) == ("but with" in facts.text or "but a step" in facts.text)


def test_results_in_a_file_are_judged(tmp_path):
    t, x, v = chain("rk4", 0.01, 50)
    np.savez(tmp_path / "mine.npz", t=t, x=x, v=v)
    judgement = a3.judge("chain", tmp_path / "mine.npz", within=1e-3, progress=False)
    assert judgement.method == "rk4" and judgement.within is True
    assert a3.judge("chain", (t, x + 0.01), within=1e-3, progress=False).within is False


@pytest.mark.parametrize(
    "states, words",
    [
        (lambda t, x, v: (t, x[:, :3]), "particles"),
        (lambda t, x, v: (t[:-1], x), "times"),
        (lambda t, x, v: (t, x[:, :, :2]), "shape"),
        (lambda t, x, v: (t - 1, x), "t"),
        (lambda t, x, v: (t, x, v[:5]), "v"),
        (lambda t, x, v: (t, "x"), "x: an array of numbers is expected, not str"),
        (lambda t, x, v: t, "states are a file, or arrays"),
        (lambda t, x, v: "nowhere.npz", "nowhere.npz"),
        (lambda t, x, v: "states.txtt", "states are read from files that end in"),
    ],
)
def test_results_that_do_not_fit_are_refused(states, words):
    with pytest.raises(a3.InputError) as error:
        a3.judge("chain", states(*chain("rk4", 0.01, 10)), progress=False)
    assert words in str(error.value) and "\n" not in str(error.value)
    print(error.value)


def test_results_that_are_not_finite_are_judged_until_then():
    t, x, v = chain("rk4", 0.01, 100)
    x[60:] = np.nan
    judgement = a3.judge("chain", (t, x), progress=False)
    assert judgement.times[-1] < 0.6 and np.isfinite(judgement.errors).all()
    assert judgement.data["not_finite_at"] == pytest.approx(0.6)
