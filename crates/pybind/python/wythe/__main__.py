"""The ``wythe`` command installed by the wheel."""

from __future__ import annotations

import sys

from wythe import command


def main() -> int:
    """Runs the command with the arguments of the process and returns its exit code."""
    return command(sys.argv[1:])


if __name__ == "__main__":
    sys.exit(main())
