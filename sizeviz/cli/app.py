"""The commands, and what becomes of errors: one line on standard error, exit code 2 for bad input, 1 for the rest."""

from __future__ import annotations

import os
import sys
from typing import TYPE_CHECKING

from cyclopts import App, CycloptsError, UnusedCliTokensError

from sizeviz import __version__
from sizeviz.errors import Cancelled, InputError, SizevizError

if TYPE_CHECKING:
    from collections.abc import Sequence

DEBUG_VARIABLE = "SIZEVIZ_DEBUG"
"""Set in the environment, it shows the traceback of an error that should not have happened."""

COMMANDS: dict[str, tuple[str, str]] = {
    "gui": ("sizeviz.cli.gui:gui", "Open the window; so does sizeviz alone."),
    "compare": ("sizeviz.cli.compare:compare", "Gradient limiting beside size preserving, like with like."),
    "run": ("sizeviz.cli.single:run", "One pipeline: process the field, mesh, smooth, judge."),
    "adapt": ("sizeviz.cli.adapt:adapt", "The adaptive process: each mesh is the background of the next."),
    "paper": ("sizeviz.cli.paper:paper", "Every figure and table of the paper, our numbers beside the published ones."),
    "field": ("sizeviz.cli.field:field", "Write the processed size field only."),
    "shot": ("sizeviz.cli.shot:shot", "A picture, vector figure or interactive page of a study or a mesh."),
    "film": ("sizeviz.cli.film:film", "An adaptive process as a film, or both methods while alpha turns."),
    "examples": ("sizeviz.cli.gallery:examples", "List the examples."),
    "doctor": ("sizeviz.cli.doctor:doctor", "Versions, OpenGL, fonts; what is missing, and the line that installs it."),
}
"""The commands in the order of the help: where each is, and what it does. They are imported when they run."""

app = App(
    name="sizeviz",
    help="See a mesh size field, limit it, preserve it, and mesh it with quadrilaterals that honour it.",
    version=__version__,
    help_format="plaintext",
    suppress_keyboard_interrupt=False,
)
for _order, (_name, (_where, _help)) in enumerate(COMMANDS.items()):
    app.command(_where, name=_name, help=_help, sort_key=_order)


@app.default
def _window() -> int:
    """Open the window."""
    from sizeviz.cli.gui import window

    return window()


def run_command_line(arguments: Sequence[str]) -> int:
    """Run one command.

    Parameters
    ----------
    arguments : sequence of str
        What follows the program's name.

    Returns
    -------
    int
        0 if all went well, 2 if the input or the command is at fault, 1 otherwise.
    """
    try:
        code = app(list(arguments), exit_on_error=False, print_error=False, result_action="return_value")
    except UnusedCliTokensError as problem:
        extra = " ".join(problem.unused_tokens or ())[:80]
        return complain(f"{extra!r} is no command or argument here (see sizeviz --help)", 2)
    except CycloptsError as problem:
        return complain(f"{_one_line(problem)} (see sizeviz --help)", 2)
    except InputError as problem:
        return complain(_one_line(problem), 2)
    except SizevizError as problem:
        return complain(_one_line(problem), 1)
    except (KeyboardInterrupt, Cancelled):
        return complain("stopped; nothing was left half-written", 1)
    except BrokenPipeError:  # the reader of a pipe has left: nothing to say, and nowhere to say it
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 1
    except Exception as problem:
        if os.environ.get(DEBUG_VARIABLE):
            raise
        what = f"{type(problem).__name__}: {_one_line(problem)}"
        return complain(f"something went wrong inside ({what}); set {DEBUG_VARIABLE}=1 to see where", 1)
    return code if isinstance(code, int) else 0


def complain(line: str, code: int) -> int:
    """Say one line on standard error, and return the exit code."""
    print(f"sizeviz: {line}", file=sys.stderr)
    return code


def _one_line(problem: BaseException) -> str:
    return " ".join(str(problem).split())
