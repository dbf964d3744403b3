"""Runs: the same bits as those of the program, arrays, refusals, interrupts."""

import os
import pickle
import signal
import subprocess
import threading
import time

import numpy as np
import pytest

import a3_simulator as a3

SCENES = ["cloth", "simple", "pendulum", "chain", "mit-sphere", "double-pendulum", "flag", "jelly", "boxes", "cantilever"]


@pytest.mark.parametrize("scene", SCENES)
def test_a_run_has_the_bits_of_the_program(program, tmp_path, scene):
    file = tmp_path / "states.npz"
    subprocess.run([program, "simulate", "--scene", scene, "--until", "0.3", "--output", file], check=True)
    run = a3.Simulation(scene)
    run.advance_to(0.3)
    states = np.load(file)
    assert np.array_equal(run.positions, states["positions"][-1])
    if scene != "simple":
        assert np.array_equal(run.velocities, states["velocities"][-1])


def test_a_run_reads_as_arrays_of_particles():
    run = a3.Simulation("flag", "rk4", step=0.01)
    run.advance_to(0.5)
    n = 11 * 16
    assert run.positions.shape == run.velocities.shape == (n, 3)
    assert run.positions.flags.c_contiguous and run.positions.dtype == np.float64
    assert np.array_equal(run.state, np.concatenate([run.positions.T.ravel(), run.velocities.T.ravel()]))
    assert run.time == 0.5 and run.steps == 50 and run.work.evaluations == 200
    assert run.masses.shape == (n,) and run.triangles.shape[1] == 3
    kinetic = 0.5 * np.sum(run.masses[:, None] * run.velocities**2)
    assert run.energy.kinetic == pytest.approx(kinetic, rel=1e-12)
    assert run.energy.total == sum(run.energy)
    assert "flag" in repr(run) and "rk4" in repr(run)


def test_springs_have_their_lengths_and_forces():
    run = a3.Simulation("cloth")
    run.advance_to(0.5)
    springs = run.springs
    assert springs.ends.shape == (2202, 2) and set(springs.kind) == {"structural", "shear", "bend"}
    i, j = springs.ends[7]
    assert springs.length[7] == pytest.approx(np.linalg.norm(run.positions[i] - run.positions[j]), rel=1e-14)
    elastic = 0.5 * np.sum(springs.stiffness * (springs.length - springs.rest_length) ** 2)
    assert run.energy.elastic == pytest.approx(elastic, rel=1e-10)
    assert springs.strain == pytest.approx(springs.length / springs.rest_length - 1)


def test_an_array_that_was_read_stays_as_it_was():
    run = a3.Simulation("chain")
    before = run.positions
    copy = before.copy()
    run.step(10)
    assert np.array_equal(before, copy)
    before[:] = 0.0
    assert run.positions.any()


def test_how_often_a_run_is_read_changes_no_bit():
    often, once = (a3.Simulation("mit", "dopri5", tolerance=1e-5) for _ in range(2))
    for k in range(1, 31):
        often.advance_to(k / 30)
    once.advance_to(1.0)
    assert np.array_equal(often.positions, once.positions)


def test_a_scene_is_a_name_a_file_a_text_or_a_table(tmp_path):
    text = '[[chain]]\nfrom = [0, 0, 0]\nto = [1, 0, 0]\nparticles = 3\nmass = 1\nstiffness = 50\n'
    file = tmp_path / "own.toml"
    file.write_text(text)
    table = {
        "chain": [
            {"from": np.zeros(3), "to": (1, 0, 0), "particles": np.int64(3), "mass": np.float64(1), "stiffness": 50}
        ]
    }
    runs = [a3.Simulation(scene) for scene in [text, str(file), file, table, a3.scene(file)]]
    for run in runs:
        run.step(20)
        assert np.array_equal(run.state, runs[0].state)


def test_a_built_in_scene_can_be_changed():
    scene = a3.scene("chain")
    scene["chain"][0]["stiffness"] = 250
    assert a3.Simulation(scene).springs.stiffness.tolist() == [250] * 3
    assert a3.Simulation("chain").springs.stiffness.tolist() == [25] * 3


def test_all_scenes_and_methods_are_listed():
    assert {"cloth", "flag"} <= set(a3.scenes())
    methods = {method.name: method for method in a3.methods()}
    assert methods["rk4"].order == 4 and not methods["rk4"].adaptive
    assert methods["dop853"].adaptive and methods["dop853"].setting < 1


@pytest.mark.parametrize(
    "make, words",
    [
        (lambda: a3.Simulation("flagg"), "did you mean flag?"),
        (lambda: a3.Simulation("flag", "rk5"), "did you mean rk4?"),
        (lambda: a3.Simulation("flag", "rk4", step=-1), "a step is a number of seconds from"),
        (lambda: a3.Simulation("flag", "rk4", step=float("nan")), "a step is a number of seconds from"),
        (lambda: a3.Simulation("flag", "rk4", tolerance=1e-3), "rk4 takes a step: give step in seconds"),
        (lambda: a3.Simulation("flag", "dopri5", step=0.1), "chooses its steps to a tolerance: give tolerance"),
        (lambda: a3.Simulation("flag", "rk4", max_step=0.1), "leave out absolute and max_step"),
        (lambda: a3.Simulation("flag", "verlet", grid=(1, 1)), "grid"),
        (lambda: a3.Simulation("simple", wind=True), "has no wind"),
        (lambda: a3.Simulation("simple", "verlet"), "needs forces and masses"),
        (lambda: a3.Simulation("nothing.toml"), "nothing.toml: it could not be read"),
        (lambda: a3.Simulation("[[cloth]]\ngridd = [3, 3]\n"), "scene:2: cloth.gridd: there is no key"),
        (lambda: a3.Simulation({"cloth": [{"gridd": [3, 3]}]}), "scene: cloth.gridd: there is no key"),
        (lambda: a3.Simulation({"gravity": [0, np.nan, 0]}), "gravity: a number of a scene is finite"),
        (lambda: a3.Simulation({"gravity": object()}), "gravity: a scene has numbers"),
        (lambda: a3.Simulation(3), "a scene is a name"),
        (lambda: a3.Simulation("flag").advance_to(float("inf")), "a time is a number of seconds"),
        (lambda: a3.Simulation("flag").advance_to(-1), "a time is a number of seconds"),
        (lambda: a3.Simulation("flag").grab(10**6), "there is no particle 1000000"),
        (lambda: a3.Simulation("flag").pull([0, np.nan, 0]), "a point is three finite numbers"),
        (lambda: a3.render("flag", colour="smell"), "the choices are speed, strain"),
    ],
)
def test_a_wrong_request_is_one_clear_line(make, words):
    with pytest.raises(a3.InputError) as error:
        make()
    assert words in str(error.value)
    assert "\n" not in str(error.value)
    assert isinstance(error.value, ValueError)


@pytest.mark.parametrize("step", [-1, 1.5, "two", None])
def test_a_number_of_steps_is_a_whole_number(step):
    with pytest.raises((TypeError, OverflowError)):
        a3.Simulation("chain").step(step)


def test_a_run_does_not_go_back():
    run = a3.Simulation("chain")
    run.advance_to(1.0)
    with pytest.raises(a3.InputError, match=r"at t = 1 s already, past 0.5 s"):
        run.advance_to(0.5)
    assert run.time == 1.0
    first = run.state
    run.reset()
    run.advance_to(1.0)
    assert np.array_equal(run.state, first)


def test_a_blow_up_says_where_and_leaves_the_last_sound_state():
    run = a3.Simulation("cloth", "euler", step=1.0)
    with pytest.raises(a3.BlowUp) as error:
        run.advance_to(10)
    blow_up = error.value
    assert "blew up at step" in str(blow_up) and "would have held" in str(blow_up)
    assert blow_up.step >= 1 and blow_up.time >= 1.0 and 0 <= blow_up.particle < 400
    assert np.isfinite(run.state).all()
    with pytest.raises(a3.BlowUp):
        run.step()
    again = pickle.loads(pickle.dumps(blow_up))
    assert str(again) == str(blow_up) and again.time == blow_up.time


def test_the_global_lock_is_free_while_a_run_advances():
    run = a3.Simulation("cloth", "rk4", step=0.0005, grid=(40, 40))
    ticks, done = [], threading.Event()

    def tick():
        while not done.is_set():
            ticks.append(time.perf_counter())
            time.sleep(0.001)

    thread = threading.Thread(target=tick)
    thread.start()
    begun = time.perf_counter()
    while time.perf_counter() - begun < 0.3:
        run.step(500)
    done.set()
    thread.join()
    assert len(ticks) > 20


def test_runs_advance_in_several_threads():
    alone = a3.Simulation("mit")
    alone.advance_to(1.0)
    runs = [a3.Simulation("mit") for _ in range(4)]
    threads = [threading.Thread(target=run.advance_to, args=(1.0,)) for run in runs]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for run in runs:
        assert np.array_equal(run.state, alone.state)


def test_threads_take_turns_at_a_run():
    run = a3.Simulation("cloth", "rk4", step=0.0005, grid=(40, 40))
    thread = threading.Thread(target=run.step, args=(1000,))
    thread.start()
    time.sleep(0.05)
    read = run.positions
    assert run.steps >= 1000
    run.step()
    thread.join()
    assert run.steps == 1001
    alone = a3.Simulation("cloth", "rk4", step=0.0005, grid=(40, 40))
    alone.step(1000)
    assert np.array_equal(read, alone.positions)


def test_reading_is_not_starved_by_steps_of_another_thread():
    run, done = a3.Simulation("cloth", "rk4", step=0.0005), threading.Event()

    def advance():
        while not done.is_set():
            run.step(20)

    thread = threading.Thread(target=advance)
    thread.start()
    seen = [run.steps for _ in range(20)]
    done.set()
    thread.join()
    assert seen == sorted(seen) and len(set(seen)) > 10


@pytest.mark.skipif(os.name == "nt", reason="signals of POSIX")
def test_ctrl_c_ends_a_wait_for_another_thread():
    run = a3.Simulation("cloth", "rk4", step=0.0005, grid=(40, 40))
    thread = threading.Thread(target=run.step, args=(30000,))
    thread.start()
    time.sleep(0.05)
    timer = threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    begun = time.perf_counter()
    with pytest.raises(KeyboardInterrupt):
        run.positions
    assert time.perf_counter() - begun < 2
    thread.join()
    assert run.steps == 30000


@pytest.mark.skipif(os.name == "nt", reason="signals of POSIX")
def test_ctrl_c_stops_a_run_between_steps():
    run = a3.Simulation("cloth", "rk4", step=0.0005)
    timer = threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    begun = time.perf_counter()
    with pytest.raises(KeyboardInterrupt):
        run.advance_to(1e6)
    assert time.perf_counter() - begun < 5
    before = run.time
    assert before > 0
    run.step()
    assert run.time > before


def test_a_hand_pulls_a_particle():
    pulled, left = a3.Simulation("cloth"), a3.Simulation("cloth")
    pulled.grab(399)
    hand = pulled.positions[399] + [1, 0, 0]
    pulled.pull(hand)
    for run in (pulled, left):
        run.advance_to(0.5)
    near, far = (np.linalg.norm(run.positions[399] - hand) for run in (pulled, left))
    assert near < 0.5 * far
    pulled.release()


def test_progress_is_reported():
    run = a3.Simulation("cloth", "rk4", step=0.0005)
    times = []
    run.advance(0.5, times.append)
    assert times == sorted(times) and all(0 < time <= 0.5 for time in times)

    def stop(time):
        raise RuntimeError(f"enough at {time}")

    with pytest.raises(RuntimeError, match="enough"):
        run.advance(100.0, stop)
    assert run.time < 100.0


@pytest.mark.parametrize("method", ["rk4", "dopri5"])
def test_a_run_that_was_pickled_goes_on_with_the_same_bits(method):
    run = a3.Simulation("mit-sphere", method, grid=(10, 10))
    run.advance_to(0.7)
    again = pickle.loads(pickle.dumps(run))
    assert again.time == run.time and np.array_equal(again.state, run.state)
    for each in (run, again):
        each.advance_to(1.2)
    assert np.array_equal(again.state, run.state) and again.steps == run.steps


def test_a_checkpoint_of_another_scene_is_refused():
    run = a3.Simulation("chain")
    before = run.state
    for bytes in (b"", b"nonsense", a3.Simulation("mit").checkpoint()):
        with pytest.raises(a3.InputError):
            run.restore(bytes)
    assert np.array_equal(run.state, before)
