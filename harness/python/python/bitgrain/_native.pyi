"""The native part of the package, as checkers of types see it."""

from os import PathLike
from types import TracebackType
from typing import Any, Callable, Dict, List, Optional, Sequence, Tuple, Type, Union, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .view import View

__all__ = [
    "BITS_VERSION",
    "Departed",
    "Edit",
    "Group",
    "HertzHistory",
    "HertzTsuji",
    "Obstacle",
    "Obstacles",
    "Window",
    "World",
    "Writer",
    "bisect",
    "check",
    "command",
    "contact_duration",
    "is_recording",
    "part_recordings",
    "run",
    "text",
    "verify",
]

BITS_VERSION: int
"""Names the arithmetic of a step: builds with the same number give the same bits."""

_Law = Union["HertzHistory", "HertzTsuji", Dict[str, Any]]
_Array = Union[ArrayLike, View]
_Push = Union[_Array, Callable[["World"], _Array]]
_Path = Union[str, "PathLike[str]"]

@final
class HertzHistory:
    def __new__(
        cls,
        kn: float,
        kt: float,
        gamma_n: float,
        gamma_t: float,
        mu: float,
        rolling: Optional[Dict[str, Any]] = None,
    ) -> HertzHistory: ...
    @property
    def kn(self) -> float: ...
    @property
    def kt(self) -> float: ...
    @property
    def gamma_n(self) -> float: ...
    @property
    def gamma_t(self) -> float: ...
    @property
    def mu(self) -> float: ...
    @property
    def rolling(self) -> Optional[Dict[str, Any]]: ...

@final
class HertzTsuji:
    def __new__(
        cls,
        young: float,
        poisson: float,
        restitution: float,
        mu: float,
        rolling: Optional[Dict[str, Any]] = None,
    ) -> HertzTsuji: ...
    @property
    def young(self) -> float: ...
    @property
    def poisson(self) -> float: ...
    @property
    def restitution(self) -> float: ...
    @property
    def mu(self) -> float: ...
    @property
    def rolling(self) -> Optional[Dict[str, Any]]: ...

@final
class Group:
    @property
    def number(self) -> int: ...

@final
class Departed:
    @property
    def id(self) -> int: ...
    @property
    def cause(self) -> str: ...
    @property
    def partner(self) -> Optional[int]: ...
    @property
    def position(self) -> Tuple[float, float, float]: ...
    @property
    def velocity(self) -> Tuple[float, float, float]: ...
    @property
    def spin(self) -> Tuple[float, float, float]: ...
    @property
    def radius(self) -> float: ...
    @property
    def mass(self) -> float: ...

@final
class Obstacle:
    @property
    def number(self) -> int: ...
    @property
    def shape(self) -> str: ...
    @property
    def point(self) -> NDArray[np.float64]: ...
    @point.setter
    def point(self, value: _Array) -> None: ...
    @property
    def velocity(self) -> NDArray[np.float64]: ...
    @velocity.setter
    def velocity(self, value: _Array) -> None: ...
    @property
    def angular_velocity(self) -> NDArray[np.float64]: ...
    @angular_velocity.setter
    def angular_velocity(self, value: _Array) -> None: ...
    @property
    def orientation(self) -> NDArray[np.float64]: ...
    @orientation.setter
    def orientation(self, value: _Array) -> None: ...
    def set_free(
        self,
        along: Tuple[bool, bool, bool] = ...,
        turns: bool = True,
        inertia: Optional[_Array] = None,
    ) -> None: ...
    @property
    def is_free(self) -> bool: ...
    @property
    def applied_force(self) -> NDArray[np.float64]: ...
    @applied_force.setter
    def applied_force(self, value: _Array) -> None: ...
    @property
    def applied_torque(self) -> NDArray[np.float64]: ...
    @applied_torque.setter
    def applied_torque(self, value: _Array) -> None: ...
    @property
    def force(self) -> NDArray[np.float64]: ...
    @property
    def torque(self) -> NDArray[np.float64]: ...
    @property
    def mean_force(self) -> NDArray[np.float64]: ...
    @property
    def mean_torque(self) -> NDArray[np.float64]: ...
    @property
    def steps_left(self) -> int: ...
    def contact_stiffness(self) -> float: ...
    def drive(self, pos: _Array, over: float, orientation: Optional[_Array] = None) -> None: ...

@final
class Obstacles:
    @property
    def numbers(self) -> List[int]: ...
    @property
    def points(self) -> NDArray[np.float64]: ...
    @property
    def forces(self) -> NDArray[np.float64]: ...
    @property
    def torques(self) -> NDArray[np.float64]: ...
    @property
    def mean_forces(self) -> NDArray[np.float64]: ...
    @property
    def mean_torques(self) -> NDArray[np.float64]: ...
    def drive(self, pos: _Array, over: float, orientations: _Array) -> None: ...

@final
class Edit:
    def __enter__(self) -> Edit: ...
    def __exit__(
        self,
        exception: Optional[Type[BaseException]],
        _value: Optional[BaseException],
        _traceback: Optional[TracebackType],
    ) -> bool: ...
    def set_velocities(self, ids: _Array, velocities: _Array) -> None: ...
    def set_spins(self, ids: _Array, spins: _Array) -> None: ...
    def insert(
        self,
        positions: _Array,
        radii: _Array,
        density: _Array,
        velocities: Optional[_Array] = None,
        spins: Optional[_Array] = None,
        group: Union[Group, str, None] = None,
        ids: Optional[_Array] = None,
    ) -> NDArray[np.uint32]: ...
    def remove(self, ids: _Array) -> None: ...
    def set_group(self, ids: _Array, group: Union[Group, str]) -> None: ...

@final
class World:
    def __new__(
        cls,
        box: Optional[_Array],
        gravity: _Array,
        dt: float,
        law: _Law,
        *,
        periodic: Tuple[bool, bool, bool] = ...,
        threads: Optional[int] = None,
        instructions: Optional[str] = None,
        lose: bool = False,
        drain: Optional[Tuple[_Array, _Array]] = None,
        strict: bool = False,
    ) -> World: ...
    def add(
        self,
        positions: _Array,
        radii: _Array,
        density: _Array,
        velocities: Optional[_Array] = None,
        spins: Optional[_Array] = None,
        group: Union[Group, str, None] = None,
        ids: Optional[_Array] = None,
    ) -> NDArray[np.uint32]: ...
    def sphere(
        self,
        radius: float,
        point: Optional[_Array] = None,
        velocity: Optional[_Array] = None,
        density: Optional[float] = None,
        material: Optional[str] = None,
    ) -> Obstacle: ...
    def cylinder(
        self,
        radius: float,
        axis: _Array,
        point: Optional[_Array] = None,
        velocity: Optional[_Array] = None,
        length: Optional[float] = None,
        density: Optional[float] = None,
        material: Optional[str] = None,
        orientation: Optional[_Array] = None,
    ) -> Obstacle: ...
    def capsule(
        self,
        radius: float,
        axis: _Array,
        half_length: float,
        point: Optional[_Array] = None,
        velocity: Optional[_Array] = None,
        density: Optional[float] = None,
        material: Optional[str] = None,
        orientation: Optional[_Array] = None,
    ) -> Obstacle: ...
    def cuboid(
        self,
        half: _Array,
        point: Optional[_Array] = None,
        velocity: Optional[_Array] = None,
        density: Optional[float] = None,
        material: Optional[str] = None,
        orientation: Optional[_Array] = None,
    ) -> Obstacle: ...
    def drum(
        self,
        radius: float,
        axis: _Array,
        length: float,
        point: Optional[_Array] = None,
        material: Optional[str] = None,
    ) -> Obstacle: ...
    def mesh(
        self,
        triangles: Union[_Array, str, PathLike[str]],
        point: Optional[_Array] = None,
        velocity: Optional[_Array] = None,
        material: Optional[str] = None,
        orientation: Optional[_Array] = None,
    ) -> Obstacle: ...
    def plane(
        self,
        normal: _Array,
        point: Optional[_Array] = None,
        velocity: Optional[_Array] = None,
        material: Optional[str] = None,
    ) -> Obstacle: ...
    def group(
        self, kind: str, gravity: Optional[_Array] = None, material: Optional[str] = None
    ) -> Group: ...
    @classmethod
    def load(
        cls,
        data: Union[bytes, bytearray],
        *,
        threads: Optional[int] = None,
        instructions: Optional[str] = None,
        strict: bool = False,
    ) -> World: ...
    def save(self) -> bytes: ...
    def select(self, obstacles: Sequence[Obstacle]) -> Obstacles: ...
    def start(self) -> None: ...
    def contact_duration(self, speed: float) -> float: ...
    def step(
        self, n: int = 1, *, force: Optional[_Push] = None, torque: Optional[_Push] = None
    ) -> None: ...
    def edit(self) -> Edit: ...
    @property
    def digest(self) -> str: ...
    @property
    def digests(self) -> Dict[str, str]: ...
    @property
    def positions(self) -> View: ...
    @property
    def radii(self) -> View: ...
    @property
    def velocities(self) -> View: ...
    @property
    def masses(self) -> View: ...
    @property
    def spins(self) -> View: ...
    @property
    def forces(self) -> View: ...
    @property
    def torques(self) -> View: ...
    @property
    def images(self) -> View: ...
    @property
    def ids(self) -> View: ...
    @property
    def groups(self) -> View: ...
    @property
    def departures(self) -> List[Departed]: ...
    @property
    def obstacles(self) -> List[Obstacle]: ...
    @property
    def box(self) -> Optional[List[NDArray[np.float64]]]: ...
    @property
    def periodic(self) -> Tuple[bool, bool, bool]: ...
    @property
    def gravity(self) -> NDArray[np.float64]: ...
    @property
    def dt(self) -> float: ...
    @property
    def step_count(self) -> int: ...
    @property
    def time(self) -> float: ...
    @property
    def kinetic_energy(self) -> float: ...
    def __len__(self) -> int: ...
    def __bool__(self) -> bool: ...

@final
class Window:
    @property
    def shape(self) -> Tuple[int, ...]: ...
    @property
    def dtype(self) -> str: ...
    def lend(self) -> NDArray[Any]: ...

@final
class Writer:
    def __new__(cls, folder: _Path, keep: str) -> Writer: ...
    def record(self, step: int, arrays: Sequence[Tuple[str, str, Sequence[int], bytes]]) -> None: ...
    def close(self) -> str: ...
    def abandon(self) -> None: ...

def contact_duration(law: _Law, speed: float, radius: float, density: float) -> float: ...
def is_recording(path: _Path) -> bool: ...
def part_recordings(first: _Path, second: _Path, prefix: bool) -> Tuple[Optional[str], List[str]]: ...
def run(
    name: Optional[str],
    sets: Sequence[str],
    out: Optional[_Path],
    beds: Optional[_Path],
    threads: Optional[int],
    save_every: Optional[str],
    only: Sequence[str],
    expect: Sequence[str],
    verbose: bool,
) -> Tuple[str, bool, bool]: ...
def verify(
    folder: _Path,
    expect: Sequence[str],
    segments: Sequence[str],
    sample: Optional[int],
    seed: int,
    threads: Optional[int],
) -> List[str]: ...
def bisect(
    folders: Tuple[_Path, _Path], programs: Tuple[_Path, _Path], prefix: bool
) -> Tuple[Optional[str], List[str]]: ...
def check(folder: _Path) -> str: ...
def text(folder: _Path, name: str) -> str: ...
def command(words: Sequence[str], this: Optional[_Path]) -> int: ...
