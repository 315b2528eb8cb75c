"""Films: panes that change from take to take, over a curve with a cursor; MP4 through ffmpeg, GIF without."""

from __future__ import annotations

import subprocess
import tempfile
from dataclasses import dataclass, replace
from importlib.util import find_spec
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from PIL import Image as Pillow

from sizeviz.errors import InputError, MissingDependencyError
from sizeviz.files import replacing
from sizeviz.monitor import SILENT, Monitor
from sizeviz.scene.camera import Camera2D
from sizeviz.scene.canvas import Canvas, text_width
from sizeviz.scene.compose import DARK, LIGHT, compose, scale_for, subject_bounds, values_of
from sizeviz.scene.stage import Stage

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence

    from numpy.typing import NDArray

    from sizeviz.scene.scale import ColorScale
    from sizeviz.scene.spec import SceneSpec
    from sizeviz.scene.subject import Subject
    from sizeviz.scene.view import Quantity, ViewState

FILM_SUFFIXES = (".mp4", ".gif")
"""File suffixes that mean films."""

FRAMES_A_SECOND = 12
"""Pictures a second in an MP4; a take is shown in several, because players stumble over slower films."""

EDGES_BELOW = 12_000
"""Element edges are drawn in takes with fewer elements than this."""


@dataclass(frozen=True, eq=False)
class Take:
    """What a film shows for a moment.

    Parameters
    ----------
    panes : callable
        Returns what the panes show, from left to right; called when it is needed, and once before, for the colours.
    place : float
        Where on the curve the cursor stands.
    caption : str
        Words over the panes.
    """

    panes: Callable[[], Sequence[Subject]]
    place: float
    caption: str


@dataclass(frozen=True, eq=False)
class Curve:
    """The plot under the panes.

    Parameters
    ----------
    x : sequence of float
        Where the takes stand.
    lines : mapping of str to (values, colour)
        What is plotted, by what the legend calls it.
    x_label, y_label : str
        Words at the axes.
    levels : sequence of float
        Heights at which a thin line runs across.
    log : bool
        Whether heights are logarithmic.
    """

    x: Sequence[float]
    lines: Mapping[str, tuple[Sequence[float], str]]
    x_label: str
    y_label: str
    levels: Sequence[float] = ()
    log: bool = False


@dataclass(frozen=True, eq=False)
class Film:
    """A film as it is planned.

    Parameters
    ----------
    title : str
        Heading of every picture.
    views : sequence of ViewState
        How the panes show their subjects, from left to right.
    takes : sequence of Take
        In order.
    curve : Curve
        Under the panes.
    seconds : float
        How long each take is shown.
    """

    title: str
    views: Sequence[ViewState]
    takes: Sequence[Take]
    curve: Curve
    seconds: float = 0.5


def save_film(film: Film, path: str | Path, *, width: int = 1280, monitor: Monitor = SILENT) -> Path:
    """Write a film; its colours mean the same from the first picture to the last.

    Parameters
    ----------
    film : Film
        What is shown.
    path : path-like
        Where to; .mp4 or .gif.
    width : int
        Pixels across, at least 320.
    monitor : Monitor
        Told of every take; may cancel.

    Raises
    ------
    InputError
        If there is nothing to show, the suffix means no film, or the place cannot be written.
    MissingDependencyError
        If MP4 is asked for without ffmpeg.
    """
    path = Path(path)
    require_film(path)
    if not film.takes:
        raise InputError("there is nothing to film; give at least one take")
    if width < 320:
        raise InputError(f"a film is {width} pixels wide; give at least 320")
    scales = _scales(film, monitor)
    pictures = _pictures(film, scales, width - width % 2, monitor)
    with replacing(path) as part:
        if path.suffix.lower() == ".gif":
            _write_gif(part, pictures, film.seconds, _palette(film, scales))
        else:
            _write_mp4(part, pictures, film.seconds)
    return path


def require_film(path: Path) -> None:
    """Raise unless a film can be written under this name.

    Raises
    ------
    InputError
        If the suffix means no film.
    MissingDependencyError
        If MP4 is asked for without ffmpeg.
    """
    suffix = path.suffix.lower()
    if suffix not in FILM_SUFFIXES:
        raise InputError(f"{path}: no film format for {path.suffix!r}; use {' or '.join(FILM_SUFFIXES)}")
    if suffix == ".mp4" and find_spec("imageio_ffmpeg") is None:
        raise MissingDependencyError("films as .mp4 need ffmpeg: pip install 'sizeviz[video]'; .gif needs nothing")


def _scales(film: Film, monitor: Monitor) -> list[ColorScale]:
    """Return a colour bar for each pane, over all takes and all panes of its quantity; values are not kept."""
    ends: dict[Quantity, list[NDArray[np.float64]]] = {view.color_by: [] for view in film.views}
    for take in film.takes:
        monitor.step(0.0, "choosing colours")
        for subject, view in zip(take.panes(), film.views, strict=True):
            values = values_of(subject, view)
            if values is not None and len(values):
                ends[view.color_by].append(np.array([np.nanmin(values), np.nanmax(values)]))
    scales = []
    for view in film.views:
        scale = scale_for(ends[view.color_by], view)
        if scale is None:
            raise InputError(f"there is nothing to colour by {view.color_by} in this film")
        scales.append(scale)
    return scales


def _pictures(film: Film, scales: Sequence[ColorScale], width: int, monitor: Monitor) -> Iterator[NDArray[np.uint8]]:
    sheet = _Sheet(film, width, subject_bounds(film.takes[0].panes()[0]))
    with Stage() as stage:
        for k, take in enumerate(film.takes):
            monitor.step(k / len(film.takes), f"filming {take.caption}")
            specs = [
                compose(subject, _with_edges(view, subject), scale=scale)
                for subject, view, scale in zip(take.panes(), film.views, scales, strict=True)
            ]
            yield sheet.drawn(stage, take, specs)


def _with_edges(view: ViewState, subject: Subject) -> ViewState:
    few = subject.mesh is not None and subject.mesh.n_quads < EDGES_BELOW
    return replace(view, edges=few)


@dataclass(eq=False)
class _Sheet:
    """Draws the pictures of one film."""

    film: Film
    width: int
    bounds: tuple[float, float, float, float]

    def drawn(self, stage: Stage, take: Take, specs: Sequence[SceneSpec]) -> NDArray[np.uint8]:
        """Return one picture, ``(height, width, 3)``; both are even."""
        x0, y0, x1, y1 = self.bounds
        size, margin = max(self.width // 72, 9), self.width // 50
        count = len(specs)
        pane = (self.width - (count + 1) * margin) // count
        tall = round(pane / min(max((x1 - x0) / (y1 - y0), 0.7), 3.0))
        top, strip = margin + round(size * 5.0), round(size * 9.5)
        height = top + tall + round(size * 6.6) + strip
        canvas = Canvas(self.width, height + height % 2, specs[0].ground, specs[0].ink)
        large = round(size * 1.35)
        room = self.width - 3 * margin - text_width(take.caption, large, bold=True)
        canvas.text(margin, margin, _shortened(self.film.title, room, large), large, bold=True)
        canvas.text(self.width - margin, margin, take.caption, large, bold=True, anchor="ra")
        camera = Camera2D.fitted(specs[0].bounds, pane / tall, 1.01)
        for k, spec in enumerate(specs):
            left = margin + k * (pane + margin)
            canvas.picture(stage.shoot(spec, camera, pane, tall), (left, top, left + pane, top + tall), frame=False)
            canvas.text(left, top - size * 0.7, spec.title, size, bold=True, anchor="ls")
            after = left + text_width(spec.title, size, bold=True) + size
            canvas.text(after, top - size * 0.7, spec.detail, size, anchor="ls", color=canvas.faint)
            canvas.text(left, top + tall + size * 1.2, spec.verdict, size, anchor="lm")
            assert spec.scale is not None
            at = top + tall + round(size * 3.6)
            canvas.bar(spec.scale, (left, at, left + round(pane * 0.7), at + round(size * 0.7)), round(size * 0.9))
        below = canvas.image.height - strip
        plot = _plotted(self.film.curve, take.place, self.width, strip, self.film.views[0].dark)
        canvas.picture(plot, (0, below, self.width, canvas.image.height), frame=False)
        return np.asarray(canvas.image, dtype=np.uint8)


def _shortened(words: str, room: float, size: int) -> str:
    """Return words cut to a width in pixels."""
    while len(words) > 2 and text_width(words, size, bold=True) > room:
        words = words[:-2].rstrip() + "…"
    return words


def _plotted(curve: Curve, place: float, width: int, height: int, dark: bool) -> NDArray[np.uint8]:
    """Return the curve with its cursor as pixels."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    ground, ink = (tuple(c / 255.0 for c in color) for color in (DARK if dark else LIGHT))
    dots = max(width / 9.0, 40.0)
    figure = Figure(figsize=(width / dots, height / dots), dpi=dots, facecolor=ground, layout="constrained")
    canvas = FigureCanvasAgg(figure)
    axes: Any = figure.add_subplot(facecolor=ground)
    for level in curve.levels:
        axes.axhline(level, color=ink, alpha=0.4, lw=0.8)
    for label, (values, color) in curve.lines.items():
        axes.plot(curve.x, values, "-", marker="o", ms=3, lw=1.4, color=color, label=label)
        axes.plot([place], [np.interp(place, curve.x, values)], "o", ms=8, color=color)
    axes.axvline(place, color=ink, lw=1.0)
    if curve.log:
        axes.set_yscale("log")
    axes.set_xlabel(curve.x_label, fontsize=9, color=ink)
    axes.set_ylabel(curve.y_label, fontsize=9, color=ink)
    axes.tick_params(labelsize=8, colors=ink)
    for side in axes.spines.values():
        side.set(color=ink, alpha=0.5, linewidth=0.6)
    if len(curve.lines) > 1:
        axes.legend(fontsize=8, frameon=False, labelcolor=ink)
    canvas.draw()
    pixels = np.asarray(canvas.buffer_rgba(), dtype=np.uint8)[..., :3]
    return np.ascontiguousarray(pixels)


def _palette(film: Film, scales: Sequence[ColorScale]) -> Pillow.Image:
    """Return 256 colours that serve a whole film: those of its bars, bare and under edges, greys, and the curve's."""
    ground, ink = (np.array(color, dtype=np.float64) for color in (DARK if film.views[0].dark else LIGHT))
    bars = {(scale.cmap, scale.norm, scale.low, scale.high): scale for scale in scales}.values()
    own = np.vstack([scale.bar(120 // len(bars)) for scale in bars]).astype(np.float64)
    greys = ground + np.linspace(0.0, 1.0, 256 - 2 * len(own) - len(film.curve.lines))[:, None] * (ink - ground)
    lines = [[int(color[k : k + 2], 16) for k in (1, 3, 5)] for _, color in film.curve.lines.values()]
    colors = np.vstack([own, 0.7 * own + 0.3 * ink, greys, np.array(lines, dtype=np.float64).reshape(-1, 3)])
    palette = Pillow.new("P", (1, 1))
    palette.putpalette(np.rint(colors).astype(np.uint8).tobytes())
    return palette


def _write_gif(path: Path, pictures: Iterator[NDArray[np.uint8]], seconds: float, palette: Pillow.Image) -> None:
    """Write the pictures with one palette, so that a colour is the same in all; no more than what changes is kept."""
    frames = [Pillow.fromarray(picture).quantize(palette=palette, dither=Pillow.Dither.NONE) for picture in pictures]
    duration = max(round(1000 * seconds), 20)
    frames[0].save(path, "GIF", save_all=True, append_images=frames[1:], duration=duration, loop=0, optimize=False)


def _write_mp4(path: Path, pictures: Iterator[NDArray[np.uint8]], seconds: float) -> None:
    """Write the pictures as H.264, which every player and browser knows; ffmpeg works in a process of its own."""
    from imageio_ffmpeg import get_ffmpeg_exe

    first = next(pictures)
    height, width = first.shape[:2]
    repeats = max(round(FRAMES_A_SECOND * seconds), 1)
    raw = ["-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{width}x{height}", "-r", str(FRAMES_A_SECOND), "-i", "-"]
    coded = ["-an", "-c:v", "libx264", "-crf", "20", "-pix_fmt", "yuv420p", "-movflags", "+faststart", str(path)]
    command = [get_ffmpeg_exe(), "-y", "-loglevel", "error", *raw, *coded]
    with tempfile.TemporaryFile() as said, subprocess.Popen(command, stdin=subprocess.PIPE, stderr=said) as child:
        assert child.stdin is not None
        try:
            for picture in chain([first], pictures):
                child.stdin.write(np.ascontiguousarray(picture).tobytes() * repeats)
            child.stdin.close()
        except BrokenPipeError:
            child.wait()
        except BaseException:
            child.kill()
            raise
        if child.wait():
            said.seek(0)
            words = said.read().decode(errors="replace").strip().splitlines()
            raise InputError(f"the film could not be written ({words[-1] if words else 'ffmpeg failed'})")
