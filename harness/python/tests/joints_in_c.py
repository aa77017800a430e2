"""The C library by its header, and a world in it with one option of each kind, as `joints.py` has them."""

import ctypes
import re
import subprocess
from functools import cache
from math import pi

from conftest import ROOT
from joints import (CHANGED, DRIVEN, DT, GRAVITY, INSERTED, KINDS, KUMAR, MATERIALS, PAIRS, PUSH, REMOVED, SPIN, TOP,
                    TORQUE, TSUJI, VELOCITY, Z, kind_of_shape, lattice, taken)  # fmt: skip

HEADER = (ROOT / "kernel/capi/include/bitgrain.h").read_text()
#: Its numbers by name.
BG = {name: int(number) for name, number in re.findall(r"#define BG_(\w+) (-?\d+)", HEADER)}
#: Names of its errors by number.
FAULTS = {BG[name]: name for name in list(BG)[list(BG).index("OK") : list(BG).index("BAD_LAW") + 1]}
TYPES = {"uint32_t": ctypes.c_uint32, "int32_t": ctypes.c_int32, "uint64_t": ctypes.c_uint64, "double": ctypes.c_double,
         "uint8_t": ctypes.c_uint8}  # fmt: skip


def structures():
    """Its structures by name, which it declares before they are used."""
    found = dict(TYPES)
    for body, name in re.findall(r"typedef struct \{(.*?)\} (bg_\w+);", HEADER, re.S):
        fields = re.findall(r"^\s*(\w+) (\w+)(?:\[(\d+)\])?;", body, re.M)
        rows = [(field, found[kind] * int(many) if many else found[kind]) for kind, field, many in fields]
        found[name] = type(name, (ctypes.Structure,), {"_fields_": rows})
    return found


BG_TYPES = structures()
POINTER = ctypes.POINTER(ctypes.c_double)
APPLY = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_uint32, POINTER, POINTER, POINTER, POINTER, POINTER)


def made(name, **fields):
    """A structure with its size and these fields."""
    kind = BG_TYPES[name]
    return kind(size=ctypes.sizeof(kind), **fields)


#: Of an obstacle that is there a program in C changes the motion alone, and adds none between steps.
NOT_IN_C = {"`point`", "`orientation`", "obstacle between steps"}


class CError(Exception):
    """What a function of the library returned, as `BG_` names it."""


@cache
def library():
    """The library, which is built where `.ci/run c` builds it."""
    target = ROOT / "target/capi"
    build = ["cargo", "build", "--release", "--locked", "--manifest-path", ROOT / "kernel/capi/Cargo.toml"]
    subprocess.run([*build, "--target-dir", target], check=True, capture_output=True)
    (built,) = [one for one in (target / "release").glob("*bitgrain_capi.*") if one.suffix in (".so", ".dylib", ".dll")]
    found = ctypes.CDLL(str(built))
    found.bg_size.restype = ctypes.c_size_t
    found.bg_strerror.restype = ctypes.c_char_p
    assert found.bg_abi_version() == BG["ABI_VERSION"]
    return found


def call(name, *arguments):
    code = getattr(library(), name)(*arguments)
    if code != BG["OK"]:
        raise CError(f"BG_{FAULTS[code]}")


def meaning(fault):
    """What `bg_strerror` says of a number that is named so."""
    return library().bg_strerror(BG[fault.removeprefix("BG_")]).decode()


def vector(numbers):
    return (ctypes.c_double * len(numbers))(*numbers)


def bits(flags):
    return sum(bool(flag) << place for place, flag in enumerate(flags))


def law_of(kind, rolling=None, between=("glass", "glass")):
    law = made("bg_law")
    if kind == "history":
        law = made("bg_law", kind=BG["HERTZ_HISTORY"], **KUMAR)
    if kind == "tsuji":
        numbers = [ctypes.c_double(TSUJI[key]) for key in ("young", "poisson", "restitution", "mu")]
        call("bg_law_hertz_tsuji", *numbers, ctypes.byref(law))
    if kind == "several":
        both = [vector(MATERIALS[name]) for name in between]
        numbers = [ctypes.c_double(number) for number in PAIRS[between]]
        call("bg_law_hertz_tsuji_between", *both, *numbers, ctypes.byref(law))
    if rolling:
        law.rolling = BG["ROLLING_" + rolling["kind"].upper()]
        law.rolling_mu = rolling["mu"]
        law.rolling_k, law.rolling_gamma = rolling.get("k", 0.0), rolling.get("gamma", 0.0)
    return law


class InC:
    """The same world in C, in a block that it owns."""

    def __init__(self, chosen):
        take = self.take = taken(chosen)
        self.shape, self.driven = kind_of_shape(chosen), 0
        self.several = take["law"]["kind"] == "several"
        self.block(more=0)
        places, velocities = lattice()
        first = 0 if take["leaving"] else 1
        self.next_id = 1
        self.insert(places[first:], 1.0, velocities[first:], self.group("free"))
        if take["grains"]:
            kind, velocity, gravity = take["grains"]
            group = self.group(kind, gravity=gravity)
            self.insert([(7.5, 2.5, TOP + 0.97)], 1.0, [velocity], group)
        call("bg_start", self.world)

    def block(self, more):
        """Makes a world of the law, groups and obstacles, without grains but with room for so many more."""
        take = self.take
        room = made("bg_capacity")
        call("bg_capacity_for_bed", 1110 + more, 2, ctypes.byref(room))
        room.groups, room.facets = 16, 4
        room.materials = 2 if self.several else 1 if "rolling" in take["law"] else 0
        config = made("bg_config", dt=DT, skin=0.1 + 1e-4 * more, outer_skin=0.3, law=law_of(**take["law"]))
        if take["box"]["box"]:
            config.hi, config.periodic = take["box"]["box"], bits(take["box"]["periodic"])
        size = library().bg_size(ctypes.byref(room))
        self.memory = (ctypes.c_uint64 * (size // 8 + 1))()
        self.world = ctypes.c_void_p()
        about = (ctypes.c_size_t(size), ctypes.byref(room), ctypes.byref(config))
        call("bg_init", self.memory, *about, ctypes.byref(self.world))
        if self.several:
            for a, one in enumerate(MATERIALS):
                for b, other in enumerate(MATERIALS):
                    rolling = take["law"].get("rolling") if (a, b) == (0, 0) else None
                    if (one, other) in PAIRS:
                        law = law_of("several", rolling, (one, other))
                        call("bg_set_pair_law", self.world, a, b, ctypes.byref(law))
        self.groups = []
        for material in range(1 + self.several):
            for kind in KINDS:
                self.group(kind, material)
        if take["leaving"]:
            policy = made("bg_policy", takes_out=take["leaving"].get("lose", False), drains="drain" in take["leaving"])
            if policy.drains:
                policy.point, policy.normal = take["leaving"]["drain"]
            call("bg_set_policy", self.world, ctypes.byref(policy))
        self.add(made("bg_obstacle", kind=BG["PLANE"], direction=Z, material=self.several))
        if not take["added"]:
            self.add_obstacle()

    def group(self, kind, material=0, gravity=None):
        """The number of a group of grains, which is added if there is none."""
        group = made("bg_group", material=material, infinite_mass=kind == "frozen", gravity=gravity or GRAVITY)
        group.integrates, group.spins = {"free": (7, 1), "lid": (4, 1)}.get(kind, (0, 0))
        if not group.integrates:
            group.gravity = (0.0, 0.0, 0.0)
        if bytes(group) not in self.groups:
            call("bg_add_group", self.world, ctypes.byref(group), ctypes.byref(ctypes.c_uint32()))
            self.groups.append(bytes(group))
        return self.groups.index(bytes(group))

    def insert(self, places, density, velocities, group):
        mass = density * (pi / 6.0 * (1.0 * 1.0 * 1.0))
        rows = [made("bg_grain", id=self.next_id + k, group=group, position=tuple(x), radius=0.5, mass=mass,
                     velocity=tuple(v)) for k, (x, v) in enumerate(zip(places, velocities))]  # fmt: skip
        self.next_id += len(rows)
        call("bg_insert", self.world, (BG_TYPES["bg_grain"] * len(rows))(*rows), ctypes.c_size_t(len(rows)))

    def add(self, obstacle, *triangles):
        number = ctypes.byref(ctypes.c_uint32())
        name = "bg_add_mesh" if triangles else "bg_add_obstacle"
        call(name, self.world, ctypes.byref(obstacle), *triangles, number)

    def add_obstacle(self):
        shape, motion = self.take["shape"], self.take["motion"]
        kind = {"cuboid": "BOX", "cylinder": "FINITE_CYLINDER" if "length" in shape else "CYLINDER"}
        kind = BG[kind.get(self.shape, self.shape.upper())]
        half = shape.get("half") or (shape.get("half_length", 0.5 * shape.get("length", 0.0)), 0.0, 0.0)
        direction = shape.get("axis") or shape.get("normal") or (0.0, 0.0, 0.0)
        body = made("bg_obstacle", kind=kind, point=shape["point"], direction=direction, half=half)
        body.radius = shape.get("radius", 0.0)
        if "mass" in shape:
            body.inverse_mass = 1.0 / shape["mass"]
        for key in ("velocity", "angular_velocity"):
            if key in motion:
                setattr(body, key, motion[key])
        if "free" in motion:
            along, body.spins = motion["free"]
            body.is_free, body.integrates = 1, bits(along)
            body.inertia, body.gravity = (2.0, 3.0, 4.0), GRAVITY
        triangles = [x for triangle in shape.get("triangles", []) for corner in triangle for x in corner]
        if triangles:
            self.add(body, vector(triangles), len(triangles) // 9)
        else:
            self.add(body)
        if "force" in motion:
            call("bg_push", self.world, 1, vector(motion["force"]), vector(motion["torque"]))
        if "drive" in motion:
            point = [x + way for x, way in zip(shape["point"], motion["drive"])]
            turn = motion.get("orientation", (1.0, 0.0, 0.0, 0.0))
            call("bg_drive_to", self.world, 1, vector(point), vector(turn), DRIVEN)
            self.driven = DRIVEN

    def step(self, count):
        push = self.take["push"]
        while count:
            steps = 1 if push == "function" else min(count, self.driven or count)
            apply = APPLY(self.pushed())
            call("bg_step_apply", self.world, ctypes.c_uint64(steps), apply if push else None, None, None)
            count -= steps
            if self.driven:
                self.driven -= steps
                if not self.driven:
                    for name in ("bg_drive", "bg_turn"):
                        call(name, self.world, 1, vector((0.0, 0.0, 0.0)))

    def pushed(self):
        """What pushes the grains in the next step."""
        push, rows = self.take["push"], {}
        if push == "function":
            velocities = self.read("VELOCITY", ctypes.c_double * 3)
            rows = {grain: [-PUSH * x for x in velocity] for grain, velocity in zip(self.ids(), velocities)}

        def apply(_user, grain, _position, _velocity, _spin, force, torque):
            if push == "force":
                force[0] = force[1] = force[2] = PUSH
            elif push == "torque":
                torque[0] = torque[1] = torque[2] = TORQUE
            else:
                force[0], force[1], force[2] = rows[grain]

        return apply

    def read(self, field, kind):
        counts = made("bg_counts")
        call("bg_get_counts", self.world, ctypes.byref(counts))
        rows = (kind * counts.grains)()
        zero, count = ctypes.c_size_t(0), ctypes.c_size_t(counts.grains)
        call("bg_read", self.world, BG[field], rows, zero, zero, count)
        return rows

    def ids(self):
        return list(self.read("ID", ctypes.c_uint32))

    def edit(self):
        verb, ids = self.take["edit"], self.ids()
        three = ctypes.c_double * 3
        if verb in ("velocities", "spins"):
            now = list(zip(ids, self.read("VELOCITY", three), self.read("SPIN", three)))[CHANGED]
            for grain, velocity, spin in now:
                new = (vector(VELOCITY), spin) if verb == "velocities" else (velocity, vector(SPIN))
                call("bg_nudge", self.world, grain, *new)
        if verb == "insert":
            self.insert(INSERTED, 2.0, [(0.0, 0.0, 0.0)] * len(INSERTED), self.group("free"))
        if verb in ("remove", "group"):
            ids = ids[REMOVED if verb == "remove" else CHANGED]
            rows = ((ctypes.c_uint32 * len(ids))(*ids), ctypes.c_size_t(len(ids)))
            if verb == "remove":
                call("bg_remove", self.world, *rows)
            else:
                call("bg_regroup", self.world, *rows, self.group("lid", int(self.several)))

    def save(self):
        size = ctypes.c_size_t()
        call("bg_save_size", self.world, ctypes.byref(size))
        out = (ctypes.c_uint8 * size.value)()
        call("bg_save", self.world, out, size)
        return bytes(out)

    def load(self):
        """Goes on from its bytes in a block of another size, with other skins."""
        data, driven = self.save(), self.driven
        self.block(more=500)
        self.driven = driven
        call("bg_load", self.world, data, ctypes.c_size_t(len(data)))

    def digest(self):
        digest = made("bg_digest")
        call("bg_get_digest", self.world, ctypes.byref(digest))
        return bytes(digest.whole).hex()
