"""Recordings: arrays of any program by step, as a chain of digests, and where two recordings part."""

import json
import operator
import os
import warnings
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Any, Dict, List, Optional, Tuple, Type, Union

import numpy as np

from . import _native
from .errors import wrong

PathLike = Union[str, "os.PathLike[str]"]

#: Types of elements by the kind and size that numpy gives them; bfloat16, which is not numpy's own, has its name.
ELEMENTS = {
    "f8": "f64", "f4": "f32", "f2": "f16", "i8": "i64", "i4": "i32", "i2": "i16", "i1": "i8",
    "u8": "u64", "u4": "u32", "u2": "u16", "u1": "u8", "b1": "bool",
}  # fmt: skip

#: What numbers of Python become: types that depend neither on the machine nor on the version of numpy.
NUMBERS: Dict[type, str] = {float: "f8", int: "i8", bool: "b1"}


class Recorder:
    """Records arrays of any program by step, as `bitgrain record` does; `bisect` says where two recordings part.

    Used as a context manager, it is closed at the end of the block; a block that ends by an exception leaves the
    recording without an end, as a program that was stopped. What was recorded can be read in any case.

    Parameters
    ----------
    path : path
        Folder for the recording, made if it is missing; it must not have one yet.
    keep : str
        Which arrays are kept beside their digests: "digests" (none), "all", "every:100" (of the steps that 100
        divides), "last:5" (of the last five steps) or "120-140" (of these steps).

    Raises
    ------
    InputError
        The folder has a recording already, is that of a run or campaign, or `keep` is none of these.
    WriteFailed

    Examples
    --------
    >>> import bitgrain, numpy as np, tempfile
    >>> def sums(folder, values):
    ...     with bitgrain.Recorder(folder, keep="all") as recorder:
    ...         total = np.float32(0)
    ...         for step, value in enumerate(values):
    ...             total += np.float32(value)
    ...             recorder.record(step, total=total)
    ...     return folder
    >>> desk = tempfile.TemporaryDirectory()
    >>> up = sums(desk.name + "/up", [1e8, 1, 1])
    >>> down = sums(desk.name + "/down", [1e8, 1, 5])
    >>> print(bitgrain.bisect(up, down))
    the same to step 1, different at step 2
      arrays: total
      total: 100000000.0 (0x4cbebc20) against 100000010.0 (0x4cbebc21)
      bits: one differs, bit 0; 1 ulp apart
      elements: 1 of 1 differ
    """

    def __init__(self, path: PathLike, keep: str = "digests") -> None:
        self._path = Path(path)
        self._link: Optional[str] = None
        self._last: Optional[int] = None
        self._writer = _native.Writer(self._path, keep)

    def record(self, step: int, /, **arrays: Any) -> None:
        """Records the arrays of a step, in the order of the keywords; all of them or, if one is refused, none.

        Parameters
        ----------
        step : int
            Number of the step, 0 to 2^64 - 1; steps ascend.
        **arrays
            What has a type of its own: arrays and numbers of numpy, views of a world, arrays of other libraries that
            have a dtype, buffers. Elements are floats of 16, 32 or 64 bits, whole numbers of 8, 16, 32 or 64 bits,
            bool, or bfloat16 of the package ml_dtypes. The layout in memory and the order of bytes do not matter:
            what is recorded is the elements row by row, little-endian. A float of Python becomes one f64, an int one
            i64, a bool one bool. Lists and tuples are refused, since their type would depend on what is in them.

            Names have 1 to 64 letters, digits, ``_ . - /``; those that Python takes for no keyword can be given as
            ``**{"fluid/pressure": p}``.

        The arrays are copied; other threads of Python run while they are hashed and written.

        Raises
        ------
        InputError
            A step that does not ascend, no array, a wrong name, type or shape, or the recorder is closed.
        WriteFailed
        """
        number = _step(step)
        given = [(name, *_elements(name, value)) for name, value in arrays.items()]
        self._writer.record(number, given)
        self._last = number

    @property
    def last(self) -> Optional[int]:
        """The last step that was recorded; None before the first."""
        return self._last

    def close(self) -> str:
        """Writes the end of the recording and makes it last on the disk; returns the last link, 64 hexadecimal digits.

        The link stands for the whole recording: two recordings with equal links are equal. Closing again returns it
        again.

        Raises
        ------
        WriteFailed
        InputError
            The recorder was left by an exception, or an earlier `close` failed: the recording has no end.
        """
        if self._link is None:
            self._link = self._writer.close()
        return self._link

    def __enter__(self) -> "Recorder":
        return self

    def __exit__(
        self,
        exception: Optional[Type[BaseException]],
        _value: Optional[BaseException],
        _traceback: Optional[TracebackType],
    ) -> None:
        if exception is None:
            self.close()
        else:
            self._writer.abandon()

    def __repr__(self) -> str:
        return f"<bitgrain.Recorder: {self._path}, last step {self._last}>"


@dataclass(frozen=True)
class Parting:
    """Where two recordings first differ."""

    #: The last step that both have and that is the same; None if they differ from the beginning.
    equal: Optional[int]
    #: The first step that differs, or that only one has.
    step: int
    #: Names of all arrays that differ there; the other fields are of the first. None if only one has the step, or a
    #: recording lacks its end: then `hint` says which.
    arrays: List[str]
    #: Index of the first element that differs; None if the arrays were not kept, or differ in type or shape.
    index: Optional[Tuple[int, ...]]
    #: That element in the first and in the second recording, as numbers of numpy (bfloat16 as float32); None with it.
    values: Optional[Tuple[Any, Any]]
    #: Their bits as whole numbers; None with it.
    bits: Optional[Tuple[int, int]]
    #: How many numbers of the type lie from one to the other; None of whole numbers, of NaN, and with it.
    ulp: Optional[int]
    #: How many elements differ; None with it.
    differing: Optional[int]
    #: How many elements there are; None with it.
    count: Optional[int]
    #: Type and shape in each recording, as "f64 100x3", if they differ; "nothing" where the array is missing.
    kinds: Optional[Tuple[str, str]]
    #: What to do to learn more.
    hint: Optional[str]
    #: All of this as the command prints it.
    text: str

    def __str__(self) -> str:
        return self.text


def parting(a: Path, b: Path, prefix: bool) -> Optional[Parting]:
    """Where two recordings part; None if every step is the same. With `prefix` one may be the beginning of the other."""
    found, notes = _native.part_recordings(a, b, prefix)
    for note in notes:
        # Of the call of `bitgrain.bisect`.
        warnings.warn(note, stacklevel=3)
    if found is None:
        return None
    told = json.loads(found)
    element = told.pop("element", {})
    kinds = told.pop("kinds", None)
    missing = told.pop("missing", None)
    if missing is not None:
        kinds = ("an array", "nothing") if missing["first_has"] else ("nothing", "an array")
    bits = element.get("bits")
    return Parting(
        **told,
        index=tuple(element["index"]) if element else None,
        values=(_value(element["type"], bits[0]), _value(element["type"], bits[1])) if bits else None,
        bits=tuple(bits) if bits else None,
        ulp=element.get("ulp"),
        differing=element.get("differing"),
        count=element.get("count"),
        kinds=kinds and tuple(kinds),
    )


def _value(element: str, bits: int) -> Any:
    """The number with these bits."""
    if element == "bf16":
        return _value("f32", bits << 16)
    kind = next(kind for kind, name in ELEMENTS.items() if name == element)
    return np.frombuffer(bits.to_bytes(int(kind[1]), "little"), dtype=f"<{kind}")[0]


def _step(step: Any) -> int:
    try:
        number = operator.index(step)
    except TypeError:
        number = -1
    if not 0 <= number < 2**64:
        raise wrong("step", f"is {step!r}; expected a whole number from 0 to 2^64 - 1")
    return number


def _elements(name: str, value: Any) -> Tuple[str, Tuple[int, ...], bytes]:
    """Type of elements, shape and bytes of what is to be recorded."""
    array = _array(f"array `{name}`", value)
    shape = array.shape
    if array.dtype.name == "bfloat16":
        return "bf16", shape, array.view(np.uint16).astype("<u2", copy=False).tobytes()
    kind = f"{array.dtype.kind}{array.dtype.itemsize}"
    if kind not in ELEMENTS:
        advice = "; record its .real and .imag" if array.dtype.kind == "c" else ""
        known = ", ".join([*ELEMENTS.values(), "bf16"])
        raise wrong(f"array `{name}`", f"has elements of the type {array.dtype}; expected one of {known}{advice}")
    return ELEMENTS[kind], shape, array.astype(f"<{kind}", copy=False).tobytes()


def _array(place: str, value: Any) -> "np.ndarray[Any, Any]":
    """What is given as an array of the type that it has."""
    if type(value) in NUMBERS:
        try:
            return np.array(value, dtype=NUMBERS[type(value)])
        except OverflowError:
            raise wrong(place, f"is {value}, which has no place in 64 bits; give np.uint64(...) or floats") from None
    if isinstance(value, np.ma.MaskedArray):
        raise wrong(place, "has a mask, which is not recorded with it: record its .data and its .mask")
    kind = type(value).__name__
    try:
        holder = value if hasattr(value, "dtype") else memoryview(value)
    except TypeError:
        problem = f"is a {kind}, which has no type of elements: give np.array(..., dtype=...)"
        raise wrong(place, problem) from None
    try:
        return np.asarray(holder)
    except (TypeError, ValueError, RuntimeError) as why:
        raise wrong(place, f"is a {kind} that numpy makes no array of: {why}") from why

