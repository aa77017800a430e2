"""LAMMPS lets 240 grains fall on a floor, on as many MPI ranks as the command line says.

    python3 lammps_ranks.py 1 | bitgrain record out/ranks-1 --keep all
    python3 lammps_ranks.py 2 | bitgrain record out/ranks-2 --keep all
    bitgrain bisect out/ranks-1 out/ranks-2

It needs `lmp` with its package GRANULAR, and `mpirun` (Debian: lammps, openmpi-bin).
"""

import pathlib
import subprocess
import sys
import tempfile

import numpy

import frames

STEPS = 2000

INPUT = f"""
units lj
atom_style sphere
boundary p p f
processors * 1 1
newton off
comm_modify vel yes
read_data grains.data
pair_style gran/hertz/history 20000.0 NULL 500.0 NULL 0.5 1
pair_coeff * *
fix move all nve/sphere
fix weight all gravity 1.0 vector 0 0 -1
fix floor all wall/gran hertz/history 20000.0 NULL 500.0 NULL 0.5 1 zplane 0.0 NULL
timestep 0.0005
thermo {STEPS}
dump all all custom 1 grains.dump id x y z vx vy vz
dump_modify all sort id format float %.17g
run {STEPS}
"""


def data():
    """A data file: a lattice of grains that are moved a little at random, so that ids do not depend on the ranks."""
    noise = 0.1 * numpy.random.default_rng(1).random((240, 3))
    lines = ["grains", "", "240 atoms", "1 atom types", "0 8.32 xlo xhi", "0 6.24 ylo yhi", "0 12 zlo zhi", "", "Atoms", ""]
    for k in range(240):
        x, y, z = 1.04 * numpy.array([k % 8, k // 8 % 6, k // 48]) + 0.55 + noise[k]
        lines.append(f"{k + 1} 1 1.0 1.0 {x:.17g} {y:.17g} {z:.17g}")
    return "\n".join(lines) + "\n"


def states(folder):
    """The states in a dump; 17 digits are the same bits again."""
    with open(folder / "grains.dump") as dump:
        while dump.readline():
            dump.readline()  # the step
            dump.readline()
            count = int(dump.readline())
            for _ in range(5):
                dump.readline()
            rows = numpy.array([dump.readline().split() for _ in range(count)], dtype=numpy.float64)
            yield {"positions": rows[:, 1:4], "velocities": rows[:, 4:7]}


with tempfile.TemporaryDirectory() as name:
    folder = pathlib.Path(name)
    (folder / "grains.data").write_text(data())
    (folder / "grains.lmp").write_text(INPUT)
    command = ["mpirun", "--oversubscribe", "-n", sys.argv[1], "lmp", "-in", "grains.lmp"]
    # What LAMMPS prints must not get among the frames.
    subprocess.run(command, cwd=folder, check=True, stdin=subprocess.DEVNULL, stdout=sys.stderr)
    frames.record(states(folder))
