"""Docstrings, examples, types and the guide's page: all that is shown runs."""

import doctest
import importlib.util
import re
import subprocess
import sys
from pathlib import Path

import pytest
from conftest import ROOT

import bitgrain

PACKAGE = Path(bitgrain.__file__).parent
EXAMPLES = sorted((ROOT / "harness/python/examples").glob("*.py"))
CLASSES = [bitgrain.World, bitgrain.Obstacle, bitgrain.Obstacles, bitgrain.Edit, bitgrain.Group, bitgrain.Departed, bitgrain.View,
           bitgrain.Folder, bitgrain.HertzHistory, bitgrain.HertzTsuji, bitgrain.Divergence,
           bitgrain.Recorder, bitgrain.Parting]


def members():
    """Public members of the public classes and functions, by name."""
    for kind in CLASSES:
        yield kind.__name__, kind
        for name, member in vars(kind).items():
            if not name.startswith("_"):
                yield f"{kind.__name__}.{name}", member
    for name in ("run", "read", "verify", "bisect", "contact_duration"):
        yield name, getattr(bitgrain, name)


def test_everything_public_is_documented():
    # Fields of a data class without a default are in its annotations, with comments.
    found = {name: member for name, member in members() if not isinstance(member, bool)}
    assert len(found) > 60
    bare = [name for name, member in found.items() if not (getattr(member, "__doc__", None) or "").strip()]
    assert bare == []


def test_docstrings_run():
    tried = 0
    for name, member in members():
        text = getattr(member, "__doc__", None) or ""
        test = doctest.DocTestParser().get_doctest(text, {}, name, None, 0)
        result = doctest.DocTestRunner().run(test)
        assert result.failed == 0, name
        tried += result.attempted
    assert tried >= 7


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_examples_run_and_repeat_their_bits(path):
    runs = [subprocess.run([sys.executable, path], capture_output=True, text=True) for _ in range(2)]
    assert runs[0].returncode == 0, runs[0].stderr
    assert re.search("digest [0-9a-f]{64}\n$", runs[0].stdout)
    assert runs[0].stdout == runs[1].stdout


def example(name):
    spec = importlib.util.spec_from_file_location(name, ROOT / f"harness/python/examples/{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_a_ball_pressed_into_a_bed_is_pushed_back():
    bed = example("bed")
    depths, forces = bed.pressed(bed.poured())
    assert depths[-1] > 1.9
    # By a multiple of the weight of the grains in its place, which is its volume below the surface at most.
    assert forces[depths > 1].mean() > 10
    assert forces[depths > 1].mean() > forces[depths < 0.3].mean()


def test_a_shear_flow_carries_higher_grains_faster():
    w = example("fluid").settled()
    free = w.groups == 0
    heights, speeds = w.positions[:, 2][free], w.velocities[:, 0][free]
    order = heights.argsort()
    assert 0 <= speeds[order[:25]].mean() < speeds[order[-25:]].mean()
    assert (w.positions[:25, 2] == 0).all()


def mypy(*words):
    words = [sys.executable, "-m", *words]
    return subprocess.run(words, cwd=ROOT / "harness/python", capture_output=True, text=True)


def test_types_of_package_and_examples():
    done = mypy("mypy", "--strict", "--package", "bitgrain")
    assert done.returncode == 0, done.stdout
    done = mypy("mypy", "--strict", *map(str, EXAMPLES))
    assert done.returncode == 0, done.stdout
    assert (PACKAGE / "py.typed").exists()


def test_stubs_are_what_is_there(tmp_path):
    allowed = tmp_path / "allowed"
    # What cannot be imported without MuJoCo.
    there = importlib.util.find_spec("mujoco") is not None
    allowed.write_text("" if there else "bitgrain.mujoco\nbitgrain._geoms\n")
    done = mypy("mypy.stubtest", "bitgrain", "--concise", "--allowlist", str(allowed))
    assert done.returncode == 0, done.stdout + done.stderr


def test_wrong_types_are_found(tmp_path):
    """The stubs can fail a check."""
    wrong = tmp_path / "wrong.py"
    wrong.write_text("import bitgrain\nbitgrain.HertzTsuji('soft', 0.3, 0.6, 0.5)\nbitgrain.World(box=None)\n")
    done = mypy("mypy", "--strict", str(wrong))
    assert done.returncode == 1 and "wrong.py:2" in done.stdout and "wrong.py:3" in done.stdout


def test_the_page_of_the_guide_runs(tmp_path, monkeypatch):
    """Its blocks, one after the other, as one program; `assert` lines in them are tests."""
    page = (ROOT / "harness/guide/src/python.md").read_text()
    blocks = re.findall(r"^```python\n(.*?)^```", page, re.S | re.M)
    assert len(blocks) >= 6 and sum(block.count("assert ") for block in blocks) >= 6
    monkeypatch.chdir(tmp_path)
    names = {}
    for k, block in enumerate(blocks):
        exec(compile(block, f"python.md, block {k + 1}", "exec"), names)


def test_notices_name_what_is_linked():
    tree = "cargo tree --locked -e normal,no-proc-macro --prefix none --format {p}|{l} --target "
    tree += "x86_64-unknown-linux-gnu"
    out = subprocess.run(tree.split(), cwd=ROOT / "harness/python", capture_output=True, text=True, check=True).stdout
    # Our own crates have a path behind their version.
    lines = {line.replace(" (*)", "") for line in out.splitlines() if "(/" not in line}
    rows = set()
    for line in lines:
        crate, licence = line.split("|")
        name, version = crate.split(" ")[:2]
        rows.add(f"| {name} | {version.lstrip('v')} | {licence.replace('/', ' OR ')} |")
    written = (ROOT / "harness/python/THIRD-PARTY.md").read_text().splitlines()
    assert len(rows) > 50
    assert {line for line in written if line.startswith("| ")} - rows == {
        "| crate | version | licence |",
        "| --- | --- | --- |",
    }, "cargo run -p bitgrain-tests --bin notices -- python"
    assert rows <= set(written)
