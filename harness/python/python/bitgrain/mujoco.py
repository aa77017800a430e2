"""Bodies of MuJoCo in a world of grains.

    sand = couple(model, data, world, ["wheel", "blade"])
    while data.time < 10:
        data.ctrl[:] = ...
        sand.step()

A step of MuJoCo, of the length h, is N steps of the grains. In :meth:`Coupling.step`

1. ``mj_step1`` finds where the geoms are and how they move;
2. each geom's obstacle goes in N steps of the grains to where the geom would be after h at that velocity;
3. the mean of the grains' force on it over those steps, and its moment about the body's centre of mass, are added to
   ``xfrc_applied`` of the geom's body; what you set there stays and acts as well;
4. ``mj_step2`` moves MuJoCo with that. Both are at the same time then.

Force times h is the impulse on the body, and minus that on the grains, to rounding: the mean is a trapezoid, as the
grains' own integration takes it. Bodies begin each step where MuJoCo has them but for h^2 times their acceleration,
which the next step makes good by a velocity, without a jump.

The force lags behind by a part of a step. On a body held by contacts of stiffness K it acts as a damper, and from a
certain h on it drives the body instead. So couplings that are too coarse are refused, and those that are nearly so are
remarked on: see `LIMITS`.
"""

import hashlib
import json
import math
import warnings
from typing import Any, Dict, List, Mapping, NamedTuple, Optional, Sequence, Tuple, Union

import numpy as np

from ._geoms import Array, Part, add_obstacle, after, check_geom, cross, lengths, mujoco, turned
from ._native import Obstacle, World, contact_duration
from .errors import BadSave, Error, wrong

__all__ = ["CoarseCoupling", "CoarseCouplingWarning", "Coupling", "LIMITS", "Limit", "couple", "grain_step", "load"]


class Limit(NamedTuple):
    """A number that says how coarse a coupling is: what it is, from where on it is remarked on, and refused."""

    meaning: str
    remark: float
    refuse: float
    remedy: str


#: How coarse a coupling may be.
#:
#: * `"time_step"`: at a tenth of a collision the coefficient of restitution is off by 0.02, at a fifth collisions make
#:   energy.
#: * `"travel"`: within a step of MuJoCo a body goes straight on, whatever the grains do.
#: * `"stiffness"`: S = h^2 K / m. The lag of the force damps the body's motion on its contacts by the ratio sqrt(S)/4
#:   of the critical damping; from S = 2/3 on that motion grows.
LIMITS: Dict[str, Limit] = {
    "time_step": Limit(
        "world.dt over the duration of a collision at the speed of the fastest body",
        0.1,
        0.2,
        "take {}, or softer grains (see grain_step)",
    ),
    "travel": Limit(
        "way of a body's surface in a step of MuJoCo over the smallest grain's radius",
        0.5,
        1.0,
        "take {}, or move slower; after a leap of data.qpos couple anew",
    ),
    "stiffness": Limit(
        "timestep^2 times the stiffness of a body's contacts over its mass as they feel it",
        0.1,
        2.0 / 3.0,
        "take {}, softer grains, or a heavier body",
    ),
}


class CoarseCoupling(Error):
    """A coupling that is too coarse: which of `LIMITS`, its value, and where it is refused."""

    limit: str
    value: float
    most: float


class CoarseCouplingWarning(UserWarning):
    """A coupling that is nearly too coarse; the message has the number."""


def grain_step(model: Any, law: Any, radius: float, density: float, speed: float) -> float:
    """Time step for a world of grains that `model` is to be coupled to.

    The longest whole part of ``model.opt.timestep`` that is at most a tenth of the duration of a collision.

    Parameters
    ----------
    model : mujoco.MjModel
    law : HertzHistory, HertzTsuji or dict
        Contact law of the world.
    radius, density : float
        Of the smallest grain (length, mass / length^3).
    speed : float
        The fastest relative speed that matters (length / time).

    Raises
    ------
    InputError
    """
    duration = contact_duration(law, speed, radius, density)
    timestep = float(model.opt.timestep)
    return timestep / math.ceil(timestep / (LIMITS["time_step"].remark * duration))


class Coupling:
    """A model of MuJoCo and a world of grains that go on together; `couple` and `load` make one.

    Attributes
    ----------
    model, data : mujoco.MjModel, mujoco.MjData
    world : World
    substeps : int
        Steps of the grains in a step of MuJoCo.
    worst : dict of float
        The coarsest that each of `LIMITS` was so far. `"stiffness"` is looked at whenever the force on a geom exceeds
        all before by a tenth.
    """

    def __init__(self, model: Any, data: Any, world: World, parts: Sequence[Part], strict: bool) -> None:
        self.model, self.data, self.world = model, data, world
        self.worst: Dict[str, float] = {name: 0.0 for name in LIMITS}
        self._parts, self._strict = list(parts), strict
        self._remarked: List[str] = []
        self._timestep = float(model.opt.timestep)
        self.substeps = _substeps(model, world)
        world.start()
        self._measure_grains()
        box, periodic = world.box, world.periodic
        edges = np.zeros(3) if box is None else box[1] - box[0]
        #: Periods, and one over them; zero along other axes.
        self._periods = np.where(periodic, edges, 0.0)
        self._per_period = np.array([1.0 / period if period > 0.0 else 0.0 for period in self._periods.tolist()])
        self._obstacles = world.select([part.obstacle for part in self._parts])
        self._geoms = [part.geom for part in self._parts]
        self._of = [part.body for part in self._parts]
        self._roots = [int(model.body_rootid[body]) for body in self._of]
        self._bodies = sorted(set(self._of))
        #: Mean force and torque of the last step on the bodies of the geoms, about their centres of mass.
        self._wrenches = np.zeros((len(self._parts), 6))
        #: The forces at which contacts were looked at, and by body and geom how stiff they were over the mass.
        self._looked = np.zeros(len(self._parts))
        self._stiffnesses: Dict[int, Dict[str, float]] = {body: {} for body in self._bodies}

    def __repr__(self) -> str:
        return f"<bitgrain.mujoco.Coupling: {self.names} in {self.world!r}>"

    @property
    def names(self) -> List[str]:
        """Names of the geoms."""
        return [part.name for part in self._parts]

    def obstacle(self, geom: str) -> Obstacle:
        """The obstacle of a geom."""
        return self._parts[self._number(geom)].obstacle

    def wrench(self, geom: str) -> Array:
        """Mean force of the grains on a geom in the last step, and its moment about the centre of mass of the geom's
        body, in the axes of the world, shape (6,): as ``xfrc_applied`` has it."""
        wrench: Array = self._wrenches[self._number(geom)].copy()
        return wrench

    def _number(self, geom: str) -> int:
        if geom not in self.names:
            raise wrong("geom", f"is {geom!r}; the coupled ones are {self.names}")
        return self.names.index(geom)

    def step(self, n: int = 1) -> None:
        """Does `n` steps of MuJoCo, each with its steps of the grains.

        Raises
        ------
        CoarseCoupling
            One of `LIMITS` is exceeded; nothing has moved in this step.
        KernelError
            What stopped the grains. MuJoCo has not moved in this step; grains and obstacles may have.
        InputError
            ``model.opt.timestep`` was changed.
        """
        model, data = self.model, self.data
        if model.opt.timestep != self._timestep:
            problem = f"is {model.opt.timestep!r} and was {self._timestep!r}; couple anew after a change"
            raise wrong("model.opt.timestep", problem)
        for _ in range(n):
            mujoco.mj_step1(model, data)
            self._move_grains()
            own = data.xfrc_applied[self._bodies].copy()
            for part, wrench in zip(self._parts, self._wrenches):
                data.xfrc_applied[part.body] += wrench
            mujoco.mj_step2(model, data)
            data.xfrc_applied[self._bodies] = own

    def _move_grains(self) -> None:
        """Steps the grains through a step of MuJoCo, and works out the wrenches. Arrays have one row a geom."""
        h, data = self._timestep, self.data
        velocity = data.cvel[self._of]
        spin, places = velocity[:, :3], data.geom_xpos[self._geoms]
        # MuJoCo's velocities are those of the centre of mass of a body's whole tree.
        velocity = velocity[:, 3:] + cross(spin, places - data.subtree_com[self._roots])
        here = self._obstacles.points
        way = places + h * velocity - here
        # To the nearest image.
        way -= self._periods * np.round(way * self._per_period)
        self._check(way, spin, velocity)
        quaternions = turned(after(data.xquat[self._of], self.model.geom_quat[self._geoms]), spin, h)
        obstacles = self._obstacles
        force, torque = obstacles.forces, obstacles.torques
        obstacles.drive(here + way, h, quaternions)
        self.world.step(self.substeps)
        # The grains' velocities change by half a step's force at either end.
        force = obstacles.mean_forces + (force - obstacles.forces) * (0.5 / self.substeps)
        torque = obstacles.mean_torques + (torque - obstacles.torques) * (0.5 / self.substeps)
        # Where geoms are from their bodies' centres of mass, in the middle of the step.
        arm = places - data.xipos[self._of]
        arm = arm + 0.5 * h * cross(spin, arm)
        self._wrenches = np.concatenate([force, torque + cross(arm, force)], axis=1)

    def _measure_grains(self) -> None:
        self._count = len(self.world)
        self._smallest = float(np.min(self.world.radii.copy())) if self._count else math.inf
        #: Duration of a collision at the speed 1; it falls with the fifth root of the speed.
        self._duration = self.world.contact_duration(1.0)

    def _check(self, way: Array, spin: Array, velocity: Array) -> None:
        """Looks at all limits before anything moves."""
        if len(self.world) != self._count:
            self._measure_grains()
        if self._count == 0:
            return
        # A turn by a radian counts as a way of at least a radius.
        rim = np.maximum(self.model.geom_rbound[self._geoms], self._smallest) * lengths(spin)
        fastest = float((lengths(velocity) + rim).max())
        travel = float((lengths(way) + rim * self._timestep).max())
        h, dt = self._timestep, self.world.dt
        self._judge("time_step", dt * fastest**0.2 / self._duration, "world.dt", dt, 1.0)
        self._judge("travel", travel / self._smallest, "model.opt.timestep", h, 1.0)
        self._judge("stiffness", h * h * self._stiffness(), "model.opt.timestep", h, 0.5)

    def _stiffness(self) -> float:
        """The largest stiffness of a body's contacts over its mass, if a geom is pressed harder than ever; else zero."""
        pressed = lengths(self._wrenches[:, :3])
        for k in np.flatnonzero(pressed > 1.1 * self._looked):
            part, self._looked[k] = self._parts[k], pressed[k]
            push, turn = (float(x) for x in self.model.body_invweight0[part.body])
            over_mass = part.obstacle.contact_stiffness() * (push + part.reach * part.reach * turn)
            self._stiffnesses[part.body][part.name] = over_mass
        return max(sum(of_body.values()) for of_body in self._stiffnesses.values())

    def _judge(self, name: str, value: float, time: str, now: float, power: float) -> None:
        """Holds a value against its limit. A shorter time, by its name and what it is now, makes it smaller: `power` is
        that of the value which the time goes with."""
        limit = LIMITS[name]
        self.worst[name] = max(self.worst[name], value)
        if value <= limit.remark:
            return
        refused = value > limit.refuse and self._strict
        border = f"at most {limit.refuse:.3g} is taken" if refused else f"above {limit.remark:.3g} results depend on it"
        remedy = limit.remedy.format(f"{time} {now * (limit.remark / value) ** power:.3g}")
        message = f"{name} is {value:.3g}, {limit.meaning}; {border}: {remedy}"
        if refused:
            error = CoarseCoupling(message)
            error.limit, error.value, error.most = name, value, limit.refuse
            raise error
        if name not in self._remarked:
            self._remarked.append(name)
            # Of the line that calls `step`.
            warnings.warn(message, CoarseCouplingWarning, stacklevel=5)

    def save(self) -> bytes:
        """MuJoCo's state and the world as bytes, from which `load` goes on with the same bits: MuJoCo on the same
        architecture and of the same version, which the bytes name.

        Raises
        ------
        KernelError, Busy
        """
        world, state = self.world.save(), _state(self.model, self.data)
        head = {
            "mujoco": mujoco.mj_versionString(),
            "model": _model_digest(self.model),
            "geoms": [[part.name, part.obstacle.number] for part in self._parts],
            "state": len(state),
            "sha256": hashlib.sha256(state + world).hexdigest(),
        }
        return _MAGIC + json.dumps(head).encode() + b"\n" + state + world


#: The first line of what is saved.
_MAGIC = b"bitgrain with mujoco, format 1\n"


def _state(model: Any, data: Any) -> bytes:
    kind = mujoco.mjtState.mjSTATE_INTEGRATION
    state = np.zeros(mujoco.mj_stateSize(model, kind))
    mujoco.mj_getState(model, data, state, kind)
    return state.astype("<f8").tobytes()


def _model_digest(model: Any) -> str:
    buffer = np.zeros(mujoco.mj_sizeModel(model), np.uint8)
    mujoco.mj_saveModel(model, None, buffer)
    return hashlib.sha256(buffer.tobytes()).hexdigest()


def _substeps(model: Any, world: World) -> int:
    """Steps of the world in a step of the model, if the two fit."""
    if model.opt.integrator == mujoco.mjtIntegrator.mjINT_RK4:
        raise wrong("model.opt.integrator", "is RK4, which does not stop for forces; expected another integrator")
    timestep, dt = float(model.opt.timestep), world.dt
    substeps = max(1, round(timestep / dt))
    if abs(substeps * dt - timestep) > 1e-9 * timestep:
        fitting = timestep / math.ceil(timestep / dt)
        raise wrong("world.dt", f"is {dt!r}; expected model.opt.timestep / a whole number, as {fitting!r}")
    return substeps


def couple(
    model: Any,
    data: Any,
    world: World,
    geoms: Sequence[str],
    *,
    material: Union[str, Mapping[str, str], None] = None,
    strict: bool = True,
) -> Coupling:
    """Puts geoms of a model of MuJoCo into a world of grains.

    Each becomes an obstacle of the world, where `data` has it: spheres, capsules, cylinders, boxes and meshes. MuJoCo
    itself takes a mesh for its convex hull; grains touch its triangles, on both sides. A contact counts a body's mass
    as MuJoCo's joints let it answer a push (``body_invweight0``), and a mesh as infinitely heavy. Gravity of the two
    is set in each of them.

    Parameters
    ----------
    model, data : mujoco.MjModel, mujoco.MjData
    world : World
        Grains, with room for the geoms; its dt is a whole part of ``model.opt.timestep``: see `grain_step`.
    geoms : sequence of str
        Names of the geoms.
    material : str or mapping of str to str, optional
        Name of the geoms' material, or of each by the geom's name, if the world's law has several.
    strict : bool
        Whether a coupling beyond `LIMITS` is refused. If not, it is remarked on.

    Raises
    ------
    InputError
        A geom is unknown, of another kind or outside the box; dt does not fit; the integrator is RK4. Before geoms that
        do not fit the box, or lie in grains, others may have been added to the world: make it anew.
    BadObstacle, ObstacleTooDeep, Busy

    Warns
    -----
    CoarseCouplingWarning
        In a step, when one of `LIMITS` is reached; once for each.
    """
    if isinstance(geoms, str) or len(geoms) == 0 or len(set(geoms)) < len(geoms):
        raise wrong("geoms", f"is {geoms!r}; expected a list of names of geoms, each once")
    _substeps(model, world)
    for name in geoms:
        check_geom(model, name)
    mujoco.mj_kinematics(model, data)
    parts = []
    for name in geoms:
        own = material if material is None or isinstance(material, str) else material.get(name)
        parts.append(Part(model, name, add_obstacle(model, data, world, name, own)))
    return Coupling(model, data, world, parts, strict)


def load(
    model: Any,
    data: Any,
    saved: bytes,
    *,
    threads: Optional[int] = None,
    instructions: Optional[str] = None,
    strict: bool = True,
) -> Coupling:
    """The coupling that `Coupling.save` wrote, with a world of its own; `data` gets the saved state.

    Parameters
    ----------
    model, data : mujoco.MjModel, mujoco.MjData
        The same model.
    saved : bytes
    threads, instructions
        As of `World.load`.
    strict : bool
        As of `couple`.

    Raises
    ------
    BadSave
        The bytes are not as they were written.
    InputError
        They are of another model, or of another version of MuJoCo.
    OtherVersion
        Another version of this package, with other bits, wrote them.
    """
    begin, _, rest = bytes(saved).partition(_MAGIC)
    line, _, payload = rest.partition(b"\n")
    try:
        head: Dict[str, Any] = json.loads(line)
    except ValueError:
        head = {}
    if begin or head.get("sha256") != hashlib.sha256(payload).hexdigest():
        raise BadSave("these bytes are not as Coupling.save wrote them: changed, cut off, or something else")
    if head["mujoco"] != mujoco.mj_versionString():
        problem = f"is of MuJoCo {head['mujoco']}, and this is {mujoco.mj_versionString()}: its bits differ"
        raise wrong("saved", problem)
    if head["model"] != _model_digest(model):
        raise wrong("model", "is not the one that was saved, or was changed since: make it as it was then")
    length = int(head["state"])
    world = World.load(payload[length:], threads=threads, instructions=instructions)
    state = np.frombuffer(payload[:length], "<f8").astype(np.float64)
    mujoco.mj_setState(model, data, state, mujoco.mjtState.mjSTATE_INTEGRATION)
    mujoco.mj_kinematics(model, data)
    obstacles = world.obstacles
    parts = [Part(model, name, obstacles[number]) for name, number in head["geoms"]]
    return Coupling(model, data, world, parts, strict)
