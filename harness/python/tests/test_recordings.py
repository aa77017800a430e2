"""Recordings from Python: the bytes of the command's, whatever the layout of an array, and where two of them part."""

import subprocess
import sys
import threading
import time
import warnings

import ml_dtypes
import numpy as np
import pytest
from conftest import falling

import bitgrain

#: numpy's types of elements and their names in a recording.
TYPES = {
    np.dtype(kind): name for kind, name in [
        ("f8", "f64"), ("f4", "f32"), ("f2", "f16"), (ml_dtypes.bfloat16, "bf16"), ("i8", "i64"), ("i4", "i32"),
        ("i2", "i16"), ("i1", "i8"), ("u8", "u64"), ("u4", "u32"), ("u2", "u16"), ("u1", "u8"), ("?", "bool"),
    ]
}


def numbers(dtype, shape=(4, 3)):
    """Bits without a pattern, as elements of a type."""
    bits = np.random.default_rng(7).integers(0, 256, dtype.itemsize * int(np.prod(shape)), dtype=np.uint8)
    return (bits % 2 if dtype == bool else bits).view(dtype).reshape(shape)


def record(folder, steps, keep="all"):
    """Records dictionaries of arrays by step; returns the last link."""
    with bitgrain.Recorder(folder, keep) as recorder:
        for step, arrays in steps.items():
            recorder.record(step, **arrays)
    return recorder.close()


def recorded_by_command(folder, steps, *words):
    """The same by frames on the command's standard input, as the guide has them; returns what it prints."""
    frames = b""
    for step, arrays in steps.items():
        frames += b"step %d\n" % step
        for name, array in arrays.items():
            shape = "x".join(map(str, array.shape))
            frames += f"array {name} {TYPES[array.dtype]} {shape}\n".encode() + array.tobytes()
        frames += b"done\n"
    done = subprocess.run([sys.executable, "-m", "bitgrain", "record", folder, *words], input=frames + b"end\n",
                          capture_output=True)
    assert done.returncode == 0, done.stderr
    return done.stdout.decode()


def files(folder):
    return {path.relative_to(folder): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


@pytest.mark.parametrize("keep", ["digests", "all", "last:2", "every:2", "1-1"])
def test_every_file_has_the_bytes_of_the_command(tmp_path, keep):
    shapes = [(4, 3), (0, 3), (), (2, 1, 2)]
    steps = {
        step: {f"{TYPES[kind]}/{k}": numbers(kind, shape) for kind in TYPES for k, shape in enumerate(shapes)}
        for step in (0, 1, 7)
    }
    link = record(tmp_path / "ours", steps, keep)
    said = recorded_by_command(tmp_path / "theirs", steps, "--keep", keep)
    ours = files(tmp_path / "ours")
    assert ours == files(tmp_path / "theirs") and len(ours) == {"all": 4, "last:2": 3}.get(keep, 1 + (keep != "digests"))
    assert ours[next(path for path in ours if path.name == "recording.csv")].count(b"\n") == 2 + 3 * 13 * 4 + 1
    assert link in said


@pytest.mark.parametrize("kind", TYPES, ids=TYPES.values())
def test_layout_and_order_of_bytes_do_not_matter(tmp_path, kind):
    plain = numbers(kind)
    twice = np.zeros((8, 6), dtype=kind)
    twice[::2, ::2] = plain
    layouts = [plain, np.asfortranarray(plain), twice[::2, ::2], plain[::-1, ::-1].copy()[::-1, ::-1],
               plain.T.copy().T]
    if kind != ml_dtypes.bfloat16:
        # By their bits: a conversion of values could change kinds of NaN.
        layouts.append(plain.byteswap().view(kind.newbyteorder(">")))
    links = {record(tmp_path / str(k), {0: {"x": array}}) for k, array in enumerate(layouts)}
    assert len(links) == 1


@pytest.mark.parametrize("kind", TYPES, ids=TYPES.values())
def test_a_changed_bit_is_found_at_its_element(tmp_path, kind):
    plain = numbers(kind)
    other = plain.copy()
    other.view(np.uint8).reshape(-1)[7 * other.itemsize] ^= 1
    record(tmp_path / "a", {0: {"x": plain}, 5: {"y": plain, "x": plain}, 6: {"x": plain}})
    record(tmp_path / "b", {0: {"x": plain}, 5: {"y": plain, "x": other}, 6: {"x": other}})
    found = bitgrain.bisect(tmp_path / "a", tmp_path / "b")
    assert (found.equal, found.step, found.arrays, found.index) == (0, 5, ["x"], (2, 1))
    assert (found.differing, found.count) == (1, 12) and found.bits[0] ^ found.bits[1] == 1
    for value, array in zip(found.values, (plain, other)):
        shown = np.float32(array[2, 1]) if kind == ml_dtypes.bfloat16 else array[2, 1]
        # Bit by bit, so that NaN is equal to itself.
        assert value.dtype == shown.dtype and value.tobytes() == shown.tobytes()
    assert found.ulp == (1 if "f" in TYPES[kind] and np.isfinite(found.values).all() else None)
    command = subprocess.run([sys.executable, "-m", "bitgrain", "bisect", tmp_path / "a", tmp_path / "b"],
                             capture_output=True, text=True)
    assert command.returncode == 3 and command.stdout == f"{found}\n"


def test_what_differs_but_is_no_element(tmp_path):
    x = np.zeros((2, 2))
    record(tmp_path / "a", {3: {"x": x}})
    record(tmp_path / "shape", {3: {"x": x[0]}})
    record(tmp_path / "missing", {3: {"y": x}})
    record(tmp_path / "digests", {3: {"x": x + 1}}, keep="digests")
    found = bitgrain.bisect(tmp_path / "a", tmp_path / "shape")
    assert found.kinds == ("f64 2x2", "f64 2") and found.index is found.values is found.ulp is None
    found = bitgrain.bisect(tmp_path / "a", tmp_path / "missing")
    assert found.arrays == ["x", "y"] and found.kinds == ("an array", "nothing") and found.equal is None
    found = bitgrain.bisect(tmp_path / "a", tmp_path / "digests")
    assert found.arrays == ["x"] and found.index is None and "record both again with --keep 3-3" in found.hint


def test_worlds_are_recorded_the_same_on_any_number_of_threads(tmp_path):
    def fall(folder, threads, nudged=False):
        # Above a thousand grains two threads step.
        w = falling(side=11, layers=9, threads=threads)
        with bitgrain.Recorder(folder, keep="last:1") as recorder:
            for _ in range(3):
                w.step(40)
                if nudged and w.step_count == 80:
                    with w.edit() as edit:
                        speed = w.velocities[500].copy()
                        speed[2] = np.nextafter(speed[2], 1)
                        edit.set_velocities([501], speed)
                recorder.record(w.step_count, velocities=w.velocities, positions=w.positions, ids=w.ids, groups=w.groups,
                                images=w.images, radii=w.radii, energy=w.kinetic_energy)
        return (folder / "recording.csv").read_bytes()

    one = fall(tmp_path / "one", 1)
    assert fall(tmp_path / "two", 2) == one
    assert b"\n40,radii,f64,1089," in one and b"\n120,images,i32,1089x3," in one and b",energy,f64,," in one
    assert bitgrain.bisect(tmp_path / "one", tmp_path / "two") is None
    fall(tmp_path / "nudged", 1, nudged=True)
    found = bitgrain.bisect(tmp_path / "one", tmp_path / "nudged")
    assert (found.equal, found.step, found.arrays[0]) == (40, 80, "velocities")


def test_numbers_of_python_have_one_type(tmp_path):
    link = record(tmp_path / "python", {0: {"x": 0.5, "n": -3, "b": True}})
    numpy = {"x": np.float64(0.5), "n": np.int64(-3), "b": np.bool_(True)}
    assert link == record(tmp_path / "numpy", {0: numpy})


def test_other_holders_of_elements(tmp_path):
    pandas = pytest.importorskip("pandas")
    x = np.array([1, 2, 3], dtype=np.uint8)
    given = [x, pandas.Series(x), bytearray(b"\1\2\3"), memoryview(b"\1\2\3"), b"\1\2\3"]
    links = [record(tmp_path / str(k), {0: {"x": value}}) for k, value in enumerate(given)]
    assert len(set(links)) == 1


@pytest.mark.parametrize("value, why", [
    ([1.0, 2.0], "is a list, which has no type of elements"),
    ((1, 2), "is a tuple"),
    (range(3), "is a range"),
    (None, "is a NoneType"),
    ("text", "is a str"),
    (2**63, "no place in 64 bits"),
    (np.array([1j]), "complex128; expected one of f64, .* record its .real"),
    (np.array(["a"]), "type <U1"),
    (np.array([{}]), "type object"),
    (np.array([0], dtype="M8[s]"), "datetime64"),
    (np.zeros(2, dtype=[("a", "f8")]), "expected one of"),
    (np.ma.masked_array([1.0], mask=[True]), "has a mask"),
    (np.zeros((1,) * 9), "more than 8 axes"),
], ids=str)
def test_what_has_no_type_or_another_is_refused(tmp_path, value, why):
    with bitgrain.Recorder(tmp_path / "a") as recorder:
        with pytest.raises(bitgrain.InputError, match=f"array `x`.*{why}"):
            recorder.record(0, fine=1.0, x=value)
        assert recorder.last is None
        # Nothing of that step was recorded, and it can be recorded now.
        recorder.record(0, fine=1.0)
        assert recorder.last == 0
    assert record(tmp_path / "b", {0: {"fine": 1.0}}) == recorder.close()


@pytest.mark.parametrize("step", [-1, 2**64, 1.0, "1", None, 4])
def test_steps_that_are_refused(tmp_path, step):
    with bitgrain.Recorder(tmp_path / "a") as recorder:
        recorder.record(4, x=1.0)
        with pytest.raises(bitgrain.InputError, match="step"):
            recorder.record(step, x=1.0)
        recorder.record(np.uint64(2**64 - 1), step=1.0, self=2.0)
        assert recorder.last == 2**64 - 1


def test_recorders_that_are_refused(tmp_path):
    with bitgrain.Recorder(tmp_path / "a") as recorder:
        for arrays in ({}, {"a b": 1.0}, {"": 1.0}, {"x" * 65: 1.0}):
            with pytest.raises(bitgrain.InputError, match="array"):
                recorder.record(0, **arrays)
    with pytest.raises(bitgrain.InputError, match="has a recording already: choose another folder"):
        bitgrain.Recorder(tmp_path / "a")
    with pytest.raises(bitgrain.InputError, match="`some` does not say which arrays to keep: .*every:100") as found:
        bitgrain.Recorder(tmp_path / "b", keep="some")
    assert found.value.place == "keep" and not (tmp_path / "b").exists()
    (tmp_path / "file").write_text("")
    with pytest.raises(bitgrain.WriteFailed, match="file"):
        bitgrain.Recorder(tmp_path / "file" / "a")


def test_a_closed_recorder_is_closed(tmp_path):
    recorder = bitgrain.Recorder(tmp_path / "a")
    recorder.record(3, x=1.0)
    link = recorder.close()
    assert recorder.close() == link and recorder.last == 3 and len(link) == 64
    with pytest.raises(bitgrain.InputError, match="is closed"):
        recorder.record(4, x=1.0)
    assert (tmp_path / "a/recording.csv").read_text().splitlines()[-2].endswith(link)


def test_a_block_that_fails_leaves_no_end(tmp_path):
    with pytest.raises(ZeroDivisionError):
        with bitgrain.Recorder(tmp_path / "a") as recorder:
            recorder.record(0, x=1.0)
            recorder.record(1, x=2.0)
            1 / 0
    with pytest.raises(bitgrain.InputError, match="is closed"):
        recorder.close()
    record(tmp_path / "b", {0: {"x": 1.0}, 1: {"x": 9.0}})
    with pytest.warns(UserWarning, match="its last step, 1, is not compared") as told:
        found = bitgrain.bisect(tmp_path / "a", tmp_path / "b")
    assert told[0].filename == __file__
    assert str(found) == "the same to step 0: the first was cut off after step 0, the second goes on with step 1"
    with pytest.warns(UserWarning):
        assert bitgrain.bisect(tmp_path / "a", tmp_path / "b", prefix=True) is None


def test_steps_of_one_side_are_a_difference(tmp_path):
    record(tmp_path / "a", {0: {"x": 1.0}, 1: {"x": 2.0}})
    record(tmp_path / "b", {0: {"x": 1.0}, 1: {"x": 2.0}, 2: {"x": 9.0}})
    found = bitgrain.bisect(tmp_path / "a", tmp_path / "b")
    assert (found.equal, found.step, found.arrays) == (1, 2, [])
    assert found.hint == "the first ends with step 1, the second goes on with step 2"
    assert bitgrain.bisect(tmp_path / "a", tmp_path / "b", prefix=True) is None
    record(tmp_path / "c", {5: {"x": 1.0}})
    found = bitgrain.bisect(tmp_path / "a", tmp_path / "c")
    assert str(found) == "different from the beginning: the first begins with step 0, the second begins with step 5"


def test_bisect_refuses_what_is_no_recording(tmp_path):
    record(tmp_path / "a", {0: {"x": 1.0}})
    (tmp_path / "empty").mkdir()
    with pytest.raises(bitgrain.InputError, match="is not the folder of a recording"):
        bitgrain.bisect(tmp_path / "a", tmp_path / "empty")
    with pytest.raises(bitgrain.InputError, match="without their programs"):
        bitgrain.bisect(tmp_path / "a", tmp_path / "a", program_b="bitgrain")
    path = tmp_path / "a/recording.csv"
    path.write_text(path.read_text().replace("\n0,x", "\n1,x"))
    with pytest.raises(bitgrain.InputError, match="recording.csv:3: does not follow from the line before"):
        bitgrain.bisect(path, tmp_path / "a")


def test_a_stale_view_is_refused_as_such(tmp_path, pair):
    with bitgrain.Recorder(tmp_path / "a") as recorder:
        old = pair.positions
        pair.step()
        with pytest.raises(bitgrain.StaleView):
            recorder.record(0, x=old)
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            recorder.record(0, x=pair.positions)
        pair.step()


def test_other_threads_run_while_it_is_hashed(tmp_path, monkeypatch):
    """No thread is made to give the interpreter's lock away, so another one moves only if it is given up."""
    before = sys.getswitchinterval()
    ticks, done = [0], threading.Event()

    def tick():
        while not done.is_set():
            ticks[0] += 1
            time.sleep(0)

    other = threading.Thread(target=tick)
    x = np.zeros(1 << 22)
    elements, moved = ("f64", x.shape, x.tobytes()), False
    with bitgrain.Recorder(tmp_path / "a") as recorder:
        sys.setswitchinterval(1000)
        try:
            other.start()
            # A machine with much to do may not come to the other thread while one array is hashed.
            for step in range(1000):
                seen = ticks[0]
                recorder._writer.record(step, [("x", *elements)])
                if moved := ticks[0] != seen:
                    break
        finally:
            done.set()
            sys.setswitchinterval(before)
    other.join()
    assert moved
