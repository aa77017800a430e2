"""Bodies of MuJoCo in worlds of grains: shapes, impulses, states, the same bits, what is too coarse."""

import re
import warnings

import numpy as np
import pytest
from conftest import ROOT

import bitgrain

mujoco = pytest.importorskip("mujoco", reason="bitgrain.mujoco needs the package mujoco")
coupling = pytest.importorskip("bitgrain.mujoco")

# Beds are small and bodies light; what is remarked on is tested by itself.
pytestmark = pytest.mark.filterwarnings("ignore::bitgrain.mujoco.CoarseCouplingWarning")

GRAVITY = (0.0, 0.0, -9.81)
#: Diameter and density of the grains of a bed, in metres and kilograms.
D, DENSITY = 0.01, 2500.0


def soft(restitution=0.4, mu=0.5):
    return bitgrain.HertzTsuji(young=1e6, poisson=0.3, restitution=restitution, mu=mu)


def made(bodies, timestep=1e-3, gravity=GRAVITY, options="", assets=""):
    """A model of these bodies, and its data."""
    pull = " ".join(map(str, gravity))
    model = mujoco.MjModel.from_xml_string(
        f'<mujoco><option timestep="{float(timestep)!r}" gravity="{pull}" {options}/><asset>{assets}</asset>'
        f"<worldbody>{bodies}</worldbody></mujoco>"
    )
    return model, mujoco.MjData(model)


def bed(model, side=6, layers=6, threads=1, gravity=GRAVITY, steps=3000):
    """A settled bed over a floor, periodic along x and y, in steps that fit the model."""
    law = soft()
    dt = coupling.grain_step(model, law, 0.45 * D, DENSITY, 2.0)
    width = 1.05 * D * side
    w = bitgrain.World((width, width, 0.6), gravity, dt, law, periodic=(True, True, False), threads=threads)
    w.plane(normal=(0, 0, 1))
    k = np.arange(side * side * layers)
    places = 1.05 * D * (0.5 + np.column_stack([k % side, k // side % side, k // side**2]))
    places += np.random.default_rng(3).uniform(-0.02 * D, 0.02 * D, places.shape)
    w.add(places, D * (0.45 + 0.0125 * (k % 5)), DENSITY)
    w.step(steps)
    return w


MASS = 0.15
BALL = f'<body name="ball" pos="0.03 0.03 0.1"><freejoint/><geom name="ball" size="0.015" mass="{MASS}"/></body>'
#: Three geoms of one body, none about its centre of mass.
DUMBBELL = """<body name="dumbbell" pos="0.03 0.03 0.1" euler="20 30 40"><freejoint/>
    <geom name="a" type="sphere" size="0.012" pos="0.02 0 0" mass="0.03"/>
    <geom name="b" type="capsule" size="0.004 0.02" euler="0 90 0" mass="0.02"/>
    <geom name="c" type="box" size="0.01 0.008 0.006" pos="-0.02 0 0.003" mass="0.05"/></body>"""


def dropped(threads=1, side=6, timestep=5e-4):
    model, data = made(BALL, timestep)
    w = bed(model, side, threads=threads)
    data.qvel[:] = (0.1, 0, -0.5, 0, 8, 3)
    return coupling.couple(model, data, w, ["ball"])


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


def test_an_obstacle_goes_and_turns_with_its_geom():
    """A tumbling body: the obstacle's pose is where the geom was to be, off by the square of MuJoCo's step."""
    offs = []
    for timestep in (2e-3, 1e-3):
        model, data = made(DUMBBELL, timestep, gravity=(0, 0, 0))
        w = bitgrain.World(None, (0, 0, 0), timestep / 20, soft())
        w.add([[1, 1, 1]], 0.5 * D, DENSITY)
        data.qvel[:] = (0.3, -0.2, 0.1, 5, -7, 3)
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
    # Its spin changes at some 50 a second squared, its ends' velocities at 2: 2e-4 at the longer step.
    assert offs[0] < 1e-3 and offs[1] < 0.35 * offs[0]


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


def on_a_spring(stiffness, steps, strict=False):
    """A ball on one elastic grain, off its equilibrium by a fiftieth of the overlap. Its step is such that the
    coupling's number is `stiffness`. Returns the coupling, and the ball's height over the equilibrium in overlaps."""
    young, poisson, mass, radius = 1e6, 0.3, 0.1, 0.02
    hertz = 2 / 3 * young / (1 - poisson**2) * (radius * 0.5 * D / (radius + 0.5 * D)) ** 0.5
    overlap = (mass * 9.81 / hertz) ** (2 / 3)
    timestep = (stiffness * mass / (1.5 * mass * 9.81 / overlap)) ** 0.5
    model, data = made(
        f'<body><joint type="slide" axis="0 0 1"/><geom name="ball" size="{radius}" mass="{mass}"/></body>', timestep
    )
    law = bitgrain.HertzTsuji(young, poisson, 1.0, 0.0)
    w = bitgrain.World(None, GRAVITY, timestep / 20, law)
    w.add([[0, 0, overlap - radius - 0.5 * D]], 0.5 * D, DENSITY, group="frozen")
    data.qpos[0] = 0.02 * overlap
    c = coupling.couple(model, data, w, ["ball"], strict=strict)
    heights = []
    for _ in range(steps):
        c.step()
        heights.append(data.qpos[0] / overlap)
    return c, np.abs(heights)


@pytest.mark.parametrize("stiffness", [0.05, 0.3, 0.75, 0.9])
def test_the_motion_on_a_stiff_contact_damps_or_grows_as_the_number_says(stiffness):
    """The step as a linear map has the characteristic polynomial
    `x^3 + (S - 2) x^2 + (1 + S/2) x - S/2`, whose largest root leaves the unit circle at S = 2/3."""
    steps = 240 if stiffness < 0.1 else 40
    c, heights = on_a_spring(stiffness, steps)
    quarter = steps // 4
    grown = (heights[-quarter:].max() / heights[:quarter].max()) ** (1 / (steps - quarter))
    expected = abs(np.roots([1, stiffness - 2, 1 + stiffness / 2, -stiffness / 2])).max()
    # Whether a maximum is hit at a step is worth some percent of one period.
    assert grown == pytest.approx(expected, abs=0.01)
    assert (expected > 1) == (stiffness > 2 / 3)
    # The force is looked at again only when a tenth above; it goes with the third root.
    assert c.worst["stiffness"] == pytest.approx(stiffness, rel=0.04) or stiffness > 0.7


def test_too_stiff_a_contact_is_remarked_on_or_refused_with_the_number():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        on_a_spring(0.05, 20, strict=True)
    with pytest.warns(coupling.CoarseCouplingWarning, match=r"stiffness is 0\.29.*model\.opt\.timestep"):
        on_a_spring(0.3, 20, strict=True)
    with pytest.raises(coupling.CoarseCoupling, match=r"stiffness is 0\.8.*at most 0\.667"):
        on_a_spring(0.9, 20, strict=True)
    with pytest.warns(coupling.CoarseCouplingWarning, match=r"stiffness is 0\.8"):
        on_a_spring(0.9, 20)


def flying(speed, timestep=1e-3, parts=20):
    model, data = made('<body><freejoint/><geom name="g" size="0.02"/></body>', timestep, gravity=(0, 0, 0))
    w = bitgrain.World(None, (0, 0, 0), timestep / parts, soft())
    w.add([[1, 1, 1]], 0.5 * D, DENSITY)
    data.qvel[0] = speed
    return coupling.couple(model, data, w, ["g"])


def test_a_body_that_is_too_fast_is_remarked_on_or_refused_with_the_number():
    with pytest.warns(coupling.CoarseCouplingWarning, match=r"travel is 0\.6"):
        flying(3.0).step()
    c = flying(6.0)
    with pytest.raises(coupling.CoarseCoupling, match=r"travel is 1\.2") as caught:
        c.step()
    assert (caught.value.limit, caught.value.most) == ("travel", 1.0)
    assert caught.value.value == pytest.approx(6e-3 / (0.5 * D))
    # Nothing moved.
    assert c.world.step_count == 0 and c.data.time == 0 and c.data.qpos[0] == 0
    c = flying(0.0)
    c.step()
    c.data.qpos[0] = 1.0
    with pytest.raises(coupling.CoarseCoupling, match="couple anew"):
        c.step()


def test_steps_of_the_grains_come_from_the_duration_of_a_collision():
    model, _ = made(BALL, 2e-3)
    law = soft()
    duration = bitgrain.contact_duration(law, 1.0, 0.5 * D, DENSITY)
    # The formula of the guide's page Scenarios, for two equal grains.
    mass = 0.5 * np.pi / 6 * D**3 * DENSITY
    overlap = (5 * mass / (4 * 2 / 3 * 1e6 / (1 - 0.09) * (0.25 * D) ** 0.5)) ** 0.4
    assert duration == pytest.approx(2.943 * overlap, rel=1e-3)
    dt = coupling.grain_step(model, law, 0.5 * D, DENSITY, 1.0)
    assert 0.05 * duration < dt <= 0.1 * duration
    assert 2e-3 / dt == pytest.approx(round(2e-3 / dt), abs=1e-9)
    c = flying(1.0)
    longest = c.world.contact_duration(1.0)
    assert longest == pytest.approx(duration)
    c.step()
    assert c.worst["time_step"] == pytest.approx(c.world.dt / longest)
    parts = round(1e-3 / (0.15 * longest))
    with pytest.warns(coupling.CoarseCouplingWarning, match="time_step is 0.1.*take world.dt"):
        flying(1.0, parts=parts).step()
    with pytest.raises(coupling.CoarseCoupling, match="time_step"):
        flying(0.5, timestep=2e-3, parts=round(2e-3 / (0.3 * longest))).step()


def couple_with(geoms, dt=1e-4, body=BALL, options="", box=None, **more):
    model, data = made(body, 1e-3, options=options)
    w = bitgrain.World(box, GRAVITY, dt, soft())
    w.add([[0.5, 0.5, 0.05]], 0.5 * D, DENSITY)
    return coupling.couple(model, data, w, geoms, **more)


@pytest.mark.parametrize("wrong, words", [
    (lambda: couple_with(["bal"]), "geoms: has 'bal', which is no geom of the model.*'ball'"),
    (lambda: couple_with([]), "expected a list of names"),
    (lambda: couple_with("ball"), "expected a list of names"),
    (lambda: couple_with(["ball", "ball"]), "each once"),
    (lambda: couple_with(["ball"], dt=3.1e-4), r"world\.dt: is 0\.00031; expected model\.opt\.timestep / .*0\.00025"),
    (lambda: couple_with(["ball"], options='integrator="RK4"'), "RK4"),
    (lambda: couple_with(["ball"], box=(1, 1, 0.09)), "'ball', at .*the world's box is too small"),
    (lambda: couple_with(["g"], body='<geom name="g" type="ellipsoid" size="1 2 3"/>'), "ELLIPSOID; spheres"),
    (lambda: couple_with(["ball"], material="steel"), "material"),
    (lambda: couple_with(["ball"]).wrench("wheel"), r"is 'wheel'; the coupled ones are \['ball'\]"),
])
def test_what_cannot_be_coupled_is_told(wrong, words):
    with pytest.raises(bitgrain.InputError, match=words):
        wrong()


def test_a_changed_timestep_is_refused():
    c = couple_with(["ball"])
    c.model.opt.timestep = 2e-3
    with pytest.raises(bitgrain.InputError, match="couple anew"):
        c.step()


def test_a_world_without_grains_steps():
    model, data = made(BALL)
    c = coupling.couple(model, data, bitgrain.World(None, GRAVITY, 1e-4, soft()), ["ball"])
    c.step(10)
    assert not c.wrench("ball").any() and data.time == pytest.approx(0.01)
    assert repr(c).startswith("<bitgrain.mujoco.Coupling: ['ball'] in <bitgrain.World: 0 grains")


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
