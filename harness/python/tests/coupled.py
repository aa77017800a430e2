"""Models of MuJoCo and beds for them."""

import mujoco
import numpy as np

import bitgrain
from bitgrain import mujoco as coupling

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
