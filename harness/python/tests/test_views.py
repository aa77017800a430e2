"""Views are read in place, never after the state has changed, and never while it changes."""

import gc
import threading

import numpy as np
import pytest
from conftest import falling

import bitgrain

NAMES = ["positions", "radii", "velocities", "masses", "spins", "forces", "torques", "images", "ids", "groups"]


@pytest.mark.parametrize("name", NAMES)
def test_shapes_and_types(bed, name):
    view = getattr(bed, name)
    array = view.copy()
    assert view.shape == array.shape and view.ndim == array.ndim and view.size == array.size
    assert view.dtype == array.dtype and len(view) == len(array) == 200
    assert np.array_equal(np.asarray(view), array)
    assert array.flags.writeable and array.base is None


def test_numbers_are_those_of_the_grains():
    w = falling()
    assert np.allclose(w.masses, np.pi / 6 * (2 * w.radii) ** 3, rtol=1e-15)
    assert list(w.ids[:3]) == [1, 2, 3]
    assert w.velocities[5].tolist() == [0.1, 0, 0]
    assert w.positions[0, 2] == 0.6


def test_numpy_takes_views(bed):
    p = bed.positions
    array = p.copy()
    assert np.array_equal(p * 2 + 1, array * 2 + 1)
    assert np.array_equal(2 - p, 2 - array)
    assert np.array_equal(p > 1, array > 1)
    assert np.array_equal(p[:, 2], array[:, 2]) and np.array_equal(p[bed.radii > 0.5], array[bed.radii.copy() > 0.5])
    assert p.mean(axis=0).tolist() == array.mean(axis=0).tolist()
    assert p.sum() == array.sum() and p.min() == array.min() and p.max() == array.max()
    assert np.linalg.norm(p, axis=1).tolist() == np.linalg.norm(array, axis=1).tolist()
    assert np.concatenate([p, p]).shape == (400, 3)
    assert np.add.reduce(p, axis=0).tolist() == np.add.reduce(array, axis=0).tolist()
    assert (p.T @ p).shape == (3, 3)
    assert [row.tolist() for row in p][:2] == array[:2].tolist()


@pytest.mark.parametrize(
    "shared",
    [
        np.transpose,
        np.ravel,
        lambda p: np.reshape(p, (3, -1)),
        lambda p: np.split(p, 2)[0],
        lambda p: np.broadcast_arrays(p, p)[1],
        lambda p: np.einsum("ij->ji", p),
        lambda p: p[:10],
        lambda p: p.T,
        np.asarray,
    ],
)
def test_no_array_shares_the_memory(bed, shared):
    found = shared(bed.positions)
    before = found.copy()
    bed.step(10)
    assert np.array_equal(found, before)


@pytest.mark.parametrize(
    "use",
    [
        lambda p: p + 1,
        lambda p: p[0],
        lambda p: len(p),
        lambda p: p.shape,
        lambda p: p.copy(),
        lambda p: np.asarray(p),
        lambda p: np.mean(p),
        lambda p: repr(p),
        lambda p: list(p),
    ],
)
@pytest.mark.parametrize("change", ["step", "edit", "add", "point"])
def test_a_view_of_an_earlier_state_is_refused(bed, use, change):
    p = bed.positions
    use(p)
    if change == "step":
        bed.step()
    elif change == "edit":
        with bed.edit() as edit:
            edit.set_spins([1], [0, 0, 1])
    elif change == "add":
        bed.add([[3, 3, 30]], 0.5, 1.0)
    else:
        bed.obstacles[0].point = (0, 0, -0.1)
    with pytest.raises(bitgrain.StaleView, match="stepped or edited"):
        use(p)
    use(bed.positions)


def test_nothing_is_written_through_a_view(bed):
    p = bed.positions
    with pytest.raises(TypeError):
        p[0] = 1
    with pytest.raises(ValueError, match="read-only"):
        np.add(p, 1, out=p)
    with pytest.raises(ValueError, match="read-only"):
        np.add.at(p, 0, 1)
    with pytest.raises(ValueError):
        np.asarray(p, copy=False) if np.lib.NumpyVersion(np.__version__) >= "2.0.0" else p.__array__(copy=False)
    lent = p._window.lend()
    with pytest.raises(ValueError):
        lent.setflags(write=True)


def test_a_lent_array_keeps_the_world_from_changing(bed):
    lent = bed.positions._window.lend()
    part = lent[3:5]
    del lent
    for change in (
        lambda: bed.step(),
        lambda: bed.add([[3, 3, 30]], 0.5, 1.0),
        lambda: setattr(bed.obstacles[0], "velocity", (0, 0, 1)),
    ):
        with pytest.raises(bitgrain.Busy):
            change()
    assert bed.step_count == 2000
    del part
    bed.step()


def test_an_error_within_numpy_leaves_the_world_free(bed):
    with pytest.raises(ValueError):
        np.concatenate([bed.positions, bed.radii])
    with pytest.raises(ValueError) as kept:
        np.linalg.norm(bed.positions, ord=7, axis=(0, 1))
    assert kept.value.__traceback__ is not None
    bed.step()


def test_a_step_within_an_operation_is_refused(bed):
    def step(x):
        bed.step()
        return x

    with pytest.raises(bitgrain.Busy):
        np.frompyfunc(step, 1, 1)(bed.positions)
    gc.collect()
    bed.step()


def test_other_threads_wait_for_nothing():
    """While one thread steps, another one is told so at once, and sees whole states only."""
    w = falling(side=12)
    w.start()
    begun, told = threading.Event(), []

    def step():
        begun.set()
        w.step(400)

    thread = threading.Thread(target=step)
    thread.start()
    begun.wait()
    while thread.is_alive():
        for look in (lambda: w.positions.sum(), lambda: w.step(), lambda: w.digest):
            try:
                look()
            except bitgrain.Busy:
                told.append(look)
            except bitgrain.StaleView:
                pass
    thread.join()
    assert told


def test_a_view_outlives_its_world():
    p = falling().positions
    gc.collect()
    assert p.copy().shape == (200, 3)
