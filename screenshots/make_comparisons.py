"""Make the comparisons that README and docs show: ``python screenshots/make_comparisons.py``."""

from __future__ import annotations

from pathlib import Path

from sizeviz.scene import save_comparison
from sizeviz.sources import load
from sizeviz.study import Study, StudyOptions, run

HERE = Path(__file__).parent


def main() -> None:
    for name in ("ring", "mri"):
        study = run(Study(load(name), StudyOptions().with_comparable_slope()))
        print(save_comparison(study, HERE / f"compare-{name}.png", width=1600))


if __name__ == "__main__":
    main()
