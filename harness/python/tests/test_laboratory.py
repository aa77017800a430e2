"""Scenarios run from Python: the same bytes as the command's, and folders that are read, verified and compared."""

import importlib.util
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest
from conftest import ROOT

import bitgrain

#: A bed of 300 grains and one drag, as the tests of the command have it.
SMALL = re.search(r'pub const SMALL: &str = r#"\n(.*?)"#;', (ROOT / "tests/src/lib.rs").read_text(), re.S)[1]

SET = {"bed.settled": 1e-2, "intruder.speed": [0.5, 1.0]}


def command(*words, cwd):
    """Runs the command as `python -m bitgrain` does."""
    words = [sys.executable, "-m", "bitgrain", *map(str, words)]
    return subprocess.run(words, cwd=cwd, capture_output=True, text=True)


@pytest.fixture(scope="module")
def desk(tmp_path_factory):
    """A folder with a scenario, in which it was run from Python."""
    folder = tmp_path_factory.mktemp("desk")
    (folder / "small.toml").write_text(SMALL)
    return folder


@pytest.fixture(scope="module")
def made(desk):
    return bitgrain.run(desk / "small.toml", set=SET, out=desk / "made", beds=desk / "beds", threads=2)


def files(folder):
    """Bytes of all files of a run but its timings."""
    paths = [path for path in folder.rglob("*") if path.is_file() and path.name != "performance.json"]
    return {str(path.relative_to(folder)): path.read_bytes() for path in paths}


def test_a_run_has_the_bytes_of_the_command(desk, made):
    sets = [f"--set={key}={json.dumps(value)}" for key, value in SET.items()]
    out = command("run", "small.toml", *sets, "--out", "by-command", "--beds", "beds-2", "--threads", "1", cwd=desk)
    assert out.returncode == 0, out.stderr
    ours, theirs = files(made.path), files(desk / "by-command")
    assert ours.keys() == theirs.keys() and len(ours) > 10
    assert [name for name in ours if ours[name] != theirs[name]] == []
    assert made.closing in out.stdout and made.executed and made.finished and made.kind == "run"


def test_the_summary_is_that_of_the_file(made):
    assert made.summary == json.loads((made.path / "summary.json").read_text())
    assert [run["name"] for run in made.summary["runs"]] == ["run-1", "run-2"]


@pytest.mark.parametrize("kind", ["pandas", "polars", "numpy", None])
def test_tables(made, kind):
    if kind in ("pandas", "polars"):
        pytest.importorskip(kind)
    again = bitgrain.read(made.path, tables=kind)
    forces = again.forces("run-1")
    module = type(forces).__module__.split(".")[0].replace("builtins", "numpy")
    # The first that is installed, if none is asked for.
    installed = [name for name in ("pandas", "polars", "numpy") if importlib.util.find_spec(name)]
    assert module == (kind or installed[0])
    columns = {name: np.asarray(forces[name]) for name in (forces if module == "numpy" else forces.columns)}
    lines = (made.path / "runs/run-1/forces.csv").read_text().splitlines()
    lines = [line for line in lines if not line.startswith("#")]
    assert list(columns) == lines[0].split(",")
    assert len(columns["step"]) == len(lines) - 1 and np.issubdtype(columns["step"].dtype, np.integer)
    # The shortest decimals that read back to the same bits do so.
    for name, cell in zip(lines[0].split(","), lines[5].split(",")):
        assert cell == "" and np.isnan(columns[name][4]) or float(cell) == columns[name][4], name


def test_names_of_tables(made):
    assert {"runs/run-1/forces", "runs/run-2/forces", "runs/run-1/chain", "beds/bed.chain"} <= set(made.tables)
    with pytest.raises(KeyError, match="there are .*runs/run-1/forces"):
        made.tables["forces"]


def test_a_finished_run_executes_nothing(desk, made):
    for again in (
        bitgrain.run(desk / "small.toml", set=SET, out=made.path, beds=desk / "beds"),
        bitgrain.run(resume=made.path, beds=desk / "beds"),
    ):
        assert not again.executed and again.closing == made.closing


def test_one_drag_of_two(desk, made):
    only = bitgrain.run(desk / "small.toml", set=SET, out=desk / "only", beds=desk / "beds", only=["run-2"])
    assert not only.finished and [run["name"] for run in only.summary["runs"]] == ["run-2"]
    assert files(only.path / "runs/run-2") == files(made.path / "runs/run-2")


def test_what_is_expected_of_a_finished_run_is_executed_again(desk, made):
    spoilt = desk / "half-way"
    shutil.copytree(made.path, spoilt)
    bitgrain.run(resume=spoilt, beds=desk / "beds", expect=[made.closing])
    for wrong in ({"expect": ["0" * 64]}, {"expect": [made.closing], "only": ["run-1"]}):
        with pytest.raises((bitgrain.Unverified, bitgrain.InputError), match="neither its closing hash|with only"):
            bitgrain.run(resume=spoilt, beds=desk / "beds", **wrong)
    assert bitgrain.bisect(made.path, desk / "only", prefix=True) is None
    assert bitgrain.bisect(made.path, desk / "only").text == "run-1: the second run has none"


def test_verify(made):
    lines = bitgrain.verify(made.path, expect=[made.closing])
    assert re.match("all \\d+ links of \\d+ pieces hold", lines[-1])
    assert len(bitgrain.verify(made.path, segments=["run-1"])) < len(lines)
    one, other = (bitgrain.verify(made.path, sample=1, seed=5) for _ in range(2))
    assert one == other
    with pytest.raises(bitgrain.Unverified) as wrong:
        bitgrain.verify(made.path, expect=["0" * 64])
    assert wrong.value.exit_status == 3 and wrong.value.lines


def test_a_changed_file_is_found(desk, made):
    spoilt = desk / "spoilt"
    shutil.copytree(made.path, spoilt)
    path = spoilt / "runs/run-1/forces.csv"
    path.write_text(path.read_text().replace("1", "2", 1))
    with pytest.raises(bitgrain.InputError, match="forces.csv: was changed after it was written"):
        bitgrain.read(spoilt).forces("run-1")
    with pytest.raises(bitgrain.Unverified) as wrong:
        bitgrain.verify(spoilt)
    assert any("forces.csv" in line for line in wrong.value.lines)


def test_bisect(desk, made):
    other = bitgrain.run(desk / "small.toml", set={**SET, "law.mu": 0.4}, out=desk / "other", beds=desk / "beds")
    found = bitgrain.bisect(made.path, other.path)
    assert found is not None and found.stage == "bed" and found.step >= 0
    assert found.text == str(found) and found.stage in found.text
    printed = command("bisect", made.path, other.path, cwd=desk)
    assert printed.returncode == 3 and found.text in printed.stdout
    assert bitgrain.bisect(made.path, desk / "by-command") is None


def test_a_run_that_the_kernel_stops_says_why(desk):
    fast = {**SET, "intruder.speed": 150.0, "drag.distance": 6.0, "measure.every": 1}
    with pytest.raises(bitgrain.RunFailed) as stopped:
        bitgrain.run(desk / "small.toml", set=fast, out=desk / "stopped", beds=desk / "beds")
    error = stopped.value
    assert isinstance(error.fault, bitgrain.ObstacleTooDeep)
    assert (error.code, error.fault.code, error.fault.obstacle) == (38, 38, 0)
    assert error.exit_status == 3 and error.stage == "run-1" and error.step == 9
    # What the others of the folder measured can be read all the same, once there is something.
    with pytest.raises(bitgrain.InputError, match="no drag that has come to its end"):
        bitgrain.read(desk / "stopped")


def test_a_bed_that_does_not_settle(desk):
    never = {"bed.settled": 1e-300, "bed.grains": 90, "bed.box": [4.0, 4.0, 6.0], "drag.dt": 9e-4,
             "drag.distance": 3.5, "measure.every": 5}
    with pytest.raises(bitgrain.Unsettled) as restless:
        bitgrain.run(desk / "small.toml", set=never, out=desk / "never", beds=desk / "beds")
    assert restless.value.bound == 1e-300 and restless.value.step > 0 and restless.value.energy > 0


def test_ctrl_c_saves_a_run_that_goes_on(desk, made):
    """As the command: stopped between two steps, saved, and the same call ends with the same bytes."""
    out = desk / "stopped-by-hand"

    def interrupt():
        # As soon as the drags are at work.
        while not (out / "runs").exists():
            time.sleep(0.001)
        os.kill(os.getpid(), signal.SIGINT)

    thread = threading.Thread(target=interrupt)
    thread.start()
    with pytest.raises(KeyboardInterrupt) as stopped:
        bitgrain.run(desk / "small.toml", set=SET, out=out, beds=desk / "beds-4", threads=1)
    thread.join()
    if isinstance(stopped.value, bitgrain.Interrupted):
        assert stopped.value.exit_status == 130 and stopped.value.saved
    again = bitgrain.run(desk / "small.toml", set=SET, out=out, beds=desk / "beds-4")
    assert again.closing == made.closing


def test_the_script_is_the_command(desk):
    from bitgrain.folder import program

    out = subprocess.run([program(), "--version"], capture_output=True, text=True)
    assert out.stdout.startswith("bitgrain 0.") and out.returncode == 0
    wrong = command("run", "quikc", cwd=desk)
    assert wrong.returncode == 2 and "did you mean `quick`" in wrong.stderr
    assert command("nonsense", cwd=desk).returncode == 2


def test_values_as_toml_spells_them():
    from bitgrain.folder import _toml

    for value, text in [
        (True, "true"), (3, "3"), (1e-7, "1e-07"), ("a\"b", '"a\\"b"'), ([1, 2.5], "[1, 2.5]"),
        (np.float64(0.5), "0.5"), (np.arange(2), "[0, 1]"), ({"a": 1}, "{a = 1}"),
    ]:
        assert _toml(value, "key") == text


def test_parquet_reads_as_written():
    """Cells of every type, some without a value: what the laboratory's own writer of Parquet made of them."""
    polars = pytest.importorskip("polars")
    table = polars.read_parquet(ROOT / "harness/lab/data/cells.parquet")
    rows = range(11)
    assert table.columns == ["text", "real", "whole", "none"]
    assert table.dtypes == [polars.String, polars.Float64, polars.Int64, polars.Float64]
    assert table["text"].to_list() == [None if k % 3 == 1 else "\u00b5" * k for k in rows]
    reals = [0.1, -0.0, 5e-324, sys.float_info.max]
    assert str(table["real"].to_list()) == str([None if k == 4 else reals[k % 4] for k in rows])
    assert table["whole"].to_list() == [None if k == 0 else k - 3 for k in rows]
    assert table["none"].to_list() == [None] * 11
