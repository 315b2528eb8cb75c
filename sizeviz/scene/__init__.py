"""From results to pictures: pure composition, one renderer, colour maps, still pictures, vector figures, pages."""

from sizeviz.scene.camera import Camera2D
from sizeviz.scene.comparison import save_comparison
from sizeviz.scene.compose import compose
from sizeviz.scene.page import save_page
from sizeviz.scene.picture import save_picture
from sizeviz.scene.renderer import Renderer
from sizeviz.scene.scale import ColorScale, ratio_scale
from sizeviz.scene.spec import SceneSpec
from sizeviz.scene.subject import Subject
from sizeviz.scene.view import ViewState

__all__ = [
    "Camera2D",
    "ColorScale",
    "Renderer",
    "SceneSpec",
    "Subject",
    "ViewState",
    "compose",
    "ratio_scale",
    "save_comparison",
    "save_page",
    "save_picture",
]
