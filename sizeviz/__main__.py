"""The command line's entry: ``sizeviz`` and ``python -m sizeviz``."""

from __future__ import annotations

import signal
import sys


def main() -> None:
    """Run the command line and leave with its exit code."""
    from sizeviz.cli import run_command_line

    # Ended by another program is like Ctrl-C: what is half-written goes.
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    sys.exit(run_command_line(sys.argv[1:]))


def gui_main() -> None:
    """Open the window with what was named on the command line: the entry that opens no terminal where that matters."""
    sys.argv.insert(1, "gui")
    main()


if __name__ == "__main__":
    main()
