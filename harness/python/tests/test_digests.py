"""The bits of Python's worlds are those of the kernel, of the command and of every other way to step."""

import json
import os
import signal
import subprocess
import sys
import threading

import numpy as np
import pytest
from cases import world_of
from conftest import ROOT, falling

import bitgrain

#: What `cargo run -p bitgrain-sim --example from_arrays` prints after step 7001.
FROM_ARRAYS = "3021cbbbb741756f511a776547d3426ef69150026a531dc5e731568f01dbd7ea"

#: More grains than one thread steps alone, and few steps.
WIDE = dict(side=12, layers=8)


def golden(case):
    """Digests by step from `golden/digests/cases.snap`."""
    lines = (ROOT / "golden/digests/cases.snap").read_text().splitlines()
    rows = [line.split() for line in lines if line.startswith(f"{case} ")]
    return {int(step): digest for _, step, digest in rows}


def instructions():
    """The sets of instructions that this machine has."""
    try:
        falling(instructions="none")
    except bitgrain.InputError as error:
        return error.problem.split("has ")[1].split(", ")


@pytest.mark.parametrize("case", ["collapse.json", "lid.json", "rig.json", "materials.json", "rolling.json"])
def test_cases_have_their_golden_digests(case):
    w = world_of(ROOT / "golden/cases" / case)
    w.start()
    expected = golden(case)
    for step in (0, 1000, 2000, 3000):
        w.step(step - w.step_count)
        assert w.digest == expected[step], f"{case} at step {step}"


def test_a_bed_from_arrays_has_the_digest_of_rust():
    w = falling()
    w.step(7001)
    assert w.digest == FROM_ARRAYS


def test_the_command_prints_the_same_digests():
    case = ROOT / "golden/cases/collapse.json"
    words = ["replay", str(case), "--steps", "500", "--every", "250", "--digests"]
    out = subprocess.run([sys.executable, "-m", "bitgrain", *words], capture_output=True, text=True, check=True)
    samples = [json.loads(line) for line in out.stdout.splitlines()]
    w = world_of(case)
    w.start()
    assert len(samples) == 3
    for sample in samples:
        w.step(sample["step"] - w.step_count)
        assert w.digest == sample["digest"]
        assert list(w.digests.values()) == sample["parts"]


def test_calls_may_be_cut_anywhere():
    whole, cut = falling(), falling()
    whole.step(60)
    for n in (1, 2, 0, 7, 50):
        cut.step(n)
    assert whole.digest == cut.digest and cut.step_count == 60


@pytest.mark.parametrize("threads", [1, 2, 3, 8])
@pytest.mark.parametrize("isa", instructions())
def test_threads_and_instructions_change_no_bit(threads, isa):
    one = falling(**WIDE, threads=1, instructions="plain")
    other = falling(**WIDE, threads=threads, instructions=isa)
    one.step(100)
    other.step(100)
    assert one.digests == other.digests


def test_ctrl_c_stops_between_two_steps():
    stopped, whole = falling(), falling()
    timer = threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        stopped.step(10**9)
    timer.join()
    assert 0 < stopped.step_count < 10**9
    stopped.step(10)
    whole.step(stopped.step_count)
    assert stopped.digest == whole.digest


def test_a_force_of_zero_is_no_force():
    none, zero = falling(), falling()
    none.step(50)
    zero.step(50, force=np.zeros((200, 3)), torque=np.zeros((200, 3)))
    assert none.digest == zero.digest


def test_a_bit_of_the_state_is_seen():
    one, other = falling(), falling()
    one.start()
    other.start()
    with other.edit() as edit:
        edit.set_velocities(7, [0.1, np.nextafter(0, 1), 0])
    assert one.digest != other.digest
    parts = {name for name in one.digests if one.digests[name] != other.digests[name]}
    assert parts == {"velocities"}


#: What a process of its own does with a world whose threads were started before it was forked.
FORKED = """
import os, sys, time
sys.path.insert(0, sys.argv[1])
from conftest import falling
w = falling(side=12, layers=8, threads=2)
w.step(2)
process = os.fork()
w.step(2)
if process == 0:
    print(w.digest, flush=True)
    os._exit(0)
end = time.monotonic() + 30
while os.waitpid(process, os.WNOHANG)[0] == 0:
    if time.monotonic() > end:
        os.kill(process, 9)
        sys.exit("the forked process hangs")
    time.sleep(0.05)
print(w.digest)
"""


@pytest.mark.skipif(not hasattr(os, "fork"), reason="there is no fork")
def test_threads_are_started_anew_in_a_forked_process():
    words = [sys.executable, "-c", FORKED, str(ROOT / "harness/python/tests")]
    ran = subprocess.run(words, capture_output=True, text=True)
    assert ran.returncode == 0, ran.stderr
    forked, own = ran.stdout.split()
    assert forked == own


def test_no_variable_makes_the_stack_of_a_thread_too_short():
    code = FORKED.split("process =")[0] + "print(w.digest)"
    small = {**os.environ, "RUST_MIN_STACK": "1"}
    words = [sys.executable, "-c", code, str(ROOT / "harness/python/tests")]
    ran = subprocess.run(words, capture_output=True, text=True, env=small)
    assert ran.returncode == 0 and len(ran.stdout) == 65, (ran.returncode, ran.stderr)
