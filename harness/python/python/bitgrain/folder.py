"""The laboratory: scenarios are run into folders, and folders are verified, compared and read."""

import csv
import importlib
import json
import os
import sys
import sysconfig
import time
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Dict, Iterator, List, Optional, Sequence, Tuple, Union

import numpy as np

from . import _native
from .errors import wrong
from .recording import Parting, parting

PathLike = Union[str, "os.PathLike[str]"]

#: What tables may come as.
KINDS = ("pandas", "polars", "numpy")


class Tables(Mapping[str, Any]):
    """The tables of a folder by their names, as "runs/run-1/forces"; each is read when it is asked for.

    A file that is not as the folder's manifest says raises :class:`bitgrain.InputError`.
    """

    def __init__(self, path: Path, names: Sequence[str], kind: str) -> None:
        self._path = path
        self._names = list(names)
        self._kind = kind

    def __getitem__(self, name: str) -> Any:
        if name not in self._names:
            raise KeyError(f"there is no table {name!r}; there are {', '.join(self._names)}")
        return _table(_native.text(self._path, f"{name}.csv"), self._kind)

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)

    def __repr__(self) -> str:
        return f"<tables: {', '.join(self._names)}>"


@dataclass(frozen=True)
class Folder:
    """The folder of a run or of a campaign, as it is on the disk."""

    #: Where it is.
    path: Path
    #: "run" or "campaign".
    kind: str
    #: Whether all of it is finished.
    finished: bool
    #: Closing hash of the manifest.
    closing: str
    #: All numbers of a run, as `summary.json` has them; empty of a campaign.
    summary: Dict[str, Any]
    #: Tables by name: data frames, or dictionaries of numpy arrays.
    tables: Tables
    #: Whether a step was executed by the call that returned this; False of a folder that was read.
    executed: bool = False

    def forces(self, run: str) -> Any:
        """The force series of a drag, as "run-1"."""
        return self.tables[f"runs/{run}/forces"]


@dataclass(frozen=True)
class Divergence:
    """Where two runs first differ."""

    #: The stage.
    stage: str
    #: Its last step with equal states; None if they differ from the beginning.
    equal: Optional[int]
    #: Its first step with different states.
    step: int
    #: Parts of the state that differ there.
    parts: List[str]
    #: The first number that differs, in words.
    number: Optional[str]
    #: The first contact that differs, in words.
    contact: Optional[str]
    #: All of this as the command prints it.
    text: str

    def __str__(self) -> str:
        return self.text


def run(
    scenario: Optional[PathLike] = None,
    *,
    set: Optional[Mapping[str, Any]] = None,
    out: Optional[PathLike] = None,
    resume: Optional[PathLike] = None,
    threads: Optional[int] = None,
    beds: Optional[PathLike] = None,
    save_every: Optional[str] = None,
    only: Sequence[str] = (),
    expect: Sequence[str] = (),
    verbose: bool = False,
    tables: Optional[str] = None,
) -> Folder:
    """Runs a scenario as `bitgrain run` does, with the same bytes in every file, and reads its folder.

    Ctrl-C stops it between two steps; it is saved, and the same call goes on from there.

    Parameters
    ----------
    scenario : str or path
        Name of a shipped scenario, or a TOML file.
    set : dict, optional
        Keys of the scenario that get other values, as ``{"law.mu": 0.3}``.
    out : path, optional
        Folder for the results; ``out/NAME`` by default.
    resume : path, optional
        Goes on with the run in this folder, in place of `scenario`, `set` and `out`.
    threads : int, optional
        Threads; one for each processor by default. No result depends on it.
    beds : path, optional
        Folder of the settled beds that runs share; in the user's cache by default.
    save_every : str, optional
        How often unfinished stages are saved, in minutes ("5m", the default) or steps ("20000").
    only : sequence of str
        Names of the drags to do; all by default.
    expect : sequence of str
        Closing hashes or last links that the run must arrive at. What was found of it is executed again.
    verbose : bool
        Lines on standard error, if that is not a terminal.
    tables : str, optional
        What tables come as; see `read`.

    Raises
    ------
    InputError
        Something that was given is wrong.
    Interrupted
        Ctrl-C; also a `KeyboardInterrupt`.
    LaboratoryError
        Whatever else keeps the run from its end, as `RunFailed` with the kernel's error.
    """
    kind = _kind(tables)
    if (scenario is None) == (resume is None) or (resume is not None and (set or out)):
        raise wrong("scenario", "give a scenario, with set and out if you like, or resume alone")
    sets = [f"{key}={_toml(value, key)}" for key, value in (set or {}).items()]
    name = None if scenario is None else os.fspath(scenario)
    place = out if resume is None else resume
    folder, _, executed = _native.run(
        name,
        sets,
        None if place is None else Path(place),
        None if beds is None else Path(beds),
        threads,
        save_every,
        list(only),
        list(expect),
        verbose,
    )
    return _read(Path(folder), kind, executed)


def read(folder: PathLike, *, tables: Optional[str] = None) -> Folder:
    """Reads the folder of a run or of a campaign, whose files must be as its manifest says.

    Parameters
    ----------
    folder : path
        The folder.
    tables : str, optional
        "pandas" or "polars" for data frames, "numpy" for a dictionary of arrays of shape (n_rows,) by column. By
        default the first of these that is installed.

    Raises
    ------
    InputError, BadManifest
    """
    return _read(Path(folder), _kind(tables), False)


def verify(
    folder: PathLike,
    *,
    expect: Sequence[str] = (),
    segments: Sequence[str] = (),
    sample: Optional[int] = None,
    seed: Optional[int] = None,
    threads: Optional[int] = None,
) -> List[str]:
    """Executes a run or a campaign again, whole or in pieces, and compares every byte, as `bitgrain verify` does.

    Returns the lines that the command prints.

    Parameters
    ----------
    folder : path
        The folder.
    expect : sequence of str
        Closing hashes or last links that the folder must have.
    segments : sequence of str
        Stages, or stretches of steps, as "run-1" or "run-1:20000-40000"; all by default.
    sample : int, optional
        Only so many pieces, chosen at random.
    seed : int, optional
        Seed of the choice; the time by default.
    threads : int, optional
        Threads; one for each processor by default.

    Raises
    ------
    Unverified
        Something does not hold; its `lines` say what.
    InputError, Interrupted
    """
    chosen = time.time_ns() if seed is None else seed
    return _native.verify(
        Path(folder), list(expect), list(segments), sample, chosen % 2**64, threads
    )


def bisect(
    a: PathLike,
    b: PathLike,
    *,
    program_a: Optional[PathLike] = None,
    program_b: Optional[PathLike] = None,
    prefix: bool = False,
) -> Union[Divergence, Parting, None]:
    """Finds where two runs or two recordings differ first, as `bitgrain bisect` does; None if they agree.

    Of runs it is the first step, grain and contact, as a `Divergence`; of recordings the first step, array, element
    and bit, as a `Parting`. If one has less than the other, or a recording lacks its end, that is a difference.

    Parameters
    ----------
    a, b : path
        The folders of the runs or of the recordings; of a recording also its file `recording.csv` alone.
    program_a, program_b : path, optional
        The programs that execute runs again; the script `bitgrain` of this package by default.
    prefix : bool
        One may be the beginning of the other.

    Raises
    ------
    InputError
        The two have nothing in common, a file was changed, a folder has both a run and a recording, or a program does
        not do as it should.
    """
    if any([_native.is_recording(Path(path)) for path in (a, b)]):
        if program_a is not None or program_b is not None:
            raise wrong("program_a", "recordings are compared without their programs; leave out both")
        return parting(Path(a), Path(b), prefix)
    own = program()
    if own is None and (program_a is None or program_b is None):
        raise wrong("program_a", "the script bitgrain of this package is not installed; name both programs")
    programs = [Path(p or own or "") for p in (program_a, program_b)]
    found, _ = _native.bisect((Path(a), Path(b)), (programs[0], programs[1]), prefix)
    return None if found is None else Divergence(**json.loads(found))


def program() -> Optional[Path]:
    """The script `bitgrain` that came with this package; None if there is none."""
    name = "bitgrain.exe" if sys.platform == "win32" else "bitgrain"
    folders = [sysconfig.get_path("scripts"), os.path.dirname(sys.executable)]
    paths = [Path(folder) / name for folder in folders if folder]
    return next((path for path in paths if path.is_file()), None)


def _read(path: Path, kind: str, executed: bool) -> Folder:
    found = json.loads(_native.check(path))
    names = [name[:-4] for name in found["files"] if name.endswith(".csv")]
    tables = Tables(path, names, kind)
    summary = found["summary"] or {}
    return Folder(path, found["kind"], found["finished"], found["closing"], summary, tables, executed)


def _kind(asked: Optional[str]) -> str:
    """What tables come as: what is asked for, or the first that is installed."""
    if asked is not None and asked not in KINDS:
        raise wrong("tables", f"is {asked!r}; expected one of {', '.join(KINDS)}")
    for kind in KINDS if asked is None else (asked,):
        try:
            importlib.import_module(kind)
        except ImportError:
            continue
        return kind
    raise wrong("tables", f"{asked} is not installed: pip install {asked}")


def _table(text: str, kind: str) -> Any:
    """A table of the laboratory: a comment, names, rows; numbers read back to the bits that were written."""
    lines = [line for line in text.splitlines() if not line.startswith("#")]
    names, *rows = list(csv.reader(lines))
    cells = zip(*rows) if rows else [() for _ in names]
    columns = {name: _column(column) for name, column in zip(names, cells)}
    return columns if kind == "numpy" else importlib.import_module(kind).DataFrame(columns)


def _column(cells: Tuple[str, ...]) -> "np.ndarray[Any, Any]":
    """Whole numbers, numbers (an empty cell is NaN) or words."""
    for kind, read in ((np.int64, int), (np.float64, lambda cell: float(cell or "nan"))):
        try:
            return np.array([read(cell) for cell in cells], dtype=kind)
        except ValueError:
            continue
    return np.array(cells)


def _toml(value: Any, key: str) -> str:
    """A value as TOML spells it."""
    value = value.tolist() if isinstance(value, (np.generic, np.ndarray)) else value
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, (int, float)):
        return repr(value)
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False)
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(_toml(item, key) for item in value) + "]"
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{name} = {_toml(item, key)}" for name, item in value.items()) + "}"
    raise wrong(f"set[{key!r}]", f"is {value!r}; expected a number, a word, a list or a dictionary of these")
