"""Ten functions for notebooks and scripts; each takes and returns values, and shows progress where somebody watches.

``load`` a source, ``paint`` on it, ``limit`` or ``preserve`` its sizes, ``mesh`` and ``smooth``, ``report`` on what
came of it, ``show`` it or take a ``screenshot``; or let it ``adapt``. They are the pipeline of the command line and the
window, stage by stage; ``sizeviz.run`` does all stages at once.
"""

from sizeviz.api.fields import limit, preserve
from sizeviz.api.loading import load, paint
from sizeviz.api.meshes import adapt, mesh, report, smooth
from sizeviz.api.pictures import screenshot, show

__all__ = ["adapt", "limit", "load", "mesh", "paint", "preserve", "report", "screenshot", "show", "smooth"]
