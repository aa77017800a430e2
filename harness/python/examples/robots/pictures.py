"""Pictures of a slice of a bed from the side, and of its bodies; needs matplotlib, and pillow to write them."""

import math
from pathlib import Path
from typing import Any, List

import matplotlib.transforms
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import LineCollection, PatchCollection
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Patch, Polygon
from numpy.typing import NDArray
from PIL import Image

from bitgrain import mujoco as coupling
from sand import D

#: Grains that stay, grains in stripes by the height at which they lay at first, bodies, lines.
STILL, STRIPES, BODY, INK = "#777777", ("#e6c88f", "#c79a5b"), "#7d93a8", "#20303f"


class Slices:
    """Frames of the grains about a height y, which the bodies are drawn over, for a still and an animation."""

    def __init__(self, sand: coupling.Coupling, y: float, height: float, slope: float = 0.0) -> None:
        w = sand.world
        assert w.box is not None
        self.sand, self.y, self.height, self.slope = sand, y, height, slope
        self.length = float(w.box[1][0] - w.box[0][0])
        self.stripe = dict(zip(w.ids.copy().tolist(), (w.positions[:, 2] / (2 * D)).astype(int) % 2))
        angle = math.radians(slope)
        corners = np.array([(x, z) for x in (0.0, self.length) for z in (-D, height)])
        across = corners[:, 0] * math.cos(angle) - corners[:, 1] * math.sin(angle)
        up = corners[:, 0] * math.sin(angle) + corners[:, 1] * math.cos(angle)
        self.limits = (across.min(), across.max()), (up.min(), up.max())
        shape = (up.max() - up.min()) / (across.max() - across.min())
        figure = Figure(figsize=(6, 6 * shape + 0.6), dpi=90, layout="constrained")
        self.canvas: Any = FigureCanvasAgg(figure)
        self.axes = figure.add_subplot()
        self.frames: List[Image.Image] = []

    def take(self, title: str) -> None:
        """Draws the present state as the next frame."""
        axes, w = self.axes, self.sand.world
        axes.clear()
        tilt = matplotlib.transforms.Affine2D().rotate_deg(self.slope) + axes.transData
        x, radii, ids, groups = w.positions.copy(), w.radii.copy(), w.ids.copy(), w.groups.copy()
        patches: List[Patch] = []
        colours: List[str] = []
        for k in np.flatnonzero(np.abs(x[:, 1] - self.y) < 0.6 * D):
            patches.append(Circle((x[k, 0], x[k, 2]), radii[k]))
            colours.append(STILL if groups[k] == 1 else STRIPES[self.stripe[int(ids[k])]])
        marks = [mark for name in self.sand.names for mark in self._outline(name, patches, colours)]
        axes.add_collection(PatchCollection(patches, facecolor=colours, edgecolor=INK, linewidth=0.3, transform=tilt))
        axes.add_collection(LineCollection(marks, color=INK, linewidth=1.5, transform=tilt))
        axes.set_xlim(*self.limits[0])
        axes.set_ylim(*self.limits[1])
        axes.set_aspect("equal")
        axes.set_xlabel("m")
        axes.set_title(title, fontsize=9, loc="left", family="monospace")
        self.canvas.draw()
        self.frames.append(Image.fromarray(np.asarray(self.canvas.buffer_rgba())[:, :, :3].copy()))

    def _outline(self, name: str, patches: List[Patch], colours: List[str]) -> "List[NDArray[np.float64]]":
        """Adds a ball, a cylinder that lies along y or a box; returns the line from the centre to the rim, if round."""
        geom, obstacle = self.sand.model.geom(name), self.sand.obstacle(name)
        centre, turn, size = obstacle.point, self.sand.data.geom_xmat[geom.id].reshape(3, 3), geom.size
        colours.append(BODY)
        if obstacle.shape != "box":
            patches.append(Circle((centre[0], centre[2]), size[0]))
            return [np.array([centre[[0, 2]], (centre + size[0] * turn[:, 0])[[0, 2]]])]
        signs = np.array([(a, b, c) for a in (-1, 1) for b in (-1, 1) for c in (-1, 1)])
        corners = (centre + np.einsum("ij,kj->ki", turn, signs * size))[:, [0, 2]]
        out = corners - corners.mean(axis=0)
        patches.append(Polygon(corners[np.argsort(np.arctan2(out[:, 1], out[:, 0]), kind="stable")]))
        return []

    def write(self, still: Path, animation: Path) -> None:
        """Writes the last frame as PNG, and all of them as GIF."""
        self.frames[-1].save(still)
        first, *others = [frame.quantize(32) for frame in self.frames]
        first.save(animation, save_all=True, append_images=others, duration=60, loop=0)


def chart(x: Any, y: Any, line: Any, words: "tuple[str, str, str, str]", path: Path) -> None:
    """A curve and a line beside it; `words` name the axes, the curve and the line."""
    figure = Figure(figsize=(5, 3.6), dpi=90, layout="constrained")
    axes = figure.add_subplot()
    axes.plot(x, y, color="#8a6a34", label=words[2])
    axes.plot(x, line, "--", color=INK, label=words[3])
    axes.set_xlabel(words[0])
    axes.set_ylabel(words[1])
    axes.set_xlim(left=0)
    axes.set_ylim(bottom=0)
    axes.legend(frameon=False)
    figure.savefig(path)
