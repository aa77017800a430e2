"""Exceptions: one class for each error of the kernel and of the laboratory.

All are :class:`Error`. Those of the kernel are :class:`KernelError`: grains are named by id, obstacles by number. Those
of the laboratory are :class:`LaboratoryError`.
"""

import json
from typing import Any, Dict, List, Optional

__all__ = [
    "Error",
    "KernelError",
    "BadDomain",
    "PeriodTooShort",
    "BadStorage",
    "BadOrder",
    "BadGrain",
    "BadObstacle",
    "BadTimeStep",
    "Arithmetic",
    "TooSlow",
    "ObstacleTooSlow",
    "GravityTooWeak",
    "BadContactHistory",
    "BadSave",
    "OtherFacets",
    "UnknownMaterial",
    "LawMisfit",
    "TooManyObstacles",
    "OtherVersion",
    "PairListFull",
    "OuterListFull",
    "ObstacleContactsFull",
    "BufferTooShort",
    "GrainsFull",
    "Overflow",
    "ObstacleOverflow",
    "NotFinite",
    "ObstacleNotFinite",
    "ObstacleTooFast",
    "TooFast",
    "Escaped",
    "OverlapTooDeep",
    "ObstacleTooDeep",
    "NotStarted",
    "Edited",
    "NoGrain",
    "UnknownGrain",
    "GrainsLeaving",
    "StaleView",
    "LongTimeStep",
    "Busy",
    "LaboratoryError",
    "InputError",
    "Damaged",
    "BadManifest",
    "RunFailed",
    "Unsettled",
    "Unfit",
    "Unverified",
    "MembersFailed",
    "Parted",
    "Interrupted",
    "ContractBroken",
    "OutOfMemory",
    "WriteFailed",
    "OutputFailed",
]


class Error(Exception):
    """Whatever this package raises."""

    #: Number of the kernel's error, the same in every version and language; 0 of errors that are not the kernel's.
    code: int = 0


class KernelError(Error):
    """Why a world was refused or a step stopped.

    Codes 1 to 19: something is wrong with what was given; 20 to 29: a list is full, and nothing was changed; 30 to 49:
    the motion went wrong, and the world is stopped; 50 to 59: the call was not due.
    """


class BadDomain(KernelError):
    """The box edges are not finite or not in order on this axis."""

    axis: int


class PeriodTooShort(KernelError):
    """A periodic axis is not longer than twice the largest contact distance."""

    axis: int


class BadStorage(KernelError):
    """The storage does not have one entry for each grain."""


class BadOrder(KernelError):
    """Ids do not strictly ascend at this one."""

    id: int


class BadGrain(KernelError):
    """A grain's group, radius or mass is missing, not positive or not finite."""

    id: int


class BadObstacle(KernelError):
    """An obstacle's size, place, direction or motion is impossible in this box; `flaw` says how."""

    obstacle: int
    flaw: str


class BadTimeStep(KernelError):
    """The time step is not positive and finite."""


class Arithmetic(KernelError):
    """The machine's arithmetic is not that of the bit contract; `flaw` says how."""

    flaw: str


class TooSlow(KernelError):
    """A carried grain would move less in a step than its coordinates resolve."""

    id: int


class ObstacleTooSlow(KernelError):
    """An obstacle would move less in a step than its coordinates resolve."""

    obstacle: int


class GravityTooWeak(KernelError):
    """Grains of this group would fall less in a step than their coordinates resolve."""

    group: int


class BadContactHistory(KernelError):
    """A saved contact is not finite or joins bodies that are not near each other."""


class BadSave(KernelError):
    """Bytes are no saved world, or were changed after they were written."""


class OtherVersion(KernelError):
    """A saved world of another layout, other arithmetic or another number type."""


class OtherFacets(KernelError):
    """The triangles of a world are not those that a mesh was made of."""

    obstacle: int


class UnknownMaterial(KernelError):
    """A group or an obstacle is of a material that the law does not know."""

    material: int


class LawMisfit(KernelError):
    """The law keeps more words of a contact than the world has room for."""


class TooManyObstacles(KernelError):
    """There are more obstacles than a world can have; those that move as one can be one mesh."""

    count: int
    most: int


class PairListFull(KernelError):
    """There is no memory for so many pairs; nothing was changed."""

    needed: int


class OuterListFull(KernelError):
    """There is no memory for so many candidates of pairs; nothing was changed."""

    needed: int


class ObstacleContactsFull(KernelError):
    """There is no memory for so many contacts of obstacles; nothing was changed."""

    needed: int


class BufferTooShort(KernelError):
    """Bytes that were lent are too few for a saved world."""

    needed: int


class GrainsFull(KernelError):
    """There is no room for so many grains; nothing was changed."""

    needed: int


class Overflow(KernelError):
    """A number of this grain is too large for its type."""

    id: int


class ObstacleOverflow(KernelError):
    """A number of this obstacle is too large for its type."""

    obstacle: int


class NotFinite(KernelError):
    """A velocity, spin, force or torque of this grain became NaN, infinite or too large to square."""

    id: int


class ObstacleNotFinite(KernelError):
    """The place of an obstacle, or the force or torque on it, became infinite or NaN."""

    obstacle: int


class ObstacleTooFast(KernelError):
    """An obstacle would move more than the smallest grain radius in one step."""

    obstacle: int


class TooFast(KernelError):
    """A grain would move more than its own radius in one step."""

    id: int


class Escaped(KernelError):
    """A grain left the box through an edge that is not periodic."""

    id: int


class OverlapTooDeep(KernelError):
    """Grains `i` and `j` overlap by more than a quarter of the smaller diameter."""

    i: int
    j: int


class ObstacleTooDeep(KernelError):
    """A grain overlaps an obstacle by more than a quarter of the smaller diameter."""

    id: int
    obstacle: int


class NotStarted(KernelError):
    """The world was stopped by a fault in the middle of a step: it has no state to be read or to go on from."""


class Edited(KernelError):
    """What a step reads was written to since the last one ended."""


class NoGrain(KernelError):
    """There is no grain at this place."""

    place: int


class UnknownGrain(KernelError):
    """No grain has this id."""

    id: int


class GrainsLeaving(KernelError):
    """Grains have left and were not taken out yet."""


class StaleView(Error):
    """A view was used after its world had been stepped or edited."""


class LongTimeStep(Error):
    """The time step of a strict world does not resolve the waves or the collisions of its bodies."""


class LongTimeStepWarning(UserWarning):
    """The time step of a world does not resolve the waves or the collisions of its bodies; the message says how."""


class Busy(Error):
    """The world is used by another thread, or by an operation that has not ended."""


class LaboratoryError(Error):
    """An error of the laboratory; its message says what, where and what to do."""

    #: Status with which the command ends.
    exit_status: int = 2


class InputError(LaboratoryError, ValueError):
    """Something that was given is wrong: `place` says what, `problem` why, and what was expected."""

    place: str
    problem: str


class Damaged(LaboratoryError):
    """A checkpoint that is not whole: changed or cut off since it was written."""

    place: str
    problem: str


class BadManifest(LaboratoryError):
    """A manifest that is not whole: changed or cut off since it was written."""

    place: str
    problem: str


class RunFailed(LaboratoryError):
    """A run stopped at a step: `fault` is the kernel's error, and `code` its number."""

    stage: str
    step: int
    fault: KernelError


class Unsettled(LaboratoryError):
    """A bed did not come to rest."""

    bed: str
    step: int
    energy: float
    bound: float
    carried: float


class Unfit(LaboratoryError):
    """A settled bed does not allow what the scenario asks for, which only pouring it shows."""

    place: str
    problem: str


class Unverified(LaboratoryError):
    """A run that was executed again did not give what was written; `lines` says what was found."""

    problem: str
    lines: List[str]


class MembersFailed(LaboratoryError):
    """Runs of a campaign failed."""

    failed: int
    done: int
    table: str


class Parted(LaboratoryError):
    """Two runs differ."""


class Interrupted(LaboratoryError, KeyboardInterrupt):
    """A run was stopped by Ctrl-C. If `saved`, the same call goes on from there."""

    stage: str
    step: int
    saved: bool


class ContractBroken(LaboratoryError):
    """This machine or this build does not keep the bit contract."""

    problem: str


class OutOfMemory(LaboratoryError, MemoryError):
    """There is not enough memory."""

    what: str
    bytes: float


class WriteFailed(LaboratoryError, OSError):
    """A file could not be written."""

    path: str


class OutputFailed(LaboratoryError, OSError):
    """Standard output was closed."""


def made(name: str, message: str, attributes: str) -> Error:
    """The exception of a class, with attributes from a JSON object; the native part raises it."""
    known: Dict[str, Any] = json.loads(attributes)
    found = globals().get(name)
    # A later kernel may have more kinds of errors.
    kind = found if isinstance(found, type) and issubclass(found, Error) else KernelError
    error: Error = kind(message)
    fault: Optional[str] = known.pop("fault", None)
    fields = known.pop("fields", {})
    for key, value in known.items():
        setattr(error, key, value)
    if isinstance(error, RunFailed) and fault is not None:
        fields["code"] = error.code
        cause = made(fault, message, json.dumps(fields))
        assert isinstance(cause, KernelError)
        error.fault = cause
    return error


def wrong(place: str, problem: str) -> InputError:
    """The exception for something that was given, of which the part in Python finds that it is wrong."""
    error = InputError(f"{place}: {problem}")
    error.place, error.problem = place, problem
    return error
