"""The page of the panes: whole in one file, exact in its colours, and alive in a browser where there is one."""

from __future__ import annotations

import base64
import json
import re
import subprocess
import zlib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from study.cases import valley_source

from sizeviz.errors import InputError
from sizeviz.scene import ViewState, save_page
from sizeviz.scene.page import page
from sizeviz.scene.subject import subject_of
from sizeviz.study import Study, run

PROBE = """<script>
(async () => {
  const trouble = document.getElementById("trouble"), rest = () => new Promise((r) => setTimeout(r, 50));
  while (!document.body.dataset.ready && trouble.hidden) await rest();
  const board = window.sizeviz, out = { trouble: trouble.textContent };
  const frame = async () => { await rest(); for (const pane of board.panes) pane.draw(board.dark); };
  await frame();
  const seen = (pane) => {
    const gl = pane.painter.gl, w = pane.canvas.width, h = pane.canvas.height, px = new Uint8Array(4 * w * h);
    gl.readPixels(0, 0, w, h, gl.RGBA, gl.UNSIGNED_BYTE, px);
    return new Set(new Uint32Array(px.buffer)).size;
  };
  out.colors = board.panes.map(seen);
  const centre = board.meshes[0].centre(7);
  board.point(...centre);
  out.readouts = board.panes.map((pane) => pane.readout.textContent);
  board.panes[0].goToWorst();
  await frame();
  out.linked = JSON.stringify(board.panes[0].camera) === JSON.stringify(board.panes[1].camera);
  out.worst = board.panes[0].hover;
  board.panes[1].show(0, "quality");
  out.verdicts = board.panes.map((pane) => pane.verdict.textContent);
  document.body.dataset.probe = JSON.stringify(out);
})();
</script></body>"""


@pytest.fixture(scope="module")
def study() -> Study:
    return run(Study(valley_source()))


def data_of(text: str) -> dict:
    data = json.loads(re.search(r'<script type="application/json" id="data">(.*?)</script>', text, re.DOTALL)[1])
    kinds = {"f4": "<f4", "u4": "<u4", "u2": "<u2", "u1": "u1"}
    data["arrays"] = [
        np.frombuffer(zlib.decompress(base64.b64decode(array["data"])), kinds[array["type"]])
        for array in data["arrays"]
    ]
    return data


def test_the_page_holds_both_meshes_with_the_colours_of_the_window(study: Study, tmp_path: Path) -> None:
    data = data_of(save_page(study, tmp_path / "p.html").read_text("utf-8"))
    arrays = data["arrays"]
    assert [subject["title"] for subject in data["subjects"]] == ["Gradient limiting", "Size preserving"]
    assert data["panes"] == [{"subject": 0, "quantity": "ratio"}, {"subject": 1, "quantity": "ratio"}]
    for subject, finished in zip(data["subjects"], study.runs.values(), strict=True):
        mesh, report = finished.mesh, finished.report
        points = arrays[subject["points"]].reshape(-1, 2) + subject["origin"]
        assert np.allclose(points, mesh.points, atol=1e-7)
        assert np.array_equal(arrays[subject["quads"]].reshape(-1, 4), mesh.quads)
        ratio = subject["quantities"]["ratio"]
        assert np.allclose(arrays[ratio["values"]], report.ratio(), rtol=1e-6)
        shown = arrays[ratio["palette"]].reshape(-1, 3)[arrays[ratio["colors"]]].astype(int)
        assert np.array_equal(shown[:, 0] > shown[:, 2], ~report.correct()), "orange is what fails, and nothing else"
        assert np.array_equal(arrays[subject["failing"]], np.flatnonzero(~report.correct()))
        assert set(subject["quantities"]) == {"ratio", "quality", "size", "prescribed", "target"}
    assert data["table"]["rows"][0] == ["Elements", *(f"{r.mesh.n_quads:,}" for r in study.runs.values())]


def test_the_page_needs_nothing_from_anywhere_and_text_cannot_break_out(study: Study) -> None:
    name = "</script><script>alert(1)</script>\u2028{{data}}"
    text = page([replace(subject_of(study, "size-preserving"), title=name)], title=name)
    assert not re.findall(r"""(?:src|href|url|import)\s*[=(]\s*["']?\w+:""", text)
    assert "default-src 'none'" in text and text.count("<script") == 2 and text.count("</script>") == 2
    assert data_of(text)["subjects"][0]["title"] == name


def test_the_panes_can_be_chosen(study: Study) -> None:
    views = [ViewState(method="size-preserving", color_by="quality"), ViewState(method="size-preserving")]
    data = data_of(page(study, methods=["size-preserving"], panes=views))
    assert data["panes"] == [{"subject": 0, "quantity": "quality"}, {"subject": 0, "quantity": "ratio"}]
    bare = data_of(page(study.runs["size-preserving"].mesh))
    assert bare["panes"] == [{"subject": 0, "quantity": "quality"}, {"subject": 0, "quantity": "size"}]


def test_a_study_without_a_mesh_is_refused() -> None:
    with pytest.raises(InputError, match="no mesh to show on a page; run a method first"):
        page(Study(valley_source()))


def test_the_page_is_whole(study: Study, tmp_path: Path) -> None:
    text = save_page(study, tmp_path / "p.html").read_text("utf-8")
    assert text.rstrip().endswith("</html>") and 'id="panes"' in text


@pytest.mark.browser
def test_a_browser_shows_both_panes_and_reads_elements(study: Study, tmp_path: Path, browser: str) -> None:
    path = save_page(study, tmp_path / "p.html")
    path.write_text(path.read_text("utf-8").replace("</body>", PROBE), "utf-8")
    command = [browser, "--headless=new", "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
               "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync",
               f"--user-data-dir={tmp_path}/profile", "--window-size=1200,900", "--virtual-time-budget=20000",
               "--dump-dom", path.as_uri()]  # fmt: skip
    dom = subprocess.run(command, capture_output=True, text=True, timeout=120).stdout
    found = json.loads(re.search(r'data-probe="(.*?)"', dom)[1].replace("&quot;", '"'))
    assert found["trouble"] == ""
    assert min(found["colors"]) > 20, "colours in both panes"
    assert found["readouts"][0].startswith("element 7   R ") and "quality" in found["readouts"][1]
    worst = int(study.runs["gradient-limiting"].report.ratio().argmax())
    assert found["linked"] and found["worst"] == worst
    assert f"at element {worst}" in found["verdicts"][0] and found["verdicts"][1].startswith("mean quality")
