"""`airlight` and `python -m airlight`: the command, quiet under Ctrl-C while it still loads."""

from __future__ import annotations

from .interrupts import leave_quietly


def main() -> None:
    """Run the command line and exit."""
    leave_quietly()
    from .app.cli import main as command_line

    command_line()


if __name__ == "__main__":
    main()
