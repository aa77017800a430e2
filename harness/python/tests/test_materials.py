"""Several materials: by name, refused by name, and saved."""

import pytest

import bitgrain

LAW = {
    "kind": "hertz_tsuji",
    "materials": {"glass": {"young": 4e5, "poisson": 0.25}, "steel": {"young": 4e6, "poisson": 0.3}},
    "pairs": [
        {"between": ["glass", "glass"], "restitution": 0.8, "mu": 0.3},
        {"between": ["glass", "steel"], "restitution": 0.6, "mu": 0.2},
    ],
}


def world(law=LAW):
    return bitgrain.World(box=None, gravity=(0, 0, -1), dt=2e-4, law=law)


def bounce(material, law=LAW):
    """The largest speed upwards of a ball of glass that falls on a floor."""
    w = world(law)
    w.plane(normal=(0, 0, 1), material=material)
    w.add([[0, 0, 1.0]], 0.5, 1.0, group=w.group("free", material="glass"))
    fastest = 0.0
    for _ in range(120):
        w.step(100)
        fastest = max(fastest, float(w.velocities[0, 2]))
    return fastest


def test_a_ball_bounces_as_its_pair_says():
    # It falls half a diameter, so it comes down at a speed of 1.
    assert abs(bounce("glass") - 0.8) < 0.02
    assert abs(bounce("steel") - 0.6) < 0.02


def test_names_are_needed_and_checked():
    w = world()
    for wrong in (dict(), dict(material="wood")):
        with pytest.raises(bitgrain.InputError, match="glass, steel"):
            w.plane(normal=(0, 0, 1), **wrong)
        with pytest.raises(bitgrain.InputError, match="glass, steel"):
            w.group("free", **wrong)
    with pytest.raises(bitgrain.InputError, match="material"):
        w.add([[0, 0, 1.0]], 0.5, 1.0)
    one = world(bitgrain.HertzTsuji(young=4e5, poisson=0.25, restitution=0.8, mu=0.3))
    with pytest.raises(bitgrain.InputError, match="one material"):
        one.plane(normal=(0, 0, 1), material="glass")


def test_a_wrong_law_is_refused_with_its_key():
    pairs = [{"between": ["glass", "glass"], "restitution": 2, "mu": 0.3}]
    with pytest.raises(bitgrain.InputError, match=r"law.pairs\[0\].restitution"):
        world({**LAW, "pairs": pairs})
    with pytest.raises(bitgrain.InputError, match="did you mean `materials`"):
        world({**{key: LAW[key] for key in ("kind", "pairs")}, "material": LAW["materials"]})


def test_a_saved_world_knows_its_materials_by_number():
    w = world()
    w.sphere(1.0, (0, 0, -1), material="steel")
    w.add([[0, 0.1, 0.6]], 0.5, 1.0, group=w.group("free", material="glass"))
    w.step(2000)
    again = bitgrain.World.load(w.save())
    for one in (w, again):
        one.step(2000)
    assert w.digest == again.digest
    # In the order of the alphabet: 0 is glass, 1 is steel.
    again.plane(normal=(0, 0, 1), point=(0, 0, -9), material="1")
    with pytest.raises(bitgrain.InputError, match="0, 1"):
        again.plane(normal=(0, 0, 1), point=(0, 0, -9), material="glass")
