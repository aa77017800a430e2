"""Edits between steps: all of a block or nothing."""

import numpy as np
import pytest
from conftest import falling

import bitgrain


def test_velocities_and_spins(bed):
    with bed.edit() as edit:
        edit.set_velocities([3, 5], [[1, 0, 0], [0, 1, 0]])
        edit.set_spins([3, 5, 7], [0, 0, 2])
    assert bed.velocities[[2, 4]].tolist() == [[1, 0, 0], [0, 1, 0]]
    assert bed.spins[[2, 4, 6]].tolist() == [[0, 0, 2]] * 3
    bed.step(10)


def test_what_stays_keeps_its_contacts(bed):
    histories = bed.digests["histories"]
    with bed.edit() as edit:
        edit.set_velocities(1, [0, 0, 0.5])
        new = edit.insert([[3, 3, 30]], 0.5, 1.0)
        edit.set_group(new, "frozen")
    assert bed.digests["histories"] == histories
    assert new.tolist() == [201] and bed.ids[-1] == 201 and bed.groups[-1] == 1
    bed.step(10)
    assert bed.positions[-1].tolist() == [3, 3, 30]


def test_grains_that_never_touched_can_be_removed_without_a_trace():
    plain, edited = falling(), falling()
    plain.step(40)
    edited.step(20)
    with edited.edit() as edit:
        new = edit.insert([[3, 3, 30], [3, 3, 32]], 0.5, 1.0)
    edited.step(15)
    with edited.edit() as edit:
        edit.remove(new)
    edited.step(5)
    assert edited.digest == plain.digest
    # Their ids are not given again.
    assert edited.add([[3, 3, 30]], 0.5, 1.0).tolist() == [203]


def test_removing_grains_of_a_bed(bed):
    keep = bed.ids[bed.positions[:, 2] < 3]
    gone = np.setdiff1d(bed.ids, keep)
    assert 0 < len(gone) < 200
    places = bed.positions[np.isin(bed.ids, keep)]
    with bed.edit() as edit:
        edit.remove(gone)
    assert np.array_equal(bed.ids, keep) and np.array_equal(bed.positions, places)
    assert len(bed) == len(keep)
    bed.step(100)


def test_a_refused_edit_changes_nothing(bed):
    before, count = bed.digest, len(bed)
    view = bed.positions
    with pytest.raises(bitgrain.UnknownGrain, match="no grain with id 999"):
        with bed.edit() as edit:
            edit.set_velocities(1, [0, 0, 0.5])
            edit.remove(999)
    with pytest.raises(bitgrain.TooFast) as fast:
        with bed.edit() as edit:
            edit.remove(2)
            edit.set_velocities(7, [0, 0, 1e6])
    assert fast.value.id == 7
    with pytest.raises(bitgrain.OverlapTooDeep) as deep:
        with bed.edit() as edit:
            new = edit.insert([bed.positions[0]], 0.5, 1.0)
    assert (deep.value.i, deep.value.j) == (1, new[0]) and deep.value.code == 37
    with pytest.raises(bitgrain.ObstacleTooDeep):
        bed.add([[3, 3, 0.1]], 0.5, 1.0)
    with pytest.raises(bitgrain.ObstacleTooDeep):
        bed.obstacles[0].point = (0, 0, 0.5)
    assert bed.digest == before and len(bed) == count
    # Nothing was changed, so that a view of before is still of the present state.
    view.copy()
    bed.step()


def test_a_block_left_by_an_exception_changes_nothing(bed):
    before = bed.digest
    with pytest.raises(ZeroDivisionError):
        with bed.edit() as edit:
            edit.remove(1)
            1 / 0
    assert bed.digest == before


def test_an_edit_outside_its_block_is_refused(bed):
    edit = bed.edit()
    with pytest.raises(bitgrain.InputError, match="not open"):
        edit.remove(1)
    with edit:
        pass
    with pytest.raises(bitgrain.InputError, match="not open"):
        edit.remove(1)


def test_a_mask_is_no_list_of_ids():
    w = falling(side=2, layers=2)
    with pytest.raises(bitgrain.InputError, match="mask"):
        with w.edit() as edit:
            edit.remove(w.positions[:, 2] > 0)
    assert len(w) == 8


def test_an_edit_starts_a_world():
    w = falling()
    with w.edit() as edit:
        edit.remove(200)
    assert len(w) == 199 and w.step_count == 0


def test_groups():
    w = falling(side=2, layers=2)
    heavy = w.group("free", gravity=(0, 0, -2))
    with w.edit() as edit:
        edit.set_group([5, 6], heavy)
        edit.set_group([7], "frozen")
        edit.set_velocities([7], [0, 0, 0])
    start = w.positions.copy()
    w.step(100)
    drop = (w.positions - start)[:, 2]
    # Free fall, with a drift of full steps: g t^2 / 2 to rounding.
    assert drop[4] == pytest.approx(2 * drop[7], rel=1e-9)
    assert drop[6] == 0 and heavy.number == 4
    with pytest.raises(bitgrain.InputError, match="another world"):
        falling().add([[1, 1, 1]], 0.5, 1.0, group=heavy)
    with pytest.raises(bitgrain.InputError, match="expected \"free\""):
        w.add([[1, 1, 30]], 0.5, 1.0, group="heavy")


def test_what_is_refused_uses_no_ids():
    w, plain = falling(), falling()
    for one in (w, plain):
        one.step()
    inside = w.positions[:1].copy()
    with pytest.raises(bitgrain.KernelError):
        w.add(inside, 0.5, 1.0)
    with pytest.raises(bitgrain.KernelError):
        with w.edit() as edit:
            assert edit.insert([[3, 3, 30]], 0.5, 1.0).tolist() == [201]
            assert edit.insert(inside, 0.5, 1.0).tolist() == [202]
    with pytest.raises(ZeroDivisionError):
        with w.edit() as edit:
            edit.insert([[3, 3, 30]], 0.5, 1.0)
            1 / 0
    # Ids that others got meanwhile stay theirs.
    with pytest.raises(ZeroDivisionError):
        with w.edit() as edit:
            edit.insert([[3, 3, 30]], 0.5, 1.0)
            assert w.add([[1, 1, 30]], 0.5, 1.0).tolist() == [202]
            edit.insert([[3, 3, 32]], 0.5, 1.0)
            1 / 0
    assert w.add([[3, 3, 34]], 0.5, 1.0).tolist() == [203]
    plain.add([[1, 1, 30], [3, 3, 34]], 0.5, 1.0, ids=[202, 203])
    for one in (w, plain):
        one.step(10)
    assert w.digest == plain.digest
