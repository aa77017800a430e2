"""What of a world may be chosen, as data, and a world in Python with one option of each kind; that in C is in
`joints_in_c.py`."""

from math import pi

import numpy as np

import bitgrain

DT = 2e-3
GRAVITY = (0.0, 0.0, -1.0)
SDS, EPSD2 = {"kind": "sds", "k": 60.0, "gamma": 0.3, "mu": 0.1}, {"kind": "epsd2", "mu": 0.1}
TSUJI = {"young": 2e4, "poisson": 0.3, "restitution": 0.6, "mu": 0.5}
KUMAR = {"kn": 2e4, "kt": 2.4e4, "gamma_n": 2.0, "gamma_t": 2.0, "mu": 0.5}
#: Young's modulus and Poisson's ratio of two materials, and restitution and friction of their pairs.
MATERIALS = {"glass": (2e4, 0.3), "steel": (4e4, 0.3)}
PAIRS = {("glass", "glass"): (0.6, 0.5), ("glass", "steel"): (0.5, 0.2), ("steel", "steel"): (0.5, 0.2)}
TETRAHEDRON = [[[0, 0, 0], [0, 1.5, 0], [1.5, 0, 0]], [[0, 0, 0], [1.5, 0, 0], [0, 0, 1.5]],
               [[0, 0, 0], [0, 0, 1.5], [0, 1.5, 0]], [[1.5, 0, 0], [0, 1.5, 0], [0, 0, 1.5]]]  # fmt: skip
#: Centre of the highest grains, and the place above one of them where the surface of a body overlaps it a little.
TOP, ABOVE = 10.29, 10.29 + 0.47
X, Y, Z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
#: A turn of 5 degrees about z.
TURN = (2499 / 2501, 0.0, 0.0, 100 / 2501)
#: Density of the bodies that have a volume.
DENSITY = 2.0


def at(height):
    return (5.5, 5.5, ABOVE + height)


#: Options by kind. Of each one is taken, the first unless another is asked for.
OPTIONS = {
    "law": {
        "`HertzTsuji`": {"kind": "tsuji"},
        "`HertzHistory`": {"kind": "history"},
        "`HertzTsuji`, `rolling` sds": {"kind": "tsuji", "rolling": SDS},
        "`HertzHistory`, `rolling` epsd2": {"kind": "history", "rolling": EPSD2},
        "two materials": {"kind": "several"},
        "two materials, `rolling` epsd2": {"kind": "several", "rolling": EPSD2},
    },
    "box": {
        "closed box": {"box": (10.0, 10.0, 30.0), "periodic": (False, False, False)},
        "periodic along x and y": {"box": (10.0, 10.0, 30.0), "periodic": (True, True, False)},
        "open space": {"box": None},
    },
    "leaving": {
        "all grains stay": {},
        "`lose`": {"lose": True},
        "`drain`": {"drain": ((0, 0, 29.95), (0, 0, -1))},
    },
    "shape": {
        "`sphere`": {"radius": 1.0, "point": at(1.0), "mass": DENSITY * (pi / 6.0 * (2.0 * 2.0 * 2.0))},
        "`cylinder`, `length`": {"radius": 0.7, "axis": X, "length": 2.0, "point": at(0.7),
                                 "mass": DENSITY * ((pi * (0.7 * 0.7)) * 2.0)},
        "`cylinder`": {"radius": 0.7, "axis": Y, "point": at(0.7)},
        "`cylinder`, oblique": {"radius": 0.7, "axis": (1.0, 1.0, 0.0), "point": at(0.7)},
        "`capsule`": {"radius": 0.6, "axis": X, "half_length": 0.8, "point": at(0.6),
                      "mass": DENSITY * ((pi * (0.6 * 0.6)) * (1.6 + 4.0 / 3.0 * 0.6))},
        "`cuboid`": {"half": (0.9, 0.7, 0.5), "point": at(0.5), "mass": DENSITY * (((0.9 * 0.7) * 0.5) * 8.0)},
        "`drum`": {"radius": 6.84, "axis": Z, "length": 62.0, "point": (5.0, 5.0, 30.98)},
        "`mesh`": {"triangles": TETRAHEDRON, "point": (5.1, 5.1, ABOVE)},
        "`plane`": {"normal": Z, "point": (0.0, 0.0, 0.01)},
        "`plane`, upright": {"normal": X, "point": (0.02, 0.0, 0.0)},
    },
    "motion": {
        "at rest": {},
        "`velocity`": {"velocity": (0.05, 0.0, -0.1)},
        "`angular_velocity`": {"angular_velocity": (0.0, 0.0, 0.3)},
        "`set_free`": {"free": ((True, True, True), True)},
        "`set_free`, `along` z": {"free": ((False, False, True), False)},
        "`applied_force`, `applied_torque`": {"free": ((True, True, True), True), "force": (1.0, 0.0, -4.0),
                                              "torque": (0.1, 0.2, 0.3)},
        "`drive`": {"drive": (0.02, 0.0, -0.01)},
        "`drive`, `orientation`": {"drive": (0.02, 0.0, -0.01), "orientation": TURN},
        "`point`": {"put": (0.1, 0.0, -0.01)},
        "`orientation`": {"turned": TURN},
    },
    "added": {"obstacle at first": False, "obstacle between steps": True},
    "grains": {
        "free grains": None,
        "frozen grain": ("frozen", (0.0, 0.0, 0.0), None),
        "carried grain": ("carried", (0.1, 0.0, 0.0), None),
        "grain of a lid": ("lid", (0.1, 0.0, 0.0), None),
        "grain with a gravity of its own": ("free", (0.0, 0.0, 0.0), (0.5, 0.0, -2.0)),
    },
    "edit": {
        "no edit": None,
        "`set_velocities`": "velocities",
        "`set_spins`": "spins",
        "`insert`": "insert",
        "`remove`": "remove",
        "`set_group`": "group",
    },
    "push": {"no force": None, "`force`": "force", "`force`, a function": "function", "`torque`": "torque"},
    "save": {"`save`": False, "`save` in the midst of a motion": True},
}  # fmt: skip
#: Kinds of the groups that there are from the first.
KINDS = ("free", "frozen", "carried", "lid")
#: What is changed: the grains, their new velocity or spin, and where grains come in.
CHANGED, VELOCITY, SPIN = slice(0, 40), (0.1, 0.0, 0.5), (0.0, 0.0, 1.0)
REMOVED, INSERTED = slice(5, 60, 3), [[3.0, 3.0, 20.0], [5.0, 5.0, 20.0]]
PUSH, TORQUE = 0.1, 0.01
#: Steps that a drive takes: it goes on where `save` in the midst of a motion is asked for.
DRIVEN = 25


def lattice():
    """Places and velocities of 1,100 grains in contact, on a floor, and one above them that leaves if it may: as few as
    more than one thread steps."""
    k = np.arange(1100)
    jitter = 0.001 * np.column_stack([k * 7919 % 13, k * 104729 % 17, k * 0])
    places = np.column_stack([0.5 + k % 10, 0.5 + k // 10 % 10, 0.49 + 0.98 * (k // 100)]) + jitter
    velocities = np.column_stack([0.1 * (k // 100), 0.0 * k, -0.1 + 0.0 * k])
    return np.vstack([[5.0, 5.0, 29.9], places]), np.vstack([[0.0, 0.0, 10.0], velocities])


def taken(chosen):
    """An option of each kind."""
    return {kind: options[chosen.get(kind, next(iter(options)))] for kind, options in OPTIONS.items()}


def kind_of_shape(chosen):
    return chosen.get("shape", "`sphere`").split("`")[1]


def law_of(kind, rolling=None):
    more = {"rolling": rolling} if rolling else {}
    if kind == "tsuji":
        return bitgrain.HertzTsuji(**TSUJI, **more)
    if kind == "history":
        return bitgrain.HertzHistory(**KUMAR, **more)
    pairs = [{"between": list(pair), "restitution": e, "mu": mu} for pair, (e, mu) in PAIRS.items()]
    pairs[0].update(more)
    materials = {name: {"young": young, "poisson": nu} for name, (young, nu) in MATERIALS.items()}
    return {"kind": "hertz_tsuji", "materials": materials, "pairs": pairs}


class InPython:
    """A world in Python. It goes on, once it was saved, on so many threads."""

    def __init__(self, chosen, threads):
        take = self.take = taken(chosen)
        self.shape, self.threads = kind_of_shape(chosen), threads
        several = take["law"]["kind"] == "several"
        self.names = list(MATERIALS) if several else [None, None]
        self.world = w = bitgrain.World(gravity=GRAVITY, dt=DT, law=law_of(**take["law"]), threads=threads, strict=True,
                                        **take["box"], **take["leaving"])  # fmt: skip
        glass, steel = self.names
        for kind in KINDS:
            w.group(kind, material=steel)
        w.plane(Z, material=steel)
        if not take["added"]:
            self.add_obstacle()
        places, velocities = lattice()
        first = 0 if take["leaving"] else 1
        w.add(places[first:], 0.5, 1.0, velocities[first:], group=w.group("free", material=glass))
        if take["grains"]:
            kind, velocity, gravity = take["grains"]
            group = w.group(kind, gravity=gravity, material=glass)
            w.add([[7.5, 2.5, TOP + 0.97]], 0.5, 1.0, [velocity], group=group)

    def add_obstacle(self):
        w, motion = self.world, self.take["motion"]
        about = {key: value for key, value in self.take["shape"].items() if key != "mass"}
        if "mass" in self.take["shape"]:
            about["density"] = DENSITY
        body = getattr(w, self.shape)(**about, material=self.names[0])
        for key in ("velocity", "angular_velocity"):
            if key in motion:
                setattr(body, key, motion[key])
        if "free" in motion:
            along, turns = motion["free"]
            body.set_free(along, turns, inertia=(2.0, 3.0, 4.0))
        if "force" in motion:
            body.applied_force, body.applied_torque = motion["force"], motion["torque"]
        if "drive" in motion:
            body.drive(body.point + motion["drive"], DRIVEN * DT, motion.get("orientation"))
        if "put" in motion:
            body.point = body.point + motion["put"]
        if "turned" in motion:
            body.orientation = motion["turned"]

    def leaves(self):
        """Whether the grain with the id 1 is to leave; nothing is beyond open space."""
        leaving = self.take["leaving"]
        return "drain" in leaving or bool(leaving and self.take["box"]["box"])

    def step(self, count):
        """So many steps: in one call on one thread, in a call each on several."""
        for steps in [count] if self.threads == 1 else [1] * count:
            ones = np.ones((len(self.world), 3))
            pushes = {"force": {"force": PUSH * ones}, "torque": {"torque": TORQUE * ones},
                      "function": {"force": lambda w: -PUSH * w.velocities}}  # fmt: skip
            self.world.step(steps, **pushes.get(self.take["push"], {}))

    def edit(self):
        w, verb = self.world, self.take["edit"]
        glass, steel = self.names
        with w.edit() as edit:
            if verb == "velocities":
                edit.set_velocities(w.ids[CHANGED], VELOCITY)
            if verb == "spins":
                edit.set_spins(w.ids[CHANGED], SPIN)
            if verb == "insert":
                edit.insert(INSERTED, 0.5, 2.0, group=w.group("free", material=glass))
            if verb == "remove":
                edit.remove(w.ids[REMOVED])
            if verb == "group":
                edit.set_group(w.ids[CHANGED], w.group("lid", material=steel))

    def save(self):
        return self.world.save()

    def load(self):
        """Goes on from its bytes."""
        self.world = bitgrain.World.load(self.save(), threads=self.threads, instructions="plain")
        if self.names[0]:
            self.names = ["0", "1"]

    def digest(self):
        return self.world.digest
