"""The panel's sections, as the session stands: technique, time, image, camera, passes, export."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from ...maths.tone import TONE_CURVES
from ...scene.io.volumes import UPRIGHT_SUFFIXES
from ...techniques import TECHNIQUES, settings_class
from .air_section import air
from .document import reach_m
from .panel import Control, checked, controls, shown_value
from .save import Saver
from .scene_sections import lights, sky
from .session import Session
from .widgets import Section, Widget

NONE = "none"
UNITS = {
    "micrometres": 1e-6,
    "millimetres": 1e-3,
    "centimetres": 1e-2,
    "inches": 0.0254,
    "feet": 0.3048,
    "metres": 1.0,
    "kilometres": 1e3,
}
"""Of models and grids, metres."""


def sections(session: Session, saver: Saver) -> list[Section]:
    """All that a person at the viewer can change, in the order in which it is asked for."""
    state = session.state
    # In the order in which a person asks: how it is lit, by what, how it looks, what it costs.
    found = [
        Section("technique", tuple(_technique(session))),
        Section("settings", tuple(_settings(session)), is_open=False),
        Section("lights", tuple(lights(state))),
        Section("sky", tuple(sky(state)), is_open=False),
        Section("air", tuple(air(state)), is_open=bool(state.scene.volumes)),
        Section("image", tuple(_image(session))),
        Section("camera", tuple(_camera(session)), is_open=False),
        Section("scene and files", tuple(_files(session, saver))),
        Section("time of passes", tuple(_passes(session)), is_open=False),
    ]
    if state.scene.animation is not None:
        found.insert(1, Section("time", tuple(_time(session))))
    notes = state.scene.warnings
    if notes:
        widgets = tuple(Widget(f"note.{i}", "note", "", text) for i, text in enumerate(notes))
        found.append(Section(f"notes on the file ({len(notes)})", widgets, is_open=False))
    return [section for section in found if section.widgets]


def _technique(session: Session) -> Iterator[Widget]:
    state = session.state

    def choose(name: str) -> None:
        state.technique = name

    def compare(name: str) -> None:
        state.compared = "" if name == NONE else name

    names = tuple(TECHNIQUES)
    yield Widget("technique", "choice", "technique", state.technique, choose, choices=names)
    yield Widget(
        "compared",
        "choice",
        "compare with",
        state.compared or NONE,
        compare,
        choices=(NONE, *names),
        tip="Another technique's image of the same view, right of a line that you can drag",
    )


def _settings(session: Session) -> Iterator[Widget]:
    state = session.state
    # Settings of the scene, under those chosen here.
    given = {**state.scene.settings.get(state.technique, {}), **state.chosen_settings}
    for control in controls(settings_class(state.technique, state.scene)):
        yield Widget(
            f"setting.{state.technique}.{control.name}",
            control.kind,
            control.label,
            shown_value(control, given),
            _setter(session, control),
            control.low,
            control.high,
            control.is_logarithmic,
            control.choices,
            control.tip,
            waits=True,
        )

    def forget(_: Any) -> None:
        state.settings.pop(state.technique, None)

    yield Widget("settings.reset", "button", "as in the file", None, forget)


def _setter(session: Session, control: Control) -> Callable[[Any], None]:
    state = session.state

    def put(value: Any) -> None:
        settings = settings_class(state.technique, state.scene)
        # An empty field means the default.
        if value == "" and control.kind == "text":
            value = control.default
        try:
            chosen = checked(settings, state.chosen_settings, control.name, value)
        except Exception as error:  # of the value: said, not raised
            state.message = str(error)
            return
        state.settings[state.technique] = chosen

    return put


def _image(session: Session) -> Iterator[Widget]:
    state, look = session.state, session.state.look

    def put(name: str) -> Callable[[Any], None]:
        def change(value: Any) -> None:
            state.look = replace(state.look, **{name: value})

        return change

    def meter(is_metered: bool) -> None:
        state.look = replace(state.look, exposure_stops=None if is_metered else 0.0)

    # Another technique may lack the layer that is looked at.
    layers = session.layers
    at = look.layer if look.layer in layers else layers[0]
    is_metered = look.exposure_stops is None
    yield Widget("layer", "choice", "layer", at, put("layer"), choices=layers)
    yield Widget("metered", "flag", "exposure from the image", is_metered, meter)
    # A slider only where the image does not set the exposure.
    if look.exposure_stops is not None:
        stops = put("exposure_stops")
        yield Widget("stops", "number", "exposure (stops)", look.exposure_stops, stops, -8.0, 8.0)
    curves = tuple(TONE_CURVES)
    yield Widget("curve", "choice", "tone curve", look.curve, put("curve"), choices=curves)


def _time(session: Session) -> Iterator[Widget]:
    state, animation = session.state, session.state.scene.animation
    assert animation is not None

    def play(value: bool) -> None:
        state.is_playing = value

    def seek(value: float) -> None:
        state.time_s = value

    yield Widget("play", "flag", "play", state.is_playing, play)
    ends = (animation.start_s, animation.last_s)
    yield Widget("time", "number", "time (s)", state.time_s, seek, *ends)
    # Files of a sequence, or a file's times, by their number.
    steps, first_s, per_s = animation.steps
    if steps > 1:
        at = min(int((state.time_s - first_s) * per_s + 1e-6), steps - 1) + 1

        def step(number: int) -> None:
            state.time_s = first_s + (number - 1) / per_s

        yield Widget("step", "whole", f"step, of {steps}", at, step, 1, steps)


def _camera(session: Session) -> Iterator[Widget]:
    hands, scene = session.controls, session.state.scene
    camera, span = hands.camera, hands.reach_m

    def put(name: str) -> Callable[[Any], None]:
        def change(value: Any) -> None:
            hands.camera = replace(hands.camera, **{name: value})

        return change

    def fly(mode: str) -> None:
        hands.is_flying = mode == "fly"

    def reach(value: float) -> None:
        hands.reach_m = value

    mode = "fly" if hands.is_flying else "orbit"
    yield Widget("drags", "choice", "drags", mode, fly, choices=("orbit", "fly"))
    yield Widget("home", "button", "back to the scene's", None, lambda _: hands.reset())
    yield Widget("fov", "number", "field of view", camera.fov_y_deg, put("fov_y_deg"), 5.0, 120.0)
    wide = put("aperture_m")
    yield Widget(
        "aperture", "number", "aperture (m)", camera.aperture_m, wide, 0.0, 0.1 * span, True
    )
    # A camera without a focus of its own is sharp at its target.
    focus = camera.focus_m or float(np.linalg.norm(np.subtract(camera.target, camera.position)))
    yield Widget("focus", "number", "focus (m)", focus, put("focus_m"), 1e-3 * span, span, True)
    yield Widget("steps", "number", "size of steps", span, reach, 1e-2, 1e4, True)
    own = reach_m(scene)
    yield Widget("steps.own", "button", "steps as the scene", None, lambda _: reach(own))


def _files(session: Session, saver: Saver) -> Iterator[Widget]:
    names = session.source.places()
    here = names[0]
    yield Widget(
        "scene",
        "choice",
        "scene",
        here,
        session.open,
        choices=names,
        tip="Shipped scenes, and files beside the one that was opened. A file that is dropped on "
        "the image is opened, too: a scene, a model, or an environment map",
    )
    yield from _placing(session)
    if saver.can_ask:
        yield Widget("ask", "button", "open ...", None, lambda _: saver.ask())
    yield Widget("undo", "button", "undo", None, lambda _: session.undo(), tip="control-z")
    yield Widget(
        "redo", "button", "redo", None, lambda _: session.redo(), tip="control-y", beside=True
    )
    yield from _saves(saver)


def _placing(session: Session) -> Iterator[Widget]:
    """Which axis is up and how long the unit is, where the file leaves that open."""
    source = session.source
    if "up" in source.left_open:
        # The first axis of a grid without names stands for the height.
        usual = "z" if Path(source.name).suffix.lower() in UPRIGHT_SUFFIXES else "y"
        at = source.model.get("up") or usual
        yield Widget(
            "up",
            "choice",
            "axis that is up",
            at,
            lambda up: session.read_as(up=up),
            choices=("y", "z"),
            tip="The file does not say it; --up of the command line",
        )
    if "scale" in source.left_open:
        scale = float(source.model.get("scale", 1.0))
        units = UNITS if scale in UNITS.values() else {f"{scale:g} m": scale, **UNITS}
        name = next(name for name, metres in units.items() if metres == scale)
        yield Widget(
            "unit",
            "choice",
            "its unit",
            name,
            lambda name: session.read_as(scale=units[name]),
            choices=tuple(units),
            tip="How long 1 is in the file; --scale METRES of the command line",
        )


def _saves(saver: Saver) -> Iterator[Widget]:
    def save(suffix: str) -> Callable[[Any], None]:
        def saved(_: Any) -> None:
            saver.save_image(suffix)

        return saved

    def save_scene(_: Any) -> None:
        saver.save_scene()

    yield Widget("png", "button", "PNG", None, save(".png"))
    yield Widget("exr", "button", "EXR with layers", None, save(".exr"), beside=True)
    if saver.can_copy:
        copy = "copy as scene file"
        yield Widget("copy", "button", copy, None, lambda _: saver.copy_scene())
    beside = saver.can_copy
    yield Widget("save", "button", "save scene file", None, save_scene, beside=beside)


def _passes(session: Session) -> Iterator[Widget]:
    state = session.state

    def measure(value: bool) -> None:
        state.shows_times = value

    yield Widget("times", "flag", "measure", state.shows_times, measure)
    if not state.shows_times:
        return
    # The longest first, each by its share of them all.
    times = sorted(session.times_ms.items(), key=lambda item: -item[1])
    whole = sum(ms for _, ms in times) or 1.0
    for name, ms in times:
        yield Widget(f"time.{name}", "bar", "", (ms / whole, f"{name}  {ms:.1f} ms"))
    if session.renderer:
        megabytes = session.gpu.allocated_bytes / 2**20
        device = f"{session.gpu.info.name}, {megabytes:.0f} MiB"
        yield Widget("device", "bar", "", (0.0, device))
