"""The command line; each command imports what it needs when it runs, so that help is quick."""

from sizeviz.cli.app import run_command_line

__all__ = ["run_command_line"]
