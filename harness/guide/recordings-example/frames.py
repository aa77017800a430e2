"""Frames of numpy arrays, as `bitgrain record` and `bitgrain bisect --commands` read them."""

import sys

import numpy


def write(step, arrays):
    """Writes the arrays of a step, a dictionary by name, to standard output."""
    out = sys.stdout.buffer
    out.write(b"step %d\n" % step)
    for name, array in arrays.items():
        array = numpy.asarray(array)
        kind = "bool" if array.dtype.kind == "b" else f"{array.dtype.kind}{8 * array.dtype.itemsize}"
        shape = "x".join(map(str, array.shape))
        out.write(f"array {name} {kind} {shape}\n".encode())
        out.write(array.astype(array.dtype.newbyteorder("<")).tobytes())
    out.write(b"done\n")
    out.flush()


def record(states):
    """Writes all states, which are dictionaries of arrays, one for each step from 0: for `bitgrain record`."""
    for step, arrays in enumerate(states):
        write(step, arrays)
    sys.stdout.buffer.write(b"end\n")


def answer(states):
    """Writes those states that are asked for: for `bitgrain bisect --commands`."""
    step, arrays = 0, next(states)
    for line in sys.stdin:
        wanted = int(line.removeprefix("goto "))
        while step < wanted and (following := next(states, None)) is not None:
            step, arrays = step + 1, following
        write(step, arrays)


def run(states):
    """Answers if the last word of the command line is `asked`, else writes all states."""
    (answer if sys.argv[-1] == "asked" else record)(iter(states))
