"""MuJoCo drops 8 boxes into a heap, with its constraint Jacobian stored as a dense or as a sparse matrix.

    bitgrain bisect --commands "python3 mujoco_fall.py dense asked" "python3 mujoco_fall.py sparse asked"
    bitgrain bisect --commands "python3 mujoco_fall.py dense asked" "python3 mujoco_fall.py dense asked"

It needs the package mujoco.
"""

import sys

import mujoco
import numpy

import frames

STEPS = 2000

BOXES = "".join(
    f'<body pos="{0.05 * (k % 3)} {0.04 * (k % 2)} {0.3 + 0.25 * k}" euler="{7 * k} {11 * k} 0"><freejoint/>'
    '<geom type="box" size="0.1 0.1 0.1"/></body>'
    for k in range(8)
)
MODEL = f'<mujoco><worldbody><geom type="plane" size="2 2 0.1"/>{BOXES}</worldbody></mujoco>'


def states(jacobian):
    """The states of all steps."""
    model = mujoco.MjModel.from_xml_string(MODEL)
    sparse = jacobian == "sparse"
    model.opt.jacobian = mujoco.mjtJacobian.mjJAC_SPARSE if sparse else mujoco.mjtJacobian.mjJAC_DENSE
    data = mujoco.MjData(model)
    for _ in range(STEPS + 1):
        yield {"qpos": data.qpos.copy(), "qvel": data.qvel.copy(), "contacts": numpy.int64(data.ncon)}
        mujoco.mj_step(model, data)


frames.run(states(sys.argv[1]))
