"""A bed of grains of one's own: poured on a floor, then a ball is pressed into it and the force on it is measured.

Units of grain diameter, density and gravity; some seconds on one core.
"""

import numpy as np

import bitgrain


def poured(seed: int = 1) -> bitgrain.World:
    """A bed of 600 grains of two sizes, at rest over a floor."""
    law = bitgrain.HertzHistory(kn=2e4, kt=2.45e4, gamma_n=80.0, gamma_t=80.0, mu=0.5)
    w = bitgrain.World(box=(8, 8, 40), gravity=(0, 0, -1), dt=1e-3, law=law, periodic=(True, True, False))
    w.plane(normal=(0, 0, 1))
    k = np.arange(600)
    places = 0.6 + 1.14 * np.column_stack([k % 7, k // 7 % 7, k // 49])
    # A generator with a seed: the same grains, and so the same bits, each time.
    chance = np.random.default_rng(seed)
    w.add(places + chance.uniform(-0.05, 0.05, places.shape), chance.choice([0.4, 0.5], len(k)), density=1.0)
    # Air resistance takes the motion out of the bed.
    w.step(16_000, force=lambda world: -0.4 * world.velocities)
    return w


def pressed(w: bitgrain.World, depth: float = 2.0) -> "tuple[np.ndarray, np.ndarray]":
    """Presses a ball of diameter 2 into the bed, and returns depths and upward forces on it."""
    surface = float(np.median(np.sort(w.positions[:, 2])[-50:]) + 0.5)
    ball = w.sphere(radius=1.0, point=(4, 4, surface + 1.1))
    stretch = 0.05
    depths, forces = [], []
    for k in range(1, round(depth / stretch) + 3):
        ball.drive(ball.point - (0, 0, stretch), over=0.1)
        w.step(100)
        depths.append(surface - (ball.point[2] - 1.0))
        forces.append(ball.mean_force[2])
    return np.array(depths), np.array(forces)


def main() -> None:
    w = poured()
    print(f"{len(w)} grains, kinetic energy {w.kinetic_energy:.1e}")
    depths, forces = pressed(w)
    for depth, force in zip(depths[1::6], forces[1::6]):
        print(f"depth {depth:5.2f}  force {force:8.2f}")
    print("digest", w.digest)


if __name__ == "__main__":
    main()
