"""Views of a world's state: arrays that are read where they are, and never after the state has changed."""

import traceback
from typing import Any, Callable, Dict, Iterator, List, Optional, Tuple

import numpy as np
from numpy.lib.mixins import NDArrayOperatorsMixin

from ._native import Window


class View(NDArrayOperatorsMixin):
    """Numbers of all grains, read in the memory of their world without a copy, and never written to.

    A view is of the state at which it was taken. Once the world is stepped or edited, using it raises
    :class:`bitgrain.StaleView`; `copy` makes an array to keep. While an operation reads the memory, a step of another
    thread is refused (:class:`bitgrain.Busy`), and the other way round.

    Arithmetic, comparisons, ufuncs and functions of numpy take views and return arrays of their own. So does an index:
    ``w.positions[:, 2]`` is an array of heights.
    """

    __slots__ = ("_window",)
    # Equality is by element, as of arrays.
    __hash__ = None  # type: ignore[assignment]

    def __init__(self, window: Window) -> None:
        self._window = window

    @property
    def shape(self) -> Tuple[int, ...]:
        """(n, 3) or (n,)."""
        return self._window.shape

    @property
    def dtype(self) -> "np.dtype[Any]":
        """The type of its numbers."""
        return np.dtype(self._window.dtype)

    @property
    def ndim(self) -> int:
        """2 or 1."""
        return len(self.shape)

    @property
    def size(self) -> int:
        """How many numbers it has."""
        return int(np.prod(self.shape))

    @property
    def T(self) -> "np.ndarray[Any, Any]":
        """A transposed copy."""
        return self.copy().T

    def copy(self) -> "np.ndarray[Any, Any]":
        """An array of its own, which stays as it is whatever the world does."""
        return np.array(self._window.lend())

    def sum(self, axis: Optional[int] = None) -> Any:
        """Sum over an axis, or of all numbers."""
        return np.sum(self, axis=axis)

    def mean(self, axis: Optional[int] = None) -> Any:
        """Mean over an axis, or of all numbers."""
        return np.mean(self, axis=axis)

    def min(self, axis: Optional[int] = None) -> Any:
        """Least number along an axis, or of all."""
        return np.min(self, axis=axis)

    def max(self, axis: Optional[int] = None) -> Any:
        """Largest number along an axis, or of all."""
        return np.max(self, axis=axis)

    def __len__(self) -> int:
        return self.shape[0]

    def __iter__(self) -> Iterator[Any]:
        return iter(self.copy())

    def __bool__(self) -> bool:
        return bool(self.copy())

    def __float__(self) -> float:
        return float(self.copy())

    def __getitem__(self, key: Any) -> Any:
        found = self._window.lend()[key]
        return np.array(found) if isinstance(found, np.ndarray) else found

    def __array__(self, dtype: Any = None, copy: Optional[bool] = None) -> "np.ndarray[Any, Any]":
        if copy is False:
            raise ValueError("a view gives its memory to nobody; leave out copy=False")
        return np.array(self._window.lend(), dtype=dtype)

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: Any, **kwargs: Any) -> Any:
        return _call(getattr(ufunc, method), inputs, kwargs)

    def __array_function__(
        self, func: Callable[..., Any], types: Any, args: Tuple[Any, ...], kwargs: Dict[str, Any]
    ) -> Any:
        return _call(func, args, kwargs)

    def __repr__(self) -> str:
        text = np.array2string(self.copy(), prefix="View(", separator=", ")
        return f"View({text})"


def _call(func: Callable[..., Any], args: Tuple[Any, ...], kwargs: Dict[str, Any]) -> Any:
    """Calls a function with the memory of views in their place; nothing of that memory comes back."""
    lent: List[Any] = []
    try:
        args = _with_lent(args, lent)
        kwargs = {key: _with_lent(value, lent) for key, value in kwargs.items()}
        return _own(func(*args, **kwargs), lent)
    except BaseException as error:
        # The frames of the function would keep the memory, and so the world, for as long as the traceback lives.
        if error.__traceback__ is not None:
            traceback.clear_frames(error.__traceback__.tb_next)
        raise
    finally:
        lent.clear()
        args, kwargs = (), {}


def _with_lent(value: Any, lent: List[Any]) -> Any:
    """An argument with arrays in place of views."""
    if isinstance(value, View):
        lent.append(value._window.lend())
        return lent[-1]
    if type(value) in (tuple, list):
        return type(value)(_with_lent(item, lent) for item in value)
    return value


def _own(value: Any, lent: List[Any]) -> Any:
    """A result with copies in place of arrays that share memory with what was lent."""
    if isinstance(value, np.ndarray):
        return np.array(value) if any(np.may_share_memory(value, one) for one in lent) else value
    if isinstance(value, tuple):
        items = [_own(item, lent) for item in value]
        # A named tuple takes its items one by one.
        return type(value)(*items) if hasattr(value, "_fields") else tuple(items)
    if isinstance(value, list):
        return [_own(item, lent) for item in value]
    return value
