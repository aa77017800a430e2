"""Bodies of MuJoCo in worlds of grains: shapes, impulses, states, the same bits."""

import re

import numpy as np
import pytest
from conftest import ROOT

import bitgrain

mujoco = pytest.importorskip("mujoco", reason="bitgrain.mujoco needs the package mujoco")
coupling = pytest.importorskip("bitgrain.mujoco")

from coupled import BALL, D, DENSITY, DUMBBELL, GRAVITY, MASS, bed, dropped, made, soft  # noqa: E402

# Beds are small and bodies light; what is remarked on is tested by itself.
pytestmark = pytest.mark.filterwarnings("ignore::bitgrain.mujoco.CoarseCouplingWarning")

CUBE = '<mesh name="cube" vertex="{}"/>'.format(
    " ".join(f"{x} {y} {z}" for x in (-0.03, 0.03) for y in (-0.02, 0.02) for z in (-0.01, 0.01))
)


@pytest.mark.parametrize("geom, shape, extent", [
    ('type="sphere" size="0.02"', "sphere", (0.02, 0.02, 0.02)),
    ('type="capsule" size="0.02 0.03"', "capsule", (0.02, 0.02, 0.05)),
    ('type="cylinder" size="0.02 0.03"', "finite_cylinder", (0.02, 0.02, 0.03)),
    ('type="box" size="0.03 0.02 0.01"', "box", (0.03, 0.02, 0.01)),
    ('type="mesh" mesh="cube"', "mesh", None),
])
def test_a_geom_is_an_obstacle_where_mujoco_has_it(geom, shape, extent):
    """A grain is put on the surface along each axis of the geom, a little into it, and pushed out along that axis."""
    body = f'<body pos="0.1 0.2 0.3" euler="10 20 30"><freejoint/><geom name="g" {geom} pos="0.01 0.02 0.03"/></body>'
    model, data = made(body, gravity=(0, 0, 0), assets=CUBE)
    mujoco.mj_kinematics(model, data)
    centre, turn = data.geom_xpos[0].copy(), data.geom_xmat[0].reshape(3, 3).copy()
    if extent is None:
        # MuJoCo turns a mesh to its principal axes, so its extents are in another order there.
        corners = model.mesh_vert[:].astype(float)
        extent = corners.max(axis=0)
    for axis in range(3):
        for side in (-1, 1):
            normal = side * turn[:, axis]
            w = bitgrain.World(None, (0, 0, 0), 1e-4, soft())
            depth = 1e-5
            w.add([centre + (extent[axis] + 0.5 * D - depth) * normal], 0.5 * D, DENSITY)
            c = coupling.couple(model, data, w, ["g"])
            assert c.obstacle("g").shape == shape
            w.start()
            force = w.forces[0]
            # The vertices of a mesh are kept in single precision, which is 1e-4 of this depth.
            assert np.allclose(force / np.linalg.norm(force), normal, atol=1e-4)
            reaction = c.obstacle("g").force
            assert np.array_equal(reaction, -force)


def momentum(w):
    return (w.masses[:, None] * w.velocities).sum(axis=0)


@pytest.mark.parametrize("names, body", [(["ball"], BALL), (["a", "b", "c"], DUMBBELL)], ids=["ball", "dumbbell"])
def test_the_impulse_on_a_body_is_minus_that_on_the_grains(names, body):
    """In each step of MuJoCo, to rounding: what the grains gain is their weight's, the floor's and the body's."""
    model, data = made(body, 5e-4)
    w = bed(model)
    data.qvel[:6] = (0.2, 0, -1.0, 0, 8, 3)
    c = coupling.couple(model, data, w, names)
    floor, h = w.obstacles[0], model.opt.timestep
    weight = w.masses.sum() * np.array(GRAVITY)
    touched = 0.0
    for _ in range(200):
        before, floors = momentum(w), floor.force
        c.step()
        of_floor = -(floor.mean_force + (floors - floor.force) * (0.5 / c.substeps)) * h
        on_body = h * sum(c.wrench(name)[:3] for name in names)
        gained = momentum(w) - before
        # Some thousand additions of momenta below 1e-2, each rounded to 1e-16 of it.
        assert np.allclose(gained, weight * h + of_floor - on_body, rtol=0, atol=1e-14)
        touched = max(touched, float(np.linalg.norm(on_body)))
    assert touched > 1e-3


@pytest.mark.parametrize("integrator", ["Euler", "implicit", "implicitfast", "discrete"])
def test_what_grains_lose_a_body_gains(integrator):
    """Without gravity or walls the momentum of all stays, to rounding."""
    model, data = made(BALL, 2e-4, gravity=(0, 0, 0), options=f'integrator="{integrator}"')
    w = bitgrain.World(None, (0, 0, 0), 1e-4, soft())
    k = np.arange(27)
    w.add(1.01 * D * np.column_stack([k % 3, k // 3 % 3, k // 9]) + (0.02, 0.02, 0.04), 0.5 * D, DENSITY)
    data.qvel[:] = (0, 0, -1.0, 0, 5, 0)
    c = coupling.couple(model, data, w, ["ball"])
    start = MASS * data.qvel[:3]
    c.step(500)
    assert np.linalg.norm(momentum(w)) > 0.01
    # Some ten thousand additions of momenta below 0.1, each rounded to 1e-17 of it.
    assert np.allclose(MASS * data.qvel[:3] + momentum(w), start, rtol=0, atol=1e-13)


#: An arm of three links, each of which turns about another axis.
ARM = """<body pos="0 0 0.3"><joint axis="0 1 0"/><geom name="a" type="capsule" size="0.01" fromto="0 0 0 0.1 0 0"/>
    <body pos="0.1 0 0" euler="30 0 0"><joint axis="0 0 1"/>
    <geom name="b" type="box" size="0.05 0.01 0.02" pos="0.05 0 0"/>
    <body pos="0.1 0 0" euler="0 0 40"><joint axis="1 1 0"/><geom name="c" type="cylinder" size="0.02 0.01"
    pos="0.03 0.02 0.01" euler="50 0 20"/></body></body></body>"""


@pytest.mark.parametrize("body, speeds", [(DUMBBELL, (0.3, -0.2, 0.1, 5, -7, 3)), (ARM, (3, -4, 5))],
                         ids=["dumbbell", "arm"])
def test_an_obstacle_goes_and_turns_with_its_geom(body, speeds):
    """The obstacle's pose is where the geom was to be, off by the square of MuJoCo's step."""
    offs = []
    for timestep in (2e-3, 1e-3):
        model, data = made(body, timestep, gravity=(0, 0, 0))
        w = bitgrain.World(None, (0, 0, 0), timestep / 20, soft())
        w.add([[1, 1, 1]], 0.5 * D, DENSITY)
        data.qvel[:] = speeds
        c = coupling.couple(model, data, w, ["a", "b", "c"])
        c.step(round(0.4 / timestep))
        mujoco.mj_kinematics(model, data)
        off = []
        for k, name in enumerate("abc"):
            quaternion = np.zeros(4)
            mujoco.mju_mat2Quat(quaternion, data.geom_xmat[k])
            turned = c.obstacle(name).orientation
            off.append(min(abs(turned - quaternion).max(), abs(turned + quaternion).max()))
            off.append(abs(c.obstacle(name).point - data.geom_xpos[k]).max() / D)
        offs.append(max(off))
    # Spins change at some 50 a second squared, velocities at 5: 2e-4, and of diameters 2e-3, at the longer step.
    assert offs[0] < 4e-3 and offs[1] < 0.35 * offs[0]


@pytest.mark.parametrize("geom, reach", [
    ('type="sphere" size="0.01"', 0.01),
    ('type="capsule" size="0.01 0.004"', 0.014),
    ('type="cylinder" size="0.01 0.01"', 0.01),
    ('type="box" size="0.01 0.01 0.01"', 0.01),
])
def test_a_contact_counts_the_mass_of_the_body(geom, reach):
    """A grain bounces off a free body of its own mass: the law's damping is that of half the mass."""
    mass = float(np.pi / 6 * D**3 * DENSITY)
    model, data = made(f'<body><freejoint/><geom name="g" {geom} mass="{mass}"/></body>', 1e-5, gravity=(0, 0, 0))
    w = bitgrain.World(None, (0, 0, 0), 1e-5, soft(restitution=0.5))
    w.add([[0, 0, reach + 0.5 * D + 1e-5]], 0.5 * D, DENSITY, velocities=[[0, 0, -0.5]])
    c = coupling.couple(model, data, w, ["g"])
    c.step(1500)
    assert c.wrench("g")[2] == 0
    # The coefficient is off by 0.01 at most for steps as short as these; a body that counted as infinitely heavy
    # makes it 0.36.
    assert (w.velocities[0, 2] - data.qvel[2]) / 0.5 == pytest.approx(0.5, abs=0.02)


def test_the_moment_is_about_the_centre_of_mass_of_the_body():
    """One grain without friction on one sphere of the dumbbell: its force acts along a line that is known."""
    model, data = made(DUMBBELL, gravity=(0, 0, 0))
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    centre, com = data.geom_xpos[0].copy(), data.xipos[1].copy()
    w = bitgrain.World(None, (0, 0, 0), 1e-4, soft(mu=0.0))
    w.add([centre + (0, 0, 0.012 + 0.5 * D - 1e-5)], 0.5 * D, DENSITY)
    c = coupling.couple(model, data, w, ["a"])
    c.step()
    force, torque = c.wrench("a")[:3], c.wrench("a")[3:]
    assert force[2] < -1e-3
    # Within a step grain and body turn about each other by their overlap over their distance, 1e-3.
    assert np.allclose(torque, np.cross(centre - com, force), rtol=0, atol=2e-3 * np.linalg.norm(torque))
    # It pushes the body down, and so turns it.
    assert data.qvel[2] < 0 and np.linalg.norm(data.qvel[3:]) > 0


def test_a_ball_comes_to_rest_on_its_weight():
    c = dropped()
    c.step(1000)
    model, data = c.model, c.data
    forces = []
    for _ in range(200):
        c.step()
        forces.append(c.wrench("ball")[2])
    assert np.mean(forces) == pytest.approx(MASS * 9.81, rel=0.01)
    assert np.linalg.norm(data.qvel[:3]) < 0.01
    assert c.world.time - 3000 * c.world.dt == pytest.approx(data.time, rel=1e-9)
    assert model.opt.timestep == pytest.approx(c.substeps * c.world.dt, rel=1e-12)


def test_forces_of_ones_own_stay_and_act():
    c = dropped()
    c.step(600)
    sunk = c.data.qpos[2]
    push = np.array([0, 0, 2 * MASS * 9.81, 0, 0, 0.01])
    c.data.xfrc_applied[1] = push
    c.step(200)
    assert np.array_equal(c.data.xfrc_applied[1], push)
    # Its weight upwards, beside what carries it, for a tenth of a second: 0.049.
    assert c.data.qpos[2] > sunk + 0.02


def bits(c):
    return c.world.digest, c.data.qpos.tobytes(), c.data.qvel.tobytes()


def test_two_runs_and_any_threads_give_the_same_bits():
    ends = []
    for threads in (1, 1, 2):
        # More than a thousand grains: fewer step on one thread.
        c = dropped(threads, side=14)
        assert len(c.world) >= 1000
        ends.append([])
        for _ in range(5):
            c.step(30)
            ends[-1].append(bits(c))
        assert c.wrench("ball").any()
    assert ends[0] == ends[1] == ends[2]
    assert len(set(ends[0])) == 5


def test_a_saved_coupling_goes_on_with_the_same_bits():
    c = dropped()
    c.step(150)
    assert c.wrench("ball").any()
    saved = c.save()
    other = coupling.load(c.model, mujoco.MjData(c.model), saved)
    assert bits(other) == bits(c) and other.save() == saved
    for _ in range(100):
        c.step()
        other.step()
        assert bits(other) == bits(c)


def test_bytes_that_do_not_fit_are_refused():
    c = dropped()
    saved = c.save()
    data = mujoco.MjData(c.model)
    for damaged in (b"", saved[:-1], saved[1:], saved[:400] + bytes([saved[400] ^ 1]) + saved[401:]):
        with pytest.raises(bitgrain.BadSave):
            coupling.load(c.model, data, damaged)
    with pytest.raises(bitgrain.InputError, match="not the one that was saved"):
        model, data = made(BALL, 1e-3)
        coupling.load(model, data, saved)
    version = mujoco.mj_versionString().encode()
    with pytest.raises(bitgrain.InputError, match="9.9.9"):
        coupling.load(c.model, data, saved.replace(version, b"9.9.9", 1))


def test_a_body_goes_through_a_period():
    """Sliding over the bed by several periods, at the speed that it has."""
    body = '<body pos="0.03 0.03 0.2"><joint type="slide" axis="1 0 0"/><geom name="g" size="0.01"/></body>'
    model, data = made(body)
    w = bed(model, steps=10)
    data.qvel[0] = 1.0
    c = coupling.couple(model, data, w, ["g"])
    c.step(200)
    width = w.box[1][0] - w.box[0][0]
    assert data.qpos[0] == pytest.approx(0.2) and 0.2 > 3 * width
    # An additions' rounding for each of some thousand steps.
    assert c.obstacle("g").point[0] == pytest.approx((0.03 + 0.2) % width, abs=1e-12)


def test_a_material_of_its_own():
    several = {
        "kind": "hertz_tsuji",
        "materials": {"sand": {"young": 1e6, "poisson": 0.3}, "ice": {"young": 1e6, "poisson": 0.3}},
        "pairs": [
            {"between": ["sand", "sand"], "restitution": 0.5, "mu": 0.5},
            {"between": ["sand", "ice"], "restitution": 0.5, "mu": 0.0},
        ],
    }
    spins = []
    for material in ("sand", {"ball": "ice"}):
        model, data = made(BALL, 1e-4, gravity=(0, 0, 0))
        w = bitgrain.World(None, (0, 0, 0), 1e-4, several)
        w.add([[0.03, 0.03, 0.1 + 0.015 + 0.4 * D]], 0.5 * D, DENSITY, group=w.group("frozen", material="sand"))
        data.qvel[3] = 1.0
        c = coupling.couple(model, data, w, ["ball"], material=material)
        c.step(10)
        spins.append(data.qvel[3])
    assert spins[0] < 1 and spins[1] == 1


def test_a_force_sensor_feels_the_grains_and_a_touch_sensor_does_not():
    body = """<body><joint type="slide" axis="0 0 1"/><geom size="0.01" mass="1"/><body name="foot" pos="0 0 -0.1">
        <site name="ankle"/><geom name="foot" size="0.02" mass="0.1"/></body></body>"""
    sensors = '<sensor><force site="ankle"/><touch site="ankle"/></sensor>'
    model = mujoco.MjModel.from_xml_string(
        f'<mujoco><option gravity="0 0 0"/><worldbody>{body}</worldbody>{sensors}</mujoco>'
    )
    data = mujoco.MjData(model)
    w = bitgrain.World(None, (0, 0, 0), 1e-4, soft(mu=0.0))
    w.add([[0, 0, -0.1 - 0.02 - 0.5 * D + 1e-4]], 0.5 * D, DENSITY, group="frozen")
    c = coupling.couple(model, data, w, ["foot"])
    c.step()
    force = c.wrench("foot")[2]
    assert force > 0.01
    # What the ankle puts on the foot: its mass times its acceleration, less the force of the grains.
    assert data.sensordata[2] == pytest.approx(0.1 * data.qacc[0] - force, rel=1e-9)
    assert data.sensordata[3] == 0


def test_everything_public_is_documented():
    assert sorted(coupling.__all__) == coupling.__all__
    for name in coupling.__all__:
        member = getattr(coupling, name)
        # A dictionary has a comment.
        assert isinstance(member, dict) or member.__doc__
        parts = vars(member).items() if isinstance(member, type) else ()
        bare = [part for part, value in parts if callable(value) and not part.startswith("_") and not value.__doc__]
        assert bare == []


def test_the_page_of_the_guide_runs(tmp_path, monkeypatch):
    """Its blocks, one after the other, as one program; `assert` lines in them are tests."""
    page = (ROOT / "harness/guide/src/robots.md").read_text()
    blocks = re.findall(r"^```python\n(.*?)^```", page, re.S | re.M)
    assert len(blocks) >= 3 and sum(block.count("assert ") for block in blocks) >= 3
    monkeypatch.chdir(tmp_path)
    names = {}
    for k, block in enumerate(blocks):
        exec(compile(block, f"robots.md, block {k + 1}", "exec"), names)
