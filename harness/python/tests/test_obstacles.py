"""Obstacles: handles, drives, forces and their means."""

import numpy as np
import pytest
from conftest import falling, tsuji

import bitgrain


@pytest.fixture
def ball():
    """A ball in empty open space, with time steps of a thousandth."""
    w = bitgrain.World(box=None, gravity=(0, 0, 0), dt=1e-3, law=tsuji())
    # Its radius is what an obstacle may move in a step.
    w.add([[10, 10, 10]], 0.5, 1.0)
    return w, w.sphere(radius=0.05)


def test_a_drive_arrives_and_rests(ball):
    w, ball = ball
    ball.drive((0.2, 0, -0.1), over=0.02)
    assert ball.steps_left == 20
    w.step(8)
    assert ball.steps_left == 12
    # Each of twenty additions rounds by at most half a unit in the last place of 0.2.
    assert np.allclose(ball.point, (0.08, 0, -0.04), rtol=0, atol=20 * 2.8e-17)
    assert np.allclose(ball.velocity, (10, 0, -5), rtol=1e-15)
    w.step(30)
    assert ball.steps_left == 0 and ball.velocity.tolist() == [0, 0, 0]
    assert np.allclose(ball.point, (0.2, 0, -0.1), rtol=0, atol=20 * 2.8e-17)


def test_an_obstacle_that_is_put_away_ends_its_contacts():
    w = bitgrain.World(box=None, gravity=(0, 0, -1), dt=1e-3, law=tsuji())
    floor, ball = w.plane(normal=(0, 0, 1)), w.sphere(radius=0.5, point=(2, 0, 0.5))
    w.add([[0, 0, 0.5], [2, 0, 1.5]], 0.5, 1.0)
    w.step(100)
    assert floor.force[2] < 0 and ball.force[2] < 0
    forces = w.forces[:].copy()
    # The grain on the ball still touches it, the one on the floor falls.
    floor.point, ball.point = (0, 0, -1), (2, 0, 0.5 + 1e-9)
    assert (w.forces[:] == forces).all()
    w.step()
    assert floor.force.tolist() == [0, 0, 0] and ball.force[2] < 0
    floor.point, ball.point = (0, 0, 0), (5, 0, 0.5)
    w.step()
    assert floor.force[2] < 0 and ball.force.tolist() == [0, 0, 0]


def test_a_drive_has_the_bits_of_a_velocity_set_by_hand():
    driven, by_hand = falling(), falling()
    for w in (driven, by_hand):
        w.sphere(radius=0.5, point=(3, 3, 30))
    driven.obstacles[1].drive((4, 3, 29), over=100 * 5e-4)
    driven.step(130)
    ball = by_hand.obstacles[1]
    ball.velocity = (np.array([4, 3, 29]) - ball.point) / (100 * 5e-4)
    by_hand.step(100)
    ball.velocity = (0, 0, 0)
    by_hand.step(30)
    assert driven.digest == by_hand.digest


def test_two_drives_end_on_their_own(ball):
    w, first = ball
    second = w.sphere(radius=0.05, point=(1, 0, 0))
    first.drive((0.1, 0, 0), over=0.005)
    second.drive((1, 0.1, 0), over=0.009)
    w.step(7)
    assert (first.steps_left, second.steps_left) == (0, 2)
    w.step(7)
    assert np.allclose([first.point, second.point], [(0.1, 0, 0), (1, 0.1, 0)], rtol=0, atol=1e-15)


def test_a_velocity_ends_a_drive(ball):
    w, ball = ball
    ball.drive((0.2, 0, 0), over=0.02)
    w.step(5)
    ball.velocity = (0, 1, 0)
    w.step(40)
    assert ball.steps_left == 0
    assert np.allclose(ball.point, (0.05, 0.04, 0), rtol=0, atol=1e-15)


def test_a_drive_over_no_step_is_refused(ball):
    _, ball = ball
    for over in (0.0, -1.0, 4e-4, float("nan"), float("inf")):
        with pytest.raises(bitgrain.InputError, match="at least half a time step"):
            ball.drive((0, 0, 1), over=over)


def test_the_floor_carries_the_weight():
    w = falling(side=2, layers=1)
    floor = w.obstacles[0]
    w.step(20_000)
    weight = w.masses.sum()
    # At rest but for creep of less than a millionth.
    assert floor.force[2] == pytest.approx(-weight, rel=1e-6)
    assert floor.mean_force[2] < 0 and floor.shape == "plane"


def test_means_are_over_the_last_call():
    w, single = falling(), falling()
    w.step(1200)
    single.step(1200)
    w.step(30)
    sums = np.zeros((2, 3))
    for _ in range(30):
        single.step()
        sums += [single.obstacles[0].force, single.obstacles[0].torque]
        assert np.array_equal(single.obstacles[0].mean_force, single.obstacles[0].force)
    assert sums[0, 2] < 0
    assert np.array_equal(w.obstacles[0].mean_force, sums[0] / 30)
    assert np.array_equal(w.obstacles[0].mean_torque, sums[1] / 30)
    assert np.all(np.isnan(falling().obstacles[0].mean_force))


def test_a_place_set_by_hand_keeps_contacts(bed):
    floor = bed.obstacles[0]
    histories = bed.digests["histories"]
    floor.point = (1, 1, 0)
    assert bed.digests["histories"] == histories
    assert floor.point.tolist() == [1, 1, 0]
    bed.step(10)


def test_a_bad_place_changes_nothing(bed):
    ball = bed.sphere(radius=0.5, point=(3, 3, 35))
    before = bed.digest
    with pytest.raises(bitgrain.BadObstacle) as refused:
        ball.point = (3, 3, 41)
    assert refused.value.obstacle == ball.number == 1
    with pytest.raises(bitgrain.BadObstacle):
        bed.cylinder(radius=0.5, axis=(1, 1, 0), point=(3, 3, 35))
    assert bed.digest == before and len(bed.obstacles) == 2
    bed.step()


def test_what_is_endless_is_not_tilted(bed):
    """A step would find that such a wall goes infinitely far, and stop the world."""
    floor, before = bed.obstacles[0], bed.digest
    for tilt in (lambda: setattr(floor, "angular_velocity", (1, 0, 0)),
                 lambda: floor.drive((0, 0, 0), 0.1, orientation=(0.8, 0.6, 0, 0)),
                 lambda: bed.select([floor]).drive([[0, 0, 0]], 0.1, [[0.8, 0.6, 0, 0]])):  # fmt: skip
        with pytest.raises(bitgrain.BadObstacle, match="about its own direction only") as refused:
            tilt()
        assert refused.value.flaw == "Tilted" and floor.steps_left == 0
    assert bed.digest == before
    floor.angular_velocity = (0, 0, 1)
    bed.step(10)


def test_arrays_of_obstacles_cannot_be_written_to(ball):
    _, ball = ball
    with pytest.raises(ValueError, match="read-only"):
        ball.velocity[0] = 1


def test_an_obstacle_of_its_own_mass():
    """A ball with a density gives way in a contact's damping; one without does not."""
    digests = set()
    for density in (None, 1.0):
        w = bitgrain.World(box=None, gravity=(0, 0, 0), dt=1e-4, law=tsuji())
        w.add([[0, 0, 0.999]], 0.5, 1.0, velocities=[[0, 0, -1]])
        w.sphere(radius=0.5, density=density)
        w.step(20)
        digests.add(w.digests["velocities"])
    assert len(digests) == 2


def test_several_obstacles_at_once_are_as_each_by_itself():
    """Two worlds with the same bodies, driven by each and together: the same bits, and the same numbers in rows."""
    ends = []
    for together in (False, True):
        w = falling()
        bodies = [w.cuboid((0.5, 0.4, 0.3), (2, 2, 12)), w.sphere(1.0, (4, 4, 12))]
        turn = (0.8, 0, 0.6, 0)
        if together:
            several = w.select(bodies[::-1])
            assert several.numbers == [2, 1]
            several.drive([[4, 4, 9], [2, 2, 9]], 0.5, [turn, turn])
        else:
            for body, place in zip(bodies, ([2, 2, 9], [4, 4, 9])):
                body.drive(place, 0.5, turn)
        w.step(1000)
        ends.append(w.digest)
    assert ends[0] == ends[1]
    assert any(body.force.any() for body in bodies)
    rows = {"points": "point", "forces": "force", "torques": "torque", "mean_forces": "mean_force",
            "mean_torques": "mean_torque"}
    for name, one in rows.items():
        assert np.array_equal(getattr(several, name), [getattr(body, one) for body in bodies[::-1]])


def test_several_obstacles_are_refused_together():
    w, other = falling(), falling()
    with pytest.raises(bitgrain.InputError, match="another world in row 1"):
        w.select([w.sphere(1.0, (3, 3, 12)), other.sphere(1.0, (3, 3, 12))])
    several = w.select([w.obstacles[0], w.obstacles[1]])
    for places, over, turns in (([[0, 0, 0]], 1, [[1, 0, 0, 0]] * 2), ([[3, 3, 9]] * 2, 0, [[1, 0, 0, 0]] * 2),
                                ([[3, 3, 9]] * 2, 1, [[1, 0, 0]] * 2), ([[3, 3, 9]] * 2, 1, [[1, 1, 0, 0]] * 2)):
        with pytest.raises(bitgrain.InputError):
            several.drive(places, over, turns)
    assert w.obstacles[1].steps_left == 0


def test_more_obstacles_than_a_world_can_have_are_said_so():
    w = bitgrain.World(box=None, gravity=(0, 0, 0), dt=1e-3, law=tsuji())
    for k in range(4096):
        w.sphere(radius=0.5, point=(k, 0, 0))
    for add in (lambda: w.sphere(radius=0.5), lambda: w.mesh([[[0, 0, 0], [1, 0, 0], [0, 1, 0]]])):
        with pytest.raises(bitgrain.TooManyObstacles, match="4097 obstacles, and a world can have 4096") as found:
            add()
        assert (found.value.count, found.value.most, found.value.code) == (4097, 4096, 18)
    w.add([[0, 5, 0]], 0.5, 1.0)
    w.step()
