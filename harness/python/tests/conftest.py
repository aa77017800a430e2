"""What the tests share."""

import sys
from pathlib import Path

import numpy as np
import pytest

import bitgrain

#: The repository.
ROOT = Path(__file__).resolve().parents[3]

sys.path.insert(0, str(Path(__file__).parent))


def tsuji():
    return bitgrain.HertzTsuji(young=2e4, poisson=0.3, restitution=0.6, mu=0.5)


def lattice(side=5, layers=8):
    """Places and radii of the grains of `harness/sim/examples/from_arrays.rs`, or of a bed with other sides."""
    k = np.arange(side * side * layers)
    places = 0.6 + 1.2 * np.column_stack([k % side, k // side % side, k // side**2])
    return places, 0.5 * (0.9 + 0.05 * (k % 5))


def falling(side=5, layers=8, **more):
    """Grains over a floor, in units of their diameter, density and gravity."""
    width = 1.2 * side
    w = bitgrain.World(
        box=(width, width, 40),
        gravity=(0, 0, -1),
        dt=5e-4,
        law=tsuji(),
        periodic=(True, True, False),
        **more,
    )
    w.plane(normal=(0, 0, 1))
    places, radii = lattice(side, layers)
    w.add(places, radii, density=1.0, velocities=np.tile([0.1, 0, 0], (len(radii), 1)))
    return w


@pytest.fixture
def bed():
    """The bed of `from_arrays.rs` after some steps."""
    w = falling()
    w.step(2000)
    return w


@pytest.fixture
def pair():
    """Two grains that touch, in open space."""
    w = bitgrain.World(box=None, gravity=(0, 0, 0), dt=1e-3, law=tsuji())
    w.add([[0, 0, 0], [0.99, 0, 0]], 0.5, 1.0)
    return w
