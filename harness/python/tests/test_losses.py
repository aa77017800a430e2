"""Grains that leave a world which takes them out."""

import numpy as np
import pytest
from conftest import tsuji

import bitgrain


def leaky(**more):
    """Grains that fly out of a box with a floor, one by one, and one that stays."""
    w = bitgrain.World(box=(10, 10, 10), gravity=(0, 0, 0), dt=1e-3, law=tsuji(), **more)
    w.sphere(radius=0.5, point=(1, 1, 1))
    velocities = [[0, 0, 8.0], [0, 0, 0], [0, 0, 4.0]]
    w.add([[3, 3, 9.9], [5, 5, 5], [7, 7, 9.9]], 0.5, 1.0, velocities=velocities)
    return w


def test_grains_that_leave_are_taken_out():
    w = leaky(lose=True)
    w.step(100)
    first, second = w.departures
    assert (first.id, first.cause, second.id, second.partner) == (1, "escaped", 3, None)
    assert first.position[2] > 10 and first.velocity == (0, 0, 8.0) and first.radius == 0.5
    assert w.ids[:].tolist() == [2] and w.step_count == 100
    w.step()
    assert w.departures == []


def test_a_world_that_does_not_lose_stops():
    w = leaky()
    with pytest.raises(bitgrain.Escaped):
        w.step(100)


def test_losses_do_not_depend_on_how_steps_are_called():
    whole, cut, asked, pushed = (leaky(lose=True) for _ in range(4))
    whole.step(100)
    for _ in range(100):
        cut.step()
    asked.step(100, force=lambda world: np.zeros((len(world), 3)))
    pushed.step(100, force=np.zeros((3, 3)))
    assert {w.digest for w in (cut, asked, pushed)} == {whole.digest}
    assert len(pushed.departures) == 2


def test_what_pushes_a_grain_goes_with_it():
    w = leaky(lose=True)
    w.step(100, force=[[0, 0, 0], [0, 0.5, 0], [0, 0, 0]])
    assert w.forces[:].tolist() == [[0, 0.5, 0]]


def test_a_drain():
    w = bitgrain.World(
        box=None, gravity=(0, 0, -1), dt=1e-3, law=tsuji(), drain=((0, 0, -0.5), (0, 0, 1))
    )
    w.add([[0, 0, 0], [0, 0, 3]], 0.5, 1.0)
    w.step(1500)
    # After sqrt(2 * 0.5) = 1 the first is behind the plane; the second after sqrt(7).
    assert [(one.id, one.cause) for one in w.departures] == [(1, "drained")]
    assert len(w) == 1


def test_the_higher_of_two_grains_too_deep_in_each_other_goes():
    w = bitgrain.World(box=None, gravity=(0, 0, 0), dt=1e-3, law=tsuji(), lose=True)
    w.add([[0, 0, 0], [0.6, 0, 0]], 0.5, 1.0)
    w.step(2)
    (gone,) = w.departures
    assert (gone.id, gone.cause, gone.partner) == (2, "grain", 1)


def test_a_wrong_drain_is_refused():
    with pytest.raises(bitgrain.InputError, match="drain: is zero"):
        leaky(drain=((0, 0, 0), (0, 0, 0)))
