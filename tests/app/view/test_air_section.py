"""The panel's widgets of fog: with and without an end."""

from __future__ import annotations

from airlight.app.view.air_section import air
from airlight.app.view.state import ViewState, structure
from airlight.scene import Camera, Medium, Mesh, Scene
from airlight.scene.io.doubts import doubts
from airlight.scene.shapes import box


def test_fog_goes_on_above_scene_and_camera_or_fills_the_scene():
    camera = Camera((3.0, 2.0, 4.0), (0, 0, 0))
    state = ViewState(Scene((Mesh(box()),), camera=camera, medium=Medium(0.3)))
    before = structure(state)
    assert "endless" in doubts(state.scene)[0]
    widgets = {w.key: w for w in air(state)}
    assert widgets["fog.endless"].value is False
    widgets["fog.endless"].change(True)
    fog = state.scene.medium
    assert fog.endless and fog.top == 2.25 and fog.sigma_t == (0.3, 0.3, 0.3)
    # Another renderer draws what is beyond the lattice, and nothing is doubted any more.
    assert structure(state) != before and doubts(state.scene) == ()
    {w.key: w for w in air(state)}["fog.endless"].change(False)
    assert state.scene.medium == Medium(0.3) and structure(state) == before
