"""The shrinking ball drawn over a pane."""

from __future__ import annotations

from typing import TYPE_CHECKING

from qtpy.QtCore import QPointF, QRectF, Qt
from qtpy.QtGui import QColor, QFontMetrics, QPen, QPolygonF

from sizeviz.app.lessons.ball import place_words

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray
    from qtpy.QtGui import QPainter

    from sizeviz.app.lessons.why import Asked
    from sizeviz.app.panes.surface import Glass

MOST_DOTS = 3000
"""Nodes looked at that are drawn; more would be a carpet."""

FILL, RIM = QColor(31, 95, 168, 56), QColor(20, 84, 160)
LOOK, BLOCK, SEEN = QColor(235, 170, 20), QColor(214, 60, 10), QColor(40, 46, 54, 150)


class BallOverlay:
    """Draws what is asked: the first ball, the ball now, the nodes looked at, the node that blocks.

    Parameters
    ----------
    asked : Asked
        What is told.
    type_scale : float
        How much larger than usual words and marks are.
    """

    def __init__(self, asked: Asked, type_scale: float = 1.0) -> None:
        self.asked, self.type_scale = asked, type_scale

    def paint(self, glass: Glass, painter: QPainter) -> None:
        """Draw."""
        story, unit = self.asked.story, self.type_scale
        moment = story.at(self.asked.step)
        centre = glass.pixel(*story.trace.centre)
        self._circle(glass, painter, centre, story.trace.start, Qt.PenStyle.DotLine, fill=False)
        self._circle(glass, painter, centre, moment.radius, Qt.PenStyle.SolidLine, fill=True)
        self._nodes(glass, painter)
        if not (moment.is_start or moment.is_end):
            self._dot(painter, glass.pixel(*moment.place), 5.0 * unit, LOOK)
        if moment.radius < story.trace.start:
            side = self._block(glass, painter, moment.blocking, centre)
        else:
            side = 1.0
        self._dot(painter, centre, 5.0 * unit, RIM)
        words = f"h* = {moment.candidate:.3g}" + ("" if moment.is_end else " ?")
        self._write(glass, painter, centre, -side * 8.0 * unit, words)

    def words(self) -> str:
        """Return what is drawn, for those who cannot see it."""
        story = self.asked.story
        moment = story.at(self.asked.step)
        return f"Ball of radius {moment.radius:.4g} at {place_words(story.trace.centre)}"

    def _block(self, glass: Glass, painter: QPainter, place: NDArray[np.float64], centre: QPointF) -> float:
        """Mark the node that blocks, its words away from the centre; return 1 if that is downwards, -1 if upwards."""
        story, at, size = self.asked.story, glass.pixel(*place), 7.0 * self.type_scale
        side = 1.0 if at.y() > centre.y() else -1.0
        diamond = QPolygonF([at + QPointF(*step) for step in ((0, -size), (size, 0), (0, size), (-size, 0))])
        painter.setBrush(BLOCK)
        painter.setPen(QPen(QColor("white"), 1.6 * self.type_scale))
        painter.drawPolygon(diamond)
        asks = story.sizes[((story.places - place) ** 2).sum(axis=1).argmin()]
        self._write(glass, painter, at, side * 1.4 * size, f"blocks: h = {asks:.3g}")
        return side

    def _write(self, glass: Glass, painter: QPainter, at: QPointF, away: float, words: str) -> None:
        """Write words centred below a pixel, or above it where ``away`` is negative."""
        metrics = QFontMetrics(glass.font())
        down = away if away > 0 else away - metrics.height() - 6.0
        glass.draw_label(painter, at + QPointF(-0.5 * metrics.horizontalAdvance(words) - 6.0, down), words)

    def _circle(
        self, glass: Glass, painter: QPainter, centre: QPointF, radius: float, style: Qt.PenStyle, fill: bool
    ) -> None:
        reach = abs(glass.pixel(radius, 0.0).x() - glass.pixel(0.0, 0.0).x())
        painter.setBrush(FILL if fill else Qt.BrushStyle.NoBrush)
        width = (2.4 if fill else 1.6) * self.type_scale
        for color, more in ((QColor(255, 255, 255, 210), 2.0), (RIM, 0.0)):
            painter.setPen(QPen(color, width + more, style))
            painter.drawEllipse(centre, reach, reach)
            painter.setBrush(Qt.BrushStyle.NoBrush)

    def _nodes(self, glass: Glass, painter: QPainter) -> None:
        seen = self.asked.story.looked_at(self.asked.step)
        if len(seen) > MOST_DOTS:
            seen = seen[:: -(-len(seen) // MOST_DOTS)]
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(SEEN)
        size = 3.0 * self.type_scale
        for x, y in self.asked.story.places[seen]:
            at = glass.pixel(x, y)
            painter.drawRect(QRectF(at.x() - 0.5 * size, at.y() - 0.5 * size, size, size))

    def _dot(self, painter: QPainter, at: QPointF, radius: float, color: QColor) -> None:
        painter.setBrush(color)
        painter.setPen(QPen(QColor("white"), 1.6 * self.type_scale))
        painter.drawEllipse(at, radius, radius)
