"""Couplings of MuJoCo that are too coarse, or cannot be."""

import warnings

import numpy as np
import pytest

import bitgrain

mujoco = pytest.importorskip("mujoco", reason="bitgrain.mujoco needs the package mujoco")
coupling = pytest.importorskip("bitgrain.mujoco")

from coupled import BALL, D, DENSITY, GRAVITY, made, soft  # noqa: E402

# Beds are small and bodies light; what is remarked on is tested by itself.
pytestmark = pytest.mark.filterwarnings("ignore::bitgrain.mujoco.CoarseCouplingWarning")


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


def test_what_cannot_be_coupled_leaves_the_world_as_it_was():
    model, data = made(BALL)
    w = bitgrain.World(None, GRAVITY, 1e-4, soft())
    for geoms in (["ball", "wheel"], ["ball", "ball"]):
        with pytest.raises(bitgrain.InputError):
            coupling.couple(model, data, w, geoms)
    assert w.obstacles == []


def test_a_geom_lies_beside_grains_that_it_would_not_fit_between_otherwise_turned():
    """A bar along x between a grain above and one below: along its own axis, z, it would pierce both."""
    model, data = made('<body><geom name="bar" type="capsule" size="0.005 0.05" euler="0 90 0"/></body>')
    w = bitgrain.World(None, (0, 0, 0), 1e-4, soft())
    w.add([[0, 0, -0.02], [0, 0, 0.02]], 0.5 * D, DENSITY)
    w.start()
    c = coupling.couple(model, data, w, ["bar"])
    c.step()
    assert not c.wrench("bar").any()


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
