"""``python -m bitgrain`` and the script ``bitgrain``: the command itself."""

import sys

from ._native import command
from .folder import program


def main() -> int:
    """Runs the command with the words that this process was called with; returns its exit status."""
    return command(["bitgrain", *sys.argv[1:]], program())


if __name__ == "__main__":
    sys.exit(main())
