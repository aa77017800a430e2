"""How fast a wheel on sand is: seconds simulated over seconds taken, by grains and threads.

    python speed.py                      # 2,000 and 20,000 grains, one and two threads; two minutes

The wheel is that of `wheel.py` on level sand, after it began to drive. Each number is the middle of five stretches.
"""

import argparse
import time
from typing import List, Optional

import mujoco  # type: ignore[import-untyped, unused-ignore]

import sand
import wheel
from bitgrain import mujoco as coupling


def factors(grains: int, threads: int, stretch: float) -> "tuple[coupling.Coupling, list[float]]":
    """The coupling, and the real-time factors of five stretches of so many seconds."""
    model, geoms = wheel.model_of(0.0)
    # Beds of one depth, 7 grains.
    width = wheel.BED_WIDTH if grains < 5000 else 0.36
    length = 1.69e-5 * grains / width
    w = sand.bed(model, grains, length, width, threads=threads)
    data = mujoco.MjData(model)
    data.qpos[:] = 0.25 * length, float(w.positions[:, 2].max()) + sand.D + wheel.RADIUS, 0.0
    model.body_pos[1, 1] = 0.5 * width
    bed = coupling.couple(model, data, w, geoms)
    data.ctrl[0] = wheel.SPIN
    bed.step(round(0.2 / wheel.TIMESTEP))
    found = []
    for _ in range(5):
        began = time.perf_counter()
        bed.step(round(stretch / wheel.TIMESTEP))
        found.append(stretch / (time.perf_counter() - began))
    return bed, sorted(found)


def main(words: Optional[List[str]] = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--grains", type=int, nargs="+", default=[2000, 20000])
    parser.add_argument("--threads", type=int, nargs="+", default=[1, 2])
    parser.add_argument("--stretch", type=float, default=0.05)
    given = parser.parse_args(words)
    for grains in given.grains:
        for threads in given.threads:
            bed, found = factors(grains, threads, given.stretch)
            steps = bed.substeps / wheel.TIMESTEP
            rate = 1e-6 * found[2] * steps * len(bed.world)
            factor = f"real-time factor {found[2]:.3f} ({found[0]:.3f} to {found[-1]:.3f})"
            print(f"{grains} grains, {threads} threads: {factor}, {rate:.1f} million grain-steps/s")
            print(f"digest {bed.world.digest}")
    print(f"dt {bed.world.dt:.2e}, {bed.substeps} in a step of MuJoCo of {wheel.TIMESTEP:.2e}, {sand.LAW}")


if __name__ == "__main__":
    main()
