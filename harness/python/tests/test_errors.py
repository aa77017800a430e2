"""Every error of the kernel and of the laboratory has its class, and says what, where and what to do."""

import re

import numpy as np
import pytest
from conftest import ROOT, falling, tsuji

import bitgrain
from bitgrain import errors


def kernel_errors():
    """Names, codes and fields of the kernel's errors, from its source."""
    text = (ROOT / "kernel/src/error.rs").read_text()
    codes = re.findall(r"Self::(\w+)(?: \{ \.\. \})? => (\d+),", text)
    body = text.split("pub enum Error {")[1].split("\n}\n")[0]
    variants = re.findall(r"^    (\w+)(?: \{\n(.*?)\n    \})?,$", body, re.S | re.M)
    fields = {name: re.findall(r"^        (\w+):", inner, re.M) for name, inner in variants}
    assert len(codes) == len(fields) > 25
    return [(name, int(code), fields[name]) for name, code in codes]


@pytest.mark.parametrize("name, code, fields", kernel_errors())
def test_every_error_of_the_kernel_has_a_class(name, code, fields):
    kind = getattr(bitgrain, name)
    assert issubclass(kind, bitgrain.KernelError) and kind.__doc__
    assert list(kind.__annotations__ if "__annotations__" in vars(kind) else ()) == fields


def test_every_error_of_the_laboratory_has_a_class():
    text = (ROOT / "harness/python/src/errors.rs").read_text()
    named = re.findall(r'"([A-Z]\w+)"', text.split("pub fn laboratory")[1])
    variants = (ROOT / "harness/sim/src/error.rs").read_text().split("pub enum Error {")[1].split("\n}\n")[0]
    assert len(named) == len(re.findall(r"^    [A-Z]\w+[ ,({]", variants, re.M)) > 10
    for name in named:
        assert issubclass(getattr(bitgrain, name), bitgrain.LaboratoryError)


def test_all_are_errors_of_this_package():
    for name in errors.__all__:
        assert issubclass(getattr(bitgrain, name), bitgrain.Error) and name in bitgrain.__all__
    assert issubclass(bitgrain.InputError, ValueError)
    assert issubclass(bitgrain.Interrupted, KeyboardInterrupt)


def world(**more):
    settings = dict(box=(8, 8, 8), gravity=(0, 0, -1), dt=1e-3, law=tsuji())
    return bitgrain.World(**{**settings, **more})


def raised(kind, act, **attributes):
    with pytest.raises(kind) as found:
        act()
    assert isinstance(found.value, bitgrain.Error)
    for name, value in attributes.items():
        assert getattr(found.value, name) == value
    return found.value


def test_errors_that_a_world_meets():
    raised(bitgrain.BadDomain, lambda: world(box=((0, 0, 0), (1, -1, 1))), axis=1, code=1)
    w = world(box=(1.5, 8, 8), periodic=(True, True, False))
    w.add([[0.5, 1, 1]], 0.5, 1.0)
    raised(bitgrain.PeriodTooShort, w.step, axis=0, code=2)
    raised(bitgrain.BadObstacle, lambda: world().sphere(radius=5, point=(4, 4, 4)), obstacle=0, code=6)
    raised(bitgrain.BadObstacle, lambda: world().sphere(radius=-1, point=(4, 4, 4)), obstacle=0, code=6)
    w = world()
    w.add([[4, 4, 4], [4, 4, 4.5]], 0.5, 1.0)
    raised(bitgrain.OverlapTooDeep, w.step, i=1, j=2, code=37)
    w = world()
    w.plane(normal=(0, 0, 1))
    w.add([[4, 4, 0.1]], 0.5, 1.0)
    raised(bitgrain.ObstacleTooDeep, w.step, id=1, obstacle=0, code=38)
    w = world()
    w.add([[4, 4, 4]], 0.5, 1.0, velocities=[[1e4, 0, 0]])
    raised(bitgrain.TooFast, w.step, id=1, code=35)
    w = world()
    w.add([[4, 4, 4]], 0.5, 1.0, velocities=[[1e200, 0, 0]])
    raised(bitgrain.NotFinite, w.step, id=1, code=32)
    w = world()
    w.add([[4, 4, 4]], 0.5, 1.0)
    ball = w.sphere(radius=0.1, point=(1, 1, 1))
    ball.velocity = (1e4, 0, 0)
    raised(bitgrain.ObstacleTooFast, w.step, obstacle=0, code=34)
    # The velocity of an obstacle may be mended, and the world goes on.
    ball.velocity = (0, 0, 0)
    w.step()
    w = world(gravity=(0, 0, -1e-30))
    w.add([[4, 4, 4]], 0.5, 1.0)
    raised(bitgrain.GravityTooWeak, w.step, group=0, code=11)
    w = world()
    w.add([[4, 4, 4]], 0.5, 1.0, velocities=[[1e-15, 0, 0]], group="carried")
    raised(bitgrain.TooSlow, w.step, id=1, code=9)
    w = world()
    w.add([[4, 4, 4]], 0.5, 1.0)
    w.sphere(radius=0.1, point=(1, 1, 1), velocity=(1e-15, 0, 0))
    raised(bitgrain.ObstacleTooSlow, w.step, obstacle=0, code=10)


@pytest.mark.parametrize("at_once", [1, 10_000])
def test_a_world_that_was_stopped_has_no_state(at_once):
    w = world()
    ball = w.sphere(radius=0.5, point=(1, 1, 1))
    ids = w.add([[4, 4, 0.1]], 0.5, 1.0)
    data = w.save()
    positions = w.positions

    def steps():
        for _ in range(10_000 // at_once):
            w.step(at_once)

    escaped = raised(bitgrain.Escaped, steps, id=1, code=36)
    assert "grain 1 left the box" in str(escaped)
    before = bitgrain.World.load(data)
    before.step(w.step_count)
    assert before.positions[0, 2] < 0.01
    raised(bitgrain.Escaped, before.step, id=1, code=36)

    def edit():
        with w.edit() as e:
            e.remove(ids)

    def place():
        ball.point = (2, 2, 2)

    for act in [
        w.step,
        w.save,
        edit,
        place,
        lambda: w.digest,
        lambda: w.digests,
        lambda: w.positions,
        lambda: w.forces,
        lambda: w.kinetic_energy,
        lambda: ball.point,
        lambda: ball.force,
        lambda: w.select([ball]).forces,
        lambda: w.add([[4, 4, 4]], 0.5, 1.0),
        lambda: w.plane(normal=(0, 0, 1)),
    ]:
        raised(bitgrain.NotStarted, act, code=50)
    with pytest.raises(bitgrain.StaleView):
        positions[0]
    # What no step changes is there, and so is the number of steps.
    assert (w.ids[0], w.radii[0], w.masses.shape, len(w), w.step_count) == (1, 0.5, (1,), 1, before.step_count)
    assert repr(ball) == "<bitgrain.Obstacle 0: sphere of a stopped world>"


@pytest.mark.parametrize(
    "act, place, problem",
    [
        (lambda: world(dt=0), "dt", "is 0; expected a positive number"),
        (lambda: world(dt=float("nan")), "dt", "is NaN"),
        (lambda: world(box=(1, 2)), "box", "expected three lengths or two corners"),
        (lambda: world(box=None, periodic=(True, False, False)), "periodic", "there is no box"),
        (lambda: world(threads=0), "threads", "expected 1 to 1024"),
        (lambda: world(instructions="sse9"), "instructions", "this machine has plain"),
        (lambda: world(law="hertz"), "law", "expected HertzHistory"),
        (lambda: world(gravity=(0, 0)), "gravity", r"shape \(2,\); expected \(3,\)"),
        (lambda: world().add([[1, 1, 1]], 0, 1), "radii", "holds 0 in row 0; expected positive"),
        (lambda: world().add([[1, 1, 1]], [0.5, 0.5], 1), "radii", r"shape \(2,\); expected \(1,\), or a number"),
        (lambda: world().add([[1, 1, 1]], 0.5, -1), "density", "holds -1"),
        (lambda: world().add([1, 1, 1], 0.5, 1), "positions", r"expected \(n, 3\)"),
        (lambda: world().add([[1, 1, 9]], 0.5, 1), "positions", "row 0 is at .* outside the box"),
        (lambda: world().add([[1, 1, np.inf]], 0.5, 1), "positions", "holds inf in row 0"),
        (lambda: world().add([[1, 1, 1]], 0.5, 1, velocities=[1, 2, 3]), "velocities", r"expected \(1, 3\)"),
        (lambda: world().add([[1, 1, 1]], 0.5, 1, ids=[1, 2]), "ids", "has 2 ids for 1 grains"),
        (lambda: world().add([[1, 1, 1], [3, 3, 3]], 0.5, 1, ids=[2, 2]), "ids", "holds 2 in row 1"),
        (lambda: world().add([[1, 1, 1]], 0.5, 1, ids=[1.5]), "ids", "whole numbers"),
        (lambda: world().plane(normal=(0, 0, 0)), "normal", "is zero"),
        (lambda: world().sphere(0.1, (1, 1, 1), density=0), "density", "is 0"),
        (lambda: world().group("heavy"), "group", "expected \"free\""),
        (lambda: bitgrain.HertzTsuji(1e6, 0.7, 0.6, 0.5), "poisson", "above -1 and at most 0.5"),
        (lambda: bitgrain.HertzTsuji(0, 0.3, 0.6, 0.5), "young", "expected a positive number"),
        (lambda: bitgrain.HertzHistory(1e6, -1, 0, 0, 0.5), "kt", "expected zero or more"),
        (lambda: bitgrain.run(), "scenario", "give a scenario"),
        (lambda: bitgrain.run("quikc"), "quikc", "did you mean `quick`"),
        (lambda: bitgrain.run("quick", set={"law.mu": {1}}), "set", "expected a number"),
        (lambda: bitgrain.run("quick", set={"law.nu": 1}), "quick", "nu"),
        (lambda: bitgrain.run("quick", threads=0), "threads", "1 to 1024"),
        (lambda: bitgrain.run("quick", save_every="often"), "save_every", "minutes|steps"),
        (lambda: bitgrain.verify("nowhere"), "nowhere", "missing"),
        (lambda: bitgrain.read("nowhere"), "nowhere", "manifest"),
        (lambda: bitgrain.read("nowhere", tables="excel"), "tables", "expected one of"),
        (lambda: bitgrain.verify("nowhere", segments=["a:b"]), "segments", "STAGE"),
    ],
)
def test_wrong_input_is_named(act, place, problem):
    with pytest.raises(bitgrain.InputError, match=problem) as found:
        act()
    assert place in found.value.place and found.value.code == 0 and found.value.exit_status == 2
    assert str(found.value) == f"{found.value.place}: {found.value.problem}"


def test_ids_of_refused_grains_are_free():
    w = world()
    with pytest.raises(bitgrain.InputError):
        w.add([[1, 1, 1], [1, 1, 9]], 0.5, 1)
    assert w.add([[1, 1, 1]], 0.5, 1).tolist() == [1] and len(w) == 1


def test_an_error_without_a_class_of_its_own_is_still_the_kernels():
    error = errors.made("OfALaterVersion", "something new", '{"code": 60}')
    assert type(error) is bitgrain.KernelError and error.code == 60


def test_views_of_another_time_are_refused_as_arguments():
    w = falling()
    velocities = w.velocities
    w.step()
    with pytest.raises(bitgrain.StaleView):
        w.step(force=velocities)
