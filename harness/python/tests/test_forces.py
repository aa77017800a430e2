"""Forces and torques of the user's own."""

import numpy as np
import pytest
from conftest import falling, tsuji

import bitgrain

DT = 1e-3


@pytest.fixture
def lone():
    """A grain of mass pi/6 alone in open space."""
    w = bitgrain.World(box=None, gravity=(0, 0, 0), dt=DT, law=tsuji())
    w.add([[0, 0, 0]], 0.5, 1.0)
    return w


def test_a_force_acts_as_newton_says(lone):
    force = np.array([[0.0, 0.0, 2.0]])
    lone.step(100, force=force)
    mass = lone.masses[0]
    # It begins to act half a step after the start; the rounding of 200 half kicks is far below 1e-12.
    assert lone.velocities[0, 2] == pytest.approx(2.0 / mass * 99.5 * DT, rel=1e-12)
    assert lone.forces[0].tolist() == [0, 0, 2]
    # The half kick that begins the next step is by the force of the last one.
    lone.step()
    assert lone.velocities[0, 2] == pytest.approx(2.0 / mass * 100 * DT, rel=1e-12)
    assert lone.forces[0].tolist() == [0, 0, 0]


def test_a_torque_turns(lone):
    lone.step(100, torque=[[0, 0.1, 0]])
    inertia = 0.4 * lone.masses[0] * 0.25
    assert lone.spins[0, 1] == pytest.approx(0.1 / inertia * 99.5 * DT, rel=1e-12)
    assert lone.torques[0].tolist() == [0, 0.1, 0]


def test_a_callable_is_asked_before_each_step():
    asked, given = falling(), falling()
    steps = []

    def drag(world):
        steps.append(world.step_count)
        return -0.5 * world.velocities

    asked.step(20, force=drag)
    for _ in range(20):
        given.start()
        given.step(force=-0.5 * given.velocities)
    assert steps == list(range(20))
    assert asked.digest == given.digest
    plain = falling()
    plain.step(20)
    assert plain.digest != asked.digest


def test_means_of_a_call_with_a_callable_are_over_all_its_steps(bed):
    other = falling()
    other.step(2000)
    bed.step(15, force=lambda world: np.zeros((200, 3)))
    other.step(15)
    assert bed.digest == other.digest
    assert np.array_equal(bed.obstacles[0].mean_force, other.obstacles[0].mean_force)


def test_who_is_asked_may_not_step(bed):
    with pytest.raises(bitgrain.Busy):
        bed.step(3, force=lambda world: world.step())
    assert bed.step_count == 2000
    bed.step()


def test_an_error_of_who_is_asked_comes_through(bed):
    def fails(world):
        if world.step_count == 2002:
            raise RuntimeError("no more")
        return np.zeros((200, 3))

    with pytest.raises(RuntimeError, match="no more"):
        bed.step(10, force=fails)
    assert bed.step_count == 2002


@pytest.mark.parametrize(
    "force, problem",
    [
        (np.zeros((199, 3)), r"shape \(199, 3\); expected \(200, 3\)"),
        (np.zeros(3), r"shape \(3,\)"),
        (np.full((200, 3), np.nan), "row 0"),
        ("up", "not an array of numbers"),
        (lambda world: None, "not an array of numbers|holds NaN|shape"),
    ],
)
def test_a_force_of_another_shape_is_refused(bed, force, problem):
    before = bed.digest
    with pytest.raises(bitgrain.InputError, match=problem):
        bed.step(5, force=force)
    assert bed.digest == before


def test_a_sinking_grain_reaches_its_speed():
    """Buoyancy of a tenth of its weight and Stokes' drag, as in the guide's page on the kernel."""
    w = bitgrain.World(box=None, gravity=(0, 0, -1), dt=DT, law=tsuji())
    w.add([[0, 0, 0]], 0.5, 1.0)
    weight = w.masses[0]
    w.step(20_000, force=lambda world: np.array([0, 0, 0.1 * weight]) - 0.5 * world.velocities)
    # The drag is that of the step before, which matters no more once the speed is constant; e^-19 is left of the start.
    assert w.velocities[0, 2] == pytest.approx(-0.9 * weight / 0.5, rel=1e-6)


class Lazy:
    """Rows that are made when they are asked for, as of torch or dask."""

    def __init__(self, rows, act):
        self.rows, self.act = rows, act

    def __array__(self, dtype=None, copy=None):
        self.act()
        return self.rows


def swap(w):
    """Another grain in the place of the first."""
    with w.edit() as edit:
        edit.remove(w.ids[:1])
        edit.insert([[3, 3, 30]], 0.5, 1.0)


def remove(w):
    with w.edit() as edit:
        edit.remove(w.ids[:1])


@pytest.mark.parametrize("act", [lambda w: w.add([[3, 3, 30]], 0.5, 1.0), remove, swap, lambda w: w.step()])
def test_forces_are_of_the_state_that_they_were_asked_for(act):
    w = falling()
    w.step()
    push = np.zeros((200, 3))
    with pytest.raises(bitgrain.InputError, match="was stepped or edited"):
        w.step(force=Lazy(push, lambda: act(w)))
    steps = w.step_count
    # A callable may look only.
    with pytest.raises(bitgrain.Busy):
        w.step(force=lambda world: Lazy(np.zeros((len(world), 3)), lambda: act(world)))
    w.step(force=Lazy(np.zeros((len(w), 3)), lambda: None))
    assert w.step_count == steps + 1
