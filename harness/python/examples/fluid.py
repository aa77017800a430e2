"""Grains in a fluid that flows past them: a force from outside on each grain, worked out with numpy before each step.

Stokes' drag towards the speed of a shear flow, and buoyancy. Units of grain diameter, density and gravity.
"""

import numpy as np

import bitgrain

#: Density of the fluid, its viscosity, and the rate of its shear flow u = RATE z along x.
DENSITY, VISCOSITY, RATE = 0.4, 0.05, 0.5


def fluid(w: bitgrain.World) -> np.ndarray:
    """Force of the fluid on each grain, shape (n, 3)."""
    flow = np.zeros(w.positions.shape)
    flow[:, 0] = RATE * w.positions[:, 2]
    drag = 6 * np.pi * VISCOSITY * w.radii[:, None] * (flow - w.velocities)
    # Grains have density 1, so that their masses are their volumes.
    buoyancy = -DENSITY * w.masses[:, None] * w.gravity
    force: np.ndarray = drag + buoyancy
    return force


def settled(steps: int = 8000) -> bitgrain.World:
    """A hundred grains that sink through the fluid onto a rough floor and are carried along by it."""
    law = bitgrain.HertzTsuji(young=2e4, poisson=0.3, restitution=0.6, mu=0.5)
    w = bitgrain.World(box=((0, 0, -1), (5, 5, 20)), gravity=(0, 0, -1), dt=1e-3, law=law, periodic=(True, True, False))
    k = np.arange(25)
    w.add(np.column_stack([k % 5 + 0.5, k // 5 + 0.5, np.zeros(25)]), 0.5, 1.0, group="frozen")
    k = np.arange(100)
    w.add(np.column_stack([k % 5 + 0.5, k // 5 % 5 + 0.5, 1.5 + 1.1 * (k // 25)]), 0.48, 1.0)
    w.step(steps, force=fluid)
    return w


def main() -> None:
    w = settled()
    free = w.groups == 0
    heights, speeds = w.positions[:, 2][free], w.velocities[:, 0][free]
    for low in range(1, 5):
        layer = (heights >= low - 0.5) & (heights < low + 0.5)
        if layer.any():
            print(f"height {low}: {layer.sum():3d} grains, mean speed {speeds[layer].mean():.3f}")
    print("digest", w.digest)


if __name__ == "__main__":
    main()
