"""Discs fall into a box. The forces on a disc are summed by ascending or by descending numbers of its neighbours.

    python3 sums.py up | bitgrain record out/up --keep all
    python3 sums.py down | bitgrain record out/down --keep all
    bitgrain bisect out/up out/down
"""

import sys

import numpy

import frames

STEPS, DT, STIFFNESS, DAMPING, RADIUS = 4000, 1e-3, 2e3, 4.0, 0.5


def forces(position, velocity, order):
    """Weight, walls and contacts, of each disc."""
    force = numpy.zeros_like(position)
    force[:, 1] -= 1.0
    for axis, wall, sign in [(0, 0.0, 1), (0, 6.0, -1), (1, 0.0, 1)]:
        depth = RADIUS - sign * (position[:, axis] - wall)
        push = numpy.where(depth > 0, STIFFNESS * depth - DAMPING * sign * velocity[:, axis], 0.0)
        force[:, axis] += sign * push
    for j in order:
        apart = position - position[j]
        distance = numpy.sqrt(apart[:, 0] ** 2 + apart[:, 1] ** 2)
        touching = (distance < 2 * RADIUS) & (distance > 0)
        normal = apart[touching] / distance[touching, None]
        speed = ((velocity[touching] - velocity[j]) * normal).sum(axis=1)
        push = STIFFNESS * (2 * RADIUS - distance[touching]) - DAMPING * speed
        force[touching] += push[:, None] * normal
    return force


def states(order):
    """The states of all steps."""
    noise = numpy.random.default_rng(1).random((30, 2))
    place = numpy.arange(30)
    position = numpy.stack([0.6 + 1.15 * (place % 5), 0.6 + 1.15 * (place // 5)], axis=1) + 0.1 * noise
    velocity = numpy.zeros_like(position)
    numbers = place if order == "up" else place[::-1]
    for _ in range(STEPS + 1):
        force = forces(position, velocity, numbers)
        yield {"forces": force, "positions": position, "velocities": velocity}
        velocity = velocity + DT * force
        position = position + DT * velocity


frames.run(states(sys.argv[1]))
