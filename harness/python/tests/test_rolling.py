"""Resistance to rolling: what it does, how it is given, and that it is saved."""

import pytest

import bitgrain

GLASS = dict(young=1e5, poisson=0.3, restitution=0.5, mu=0.5)
EPSD2 = {"kind": "epsd2", "mu": 0.05}
SDS = {"kind": "sds", "k": 2e3, "gamma": 1.0, "mu": 0.05}


def rolling_ball(law):
    """A ball that rolls on a floor at a speed of 0.3."""
    w = bitgrain.World(box=None, gravity=(0, 0, -1), dt=1e-4, law=law)
    w.plane(normal=(0, 0, 1))
    w.add([[0, 0, 0.4997]], 0.5, 1.0, velocities=[[0.3, 0, 0]], spins=[[0, 0.6, 0]])
    return w


@pytest.mark.parametrize("rolling", [EPSD2, SDS])
def test_a_ball_comes_to_rest(rolling):
    slowed = rolling_ball(bitgrain.HertzTsuji(**GLASS, rolling=rolling))
    free = rolling_ball(bitgrain.HertzTsuji(**GLASS))
    for w in (slowed, free):
        w.step(100_000)
    # Slowed down by (5/7) mu g it stops after 8.4 units of time.
    assert abs(float(slowed.velocities[0, 0])) < 0.02
    assert float(free.velocities[0, 0]) > 0.29


@pytest.mark.parametrize("rolling", [EPSD2, SDS])
def test_a_saved_world_goes_on_with_the_same_bits(rolling):
    w = rolling_ball(bitgrain.HertzTsuji(**GLASS, rolling=rolling))
    w.step(3000)
    again = bitgrain.World.load(w.save())
    for one in (w, again):
        one.step(2000)
    assert w.digest == again.digest
    # An edit in between keeps what the law has kept of contacts.
    again.add([[5, 5, 5]], 0.5, 1.0)
    again.step(1)
    w.step(1)
    assert (w.positions[0] == again.positions[0]).all()
    assert (w.spins[0] == again.spins[0]).all()


def test_a_law_says_how_it_was_made():
    law = bitgrain.HertzTsuji(**GLASS, rolling=SDS)
    assert law.rolling == SDS
    assert eval(repr(law), vars(bitgrain)).rolling == SDS
    assert bitgrain.HertzTsuji(**GLASS).rolling is None
    history = bitgrain.HertzHistory(kn=1e5, kt=1e5, gamma_n=1, gamma_t=1, mu=0.5, rolling=EPSD2)
    assert eval(repr(history), vars(bitgrain)).rolling == EPSD2


@pytest.mark.parametrize(
    ("rolling", "message"),
    [
        ({"kind": "epsd2", "mu": -1}, "rolling.mu"),
        ({"kind": "sds", "mu": 0.1}, "missing field `k`"),
        ({"kind": "cdt", "mu": 0.1}, "unknown variant `cdt`"),
        ({"kind": "epsd2", "mu": 0.1, "nu": 3}, "unknown field `nu`"),
    ],
)
def test_a_wrong_resistance_is_refused_with_its_key(rolling, message):
    with pytest.raises(bitgrain.Error, match=message):
        bitgrain.HertzTsuji(**GLASS, rolling=rolling)
