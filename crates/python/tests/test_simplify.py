"""What a scene can do without."""

import pickle

import a3_simulator as a3
import numpy as np
import pytest

CLOTH = """
gravity = [0, -9.81, 0]
drag_per_mass = 1
floor = { height = -20 }
[[cloth]]
grid = [9, 9]
width = 1
density = 1
stiffness = [200, 0, 0]
at = [0, 0, 0]
pin = [{ at = ["top"] }]
"""


@pytest.fixture(scope="module")
def found():
    return a3.simplify(CLOTH, 1e-2, until=1, chart=True, progress=False)


def test_the_effects_are_those_of_runs(found):
    assert found["floor"].change == 0.0
    assert found["floor"].verdict == "leave it out"
    for effect in found.models:
        assert effect.in_lean == (effect.verdict in ("leave it out", "take it"))
        assert effect.in_lean or effect.model not in found.lean.parts

    def positions(text):
        run = a3.Simulation(text, "dopri5", tolerance=1e-8)
        frames = []
        for k in range(1, 61):
            run.advance_to(k / 60)
            frames.append(run.positions)
        return np.array(frames)

    apart = positions(CLOTH) - positions(CLOTH.replace("drag_per_mass = 1", ""))
    by_hand = np.sqrt((apart**2).sum(axis=2).mean(axis=1)).max()
    assert found["drag"].change == pytest.approx(by_hand, rel=0.02, abs=2 * found.uncertainty)


def test_the_lean_scene_runs(found):
    assert "floor" in found.lean.parts
    assert found.lean.error <= 1e-2
    run = a3.Simulation(found.lean.scene)
    assert run.method == found.lean.method
    run.advance_to(1.0)
    assert np.isfinite(run.positions).all()


def test_it_shows_and_pickles_itself(found):
    assert "left out or changed" in str(found)
    assert found._repr_svg_().startswith("<svg")
    again = pickle.loads(pickle.dumps(found))
    assert again.models == found.models
    assert again.svg == found.svg


def test_bad_input_is_one_line():
    for arguments, words in [
        ({"error": 0.0}, "an error is"),
        ({"error": 1e-2, "of": "colour"}, "there is no quantity `colour`"),
        ({"error": 1e-2, "until": 1e9}, "1000"),
    ]:
        with pytest.raises(a3.InputError) as raised:
            a3.simplify("chain", progress=False, **arguments)
        assert words in str(raised.value)
        assert "\n" not in str(raised.value)
    system = a3.System(lambda t, y: -y, [1.0])
    with pytest.raises(a3.InputError, match="without functions of Python"):
        a3.simplify(system, 1e-2, progress=False)
