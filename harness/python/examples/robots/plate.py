"""A square stamp that a robot's arm presses into sand: pressure against depth, beside the linear law of experiments.

    python plate.py --out plate          # a table and a picture; two minutes

Slow vertical pressing into dry grains is resisted in proportion to the depth, after a beginning that is steeper: of
plates by C. Li, T. Zhang and D. Goldman, Science 339, 1408 (2013), of solids of many shapes by W. Kang, Y. Feng,
C. Liu and R. Blumenfeld, Nature Communications 9, 1101 (2018), who find that the slope depends on the grains' angle of
internal friction alone. The slope is given here in units of the bed's own pressure per depth, rho g. What theory has
for a square footing, `exp(pi tan phi) tan^2(45 deg + phi/2) (1 + tan phi)` (H. Reissner 1924, E. De Beer 1970), is told
for some angles phi.
"""

import argparse
import math
from pathlib import Path
from typing import Any, Dict, List, Optional, Tuple

import mujoco  # type: ignore[import-untyped, unused-ignore]
import numpy as np

import pictures
import sand
from bitgrain import mujoco as coupling

#: Side of the stamp, its height, the speed, and MuJoCo's step.
SIDE, HEIGHT, SPEED, TIMESTEP = 5 * sand.D, 0.06, 0.03, 8e-4


def model_of(side: float) -> Any:
    return mujoco.MjModel.from_xml_string(f"""
        <mujoco><option timestep="{TIMESTEP}" gravity="0 0 -{sand.GRAVITY}"/><worldbody><body name="stamp">
            <joint name="down" type="slide" axis="0 0 1"/>
            <geom name="stamp" type="box" size="{0.5 * side} {0.5 * side} {0.5 * HEIGHT}" mass="2"/></body></worldbody>
        <actuator><position name="arm" joint="down" kp="2e5" dampratio="1"/></actuator></mujoco>""")


def footing(degrees: float) -> float:
    """Bearing capacity of a square footing over the pressure of the soil at its depth."""
    tangent = math.tan(math.radians(degrees))
    strip = math.exp(math.pi * tangent) * math.tan(math.radians(45 + 0.5 * degrees)) ** 2
    return strip * (1 + tangent)


def pressed(
    grains: int, box: float, depth: float, out: Path, threads: int = 1, side: float = SIDE, seed: int = 1, picture: bool = True
) -> Tuple[List[Dict[str, float]], Dict[str, float]]:
    """Presses the stamp to a depth; returns the rows, and what was fitted to them."""
    out.mkdir(parents=True, exist_ok=True)
    model = model_of(side)
    w = sand.bed(model, grains, box, box, threads=threads, seed=seed)
    top, bulk = sand.surface(w), sand.bulk_density(w)
    data = mujoco.MjData(model)
    model.body_pos[1, :2] = 0.5 * box
    clear = float(w.positions[:, 2].max()) + sand.D
    data.qpos[0] = clear + 0.5 * HEIGHT
    bed = coupling.couple(model, data, w, ["stamp"])
    slices = pictures.Slices(bed, 0.5 * box, clear + 0.6 * HEIGHT) if picture else None
    rows: List[Dict[str, float]] = []
    every, sums = round(0.05 * sand.D / SPEED / TIMESTEP), []
    target = clear
    while top - (data.qpos[0] - 0.5 * HEIGHT) < depth:
        target -= SPEED * TIMESTEP
        data.ctrl[0] = target + 0.5 * HEIGHT
        bed.step()
        sums.append(float(bed.wrench("stamp")[2]))
        if len(sums) == every:
            at = top - (float(data.qpos[0]) - 0.5 * HEIGHT)
            rows.append({"depth": at, "force": float(np.mean(sums)), "pressure": float(np.mean(sums)) / side**2})
            sums.clear()
            if slices and len(rows) % 2 == 0:
                slices.take(f"depth {1000 * at:5.1f} mm   {rows[-1]['pressure'] / 1000:5.1f} kPa")
    fit = fitted(rows, bulk, side)
    sand.table(rows[::6], out / "plate.csv")
    if slices:
        slices.write(out / "plate.png", out / "plate.gif")
        depths = np.array([max(0.0, row["depth"]) for row in rows])
        line = fit["slope"] * bulk * sand.GRAVITY * depths + fit["at_zero_depth"]
        words = "depth / mm", "pressure / kPa", "stamp", f"{fit['slope']:.1f} rho g z + constant"
        pressure = np.array([row["pressure"] for row in rows])
        pictures.chart(1000 * depths, pressure / 1000, line / 1000, words, out / "pressure.png")
    print("; ".join(f"{name} {value:.4g}" for name, value in fit.items()), f"; coupling {bed.worst}")
    print("slopes of footings by phi: " + ", ".join(f"{phi} deg {footing(phi):.0f}" for phi in (20, 25, 30)))
    print("digest", w.digest)
    return rows, fit


def fitted(rows: List[Dict[str, float]], bulk: float, side: float) -> Dict[str, float]:
    """A line through the pressures from 0.3 of the side on; its slope in rho g, and the part of the variance it has."""
    depth = np.array([row["depth"] for row in rows])
    pressure = np.array([row["pressure"] for row in rows])
    deep = depth > 0.3 * side
    if deep.sum() < 3:
        raise SystemExit(f"--depth: the line is fitted beyond {0.3 * side} m; press deeper")
    slope, offset = np.polyfit(depth[deep], pressure[deep], 1)
    rest = pressure[deep] - (slope * depth[deep] + offset)
    return {
        "slope": float(slope) / (bulk * sand.GRAVITY),
        "at_zero_depth": float(offset),
        "r2": float(1 - rest.var() / pressure[deep].var()),
        "bulk_density": bulk,
        "from_depth": 0.3 * side,
    }


def main(words: Optional[List[str]] = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, default=Path("plate"))
    parser.add_argument("--grains", type=int, default=7000)
    parser.add_argument("--box", type=float, default=0.22)
    parser.add_argument("--depth", type=float, default=0.05)
    parser.add_argument("--side", type=float, default=SIDE)
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--seed", type=int, default=1, help="of the bed")
    given = parser.parse_args(words)
    pressed(given.grains, given.box, given.depth, given.out, given.threads, given.side, given.seed)


if __name__ == "__main__":
    main()
