"""What the examples with MuJoCo share: sand, a bed of it, tables, pictures of a slice seen from the side.

Metres, kilograms, seconds. The sand is coarse and soft: grains of a centimetre, of a Young's modulus of 5 MPa, so that
steps are long. Stiffer or finer grains need shorter steps, in proportion to the radius and to the modulus^(-2/5).
"""

import csv
import math
from pathlib import Path
from typing import Any, List, Mapping, Sequence, Tuple

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
    model: Any, grains: int, length: float, width: float, slope: float = 0.0, threads: int = 1, seconds: float = 0.6
) -> bitgrain.World:
    """So many grains at rest, periodic along x and y, on grains that stay; its dt fits the model."""
    chance = np.random.default_rng(1)
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
    w.add(base, 0.5 * D * chance.uniform(0.8, 1.0, len(base)), DENSITY, group="frozen")
    # Loose, and shaken, so that it falls into disorder.
    rows = (int(length / (1.15 * D)), int(width / (1.15 * D)))
    places = lattice(grains, rows, np.array([length / rows[0], width / rows[1]]))
    places[:, 2] = 1.3 * D + 1.15 * D * places[:, 2]
    places += chance.uniform(-0.04 * D, 0.04 * D, places.shape)
    motion = chance.uniform(-0.3, 0.3, places.shape)
    w.add(places, 0.5 * D * chance.uniform(0.9, 1.1, grains), DENSITY, velocities=motion)
    w.step(round(seconds / dt))
    return w


def surface(w: bitgrain.World) -> float:
    """Height of the bed: the mean top of the highest grain of each square of 2 d."""
    x, radii = w.positions.copy(), w.radii.copy()
    box = w.box
    assert box is not None
    cells = np.floor((x[:, :2] - box[0][:2]) / (2 * D)).astype(int)
    tops: "dict[tuple[int, int], float]" = {}
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


class Pictures:
    """Pictures of a slice of the bed about a height y, from the side; needs matplotlib, and pillow to write."""

    def __init__(self, sand: coupling.Coupling, y: float, height: float, slope: float = 0.0) -> None:
        import matplotlib

        matplotlib.use("Agg")
        from matplotlib import pyplot

        self.sand, self.y, self.slope = sand, y, slope
        box = sand.world.box
        assert box is not None
        self.lengths = [float(x) for x in box[1] - box[0]]
        self.figure, self.axes = pyplot.subplots(figsize=(6.4, 6.4 * min(1.0, height / self.lengths[0] + 0.15)), dpi=100)
        # Stripes by the height at which grains lay at first show how the bed was moved.
        self.first = dict(zip(sand.world.ids.copy().tolist(), sand.world.positions[:, 2].tolist()))
        self.height = height
        self.frames: List[Any] = []

    def take(self, title: str) -> None:
        """Draws the present state as the next frame."""
        from matplotlib import collections, transforms
        from PIL import Image

        axes, w = self.axes, self.sand.world
        axes.clear()
        tilt = transforms.Affine2D().rotate_deg(self.slope) + axes.transData
        x, radii, ids = w.positions.copy(), w.radii.copy(), w.ids.copy().tolist()
        within = np.abs(x[:, 1] - self.y) < 0.6 * D
        stripes = np.array([int(self.first[k] / (2 * D)) % 2 for k in ids])
        still = w.groups.copy() == 1
        colours = np.where(still, "#777777", np.where(stripes == 1, "#c79a5b", "#e6c88f"))
        for place in np.flatnonzero(within):
            axes.add_patch(self._circle(x[place, 0], x[place, 2], radii[place], colours[place], tilt))
        self._bodies(axes, tilt, collections)
        corners = np.array([(a, b) for a in (0.0, self.lengths[0]) for b in (-D, self.height)])
        angle = math.radians(self.slope)
        turn = np.array([[math.cos(angle), math.sin(angle)], [-math.sin(angle), math.cos(angle)]])
        seen = np.stack([corners[:, 0] * turn[0, 0] - corners[:, 1] * turn[0, 1],
                         corners[:, 0] * turn[0, 1] + corners[:, 1] * turn[0, 0]])
        axes.set_xlim(seen[0].min(), seen[0].max())
        axes.set_ylim(seen[1].min(), seen[1].max())
        axes.set_aspect("equal")
        axes.set_title(title, fontsize=9, loc="left", family="monospace")
        self.figure.canvas.draw()
        buffer = np.asarray(self.figure.canvas.buffer_rgba())[:, :, :3].copy()
        self.frames.append(Image.fromarray(buffer))

    def _circle(self, x: float, z: float, radius: float, colour: str, tilt: Any, **more: Any) -> Any:
        from matplotlib import patches

        return patches.Circle((x, z), radius, facecolor=colour, edgecolor="#5a4526", linewidth=0.3, transform=tilt, **more)

    def _bodies(self, axes: Any, tilt: Any, collections: Any) -> None:
        """Outlines of balls, of cylinders that lie along y, and of boxes, each in the period where it is seen."""
        model, data = self.sand.model, self.sand.data
        shapes = []
        for name in self.sand.names:
            geom = model.geom(name)
            centre, turn = self.sand.obstacle(name).point, data.geom_xmat[geom.id].reshape(3, 3)
            size = geom.size
            if self.sand.obstacle(name).shape == "box":
                signs = np.array([(a, b, c) for a in (-1, 1) for b in (-1, 1) for c in (-1, 1)])
                corners = centre + (signs * size) @ turn.T
                flat = corners[:, [0, 2]]
                middle = flat.mean(axis=0)
                flat = flat[np.argsort(np.arctan2(flat[:, 1] - middle[1], flat[:, 0] - middle[0]))]
                shapes.append(flat)
            else:
                axes.add_patch(self._circle(centre[0], centre[2], size[0], "#7d93a8", tilt, alpha=0.9))
                rim = centre + size[0] * turn[:, 0]
                axes.plot([centre[0], rim[0]], [centre[2], rim[2]], color="#20303f", linewidth=1.5, transform=tilt)
        axes.add_collection(collections.PolyCollection(shapes, facecolor="#7d93a8", edgecolor="#20303f", transform=tilt))

    def write(self, still: Path, animation: Path) -> None:
        """Writes the last frame as PNG and all of them as GIF."""
        from matplotlib import pyplot

        self.frames[-1].save(still)
        few = [frame.quantize(32) for frame in self.frames]
        few[0].save(animation, save_all=True, append_images=few[1:], duration=60, loop=0)
        pyplot.close(self.figure)
