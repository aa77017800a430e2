"""Geoms of MuJoCo as obstacles of a world; for `bitgrain.mujoco`."""

import math
from typing import Any, Optional, Tuple

import numpy as np
from numpy.typing import NDArray

from ._native import Obstacle, World
from .errors import BadObstacle, PeriodTooShort, wrong

try:
    import mujoco  # type: ignore[import-untyped, import-not-found, unused-ignore]
except ImportError as _missing:
    raise ImportError("bitgrain.mujoco needs the package mujoco: pip install 'bitgrain[mujoco]'") from _missing

__all__ = ["Array", "Part", "add_obstacle", "after", "check_geom", "cross", "lengths", "mujoco", "turned"]

Array = NDArray[np.float64]


class Part:
    """A geom and its obstacle."""

    def __init__(self, model: Any, name: str, obstacle: Obstacle) -> None:
        self.name = name
        self.obstacle = obstacle
        self.geom = _geom(model, name)
        self.body = int(model.geom_bodyid[self.geom])
        offset = model.geom_pos[self.geom] - model.body_ipos[self.body]
        #: How far its surface is from the body's centre of mass at most.
        self.reach = float(lengths(offset[None])[0]) + float(model.geom_rbound[self.geom])


def lengths(a: Array) -> Array:
    """Lengths of the rows."""
    x, y, z = a.T
    found: Array = np.sqrt(x * x + y * y + z * z)
    return found


def cross(a: Array, b: Array) -> Array:
    """Products of the rows: numpy's own takes some times as long."""
    (x, y, z), (u, v, w) = a.T, b.T
    return np.array([y * w - z * v, z * u - x * w, x * v - y * u]).T


def after(q: Array, p: Array) -> Array:
    """Rows of quaternions: the turn p and then q."""
    (a, x, y, z), (b, u, v, w) = q.T, p.T
    return np.array([
        a * b - x * u - y * v - z * w,
        a * u + x * b + y * w - z * v,
        a * v - x * w + y * b + z * u,
        a * w + x * v - y * u + z * b,
    ]).T


def turned(q: Array, spin: Array, time: float) -> Array:
    """Rows of unit quaternions after a time at a spin: as the world turns obstacles, by a rational rotation."""
    turn = np.concatenate([np.ones((len(q), 1)), 0.5 * time * spin], axis=1)
    a, x, y, z = (found := after(turn, q)).T
    unit: Array = found / np.sqrt(a * a + x * x + y * y + z * z)[:, None]
    return unit


def _geom(model: Any, name: str) -> int:
    number = int(mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_GEOM, name))
    if number < 0:
        there = [model.geom(k).name for k in range(model.ngeom)]
        raise wrong("geoms", f"has {name!r}, which is no geom of the model; its geoms are {there}")
    return number


def check_geom(model: Any, name: str) -> None:
    """Refuses a geom that there is not, or that cannot push grains."""
    kinds = mujoco.mjtGeom
    pushing = [kinds.mjGEOM_SPHERE, kinds.mjGEOM_CAPSULE, kinds.mjGEOM_CYLINDER, kinds.mjGEOM_BOX, kinds.mjGEOM_MESH]
    kind = kinds(int(model.geom_type[_geom(model, name)]))
    if kind not in pushing:
        problem = f"has {name!r}, a {kind.name}; spheres, capsules, cylinders, boxes and meshes push grains"
        raise wrong("geoms", problem)


def add_obstacle(model: Any, data: Any, world: World, name: str, material: Optional[str]) -> Obstacle:
    """Adds the obstacle of a geom that `check_geom` took, where the geom is."""
    geom = _geom(model, name)
    size = [float(x) for x in model.geom_size[geom]]
    point, quaternion = data.geom_xpos[geom].copy(), np.zeros(4)
    mujoco.mju_mat2Quat(quaternion, data.geom_xmat[geom])
    weight = float(model.body_invweight0[model.geom_bodyid[geom], 0])
    kind, kinds = int(model.geom_type[geom]), mujoco.mjtGeom

    def density(volume: float) -> Optional[float]:
        """That gives a contact the mass which the body opposes to a push; none of a body that does not yield."""
        return 1.0 / (weight * volume) if weight > 0.0 else None

    round_area = math.pi * size[0] * size[0]
    ball = round_area * size[0] * 4.0 / 3.0
    axis = (0.0, 0.0, 1.0)
    more: Any = {"material": material, "orientation": quaternion}
    try:
        if kind == kinds.mjGEOM_SPHERE:
            made = world.sphere(size[0], point, density=density(ball), material=material)
        elif kind == kinds.mjGEOM_CAPSULE:
            weighed = density(ball + round_area * 2.0 * size[1])
            made = world.capsule(size[0], axis, size[1], point, density=weighed, **more)
        elif kind == kinds.mjGEOM_CYLINDER:
            length = 2.0 * size[1]
            weighed = density(round_area * length)
            made = world.cylinder(size[0], axis, point, length=length, density=weighed, **more)
        elif kind == kinds.mjGEOM_BOX:
            weighed = density(8.0 * size[0] * size[1] * size[2])
            made = world.cuboid(size, point, density=weighed, **more)
        else:
            made = world.mesh(_triangles(model, geom), point, **more)
    except (BadObstacle, PeriodTooShort) as error:
        place = [round(float(x), 6) for x in point]
        problem = f"has {name!r}, at {place}, for which the world's box is too small: {error}"
        raise wrong("geoms", problem) from error
    return made


def _triangles(model: Any, geom: int) -> Array:
    """Corners of the triangles of a geom's mesh in its own axes, shape (n, 3, 3)."""
    mesh = int(model.geom_dataid[geom])
    first, face = int(model.mesh_vertadr[mesh]), int(model.mesh_faceadr[mesh])
    corners = model.mesh_vert[first : first + int(model.mesh_vertnum[mesh])]
    faces = model.mesh_face[face : face + int(model.mesh_facenum[mesh])]
    return np.asarray(corners[faces], dtype=np.float64)
