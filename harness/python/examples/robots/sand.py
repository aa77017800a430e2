"""What the examples with MuJoCo share: sand, a bed of it, tables.

Metres, kilograms, seconds. The sand is coarse and soft: grains of a centimetre, of a Young's modulus of 5 MPa, so that
steps are long. Stiffer or finer grains need shorter steps, in proportion to the radius and to the modulus^(-2/5).
"""

import csv
import math
from pathlib import Path
from typing import Any, Dict, Mapping, Sequence, Tuple

import numpy as np
from numpy.typing import NDArray

import bitgrain
from bitgrain import mujoco as coupling

#: Mean diameter of the grains, and their density.
D, DENSITY = 0.01, 2500.0
GRAVITY = 9.81
LAW = bitgrain.HertzTsuji(young=5e6, poisson=0.3, restitution=0.4, mu=0.5)
#: The fastest motion for which the grains' step is a tenth of a collision.
SPEED = 2.0

Array = NDArray[np.float64]


def gravity(slope: float) -> Tuple[float, float, float]:
    """Gravity in axes of which x points up a slope of so many degrees."""
    angle = math.radians(slope)
    return -GRAVITY * math.sin(angle), 0.0, -GRAVITY * math.cos(angle)


def bed(
    model: Any, grains: int, length: float, width: float, slope: float = 0.0, threads: int = 1, seed: int = 1
) -> bitgrain.World:
    """So many grains at rest, periodic along x and y, on grains that stay; its dt fits the model."""
    chance = np.random.default_rng(seed)
    dt = coupling.grain_step(model, LAW, 0.45 * D, DENSITY, SPEED)
    nx, ny = int(length / D), int(width / D)
    spacing = np.array([length / nx, width / ny])
    box = ((0.0, 0.0, -D), (length, width, 1.5))
    pull = gravity(slope)
    w = bitgrain.World(box, pull, dt, LAW, periodic=(True, True, False), threads=threads)

    def lattice(count: int, rows: Tuple[int, int], step: Array) -> Array:
        k = np.arange(count)
        places = np.column_stack([k % rows[0], k // rows[0] % rows[1], k // (rows[0] * rows[1])])
        spread: Array = (places[:, :2] + 0.5) * step
        return np.column_stack([spread, places[:, 2].astype(float)])

    base = lattice(nx * ny, (nx, ny), spacing)
    w.add(base, 0.5 * D * chance.uniform(0.9, 1.1, len(base)), DENSITY, group="frozen")
    # Loose, and shaken, so that it falls into disorder.
    rows = (int(length / (1.15 * D)), int(width / (1.15 * D)))
    places = lattice(grains, rows, np.array([length / rows[0], width / rows[1]]))
    places[:, 2] = 1.3 * D + 1.15 * D * places[:, 2]
    places += chance.uniform(-0.04 * D, 0.04 * D, places.shape)
    motion = chance.uniform(-0.3, 0.3, places.shape)
    w.add(places, 0.5 * D * chance.uniform(0.9, 1.1, grains), DENSITY, velocities=motion)
    w.step(round(0.6 / dt))
    return w


def surface(w: bitgrain.World) -> float:
    """Height of the bed: the mean top of the highest grain of each square of 2 d."""
    x, radii = w.positions.copy(), w.radii.copy()
    box = w.box
    assert box is not None
    cells = np.floor((x[:, :2] - box[0][:2]) / (2 * D)).astype(int)
    tops: Dict[Tuple[int, int], float] = {}
    for (i, j), top in zip(cells.tolist(), (x[:, 2] + radii).tolist()):
        tops[i, j] = max(top, tops.get((i, j), -1.0))
    return float(np.mean(sorted(tops.values())))


def bulk_density(w: bitgrain.World) -> float:
    """Mass of the grains over their volume, from 2 d above the floor to 2 d below the surface."""
    z, masses, box = w.positions[:, 2], w.masses.copy(), w.box
    assert box is not None
    low, high = 2 * D, surface(w) - 2 * D
    area = float((box[1][0] - box[0][0]) * (box[1][1] - box[0][1]))
    return float(masses[(z > low) & (z < high)].sum()) / (area * (high - low))


Row = Mapping[str, float]


def table(rows: Sequence[Row], path: Path) -> None:
    """Writes rows of numbers as CSV, and prints them."""
    with path.open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(rows[0])
        writer.writerows([repr(float(x)) for x in row.values()] for row in rows)
    print("  ".join(f"{name:>12}" for name in rows[0]))
    for row in rows:
        print("  ".join(f"{x:12.5g}" for x in row.values()))
