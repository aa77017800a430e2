"""The examples with MuJoCo, whole at small sizes: what they find, their files, the same bits twice."""

import csv
import importlib
import subprocess
import sys

import pytest
from conftest import ROOT

pytest.importorskip("mujoco", reason="bitgrain.mujoco needs the package mujoco")
pytest.importorskip("matplotlib", reason="the examples draw with matplotlib")

FOLDER = ROOT / "harness/python/examples/robots"
# Small and light as they are here.
pytestmark = pytest.mark.filterwarnings("ignore::bitgrain.mujoco.CoarseCouplingWarning")


@pytest.mark.parametrize("name, words, files", [
    ("ball", "--grains 300 --seconds 0.05 --frames 3", ["ball.csv", "ball.gif", "ball.png"]),
    ("wheel", "--grains 600 --length 0.13 --seconds 0.1 --slopes 0 5 --frames 3",
     ["wheel.csv", "wheel.gif", "wheel.png"]),
    ("plate", "--grains 1300 --box 0.15 --side 0.03 --depth 0.013",
     ["plate.csv", "plate.gif", "plate.png", "pressure.png"]),
])
def test_an_example_runs_and_repeats_its_bits(name, words, files, tmp_path):
    told = []
    for run in ("one", "two"):
        call = [sys.executable, f"{name}.py", "--out", str(tmp_path / run), *words.split()]
        done = subprocess.run(call, cwd=FOLDER, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        told.append(done.stdout)
    assert "digest " in told[0] and told[0] == told[1]
    assert sorted(path.name for path in (tmp_path / "one").iterdir()) == files
    tables = [(tmp_path / run / files[0]).read_text() for run in ("one", "two")]
    assert tables[0] == tables[1]
    rows = list(csv.DictReader(tables[0].splitlines()))
    assert len(rows) > 1 and all(float(x) < 1e6 for row in rows for x in row.values())


def test_the_speed_of_threads_is_measured_on_the_same_bits():
    words = "--grains 1200 --threads 1 2 --stretch 0.005"
    call = [sys.executable, "speed.py", *words.split()]
    done = subprocess.run(call, cwd=FOLDER, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    one, first, two, second, law = done.stdout.splitlines()
    assert "1 threads: real-time factor" in one and "2 threads: real-time factor" in two
    assert first.startswith("digest ") and first == second
    assert "dt 1.00e-04, 3 in a step" in law and "young=5000000.0" in law


@pytest.fixture
def example(monkeypatch):
    monkeypatch.syspath_prepend(str(FOLDER))
    return importlib.import_module


def test_a_ball_sinks_and_stops_moving_and_turning(example, tmp_path):
    ball = example("ball")
    rows = ball.dropped(900, 0.9, tmp_path, frames=0)
    end = rows[-1]
    weight = 4 / 3 * 3.14159 * ball.RADIUS**3 * 5000 * 9.81
    assert 0.2 < end["depth"] / ball.RADIUS < 2 and abs(end["force"] / weight - 1) < 0.05
    # From a metre and 20 radians a second; what is left is a trembling of the bed that fades.
    assert rows[0]["spin"] == pytest.approx(20) and end["spin"] < 0.1 and end["speed"] < 0.01
    assert end["turned"] < 1e-3


def test_a_wheel_climbs_with_more_slip_and_torque_where_it_is_steeper(example, tmp_path):
    level, steep = example("wheel").drive([0.0, 12.0], 2200, 1.2, tmp_path, length=0.24, frames=0)
    assert 0 < level["slip"] < steep["slip"] < 1
    assert 0 < level["torque"] < steep["torque"]


def test_the_pressure_on_a_stamp_grows_with_depth(example, tmp_path):
    rows, fit = example("plate").pressed(1800, 0.16, 0.03, tmp_path, side=0.04, picture=False)
    assert rows[0]["pressure"] == 0
    # Between the bed's own pressure per depth, of a fluid, and far more than any sand's angle gives.
    assert 5 < fit["slope"] < 50
    assert 0.5 < fit["bulk_density"] / 2500 < 0.65


def test_footings_are_those_of_the_books(example):
    """Bearing capacity factors N_q of Reissner, as they are printed: 6.40, 10.7 and 18.4."""
    plate = example("plate")
    for degrees, strip, tangent in ((20, 6.40, 0.36397), (25, 10.66, 0.46631), (30, 18.40, 0.57735)):
        assert plate.footing(degrees) == pytest.approx(strip * (1 + tangent), rel=2e-3)


def test_types_of_the_examples():
    files = sorted(path.name for path in FOLDER.glob("*.py"))
    assert len(files) == 6
    call = [sys.executable, "-m", "mypy", "--strict", *files]
    done = subprocess.run(call, cwd=FOLDER, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout
