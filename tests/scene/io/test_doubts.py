"""Warnings about what is allowed but hardly meant."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from airlight.scene import Camera, Material, Medium, Mesh, Scene
from airlight.scene.io import load
from airlight.scene.io.doubts import doubts
from airlight.scene.shapes import box


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


def open_scene(eye_y: float = 1.5, **medium: object) -> Scene:
    cube = Mesh(box(), Material())
    return Scene((cube,), camera=Camera((3.0, eye_y, 4.0), (0, 0, 0)), medium=Medium(**medium))


def test_fog_that_ends_before_the_sky_is_doubted():
    (line,) = doubts(open_scene(sigma_t=0.3))
    assert line.endswith("endless = true in [medium] lets it go on")
    assert doubts(open_scene(sigma_t=0.01)) == ()  # thin: nobody sees it end
    assert doubts(open_scene(sigma_t=0.3, bounds=((-2, 0, -2), (2, 1, 2)))) == ()
    # Where walls are all around, fog ends at them.
    assert doubts(scene(0.5, sigma_t=0.3)) == ()


def test_a_camera_above_endless_fog_is_told_where_that_ends():
    (line,) = doubts(open_scene(sigma_t=0.3, endless=True))
    assert line.startswith("the camera is 0.75 m above the fog, which ends at a height of 0.75 m")
    assert doubts(open_scene(sigma_t=0.3, endless=True, top=1.0)) == ()
    assert doubts(open_scene(0.2, sigma_t=0.3, endless=True)) == ()
