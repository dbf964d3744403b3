"""Runs that go back in time."""

import pytest

import a3_simulator as a3


def test_a_checkpoint_knows_its_direction():
    system = a3.System(lambda t, y: [y[1], -y[0]], [1.0, 0.0])
    forward = a3.Simulation(system, "dopri5", tolerance=1e-8)
    backward = a3.Simulation(system, "dopri5", tolerance=1e-8, backward=True)
    forward.advance_to(1.0)
    backward.advance_to(-1.0)
    for one, other in [(forward, backward), (backward, forward)]:
        kept, before = one.checkpoint(), other.state
        with pytest.raises(a3.InputError, match="a run in the other direction of time"):
            other.restore(kept)
        assert (other.state == before).all()
    kept, state = backward.checkpoint(), backward.state
    backward.advance_to(-2.0)
    backward.restore(kept)
    assert backward.time == -1.0 and (backward.state == state).all()
