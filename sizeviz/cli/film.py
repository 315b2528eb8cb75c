"""``sizeviz film``: an adaptive process as a film, or what turning α does."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from sizeviz.cli.options import FileArgument, PipelineOptions
from sizeviz.cli.values import Whole

if TYPE_CHECKING:
    from sizeviz.monitor import Monitor
    from sizeviz.scene.film import Film


@Parameter(name="*")
@dataclass(frozen=True, kw_only=True)
class TurnOptions:
    """How α turns.

    Parameters
    ----------
    first, last
        The α that the film begins and ends with.
    takes
        How many α there are, evenly spaced in their logarithm.
    width
        Pixels across.
    dark
        Dark ground.
    """

    first: float = 1.0
    last: float = 6.0
    takes: Whole = 24
    width: Whole = 1280
    dark: Annotated[bool, Parameter(negative="")] = False


def film(
    source: Annotated[str, Parameter(help="A folder that adapt wrote; or a source or study to turn alpha on.")],
    /,
    *,
    output: FileArgument,
    options: PipelineOptions | None = None,
    turn: TurnOptions | None = None,
) -> None:
    """Film an adaptive process iteration by iteration, or both methods while alpha turns; .mp4 or .gif.

    Of a folder that adapt wrote, every mesh is shown. Of anything else, one pipeline is run for every alpha, with
    epsilon = 1/alpha, and the methods are shown side by side.
    """
    from sizeviz.cli.terminal import progress
    from sizeviz.errors import InputError
    from sizeviz.files import require_writable_file
    from sizeviz.monitor import SubMonitor
    from sizeviz.scene.film import require_film, save_film
    from sizeviz.scene.opengl import require_gl

    turn = turn or TurnOptions()
    if not 320 <= turn.width <= 4096:
        raise InputError(f"width is {turn.width}; give 320 to 4096 pixels")
    require_film(output)
    require_writable_file(output)
    require_gl()
    with progress() as monitor:
        planned = _planned(source, options or PipelineOptions(), turn, SubMonitor(monitor, 0.0, 0.8))
        save_film(planned, output, width=turn.width, monitor=SubMonitor(monitor, 0.8, 1.0))
    print(f"{output}: {len(planned.takes)} takes of {planned.title}")


def _planned(source: str, options: PipelineOptions, turn: TurnOptions, monitor: Monitor) -> Film:
    import numpy as np

    from sizeviz.cli.options import loaded, study_options
    from sizeviz.cli.session import prepared
    from sizeviz.errors import InputError
    from sizeviz.scene.film_plans import adaptive_film, alpha_film
    from sizeviz.sizing.options import LEAST
    from sizeviz.study import Study
    from sizeviz.study.storage import SUFFIX, read_study

    if os.path.isdir(source):  # of a name too long for any path it says no, where Path would raise
        return adaptive_film(source, dark=turn.dark)
    if not 1 <= turn.takes <= 1000:
        raise InputError(f"takes is {turn.takes}; give 1 to 1000")
    if not all(LEAST <= alpha <= 1.0 / LEAST for alpha in (turn.first, turn.last)):
        raise InputError(f"alpha turns from {turn.first} to {turn.last}; give {LEAST:g} to {1 / LEAST:g}")
    alphas = [float(alpha) for alpha in np.geomspace(turn.first, turn.last, turn.takes)]
    if Path(source).suffix.lower() == SUFFIX:
        study = read_study(source).study
    else:
        study = Study(loaded(source, options), study_options(options))
    return alpha_film(study, alphas, measure=options.measure, dark=turn.dark, monitor=prepared(monitor))
