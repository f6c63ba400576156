"""The command line: ``python -m sphorge``, and the script ``sphorge``."""

from __future__ import annotations

import signal
import sys

from . import _sphorge


def main() -> None:
    """Executes the command line of this process, and ends it with its exit code."""
    # The command line meets Ctrl-C itself: runs save their state.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    sys.exit(_sphorge.main(["sphorge", *sys.argv[1:]], [sys.executable, "-m", "sphorge"]))


if __name__ == "__main__":
    main()
