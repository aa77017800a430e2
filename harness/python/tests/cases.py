"""Worlds from the case files of the laboratory."""

import json

import bitgrain


def world_of(path, **more):
    """The world of a case file, as `bitgrain replay` makes it; not yet started."""
    case = json.loads(path.read_text())
    law = dict(case["law"])
    if "pairs" not in law:
        kinds = {"hertz_history": bitgrain.HertzHistory, "hertz_tsuji": bitgrain.HertzTsuji}
        law = kinds[law.pop("kind")](**law)
    bounds = case.get("box")
    w = bitgrain.World(
        box=bounds and (bounds["lo"], bounds["hi"]),
        periodic=tuple(bounds["periodic"]) if bounds else (False, False, False),
        gravity=case.get("gravity", (0, 0, 0)),
        dt=case["dt"],
        law=law,
        **more,
    )
    for body in case.get("obstacles", []):
        velocity, material = body.get("velocity"), body.get("material")
        if body["shape"] == "plane":
            w.plane(normal=body["normal"], point=body["point"], velocity=velocity, material=material)
        elif body["shape"] == "sphere":
            w.sphere(0.5 * body["diameter"], body["center"], velocity, body.get("density"), material)
        else:
            w.cylinder(0.5 * body["diameter"], body["axis"], body["center"], velocity, material=material)
    for g in sorted(case["grains"], key=lambda g: g["id"]):
        motion, velocity = g.get("motion", "free"), list(g.get("velocity", (0, 0, 0)))
        if isinstance(motion, dict):
            ((motion, along),) = motion.items()
            velocity[: len(along)] = along
        none = (0, 0, 0) if motion == "weightless" else None
        kind = "free" if motion == "weightless" else motion
        w.add(
            [g["position"]],
            0.5 * g["diameter"],
            g["density"],
            velocities=[velocity],
            spins=[g.get("spin", (0, 0, 0))],
            group=w.group(kind, gravity=none, material=g.get("material")),
            ids=[g["id"]],
        )
    return w
