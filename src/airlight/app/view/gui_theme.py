"""How the window's panel looks: neutral greys, so that the image's colours are judged by
themselves, one accent, and a typeface that is not imgui's own.
"""

from __future__ import annotations

from pathlib import Path

import imgui_bundle
from imgui_bundle import imgui

Colour = tuple[float, float, float, float]
GROUND: Colour = (0.067, 0.071, 0.078, 1.0)
ACCENT: Colour = (0.94, 0.71, 0.33, 1.0)
ERROR: Colour = (1.0, 0.47, 0.40, 1.0)
NOTICE: Colour = (0.62, 0.82, 0.62, 1.0)
_TEXT: Colour = (0.88, 0.89, 0.91, 1.0)
FAINT: Colour = (0.53, 0.55, 0.59, 1.0)
_FONT = Path(imgui_bundle.__file__).parent / "assets" / "fonts" / "Roboto" / "Roboto-Regular.ttf"
_FONT_PX = 14.5


def put_theme() -> None:
    """The theme, for the imgui context of this moment."""
    imgui.style_colors_dark()
    # Round corners, thin borders, some space.
    style = imgui.get_style()
    style.window_rounding = 0.0
    style.frame_rounding = style.grab_rounding = style.popup_rounding = 5.0
    style.window_border_size, style.popup_border_size = 0.0, 1.0
    style.window_padding, style.frame_padding = imgui.ImVec2(14.0, 12.0), imgui.ImVec2(8.0, 4.0)
    style.item_spacing, style.grab_min_size = imgui.ImVec2(8.0, 6.0), 9.0
    style.scrollbar_size = 9.0
    # Greys with a touch of blue.
    for colour, grey, alpha in (
        (imgui.Col_.window_bg, 0.105, 1.0),
        (imgui.Col_.popup_bg, 0.13, 0.98),
        (imgui.Col_.border, 0.24, 1.0),
        (imgui.Col_.frame_bg, 0.17, 1.0),
        (imgui.Col_.frame_bg_hovered, 0.22, 1.0),
        (imgui.Col_.frame_bg_active, 0.25, 1.0),
        (imgui.Col_.header, 0.135, 1.0),
        (imgui.Col_.header_hovered, 0.19, 1.0),
        (imgui.Col_.header_active, 0.22, 1.0),
        (imgui.Col_.button, 0.21, 1.0),
        (imgui.Col_.button_hovered, 0.28, 1.0),
        (imgui.Col_.button_active, 0.34, 1.0),
        (imgui.Col_.slider_grab, 0.52, 1.0),
        (imgui.Col_.plot_histogram, 0.30, 1.0),
        (imgui.Col_.scrollbar_bg, 0.105, 0.0),
    ):
        style.set_color_(colour, (grey, grey * 1.02, grey * 1.06, alpha))
    for colour, own in (
        (imgui.Col_.text, _TEXT),
        (imgui.Col_.text_disabled, FAINT),
        (imgui.Col_.slider_grab_active, ACCENT),
        (imgui.Col_.check_mark, ACCENT),
    ):
        style.set_color_(colour, own)
    if _FONT.is_file():  # else imgui's own
        imgui.get_io().fonts.add_font_from_file_ttf(str(_FONT), _FONT_PX)
