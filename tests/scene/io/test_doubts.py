"""Warnings about what is allowed but hardly meant."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from airlight.scene import Camera, Medium, Scene
from airlight.scene.io import load
from airlight.scene.io.doubts import doubts


def scene(eye_m: float, **medium: object) -> Scene:
    """The Cornell box from `eye_m` before its middle."""
    cornell = load("builtin:cornell")
    middle = np.mean(cornell.bounds, axis=0)
    camera = Camera(tuple(np.add(middle, (0.0, 0.0, eye_m))), tuple(middle))
    return replace(cornell, camera=camera, medium=Medium(**medium))


def test_fog_that_hides_everything_is_doubted():
    (line,) = doubts(scene(200.0, sigma_t=0.05))
    assert line.startswith(
        "the camera looks through 200 m of fog, 10 optical depths: nothing else "
    )
    assert line.endswith("Lengths are metres: scale the mesh, or lower sigma_t")


def test_fog_one_sees_through_is_not():
    assert doubts(scene(20.0, sigma_t=0.05)) == ()
    assert doubts(scene(200.0, sigma_t=(0.5, 0.5, 0.01))) == ()  # blue comes through
    assert doubts(scene(200.0, sigma_t=0.05, bounds=((-1, -1, -1), (1, 1, 1)))) == ()
    assert doubts(load("builtin:foggy-room")) == ()


def test_a_scene_file_in_centimetres_is_doubted_when_it_is_loaded(tmp_path):
    text = '[[mesh]]\nshape = "box"\nscale = 150\n[medium]\nsigma_s = 0.05\n'
    (tmp_path / "a.toml").write_text(text)
    assert "optical depths" in load(tmp_path / "a.toml").warnings[-1]


def test_fog_that_hides_a_room_from_inside_is_doubted():
    """In the foggy room the nearest twentieth of the view is some 2 m away."""
    foggy = load("builtin:foggy-room")
    thick = replace(foggy, medium=Medium(sigma_t=5.0))
    (line,) = doubts(thick)
    assert "optical depths: nothing else" in line
    assert doubts(replace(foggy, medium=Medium(sigma_t=1.0))) == ()
