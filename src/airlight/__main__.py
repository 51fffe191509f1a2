"""`airlight` and `python -m airlight`: the command, quiet under Ctrl-C while it still loads."""

from __future__ import annotations

import os

from .interrupts import leave_quietly


def main() -> None:
    """Run the command line and exit."""
    # Before the imports below, which take a while.
    leave_quietly()
    # Matrices here are small, and threads of BLAS spin on cores that a CPU adapter draws with.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    from .app.cli import main as command_line

    command_line()


if __name__ == "__main__":
    main()
