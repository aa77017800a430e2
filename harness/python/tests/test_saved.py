"""Worlds as bytes: the same bits go on from them, and what cannot be saved is refused."""

import re

import blake3
import numpy as np
import pytest
from conftest import ROOT, falling, tsuji

import bitgrain


def test_a_world_goes_on_from_its_bytes(bed):
    bed.sphere(radius=0.5, point=(3, 3, 20), velocity=(0, 0, -0.1), density=2.0)
    heavy = bed.group("free", gravity=(0, 0, -2))
    bed.add([[3, 3, 30]], radii=0.5, density=1.0, group=heavy)
    data = bed.save()
    again = bitgrain.World.load(data, threads=1)
    assert again.save() == data and isinstance(data, bytes)
    for name in ("positions", "velocities", "spins", "forces", "torques", "images", "radii", "masses", "ids", "groups"):
        ours, theirs = getattr(again, name), getattr(bed, name)
        assert (ours == theirs.copy()).all() and ours.shape == theirs.shape and ours.dtype == theirs.dtype
    for name in ("step_count", "time", "dt", "digest", "periodic", "kinetic_energy"):
        assert getattr(again, name) == getattr(bed, name)
    assert (again.gravity == bed.gravity).all() and np.array_equal(again.box, bed.box)
    assert [body.shape for body in again.obstacles] == ["plane", "sphere"]
    # And it can be stepped, edited and added to as the other.
    for w in (bed, again):
        w.step(300)
        assert list(w.add([[1, 1, 25]], radii=0.5, density=1.0, group="lid")) == [202]
        w.step(100)
    assert again.digest == bed.digest and again.groups[-1] == 3
    assert (again.obstacles[1].mean_force == bed.obstacles[1].mean_force).all()


def test_threads_and_instructions_change_no_bit():
    w = falling(side=11, layers=9, threads=2)
    w.step(50)
    data = w.save()
    others = [bitgrain.World.load(bytearray(data), threads=k, instructions="plain") for k in (1, 2)]
    for other in [w, *others]:
        other.step(50)
    assert others[0].digest == others[1].digest == w.digest
    for wrong in ({"threads": 0}, {"instructions": "mmx"}):
        with pytest.raises(bitgrain.InputError, match=next(iter(wrong))):
            bitgrain.World.load(data, **wrong)


def test_losses_are_saved():
    w = bitgrain.World(box=None, gravity=(0, 0, -1), dt=1e-3, law=tsuji(), lose=True, drain=((0, 0, -2), (0, 0, 1)))
    w.add([[0, 0, 0], [0, 0, 5]], radii=0.5, density=1.0)
    assert w.save() == bitgrain.World.load(w.save()).save()
    again = bitgrain.World.load(w.save())
    again.step(2500)
    assert [one.id for one in again.departures] == [1] and again.box is None


def test_saving_starts_a_world():
    w, other = falling(), falling()
    other.start()
    assert w.save() == other.save()


def test_a_drive_is_not_saved(bed):
    bed.obstacles[0].drive((0, 0, 0.001), over=10 * bed.dt)
    bed.step(3)
    with pytest.raises(bitgrain.InputError, match="obstacle 0 is driven for 7 steps more"):
        bed.save()
    bed.step(7)
    assert bitgrain.World.load(bed.save()).digest == bed.digest


def test_a_stopped_world_is_not_saved(pair):
    pair.step()
    with pair.edit() as edit:
        edit.set_velocities(2, [-300, 0, 0])
    with pytest.raises(bitgrain.OverlapTooDeep):
        pair.step(5)
    with pytest.raises(bitgrain.NotStarted):
        pair.save()


def test_changed_bytes_are_refused(pair):
    data = pair.save()
    for at in range(0, len(data), 7):
        changed = bytearray(data)
        changed[at] ^= 4
        with pytest.raises((bitgrain.BadSave, bitgrain.OtherVersion)):
            bitgrain.World.load(changed)
    for cut in (b"", data[:-1], b"not a world"):
        with pytest.raises(bitgrain.BadSave):
            bitgrain.World.load(cut)
    with pytest.raises(TypeError):
        bitgrain.World.load("text")


def test_a_world_of_c_gets_the_groups_that_it_lacks():
    """The bytes of a world with one group alone, as C makes them."""
    w = bitgrain.World(box=None, gravity=(0, 0, -1), dt=1e-3, law=tsuji())
    w.add([[0, 0, 0]], radii=0.5, density=1.0)
    data = with_groups(w.save(), 1)
    other = bitgrain.World.load(data)
    assert other.save() == data and list(other.gravity) == [0, 0, -1]
    assert other.group("free").number == 0 and other.group("carried").number == 1
    other.add([[0, 0, -3]], radii=0.5, density=1.0, group="frozen")
    assert list(other.groups) == [0, 2] and other.group("frozen").number == 2
    other.step(10)
    assert (other.velocities[1] == 0).all() and other.velocities[0, 2] < 0


def with_groups(data, kept):
    """The bytes with the first groups alone; the layout is that of `kernel/src/saved`, hashes and all."""
    layout = (ROOT / "kernel/src/saved/layout.rs").read_text()
    counts, head = (int(re.search(rf"const {name}: usize = (\d+);", layout)[1]) for name in ("COUNTS", "HEAD"))
    law, world = data[: 52 + 32], bytearray(data[52 + 32 :])
    begin, group = 4 * counts + 8 * head, 4 + 3 * 8
    (count,) = np.frombuffer(world, "<u4", 1, 4 * 9)
    assert count == 4
    world[4 * 9 : 4 * 10] = np.uint32(kept).astype("<u4").tobytes()
    del world[begin + kept * group : begin + count * group]
    world[-32:] = blake3.blake3(world[:-32]).digest()
    return law + bytes(world)


@pytest.mark.parametrize("more", [b"\0", b"\0" * 4, b"more"])
def test_bytes_behind_the_end_are_refused(bed, more):
    with pytest.raises(bitgrain.BadSave):
        bitgrain.World.load(bed.save() + more)
