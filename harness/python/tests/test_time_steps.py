"""Time steps that resolve neither waves nor collisions are said once, or refused."""

import warnings

import numpy as np
import pytest
from conftest import falling, tsuji

import bitgrain

#: Rayleigh time of a grain of the radius 0.5 and the density 1 under `tsuji()`.
RAYLEIGH = np.pi * 0.5 * np.sqrt(2.6 / 2e4) / (0.1631 * 0.3 + 0.8766)


def alone(fraction, **more):
    w = bitgrain.World(box=None, gravity=(0, 0, 0), dt=fraction * RAYLEIGH, law=tsuji(), **more)
    w.add([[0, 0, 0], [5, 0, 0]], 0.5, 1.0)
    return w


def test_a_long_time_step_is_said_once():
    w = alone(1.4)
    with pytest.warns(bitgrain.LongTimeStepWarning, match="1.400 of the shortest Rayleigh time") as said:
        w.step(5)
    assert len(said) == 1 and said[0].filename == __file__
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        w.step(5)
        alone(0.19).step(5)
        falling().step(200)
    assert w.step_count == 10


def test_a_strict_world_refuses_it():
    w = alone(0.21, strict=True)
    for _ in range(2):
        with pytest.raises(bitgrain.LongTimeStep, match="0.210 of the shortest Rayleigh time"):
            w.step(5)
    assert w.step_count == 0
    alone(0.19, strict=True).step(5)
    saved = alone(0.21)
    with pytest.raises(bitgrain.LongTimeStep):
        bitgrain.World.load(saved.save(), strict=True).step()


def test_the_fastest_pair_counts_and_what_changes():
    w = alone(0.19, strict=True)
    with w.edit() as edit:
        edit.set_velocities(1, [15, 0, 0])
    with pytest.raises(bitgrain.LongTimeStep, match="of the shortest collision"):
        w.step()
    with w.edit() as edit:
        # All alike: nothing meets.
        edit.set_velocities(w.ids, [15, 0, 0])
    w.step()
    # What is fast before a thousand steps are over is found within them.
    w = alone(0.19, strict=True)
    with pytest.raises(bitgrain.LongTimeStep):
        w.step(100_000, force=np.array([[0, 0.2, 0], [0, -0.2, 0]]))
    assert 0 < w.step_count < 100_000 and w.step_count % 1000 == 0


def test_free_bodies_count():
    w = alone(0.19, strict=True)
    ball = w.sphere(radius=0.5, point=(0, 9, 0), density=1e-3)
    w.step()
    ball.set_free()
    with pytest.raises(bitgrain.LongTimeStep, match="Rayleigh"):
        w.step()


def test_an_error_of_the_filter_stops_the_step():
    w = alone(1.4)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(bitgrain.LongTimeStepWarning):
            w.step()
    assert w.step_count == 0
