"""The site is built without a warning; its how-to pages show what works."""

from __future__ import annotations

import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

from sizeviz.cli.app import app

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
PAGES = sorted([*(DOCS / "howto").glob("*.md"), DOCS / "lessons.md", DOCS / "index.md"])


def blocks(page: Path, language: str) -> str:
    return "".join(re.findall(rf"```{language}\n(.*?)```", page.read_text(encoding="utf-8"), re.DOTALL))


TOLD = sorted({ROOT / "README.md", ROOT / "CHANGELOG.md", *DOCS.rglob("*.md")} - {*(DOCS / "_build").rglob("*")})
"""Everything that is read on the site or beside it."""

COMMANDS = [line for page in PAGES for line in blocks(page, "sh").splitlines()]


@pytest.mark.slow
def test_the_site_is_built_without_a_warning(tmp_path):
    command = [sys.executable, "-m", "sphinx", "-W", "--keep-going", "-q", "-b", "html", "-d", str(tmp_path / "trees")]
    done = subprocess.run([*command, str(DOCS), str(tmp_path)], capture_output=True, text=True, timeout=500, cwd=ROOT)
    assert done.returncode == 0, done.stderr
    for page in ("index", "api", "lessons", "auto_tutorials/index", "algorithms/size-preserving", "howto/figures"):
        assert (tmp_path / f"{page}.html").stat().st_size > 2000
    tutorial = (tmp_path / "auto_tutorials" / "lesson_1_line.html").read_text(encoding="utf-8")
    assert "size preserving, α = 1: 5 elements, largest R 1.00" in tutorial and ".ipynb" in tutorial
    commands = (tmp_path / "commands.html").read_text(encoding="utf-8")
    assert all(f'id="sizeviz-{name}"' in commands for name in ("compare", "run", "adapt", "film", "doctor"))
    assert "sizeviz.api.preserve" in (tmp_path / "api.html").read_text(encoding="utf-8")


@pytest.mark.parametrize("line", COMMANDS)
def test_commands_of_the_how_to_pages_are_understood(line):
    program, *arguments = shlex.split(line)
    assert program == "sizeviz"
    command, bound, *_ = app.parse_args(arguments, exit_on_error=False, print_error=False)
    assert command.__name__ == arguments[0] and bound.arguments


@pytest.mark.parametrize("page", [page for page in PAGES if blocks(page, "python")], ids=lambda page: page.stem)
def test_python_of_the_how_to_pages_runs(page):
    exec(compile(blocks(page, "python"), page.name, "exec"), {})


@pytest.mark.parametrize("page", TOLD, ids=lambda page: page.stem)
def test_links_lead_somewhere(page):
    for target in re.findall(r"\]\((?!https?:)([^)#]+)\)", page.read_text(encoding="utf-8")):
        made = target.replace("auto_tutorials", "tutorials").replace(".rst", ".py")
        assert (page.parent / made).exists(), target


def test_every_decision_has_its_number_and_is_listed():
    listed = (DOCS / "adr" / "README.md").read_text(encoding="utf-8")
    for number, page in enumerate(sorted((DOCS / "adr").glob("0*.md")), 1):
        heading = page.read_text(encoding="utf-8").splitlines()[0].removeprefix("# ")
        assert page.name.startswith(f"{number:04d}-") and heading.startswith(f"{number}. ")
        assert f"[{heading.partition('. ')[2]}]({page.name})" in listed


def test_every_page_is_in_the_table_of_contents():
    index = (DOCS / "index.md").read_text(encoding="utf-8")
    for folder in ("howto", "algorithms"):
        for page in (DOCS / folder).glob("*.md"):
            assert f"\n{folder}/{page.stem}\n" in index
