"""The frame around panes and panels: it arranges and shows them, and decides nothing."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from qtpy.QtCore import Qt
from qtpy.QtWidgets import (
    QDockWidget,
    QLabel,
    QMainWindow,
    QScrollArea,
    QSizePolicy,
    QSplitter,
    QStackedWidget,
    QTabWidget,
    QToolBar,
    QToolButton,
    QUndoView,
    QVBoxLayout,
    QWidget,
)

from sizeviz.app.actions import Actions
from sizeviz.app.brush.tool import PaintTool
from sizeviz.app.controller import Controller
from sizeviz.app.feedback import LogPanel, Progress, Toast
from sizeviz.app.files import StudyFiles
from sizeviz.app.inspect.histogram import HistogramPanel
from sizeviz.app.inspect.judge import StatisticsPanel, WorstPanel
from sizeviz.app.inspect.look import Inspector
from sizeviz.app.menus import FILE, VIEW, menu_button
from sizeviz.app.palette import CommandPalette, ShortcutOverlay
from sizeviz.app.panels.controls import Section
from sizeviz.app.panels.options import JudgePanel, MeshPanel, SizePanel, SmoothPanel
from sizeviz.app.panels.paint import PaintPanel
from sizeviz.app.panels.source import SourcePanel
from sizeviz.app.panes.board import PaneBoard
from sizeviz.app.panes.canvas import GLCanvas
from sizeviz.app.panes.remembered import view_values
from sizeviz.app.prepare import Preparation
from sizeviz.app.settings import Settings
from sizeviz.app.theme import THEMES, Theme, apply_theme
from sizeviz.app.turns import Turns
from sizeviz.app.welcome import Welcome

if TYPE_CHECKING:
    from collections.abc import Callable, Hashable

    from qtpy.QtGui import QDragEnterEvent, QDropEvent, QResizeEvent

    from sizeviz.app.engine import Engine
    from sizeviz.app.panes.canvas import Canvas
    from sizeviz.study import Study

SIDEBAR = 314
"""Width of the pipeline's panels, in device-independent pixels."""

INSPECTOR = 372
"""Width of the judgement's panels."""

SPACING = 3
"""Between the toolbar's buttons."""

OF_A_STUDY: tuple[str, ...] = (
    "save", "save-as", "save-picture", "save-comparison", "save-page", "save-film", "save-mesh", "save-prescribed",
    "save-target", "copy-command", "copy-python", "copy-table", "copy-table-csv", "copy-table-latex", "worst-ratio",
    "worst-quality", "log",
)  # fmt: skip
"""Commands that there is nothing for until something is open."""


class Frame(QMainWindow):
    """All that the window shows, not yet connected to what it does.

    Parameters
    ----------
    engine : Engine
        The pipeline.
    settings : Settings, optional
        What is remembered; the platform's own place by default.
    make_canvas : callable
        Makes a pane's drawing widget; tests without OpenGL bring their own.
    """

    def __init__(
        self,
        engine: Engine,
        settings: Settings | None = None,
        make_canvas: Callable[[QWidget], Canvas] = GLCanvas,
    ) -> None:
        super().__init__()
        self.setWindowTitle("sizeviz")
        self.setAcceptDrops(True)
        self.settings = settings or Settings()
        self.theme = THEMES.get(self.settings.theme, THEMES["light"])
        apply_theme(self, self.theme)  # before there is anything to polish
        self.controller = Controller(engine, self)
        self.turns = Turns(self)
        self.actions_ = Actions(self)
        self.examples = list(engine.examples())
        self._make_canvas = make_canvas
        self.files = StudyFiles(self.controller, self.settings.autosaves, lambda: view_values(self.board), self)
        self._build_centre()
        self._build_pipeline()
        self._build_inspector()
        self._build_bars()
        panels = [*self.sections, self.statistics, *self.histograms, self.worst, self.tabs, self.progress]
        self.preparation = Preparation(self.board, panels, self)
        self.tool = PaintTool(self.controller, self.board, self.paint)
        self.inspector = Inspector(self.controller, self.board, self.readout, self.worst)
        self.palette_ = CommandPalette(self.actions_, self)
        self.overlay = ShortcutOverlay(self.actions_, self)
        self._laid_out = self.settings.restore_layout(self)
        if not self._laid_out:
            self.resize(1500, 920)
        for dock in (self.pipeline_dock, self.inspector_dock):
            dock.hide()  # the welcome page stands alone

    # -- building --------------------------------------------------------------------------------------------------

    def _build_centre(self) -> None:
        self.board = PaneBoard(self.controller, self._make_canvas)
        self.welcome = Welcome(self.examples, self.settings.recent, self.files.leftovers())
        self.pages = QStackedWidget()
        self.pages.addWidget(self.welcome)
        self.pages.addWidget(self.board)
        self.pages.currentChanged.connect(self._suit_pages)
        self._suit_pages()
        self.setCentralWidget(self.pages)
        self.toast = Toast(self.pages)

    def _build_pipeline(self) -> None:
        self.source = SourcePanel(self.examples)
        self.paint, self.size_panel, self.mesh_panel = PaintPanel(), SizePanel(), MeshPanel()
        self.smooth_panel, self.judge_panel = SmoothPanel(), JudgePanel()
        inner = QWidget()
        inner.setObjectName("sidebar")
        column = QVBoxLayout(inner)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(0)
        self.sections = [
            Section("1   Source", self.source),
            Section("     Paint", self.paint, open_=False),
            Section("2   Size", self.size_panel),
            Section("3   Mesh", self.mesh_panel, open_=False),
            Section("4   Smooth", self.smooth_panel, open_=False),
            Section("5   Judge", self.judge_panel),
        ]
        for section in self.sections:
            column.addWidget(section)
        column.addStretch(1)
        scroll = QScrollArea()
        scroll.setWidget(inner)
        scroll.setWidgetResizable(True)
        scroll.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        scroll.setMinimumWidth(SIDEBAR)
        scroll.setFocusPolicy(Qt.FocusPolicy.NoFocus)  # its controls take the keyboard, and it follows them
        sidebar = QWidget()
        whole = QVBoxLayout(sidebar)
        whole.setContentsMargins(0, 0, 0, 0)
        whole.setSpacing(0)
        whole.addWidget(scroll, 1)
        whole.addWidget(self.judge_panel.footer)
        self.pipeline_dock = self._dock("Pipeline", sidebar, Qt.DockWidgetArea.LeftDockWidgetArea)

    def _build_inspector(self) -> None:
        self.statistics, self.worst = StatisticsPanel(), WorstPanel()
        self.histograms = [HistogramPanel("ratio", self.theme), HistogramPanel("quality", self.theme)]
        judge = QSplitter(Qt.Orientation.Vertical)
        judge.setChildrenCollapsible(False)
        for panel in (self.statistics, *self.histograms, self.worst):
            judge.addWidget(panel)
        judge.setSizes([374, 132, 132, 240])
        judge.setStretchFactor(3, 1)  # a low window takes rows from the list, not from the table
        self.history = QUndoView(self.controller.store.stack)
        self.history.setEmptyLabel("As opened")
        self.history.setAccessibleName("History")
        self.log = LogPanel()
        self.tabs = QTabWidget()
        self.tabs.setDocumentMode(True)
        self.tabs.tabBar().setDrawBase(False)
        self.tabs.tabBar().setAccessibleName("Pages of results")
        for page, words in ((judge, "Judgement"), (self.history, "History"), (self.log, "Log")):
            self.tabs.addTab(page, words)
        self.tabs.setMinimumWidth(INSPECTOR)
        self.inspector_dock = self._dock("Results", self.tabs, Qt.DockWidgetArea.RightDockWidgetArea)

    def _dock(self, title: str, widget: QWidget, area: Qt.DockWidgetArea) -> QDockWidget:
        dock = QDockWidget(title, self)
        dock.setObjectName(title)
        dock.setTitleBarWidget(QWidget())  # no title bar: the panels name themselves
        dock.setFeatures(QDockWidget.DockWidgetFeature.DockWidgetClosable)
        dock.setWidget(widget)
        self.addDockWidget(area, dock)
        return dock

    def _build_bars(self) -> None:
        bar = QToolBar("Tools")
        bar.setObjectName("tools")
        bar.setMovable(False)
        bar.addWidget(menu_button("File", "Open, save, export", FILE, self.actions_, self))
        view = menu_button("View", "Zoom, worst elements, colours, panels", VIEW, self.actions_, self)
        about_panes = [bar.addWidget(view)]
        for name in ("undo", "redo", "", "paint", "", "link", "shared-range", "swap", "", "panes-1", "panes-2",
                     "panes-3", "panes-4"):  # fmt: skip
            if name == "panes-1":
                about_panes.append(bar.addWidget(_quiet("  Panes")))
            if name:
                bar.addAction(self.actions_[name])
            about_panes.append(self.actions_[name] if name else bar.addSeparator())

        def suit_page() -> None:
            """Offer only what the page at hand can do."""
            for action in about_panes:
                action.setVisible(self.pages.currentWidget() is self.board)
            if self.isVisible():
                self.suit_bar()

        self.pages.currentChanged.connect(suit_page)
        suit_page()
        short = {"paint": "Paint", "link": "Link", "shared-range": "Shared range", "swap": "Swap",
                 "panes-1": "1", "panes-2": "2", "panes-3": "3", "panes-4": "4"}  # fmt: skip
        for name, words in short.items():
            self.actions_[name].setIconText(words)
        spacer = QWidget()
        spacer.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Preferred)
        bar.addWidget(spacer)
        search = QToolButton()
        search.setObjectName("search")
        search.setText("Search    Ctrl+K")
        search.setAccessibleName("Open the command palette")
        search.setToolTip("Find any command by typing a few letters (Ctrl+K)")
        search.clicked.connect(lambda: self.actions_["palette"].trigger())
        self._search = bar.addWidget(search)
        for name, words in (("theme", "Dark"), ("shortcuts", "?")):
            self.actions_[name].setIconText(words)
            bar.addAction(self.actions_[name])
        self.addToolBar(bar)
        self.toolbar = bar
        self.readout = QLabel("")
        self.readout.setAccessibleName("Values under the cursor")
        self.readout.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Preferred)
        self.progress = Progress()
        self.statusBar().setSizeGripEnabled(False)
        self.statusBar().setMinimumHeight(42)  # room for Cancel, so that nothing moves when a run begins
        self.statusBar().addWidget(self.readout, 1)
        self.statusBar().addPermanentWidget(self.progress)

    # -- showing ---------------------------------------------------------------------------------------------------

    def show_study(self, study: Study) -> None:
        """Bring panels and panes to a study."""
        if self.pages.currentWidget() is self.welcome:
            self._let_shrink(self.welcome)  # the panels come before it goes, and the window must not grow for both
            turned: dict[Hashable, Callable[[], object]] = {dock: dock.show for dock in self.wanted_docks}
            turned[self.board] = self._leave_welcome
            turned |= {surface: surface.show for surface in self.board.curtained()}
            self.turns.take(turned | {"focus": lambda: self.board.active.surface.glass.setFocus()})
        self.show_title()
        self.source.show_source(study.source)
        self.show_options()
        self.board.refresh()
        self.show_judgement()
        self.show_state()

    @property
    def wanted_docks(self) -> list[QDockWidget]:
        """The panels beside the panes that nobody has put away."""
        docks = (("panel-pipeline", self.pipeline_dock), ("panel-results", self.inspector_dock))
        return [dock for name, dock in docks if self.actions_[name].isChecked()]

    def show_docks(self) -> None:
        """Show the wanted panels beside the panes, none beside another page."""
        for dock in (self.pipeline_dock, self.inspector_dock):
            dock.setVisible(self.pages.currentWidget() is self.board and dock in self.wanted_docks)

    def turn_page(self, page: QWidget) -> None:
        """Show another page; panels go before it comes, so that the window need not grow for both."""
        if page is not self.board:
            for dock in (self.pipeline_dock, self.inspector_dock):
                dock.hide()
        self.pages.setCurrentWidget(page)
        self.show_docks()

    def show_options(self) -> None:
        """Show the study's options, whatever was typed."""
        if self.controller.study is not None:
            for panel in (self.size_panel, self.mesh_panel, self.smooth_panel):
                panel.show_options(self.controller.study.options)

    def _leave_welcome(self) -> None:
        if not self._laid_out:
            docks = [self.pipeline_dock, self.inspector_dock]
            self.resizeDocks(docks, [SIDEBAR, INSPECTOR], Qt.Orientation.Horizontal)
        self.pages.setCurrentWidget(self.board)

    def _suit_pages(self) -> None:
        """Let the window be as small as the page on show can be, however much room the others would want."""
        for k in range(self.pages.count()):
            self._let_shrink(self.pages.widget(k))
        current = self.pages.currentWidget()
        if current is not None:
            current.setSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Preferred)

    @staticmethod
    def _let_shrink(page: QWidget) -> None:
        page.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Ignored)

    def show_title(self) -> None:
        """Name the study's file, or what it was opened from, and mark unsaved changes."""
        study, path = self.controller.study, self.files.path
        if study is not None:
            self.setWindowTitle(f"{study.source.label if path is None else path.name}[*] – sizeviz")
            self.setWindowModified(self.files.is_modified)

    def show_judgement(self) -> None:
        """Bring table, histograms and the worst elements to the active pane."""
        pane = self.board.active
        method, view = pane.view.method, pane.view
        methods, study = self.board.methods, self.controller.study
        subject = self.controller.displayed(method).subject
        older = {name: self.controller.displayed(name).subject.report for name in self.controller.missing()}
        stale = {name: report for name, report in older.items() if report is not None}
        pieces: dict[Hashable, Callable[[], object]] = {
            panel: partial(panel.show_subject, subject, method, view) for panel in self.histograms
        }
        self.turns.take(
            {
                self.statistics: partial(self.statistics.show_study, study, methods, view.measure, stale),
                self.worst: partial(self.worst.show_subject, subject, method, view.measure),
                **pieces,
            }
        )
        if self.board.is_light:
            self.turns.finish()

    @property
    def is_settling(self) -> bool:
        """Whether anything that was asked for is still on its way to the screen."""
        return self.turns.is_busy or self.board.is_drawing

    def show_state(self) -> None:
        """Bring undo, redo, Apply and the badges to what is possible now."""
        stack, busy = self.controller.store.stack, self.controller.is_running
        self.actions_["undo"].setEnabled(stack.canUndo())
        self.actions_["redo"].setEnabled(stack.canRedo())
        missing = len(self.controller.missing())
        self.actions_["apply"].setEnabled(missing > 0 and not busy)
        self.actions_["cancel"].setEnabled(busy)
        for name in OF_A_STUDY:
            self.actions_[name].setEnabled(self.controller.study is not None)
        self.judge_panel.show_state(missing, busy)

    def set_theme(self, theme: Theme) -> None:
        """Change between light and dark."""
        self.theme = theme
        apply_theme(self, theme)
        self.settings.theme = "dark" if theme.dark else "light"
        self.board.dark = theme.dark
        for histogram in self.histograms:
            histogram.set_theme(theme)
        self.board.refresh()

    # -- files dropped -----------------------------------------------------------------------------------------------

    def dragEnterEvent(self, event: QDragEnterEvent) -> None:
        """Take files."""
        if any(url.isLocalFile() for url in event.mimeData().urls()):
            event.acceptProposedAction()

    def dropEvent(self, event: QDropEvent) -> None:
        """Open the first file dropped."""
        paths = [url.toLocalFile() for url in event.mimeData().urls() if url.isLocalFile()]
        if paths:
            event.acceptProposedAction()
            self.controller.open_source(paths[0])

    def suit_bar(self) -> None:
        """Offer the search where the toolbar has room for it; where it has not, its keys work all the same."""
        bar, shown = self.toolbar, self._search.isVisible()
        wish = bar.widgetForAction(self._search).sizeHint().width() + SPACING
        room = self.width() - bar.sizeHint().width() + (wish if shown else 0)
        self._search.setVisible(room >= wish)

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Keep the message in its place, and the toolbar's buttons in sight."""
        super().resizeEvent(event)
        self.suit_bar()
        if self.toast.isVisible():
            self.toast.place()


def _quiet(words: str) -> QLabel:
    label = QLabel(words)
    label.setProperty("role", "muted")
    return label
