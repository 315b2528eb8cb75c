"""Make the film of a turning α that README shows: ``python screenshots/make_film.py``."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from sizeviz import Study, load
from sizeviz.scene.film import save_film
from sizeviz.scene.film_plans import alpha_film

HERE = Path(__file__).parent

if __name__ == "__main__":
    study = Study(load("expr:min(0.12, max(0.015, abs(hypot(x - 0.5, y - 0.5) - 0.3)))"))
    film = alpha_film(study, [float(alpha) for alpha in np.geomspace(1.0, 6.0, 12)])
    print(save_film(film, HERE / "turning-alpha.gif", width=760))
