"""The panel beside the image (imgui): everything that a session can be told."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from imgui_bundle import imgui

from ...maths.tone import TONE_CURVES
from ...techniques import TECHNIQUES, settings_class
from .gui_scene import light_controls, media_controls
from .panel import Control, checked, controls, shown_value
from .save import Saver
from .session import Session, reach_m

PANEL_WIDTH = 330.0
_LEAST_SIDE = 60.0  # of a surface that a panel fits on
_ERROR_COLOUR, _NOTICE_COLOUR = (1.0, 0.45, 0.35, 1.0), (0.55, 0.85, 0.55, 1.0)
_BAR_COLOUR = (0.35, 0.55, 0.8, 1.0)
_HELP = (
    "left drag: turn   right drag: move   wheel: nearer\n"
    "w a s d q e: fly (shift: faster)   f: orbit or fly\n"
    "control-drag, or l and drag: turn the light\n"
    "r: camera back   tab: panel   ?: this help"
)


class Panel:
    """`draw` between imgui's new frame and its rendering."""

    def __init__(self, session: Session, saver: Saver) -> None:
        self.session, self.saver = session, saver
        self.is_shown, self.shows_help = True, False
        self._box = (0.0, 0.0, 0.0, 0.0)
        self._display = (0.0, 0.0)
        self._has_popup = False
        self._held: dict[str, Any] = {}
        style_like_a_darkroom()

    def draw(self) -> None:
        """Build this frame's widgets; what they change is in the session at once."""
        display = imgui.get_io().display_size
        if self.shows_help and min(display.x, display.y) >= _LEAST_SIDE:
            self._help(display.x, display.y)
        if not self.is_shown or min(display.x, display.y) < _LEAST_SIDE:
            self._box, self._has_popup = (0.0, 0.0, 0.0, 0.0), False
            return
        if self._display != (display.x, display.y):
            # Along the left edge, until it is moved by hand.
            self._display = (display.x, display.y)
            imgui.set_next_window_pos((0.0, 0.0))
            imgui.set_next_window_size((min(PANEL_WIDTH, display.x), display.y))
        is_open, _ = imgui.begin(f"airlight - {self.session.state.scene.name}###panel")
        place, size = imgui.get_window_pos(), imgui.get_window_size()
        self._box = (place.x, place.y, place.x + size.x, place.y + size.y)
        if is_open:
            imgui.push_item_width(-165.0)
            self._sections()
            imgui.pop_item_width()
        imgui.end()
        anything = imgui.PopupFlags_.any_popup
        self._has_popup = imgui.is_popup_open("", anything)

    def _help(self, width: float, height: float) -> None:
        """What mouse and keys do, in the middle of the image, until ? is pressed again."""
        imgui.set_next_window_pos((width / 2.0, height / 2.0), imgui.Cond_.always, (0.5, 0.5))
        flags = imgui.WindowFlags_.always_auto_resize | imgui.WindowFlags_.no_inputs
        imgui.begin("help###help", None, flags | imgui.WindowFlags_.no_collapse)
        imgui.text(_HELP)
        imgui.end()

    def covers(self, x: float, y: float) -> bool:
        """Whether the panel, or a list that it opened, takes a click here, in logical pixels.

        imgui itself knows only a frame later, which on a slow machine is after the click.
        """
        left, top, right, bottom = self._box
        return self._has_popup or (left <= x < right and top <= y < bottom)

    def _sections(self) -> None:
        self._status()
        self._technique()
        state = self.session.state
        if state.scene.animation is not None:
            self._time()
        if _header("light"):
            light_controls(state)
        if _header("air"):
            media_controls(state)
        if _header("image"):
            self._look()
        if _header("camera", is_open=False):
            self._camera()
        if _header("time of passes", is_open=state.shows_times):
            self._times()
        elif state.shows_times:
            state.shows_times = False
        if _header("export"):
            self._save()

    def _status(self) -> None:
        session, state = self.session, self.session.state
        for said in (state.message, *session.doubts):
            if said:
                imgui.push_style_color(imgui.Col_.text, _ERROR_COLOUR)
                imgui.text_wrapped(said)
                imgui.pop_style_color()
        if state.notice:
            imgui.push_style_color(imgui.Col_.text, _NOTICE_COLOUR)
            imgui.text_wrapped(f"{state.notice}   {session.progress}".rstrip())
            imgui.pop_style_color()
        if session.renderer is None:
            return
        imgui.text(session.status)
        imgui.same_line()
        imgui.progress_bar(session.share, (-1.0, 0.0), "")
        tip(f"{_HELP}\n{session.fine.message}".strip())

    def _technique(self) -> None:
        state = self.session.state
        names = list(TECHNIQUES)
        changed, index = imgui.combo("technique", names.index(state.technique), names)
        if changed:
            state.technique = names[index]
        if imgui.tree_node("settings"):
            for control in controls(settings_class(state.technique, state.scene)):
                self._setting(control)
            if imgui.button("as in the file"):
                state.settings.pop(state.technique, None)
                self._held.clear()
            imgui.tree_pop()

    def _setting(self, control: Control) -> None:
        state = self.session.state
        given = {**state.scene.settings.get(state.technique, {}), **state.chosen_settings}
        value = shown_value(control, given)
        changed, new = self._widget(control, value)
        tip(control.tip)
        if not changed or new == value:
            return
        own = state.chosen_settings
        try:
            settings = settings_class(state.technique, state.scene)
            state.settings[state.technique] = checked(settings, own, control.name, new)
        except Exception as error:  # of the value: said, not raised
            state.message = str(error)

    def _widget(self, control: Control, value: Any) -> tuple[bool, Any]:
        """(whether it was changed for good, the value). A slider counts when it is let go."""
        label = f"{control.label}##{control.name}"
        if control.kind == "flag":
            changed, new = imgui.checkbox(label, value)
            return changed, new
        if control.kind == "choice":
            choices = list(control.choices)
            changed, index = imgui.combo(label, choices.index(value), choices)
            return changed, choices[index]
        key = f"{self.session.state.technique}.{control.name}"
        changed, held = _slid(control, label, self._held.get(key, value))
        if changed:
            self._held[key] = held
        if imgui.is_item_deactivated_after_edit():
            return True, self._held.pop(key, held)
        return False, value

    def _look(self) -> None:
        state, look = self.session.state, self.session.state.look
        layers = list(self.session.layers)
        at = layers.index(look.layer) if look.layer in layers else 0
        changed, index = imgui.combo("layer", at, layers)
        if changed:
            state.look = replace(look, layer=layers[index])
        is_metered = look.exposure_stops is None
        changed, is_metered = imgui.checkbox("exposure from the image", is_metered)
        if changed:
            state.look = replace(state.look, exposure_stops=None if is_metered else 0.0)
        if not is_metered:
            stops = look.exposure_stops or 0.0
            changed, stops = imgui.slider_float("exposure (stops)", stops, -8.0, 8.0, "%.2f")
            if changed:
                state.look = replace(state.look, exposure_stops=stops)
        curves = list(TONE_CURVES)
        changed, index = imgui.combo("tone curve", curves.index(look.curve), curves)
        if changed:
            state.look = replace(state.look, curve=curves[index])

    def _time(self) -> None:
        state, animation = self.session.state, self.session.state.scene.animation
        assert animation is not None
        _, state.is_playing = imgui.checkbox("play", state.is_playing)
        imgui.same_line()
        changed, time_s = imgui.slider_float(
            "time (s)", state.time_s, animation.start_s, animation.last_s, "%.2f"
        )
        if changed:
            state.time_s = time_s

    def _camera(self) -> None:
        hands = self.session.controls
        if imgui.radio_button("orbit", not hands.is_flying):
            hands.is_flying = False
        imgui.same_line()
        if imgui.radio_button("fly", hands.is_flying):
            hands.is_flying = True
        imgui.same_line()
        if imgui.button("back"):
            hands.reset()
        changed, fov = imgui.slider_float("field of view", hands.camera.fov_y_deg, 5.0, 120.0)
        if changed:
            hands.camera = replace(hands.camera, fov_y_deg=fov)
        self._lens()
        low = -2.0
        changed, speed = imgui.slider_float(
            "size of steps", hands.reach_m, 10.0**low, 1e4, "%.3g", imgui.SliderFlags_.logarithmic
        )
        if changed:
            hands.reach_m = speed
        if imgui.button("steps as the scene"):
            hands.reach_m = reach_m(self.session.state.scene)

    def _lens(self) -> None:
        """Depth of field: at rest the image is a mean over the lens."""
        hands = self.session.controls
        camera, span = hands.camera, hands.reach_m
        focus = camera.focus_m or float(np.linalg.norm(np.subtract(camera.target, camera.position)))
        flags = imgui.SliderFlags_.logarithmic
        opened, aperture = imgui.slider_float(
            "aperture (m)", camera.aperture_m, 0.0, 0.1 * span, "%.3g", flags
        )
        focused, focus = imgui.slider_float("focus (m)", focus, 1e-3 * span, span, "%.3g", flags)
        if opened:
            hands.camera = replace(camera, aperture_m=aperture)
        if focused:
            hands.camera = replace(hands.camera, focus_m=focus)

    def _times(self) -> None:
        session = self.session
        session.state.shows_times = True
        times = sorted(session.times_ms.items(), key=lambda item: -item[1])
        whole = sum(ms for _, ms in times) or 1.0
        imgui.push_style_color(imgui.Col_.plot_histogram, _BAR_COLOUR)
        for name, ms in times:
            imgui.progress_bar(ms / whole, (-1.0, 0.0), f"{name}  {ms:.1f} ms")
        imgui.pop_style_color()
        if session.renderer:
            imgui.text_wrapped(
                ", ".join(f"{k} {v}" for k, v in session.renderer.technique.stats.items())
            )
            megabytes = session.gpu.allocated_bytes / 2**20
            imgui.text(f"{session.gpu.info.name}\n{megabytes:.0f} MiB")

    def _save(self) -> None:
        if imgui.button("PNG"):
            self.saver.save_image(".png")
        imgui.same_line()
        if imgui.button("EXR with layers"):
            self.saver.save_image(".exr")
        if self.saver.can_copy:
            if imgui.button("copy as scene file"):
                self.saver.copy_scene()
            imgui.same_line()
        if imgui.button("save scene file"):
            self.saver.save_scene()


def tip(text: str) -> None:
    """What hovering over the last widget shows."""
    if imgui.is_item_hovered(imgui.HoveredFlags_.delay_short):
        imgui.set_tooltip(text)


def style_like_a_darkroom() -> None:
    """Dark, neutral grey, so that the image's colours are judged by themselves."""
    imgui.style_colors_dark()
    style = imgui.get_style()
    style.window_rounding = style.frame_rounding = style.grab_rounding = 3.0
    for colour, grey, alpha in (
        (imgui.Col_.window_bg, 0.10, 0.92),
        (imgui.Col_.frame_bg, 0.20, 1.0),
        (imgui.Col_.title_bg_active, 0.18, 1.0),
        (imgui.Col_.header, 0.24, 1.0),
        (imgui.Col_.button, 0.28, 1.0),
        (imgui.Col_.slider_grab, 0.60, 1.0),
        (imgui.Col_.check_mark, 0.90, 1.0),
        (imgui.Col_.frame_bg_hovered, 0.27, 1.0),
        (imgui.Col_.header_hovered, 0.32, 1.0),
        (imgui.Col_.button_hovered, 0.38, 1.0),
    ):
        style.set_color_(colour, (grey, grey, grey, alpha))


def _header(name: str, *, is_open: bool = True) -> bool:
    flags = imgui.TreeNodeFlags_.default_open if is_open else imgui.TreeNodeFlags_.none
    return bool(imgui.collapsing_header(f"{name}##section", flags))


def _slid(control: Control, label: str, value: Any) -> tuple[bool, Any]:
    """A slider where both ends are known (control-click types a number), else a field."""
    flags = imgui.SliderFlags_.always_clamp
    if control.is_logarithmic:
        flags |= imgui.SliderFlags_.logarithmic
    low, high = control.low, control.high
    new: Any
    if control.kind == "text" or low is None or high is None:
        text = f"{value:g}" if isinstance(value, float) else str(value)
        changed, new = imgui.input_text(label, text)
    elif control.kind == "whole":
        changed, new = imgui.slider_int(label, value, int(low), int(high), "%d", flags)
    else:
        changed, new = imgui.slider_float(label, value, low, high, "%.4g", flags)
    return changed, new
