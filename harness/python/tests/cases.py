"""Worlds from the case files of the laboratory."""

import json

import bitgrain


def world_of(path, **more):
    """The world of a case file, as `bitgrain replay` makes it; not yet started."""
    case = json.loads(path.read_text())
    law = dict(case["law"])
    kind = {"hertz_history": bitgrain.HertzHistory, "hertz_tsuji": bitgrain.HertzTsuji}[law.pop("kind")]
    bounds = case.get("box")
    w = bitgrain.World(
        box=bounds and (bounds["lo"], bounds["hi"]),
        periodic=tuple(bounds["periodic"]) if bounds else (False, False, False),
        gravity=case.get("gravity", (0, 0, 0)),
        dt=case["dt"],
        law=kind(**law),
        **more,
    )
    for body in case.get("obstacles", []):
        velocity = body.get("velocity")
        if body["shape"] == "plane":
            w.plane(normal=body["normal"], point=body["point"], velocity=velocity)
        elif body["shape"] == "sphere":
            w.sphere(0.5 * body["diameter"], body["center"], velocity, body.get("density"))
        else:
            w.cylinder(0.5 * body["diameter"], body["axis"], body["center"], velocity)
    weightless = w.group("free", gravity=(0, 0, 0))
    for g in sorted(case["grains"], key=lambda g: g["id"]):
        motion, velocity = g.get("motion", "free"), list(g.get("velocity", (0, 0, 0)))
        if isinstance(motion, dict):
            ((motion, along),) = motion.items()
            velocity[: len(along)] = along
        w.add(
            [g["position"]],
            0.5 * g["diameter"],
            g["density"],
            velocities=[velocity],
            spins=[g.get("spin", (0, 0, 0))],
            group=weightless if motion == "weightless" else motion,
            ids=[g["id"]],
        )
    return w
