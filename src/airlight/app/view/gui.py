"""The panel in a window (imgui): the declared sections, beside the image."""

from __future__ import annotations

from typing import Any

import numpy as np
from imgui_bundle import imgui

from ...gpu.device import Gpu
from ...gpu.memory import Texture
from .gizmos import Mark
from .gui_drawing import draw_marks, sky_pad
from .gui_theme import ACCENT, ERROR, FAINT, NOTICE, put_theme
from .help import HELP
from .save import Saver
from .sections import sections
from .session import Session
from .widgets import Section, Widget

PANEL_WIDTH = 330.0
_LEAST_SIDE = 60.0  # of a surface that a panel fits on
_LEAST_IMAGE = 160.0  # left for the image; else the panel lies over it
_LABELS = -150.0


class Panel:
    """`draw` between imgui's new frame and its rendering."""

    def __init__(self, session: Session, saver: Saver, overlay: Any) -> None:
        self.session, self.saver, self.overlay = session, saver, overlay
        self.is_shown, self.shows_help = True, False
        self.marks: tuple[Mark, ...] = ()
        self._has_popup = False
        self._held: dict[str, Any] = {}
        self._charts = Charts(session.gpu, overlay.backend)
        put_theme()
        overlay.set_gui(self.draw)

    def takes_text(self) -> bool:
        """Whether keys are being typed into one of its fields."""
        return bool(self.overlay.backend.io.want_text_input)

    def render(self) -> None:
        """Draw it over the surface."""
        self.overlay.render()

    def width(self, whole: float, height: float) -> float:
        """How much of a surface's width, in logical pixels, the panel takes from the image."""
        # A narrow surface has no room beside the image: the panel lies over it.
        is_beside = whole >= PANEL_WIDTH + _LEAST_IMAGE and height >= _LEAST_SIDE
        return PANEL_WIDTH if self.is_shown and is_beside else 0.0

    def covers(self, x: float, y: float) -> bool:
        """Whether the panel, or a list that it opened, takes a click here, in logical pixels.

        imgui itself knows only a frame later, which on a slow machine is after the click.
        """
        del y
        display = imgui.get_io().display_size
        if not self.is_shown or min(display.x, display.y) < _LEAST_SIDE:
            return False
        return self._has_popup or x < min(PANEL_WIDTH, display.x)

    def draw(self) -> None:
        """Build this frame's widgets; what they change is in the session at once."""
        display = imgui.get_io().display_size
        # A surface that is folded to nothing has no place for a panel.
        if min(display.x, display.y) < _LEAST_SIDE:
            self._has_popup = False
            return
        draw_marks(self.marks, self.width(display.x, display.y))
        # Without the panel, a line of status.
        if self.shows_help:
            _help(display.x, display.y)
        if not self.is_shown:
            self._status(display)
            self._has_popup = False
            return
        # The panel takes the left side, as high as the window; sections follow each other.
        imgui.set_next_window_pos((0.0, 0.0))
        imgui.set_next_window_size((min(PANEL_WIDTH, display.x), display.y))
        fixed = imgui.WindowFlags_.no_move | imgui.WindowFlags_.no_resize
        flags = fixed | imgui.WindowFlags_.no_collapse | imgui.WindowFlags_.no_title_bar
        imgui.begin("panel", None, flags)
        self._head()
        imgui.push_item_width(_LABELS)
        for section in sections(self.session, self.saver):
            self._section(section)
        imgui.pop_item_width()
        imgui.end()
        self._has_popup = imgui.is_popup_open("", imgui.PopupFlags_.any_popup)

    def _head(self) -> None:
        """The scene's name, what went wrong or well, and how far the image is."""
        session, state = self.session, self.session.state
        imgui.text_colored(ACCENT, "airlight")
        imgui.same_line()
        imgui.text(state.scene.name)
        for said in (state.message, *session.doubts):
            if said:
                _wrapped(said, ERROR)
        if state.notice:
            _wrapped(f"{state.notice}   {session.progress}".rstrip(), NOTICE)
        # How far the still is, and what it is drawn with.
        if session.renderer is not None:
            imgui.push_style_color(imgui.Col_.plot_histogram, ACCENT)
            imgui.progress_bar(session.share, (-1.0, 3.0), "")
            imgui.pop_style_color()
            imgui.text_disabled(session.status)
            tip(session.fine.message)

    def _status(self, display: Any) -> None:
        """In a corner while the panel is hidden: only what must not be missed."""
        state = self.session.state
        said = state.message or state.notice
        if not said:
            return
        imgui.set_next_window_pos((12.0, display.y - 12.0), imgui.Cond_.always, (0.0, 1.0))
        flags = imgui.WindowFlags_.no_decoration | imgui.WindowFlags_.no_inputs
        imgui.begin("status", None, flags | imgui.WindowFlags_.always_auto_resize)
        imgui.text(f"{said}   {self.session.progress}".rstrip())
        imgui.end()

    def _section(self, section: Section) -> None:
        flags = imgui.TreeNodeFlags_.none
        if section.is_open:
            flags = imgui.TreeNodeFlags_.default_open
        if imgui.collapsing_header(section.name.capitalize(), flags):
            for widget in section.widgets:
                self._widget(widget)
            imgui.dummy((0.0, 2.0))

    def _widget(self, widget: Widget) -> None:
        """One widget; what a hand changed is told at once, or when it lets go."""
        if widget.beside:
            imgui.same_line()
        value = self._held.get(widget.key, widget.value)
        changed, new = self._drawn(widget, value)
        tip(widget.tip)
        if widget.change is None:
            return
        # What takes long counts when the hand lets go; until then the panel shows what it holds.
        slides = widget.kind in ("number", "whole", "text", "colour")
        if not (widget.waits and slides):
            if changed:
                widget.change(new)
            return
        if changed:
            self._held[widget.key] = new
        # A colour is chosen in a window of its own, of which the item itself does not know.
        lets_go = widget.key in self._held and not imgui.is_any_item_active()
        if imgui.is_item_deactivated_after_edit() or lets_go:
            widget.change(self._held.pop(widget.key, new))

    def _drawn(self, widget: Widget, value: Any) -> tuple[bool, Any]:
        """(whether a hand changed it, its value now)."""
        label = f"{widget.label}##{widget.key}"
        match widget.kind:
            case "flag":
                ticked, flag = imgui.checkbox(label, value)
                return bool(ticked), flag
            case "choice":
                at = widget.choices.index(value)
                changed, index = imgui.combo(label, at, [_short(c) for c in widget.choices])
                return changed, widget.choices[index]
            case "button":
                return bool(imgui.button(label)), None
            case "number" | "whole" | "text":
                return _slid(widget, label, value)
            case "vector":
                drag = imgui.drag_float3 if len(value) == 3 else imgui.drag_float2
                changed, numbers = drag(label, list(value), widget.step, format="%.3g")
                return changed, tuple(float(v) for v in numbers)
            case "colour":
                flags = imgui.ColorEditFlags_.float | imgui.ColorEditFlags_.no_inputs
                changed, colour = imgui.color_edit3(label, list(value), flags)
                return changed, tuple(min(max(float(c), 0.0), 1.0) for c in colour)
            case "sky":
                return sky_pad(label, value)
            # Bars, charts and notes are only looked at.
            case "bar":
                imgui.progress_bar(value[0], (-1.0, 0.0), value[1])
            case "chart":
                self._charts.draw(widget.key, value)
            case "note":
                _wrapped(value, FAINT)
        return False, value


class Charts:
    """Images in the panel, as textures that imgui knows."""

    def __init__(self, gpu: Gpu, backend: Any) -> None:
        self.gpu, self._backend = gpu, backend
        self._known: dict[str, tuple[Any, Texture, Any]] = {}

    def draw(self, key: str, image: Any) -> None:
        """An image (h, w, 3) uint8 at its size."""
        height, width = image.shape[:2]
        known = self._known.get(key)
        # An image that is the same object is on the device already.
        if known is None or known[0] is not image:
            if known is not None:
                self._backend.unregister_texture(known[2])
                known[1].release()
            texture = Texture(self.gpu, "chart", (width, height), "rgba8unorm")
            texture.write(np.dstack([image, np.full((height, width), 255, np.uint8)]))
            known = (image, texture, self._backend.register_texture(texture.resource))
            self._known[key] = known
        imgui.image(known[2], (float(width), float(height)))


def tip(text: str) -> None:
    """What hovering over the last widget shows."""
    if text and imgui.is_item_hovered(imgui.HoveredFlags_.delay_short):
        imgui.set_tooltip(text)


def _wrapped(text: str, colour: tuple[float, float, float, float]) -> None:
    imgui.push_style_color(imgui.Col_.text, colour)
    imgui.text_wrapped(text)
    imgui.pop_style_color()


def _short(choice: str) -> str:
    """A path by its name: the folder is the same for all of them."""
    return choice.rsplit("/", 1)[-1]


def _help(width: float, height: float) -> None:
    """What mouse and keys do, in the middle of the image, until ? is pressed again."""
    imgui.set_next_window_pos((width / 2.0, height / 2.0), imgui.Cond_.always, (0.5, 0.5))
    flags = imgui.WindowFlags_.always_auto_resize | imgui.WindowFlags_.no_inputs
    imgui.begin("help", None, flags | imgui.WindowFlags_.no_title_bar)
    for hand, does in HELP:
        imgui.text_colored(ACCENT, hand)
        imgui.same_line(190.0)
        imgui.text(does)
    imgui.end()


def _slid(widget: Widget, label: str, value: Any) -> tuple[bool, Any]:
    """A slider where both ends are known (control-click types a number), else a field."""
    # Typed numbers are clamped, too, as a setting out of range would stop rendering.
    flags = imgui.SliderFlags_.always_clamp
    if widget.is_logarithmic:
        flags |= imgui.SliderFlags_.logarithmic
    low, high = widget.low, widget.high
    # Without both ends there is nothing to slide between.
    if widget.kind == "text" or low is None or high is None:
        text = f"{value:g}" if isinstance(value, float) else str(value)
        changed, new = imgui.input_text(label, text)
        return bool(changed), new
    if widget.kind == "whole":
        whole, count = imgui.slider_int(label, value, int(low), int(high), "%d", flags)
        return bool(whole), count
    slid, number = imgui.slider_float(label, value, low, high, "%.4g", flags)
    return bool(slid), number
