"""A ball that falls spinning on a bed of sand, sinks in and comes to rest: does it stop turning too?

    python ball.py --out ball            # a table, a picture and an animation; half a minute

Grains have no rolling resistance: what stops the turning is friction at the many contacts of the ball.
"""

import argparse
import math
from pathlib import Path
from typing import Any, Dict, List, Optional

import mujoco  # type: ignore[import-untyped, unused-ignore]
import numpy as np

import pictures
import sand
from bitgrain import mujoco as coupling

RADIUS, TIMESTEP = 2.5 * sand.D, 5e-4


def model_of(density: float) -> Any:
    return mujoco.MjModel.from_xml_string(f"""
        <mujoco><option timestep="{TIMESTEP}" gravity="0 0 -{sand.GRAVITY}"/><worldbody><body name="ball"><freejoint/>
            <geom name="ball" type="sphere" size="{RADIUS}" density="{density}"/></body></worldbody></mujoco>""")


def dropped(
    grains: int, seconds: float, out: Path, threads: int = 1, density: float = 5000.0, frames: int = 60
) -> List[Dict[str, float]]:
    """Drops the ball from a diameter above the bed, at a metre a second and 20 radians a second; returns the rows."""
    out.mkdir(parents=True, exist_ok=True)
    model = model_of(density)
    side = 0.14
    w = sand.bed(model, grains, side, side, threads=threads)
    top = sand.surface(w)
    data = mujoco.MjData(model)
    data.qpos[:3] = 0.5 * side, 0.5 * side, top + 2 * RADIUS
    # The spin of a free joint is in the axes of the body.
    data.qvel[:] = 0.0, 0.0, -1.0, 0.0, 16.0, 12.0
    bed = coupling.couple(model, data, w, ["ball"])
    slices = pictures.Slices(bed, 0.5 * side, top + 4 * RADIUS) if frames else None
    rows: List[Dict[str, float]] = []
    steps = round(seconds / TIMESTEP)
    every, before = max(1, steps // 25), data.qpos[3:].copy()
    for step in range(steps + 1):
        if slices and step % max(1, steps // frames) == 0:
            slices.take(f"t = {data.time:5.2f} s   {math.hypot(*data.qvel[3:]):6.2f} rad/s")
        if step % every == 0:
            angle = 2.0 * math.acos(min(1.0, abs(float(np.dot(before, data.qpos[3:])))))
            before = data.qpos[3:].copy()
            rows.append({
                "time": float(data.time),
                "depth": float(top - (data.qpos[2] - RADIUS)),
                "speed": math.hypot(*data.qvel[:3]),
                "spin": math.hypot(*data.qvel[3:]),
                # Since the row before: to and fro is no turning.
                "turned": angle,
                "force": float(bed.wrench("ball")[2]),
            })
        if step < steps:
            bed.step()
    sand.table(rows, out / "ball.csv")
    if slices:
        slices.write(out / "ball.png", out / "ball.gif")
    weight = float(model.body_mass[1]) * sand.GRAVITY
    print(f"weight {weight:.3f} N; coupling {bed.worst}, {bed.substeps} steps of the grains in one of MuJoCo")
    print("digest", w.digest)
    print("qpos", data.qpos.tobytes().hex())
    return rows


def main(words: Optional[List[str]] = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, default=Path("ball"))
    parser.add_argument("--grains", type=int, default=2000)
    parser.add_argument("--seconds", type=float, default=2.0)
    parser.add_argument("--density", type=float, default=5000.0)
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--frames", type=int, default=60)
    given = parser.parse_args(words)
    rows = dropped(given.grains, given.seconds, given.out, given.threads, given.density, given.frames)
    end = rows[-1]
    print(f"at the end: speed {end['speed']:.1e} m/s, spin {end['spin']:.1e} rad/s, depth {end['depth']:.4f} m;")
    print(f"since the row before it turned by {end['turned']:.1e} rad")


if __name__ == "__main__":
    main()
