"""Rigid bodies: shapes, turning, free motion, and the same bits as a case."""

import json
import math
import subprocess
import sys

import numpy as np
import pytest
from conftest import falling, tsuji

import bitgrain


def open_world(gravity=(0, 0, -1)):
    """A grain far from everything, with time steps of a ten-thousandth."""
    w = bitgrain.World(box=None, gravity=gravity, dt=1e-4, law=tsuji())
    w.add([[50, 50, 50]], 0.5, 1.0)
    return w


def test_a_body_that_nothing_touches_falls_and_spins():
    w = open_world()
    box = w.cuboid(half=(1, 2, 3), density=2.0, velocity=(1, 0, 0))
    assert (box.shape, box.is_free) == ("box", False)
    box.set_free()
    box.angular_velocity = (0, 0, 0.5)
    assert box.is_free
    w.step(1000)
    t = 0.1
    assert np.allclose(box.point, (t, 0, -0.5 * t * t), rtol=0, atol=1e-12)
    half = 0.25 * t
    # A rational rotation turns by less than the spin says: by its third power, 1e-11 here.
    assert np.allclose(box.orientation, (math.cos(half), 0, 0, math.sin(half)), rtol=0, atol=1e-10)


def test_a_force_and_a_torque_of_the_host_push():
    w = open_world(gravity=(0, 0, 0))
    mass = 2.0 * 8 * 6
    box = w.cuboid(half=(1, 2, 3), density=2.0)
    with pytest.raises(bitgrain.InputError, match="set_free"):
        box.applied_force = (1, 0, 0)
    box.set_free(along=(True, False, True))
    box.applied_force = (mass, mass, 0)
    box.applied_torque = (0, 0, mass * (1 + 4) / 3)
    w.step(1000)
    assert np.allclose(box.velocity, (0.1, 0, 0), rtol=0, atol=1e-12)
    assert np.allclose(box.angular_velocity, (0, 0, 0.1), rtol=0, atol=1e-12)


def test_a_drive_turns_to_an_orientation_and_rests():
    w = open_world(gravity=(0, 0, 0))
    box = w.cuboid(half=(1, 2, 3))
    there = (0.6, 0, 0.8, 0)
    box.drive((0.01, 0, 0), over=0.05, orientation=there)
    w.step(300)
    assert box.angular_velocity[1] > 1
    w.step(700)
    assert np.allclose(box.orientation, there, rtol=0, atol=1e-12)
    assert np.allclose(box.point, (0.01, 0, 0), rtol=0, atol=1e-12)
    assert not box.angular_velocity.any() and not box.velocity.any()


def test_a_drum_carries_a_grain_along():
    w = bitgrain.World(box=None, gravity=(0, 0, -1), dt=1e-4, law=tsuji())
    w.add([[0, 0, -4.5]], 0.5, 1.0)
    drum = w.drum(radius=5.0, axis=(0, 1, 0), length=4.0)
    drum.angular_velocity = (0, 0.5, 0)
    w.step(2000)
    # Its lowest point moves towards -x.
    assert w.velocities[0, 0] < 0 and drum.torque[1] != 0
    assert drum.shape == "drum"


def test_bodies_are_those_of_a_case(tmp_path):
    """The same world by a case file, stepped by `replay`."""
    law = {"kind": "hertz_tsuji", "young": 2e5, "poisson": 0.3, "restitution": 0.5, "mu": 0.5}
    case = {
        "law": law,
        "gravity": [0, 0, -1],
        "dt": 2e-4,
        "obstacles": [
            {"shape": "capsule", "center": [0.2, 0, 1.5], "axis": [1, 0, 0], "diameter": 1, "half_length": 0.7,
             "density": 2, "motion": "free", "angular_velocity": [0, 0.1, 0.2]},
            {"shape": "cylinder", "center": [0, 0, -2], "axis": [0, 1, 0], "diameter": 1, "length": 3,
             "orientation": [0.8, 0.6, 0, 0], "angular_velocity": [1, 0, 0]},
        ],
        "grains": [{"id": 1, "diameter": 1, "density": 1, "position": [0, 0.05, 0.1]}],
    }
    path = tmp_path / "case.json"
    path.write_text(json.dumps(case))
    replay = [sys.executable, "-m", "bitgrain", "replay", str(path), "--steps", "3000", "--every", "3000"]
    told = subprocess.run(replay, capture_output=True, text=True, check=True).stdout
    samples = [json.loads(line) for line in told.splitlines()]
    w = bitgrain.World(box=None, gravity=(0, 0, -1), dt=2e-4, law=bitgrain.HertzTsuji(
        young=2e5, poisson=0.3, restitution=0.5, mu=0.5))
    w.add([[0, 0.05, 0.1]], 0.5, 1.0)
    free = w.capsule(radius=0.5, axis=(1, 0, 0), half_length=0.7, point=(0.2, 0, 1.5), density=2)
    free.set_free()
    free.angular_velocity = (0, 0.1, 0.2)
    bar = w.cylinder(radius=0.5, axis=(0, 1, 0), point=(0, 0, -2), length=3)
    bar.orientation = (0.8, 0.6, 0, 0)
    bar.angular_velocity = (1, 0, 0)
    w.step(3000)
    assert w.digest == samples[-1]["digest"]
    assert free.force.any() or bar.force.any() or w.velocities[0].any()


def test_a_saved_world_keeps_its_bodies():
    w = falling()
    box = w.cuboid(half=(0.5, 0.4, 0.3), point=(3, 3, 15), density=3.0)
    box.set_free()
    w.step(500)
    other = bitgrain.World.load(w.save())
    w.step(500)
    other.step(500)
    assert w.digest == other.digest
    assert other.obstacles[-1].is_free


@pytest.mark.parametrize("call", [
    lambda w: w.cylinder(radius=1, axis=(0, 1, 0), density=1.0),
    lambda w: setattr(w.sphere(radius=1), "orientation", (1, 1, 0, 0)),
    lambda w: w.sphere(radius=1).set_free(),
    lambda w: w.cuboid(half=(1, 0, 1)),
])
def test_what_cannot_be_is_refused(call):
    with pytest.raises((bitgrain.InputError, bitgrain.BadObstacle)):
        call(open_world())


def square():
    a, b, c, d = [-3, -3, 0], [3, -3, 0], [3, 3, 0], [-3, 3, 0]
    return [[a, b, c], [a, c, d]]


def over_a_square():
    """A grain that falls by a tenth and rolls over the edge of both triangles."""
    w = bitgrain.World(box=None, gravity=(0, 0, -1), dt=1e-4, law=tsuji())
    w.add([[0.1, 0, 0.6]], 0.5, 1.0, velocities=[[-0.2, 0.1, 0]])
    return w


def test_a_mesh_carries_a_grain_as_a_plane():
    ends = []
    for add in (lambda w: w.plane(normal=(0, 0, 1)), lambda w: w.mesh(square())):
        w = over_a_square()
        add(w)
        w.step(20000)
        ends.append((w.positions.copy(), w.forces.copy()))
    (x, f), (y, g) = ends
    assert f[0, 2] > 0
    assert np.allclose(x, y, atol=1e-11) and np.allclose(f, g, atol=1e-8)


def test_a_saved_world_keeps_its_mesh(tmp_path):
    path = tmp_path / "square.stl"
    facets = "".join(
        "facet normal 0 0 1\nouter loop\n"
        + "".join("vertex {} {} {}\n".format(*corner) for corner in facet)
        + "endloop\nendfacet\n"
        for facet in square()
    )
    path.write_text("solid square\n" + facets + "endsolid square\n")
    w = over_a_square()
    mesh = w.mesh(path, velocity=(0, 0, 0.5))
    assert mesh.shape == "mesh"
    w.step(5000)
    other = bitgrain.World.load(w.save())
    w.step(5000)
    other.step(5000)
    assert w.digest == other.digest


@pytest.mark.parametrize("triangles", [[], [[0, 0, 0]], [[[0, 0, float("nan")]] * 3], "no-such-file.stl"])
def test_what_is_no_mesh_is_refused(triangles):
    with pytest.raises(bitgrain.InputError):
        open_world().mesh(triangles)
