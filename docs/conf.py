"""The site: ``make docs`` builds it into docs/_build/html, with every warning an error."""

from __future__ import annotations

import os
import re
import sys
from importlib import import_module
from pathlib import Path

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE.parent))
os.environ["MPLBACKEND"] = "agg"

project = "sizeviz"
author = "The sizeviz maintainers"
copyright = "the sizeviz maintainers, BSD-3-Clause"
version = release = import_module("sizeviz").__version__
extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx.ext.mathjax",
    "sphinx_gallery.gen_gallery",
]
root_doc = "index"
exclude_patterns = ["_build", "tutorials", "**.ipynb", "auto_tutorials/**.py", "auto_tutorials/GALLERY_HEADER.rst"]
nitpicky = False

html_theme = "furo"
html_title = "sizeviz"
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_theme_options = {
    "light_css_variables": {"color-brand-primary": "#1f5fa8", "color-brand-content": "#1f5fa8"},
    "dark_css_variables": {"color-brand-primary": "#6aa9e6", "color-brand-content": "#6aa9e6"},
}

myst_enable_extensions = ["colon_fence"]
myst_heading_anchors = 3
suppress_warnings = ["config.cache"]  # the gallery's settings hold functions, which cannot be kept between builds

sphinx_gallery_conf = {
    "examples_dirs": "tutorials",
    "gallery_dirs": "auto_tutorials",
    "filename_pattern": r"/lesson_\d",
    "within_subsection_order": "FileNameSortKey",
    "download_all_examples": False,
    "show_signature": False,
    "show_memory": False,
    "min_reported_time": 1e9,
    "write_computation_times": False,
    "abort_on_example_error": True,
    "remove_config_comments": True,
    "only_warn_on_example_error": False,
}

autodoc_member_order = "bysource"
autodoc_typehints = "none"
autodoc_class_signature = "mixed"
napoleon_numpy_docstring = True
napoleon_google_docstring = False
napoleon_use_rtype = False
napoleon_use_ivar = True


def escaped(line: str) -> str:
    """Return a line of a docstring with h* and |x - y| meant as they are written, not as markup."""
    parts = re.split(r"(``[^`]*``)", line)
    return "".join(part if k % 2 else re.sub(r"(?<![\\\w])\||(?<=\w)\||\*(?!\*)(?<!\*\*)", r"\\\g<0>", part)
                   for k, part in enumerate(parts))  # fmt: skip


def escape(app: object, what: str, name: str, obj: object, options: object, lines: list[str]) -> None:
    """Escape a docstring before it is taken for reStructuredText."""
    lines[:] = [escaped(line) for line in lines]


def out_of_the_way(app: object, page: str, source: list[str]) -> None:
    """Keep single decisions out of the list of pages: their own page lists them."""
    if page.startswith("adr/0"):
        source[0] = f"---\norphan: true\n---\n{source[0]}"


def with_commands(app: object, page: str, source: list[str]) -> None:
    """Put every command's help, as the program itself gives it, into the page of the command line."""
    if page == "commands":
        from sizeviz.cli.app import app as program

        told = program.generate_docs(output_format="markdown")
        source[0] += told[told.index("**Commands**") :]


def setup(app: object) -> None:
    """Take docstrings before napoleon does, and add what the program says of itself."""
    app.connect("autodoc-process-docstring", escape, priority=100)
    app.connect("source-read", with_commands)
    app.connect("source-read", out_of_the_way)
