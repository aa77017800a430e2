"""A wheel that a motor turns, up slopes of sand: torque and slip, slope by slope.

    python wheel.py --out wheel          # a table, a picture and an animation; two minutes

The wheel can go along the slope, rise and turn; a motor holds its spin. The bed is periodic, and slopes are made by
tilting gravity. Slip is one minus the way over the way of a wheel that rolls on its rim; it is the mean of the second
half of the time, as the torque is.
"""

import argparse
from pathlib import Path
from typing import Any, Dict, List, Optional, Sequence, Tuple

import mujoco  # type: ignore[import-untyped, unused-ignore]
import numpy as np
from numpy.typing import NDArray

import pictures
import sand
from bitgrain import mujoco as coupling

RADIUS, WIDTH, MASS, SPIN, TIMESTEP = 0.04, 0.03, 0.4, 5.0, 3e-4
GROUSERS = 12
#: A period must be longer than twice what the largest body's sizes add up to.
BED_WIDTH = 0.13


def model_of(slope: float) -> Tuple[Any, List[str]]:
    """The model, and the names of the geoms that push grains: the rim and its grousers."""
    grousers = "".join(
        f'<geom name="grouser{k}" type="box" size="0.004 {0.5 * WIDTH} 0.0015" mass="0.001"'
        f' pos="{RADIUS * np.cos(turn)} 0 {-RADIUS * np.sin(turn)}" euler="0 {np.degrees(turn)} 0"/>'
        for k, turn in enumerate(2 * np.pi * np.arange(GROUSERS) / GROUSERS)
    )
    pull = " ".join(map(repr, sand.gravity(slope)))
    model = mujoco.MjModel.from_xml_string(f"""
        <mujoco><option timestep="{TIMESTEP}" gravity="{pull}"/><worldbody><body name="wheel">
            <joint name="along" type="slide" axis="1 0 0"/><joint name="up" type="slide" axis="0 0 1"/>
            <joint name="turn" type="hinge" axis="0 1 0"/>
            <geom name="rim" type="cylinder" size="{RADIUS} {0.5 * WIDTH}" euler="90 0 0" mass="{MASS}"/>{grousers}
        </body></worldbody>
        <actuator><velocity name="motor" joint="turn" kv="0.5"/></actuator></mujoco>""")
    return model, ["rim"] + [f"grouser{k}" for k in range(GROUSERS)]


def mean(series: NDArray[np.float64]) -> Tuple[float, float]:
    """The mean, and its standard error by the means of four parts."""
    parts = [part.mean() for part in np.array_split(series, 4)]
    return float(np.mean(parts)), float(np.std(parts, ddof=1) / 2.0)


def climb(
    slope: float, grains: int, seconds: float, length: float, threads: int, frames: int
) -> Tuple[Dict[str, float], str, Optional[pictures.Slices]]:
    """Lets the wheel drive up one slope; returns its row, the digest, and the pictures if some are wanted."""
    width = BED_WIDTH
    model, geoms = model_of(slope)
    w = sand.bed(model, grains, length, width, slope, threads)
    top = sand.surface(w)
    data = mujoco.MjData(model)
    # Clear of the highest grain.
    data.qpos[:] = 0.25 * length, float(w.positions[:, 2].max()) + sand.D + RADIUS, 0.0
    # The model's bodies are about the origin; the bed's middle is at half its width.
    model.body_pos[1, 1] = 0.5 * width
    bed = coupling.couple(model, data, w, geoms)
    slices = pictures.Slices(bed, 0.5 * width, top + 2.5 * RADIUS, slope) if frames else None
    steps = round(seconds / TIMESTEP)
    ways, torques, heights = [], [], []
    for step in range(steps):
        # The motor starts when the wheel has come down.
        data.ctrl[0] = SPIN * min(1.0, max(0.0, (data.time - 0.15) / 0.1))
        if slices and step % max(1, steps // frames) == 0:
            slices.take(f"slope {slope:4.1f} deg   t = {data.time:4.2f} s")
        bed.step()
        ways.append(float(data.qpos[0]))
        torques.append(float(data.actuator_force[0]))
        heights.append(float(data.qpos[1]))
    half = steps // 2
    speeds = np.diff(np.array(ways[half:])) / TIMESTEP
    torque, torque_error = mean(np.array(torques[half:]))
    slip, slip_error = mean(1.0 - speeds / (SPIN * RADIUS))
    row = {
        "slope": slope,
        "torque": torque,
        "torque_error": torque_error,
        "slip": slip,
        "slip_error": slip_error,
        "sinkage": top - (float(np.mean(heights[half:])) - RADIUS),
        "stiffness": bed.worst["stiffness"],
    }
    return row, w.digest, slices


def main(words: Optional[List[str]] = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, default=Path("wheel"))
    parser.add_argument("--grains", type=int, default=4000)
    parser.add_argument("--seconds", type=float, default=2.4)
    parser.add_argument("--length", type=float, default=0.36, help="of the bed, in metres")
    parser.add_argument("--slopes", type=float, nargs="+", default=[0.0, 4.0, 8.0, 12.0, 16.0, 20.0])
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--frames", type=int, default=50)
    given = parser.parse_args(words)
    drive(given.slopes, given.grains, given.seconds, given.out, given.length, given.threads, given.frames)


def drive(
    slopes: Sequence[float],
    grains: int,
    seconds: float,
    out: Path,
    length: float = 0.36,
    threads: int = 1,
    frames: int = 50,
) -> List[Dict[str, float]]:
    """All slopes, with pictures of the one in the middle; returns the rows."""
    out.mkdir(parents=True, exist_ok=True)
    rows, digests = [], []
    for number, slope in enumerate(slopes):
        row, digest, slices = climb(slope, grains, seconds, length, threads, frames * (number == len(slopes) // 2))
        rows.append(row)
        digests.append(digest)
        if slices:
            slices.write(out / "wheel.png", out / "wheel.gif")
    sand.table(rows, out / "wheel.csv")
    for slope, digest in zip(slopes, digests):
        print(f"slope {slope}: digest {digest}")
    return rows


if __name__ == "__main__":
    main()
