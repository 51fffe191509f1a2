"""Media that Mitsuba cannot hold are refused; where boundaries lie."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.errors import ReferenceFailure
from airlight.reference.mitsuba import write_mitsuba
from airlight.reference.mitsuba_boundary import _overlap, _unit_sphere
from airlight.reference.mitsuba_files import FileStore
from airlight.reference.mitsuba_media import medium_bounds, scene_media
from airlight.scene import Camera, Medium, Mesh, Scene, Volume
from airlight.scene.io import load
from airlight.scene.shapes import box


def cube(low: float, high: float, **values) -> Volume:
    return Volume((1, 1, 1), shape="box", bounds=((low,) * 3, (high,) * 3), **values)


def media(scene: Scene, tmp_path):
    return scene_media(scene, FileStore(tmp_path, "."), [])


def test_overlapping_volumes_are_refused(tmp_path) -> None:
    scene = Scene(volumes=(cube(0, 1, source="a.vol"), cube(0.5, 2)))
    with pytest.raises(ReferenceFailure) as caught:
        media(scene, tmp_path)
    assert str(caught.value) == (
        "volumes a.vol and volumes[1] overlap, and Mitsuba knows one medium per point. "
        "Move them apart, or render them one at a time."
    )


def test_a_volume_through_the_bounds_of_the_air_is_refused(tmp_path) -> None:
    air = Medium((1, 1, 1), bounds=((0, 0, 0), (1, 1, 1)))
    with pytest.raises(ReferenceFailure) as caught:
        media(Scene(medium=air, volumes=(cube(0.5, 2),)), tmp_path)
    assert str(caught.value) == (
        "volumes[0] reaches through the bounds of [medium], and Mitsuba knows one medium per "
        "point. Widen the medium's bounds, or leave them out."
    )


def test_touching_volumes_are_not_overlapping(tmp_path) -> None:
    assert len(media(Scene(volumes=(cube(0, 1), cube(1, 2))), tmp_path).mediums) == 2


def test_turned_boxes_overlap_by_their_own_shape() -> None:
    """Two unit cubes, one turned by 45 degrees: apart beyond 0.5 + sqrt(1/2)."""
    signs = np.array(np.meshgrid(*[[-0.5, 0.5]] * 3)).reshape(3, 8).T
    c = np.sqrt(0.5)
    turned = signs @ np.array([[c, c, 0], [-c, c, 0], [0, 0, 1]])
    assert _overlap(signs, turned + np.array([1.19, 0, 0]))
    assert not _overlap(signs, turned + np.array([1.22, 0, 0]))


def test_the_camera_is_in_the_innermost_medium(tmp_path) -> None:
    air = Medium((1, 1, 1), bounds=((-4,) * 3, (4,) * 3))
    ball = Volume((1, 1, 1), shape="sphere", bounds=((-1,) * 3, (1,) * 3))
    for x, expected in ((0.0, "volume_0"), (0.9, "volume_0"), (1.1, "air"), (5.0, "")):
        camera = Camera(position=(x, 0, 0), target=(9, 1, 0))
        assert (
            media(Scene(medium=air, volumes=(ball,), camera=camera), tmp_path).camera_id == expected
        )
    corner = Camera(position=(0.9, 0.9, 0.9), target=(9, 0, 0))  # in the ball's box, not in it
    assert media(Scene(medium=air, volumes=(ball,), camera=corner), tmp_path).camera_id == "air"


def test_air_without_bounds_holds_scene_and_camera() -> None:
    camera = Camera(position=(0, 0, 9), target=(0, 0, 0))
    scene = Scene(meshes=(Mesh(box()),), medium=Medium((1, 1, 1)), camera=camera)
    low, high = medium_bounds(scene)
    assert (low < (-0.5, -0.5, -0.5)).all() and (high > (0.5, 0.5, 9)).all()
    np.testing.assert_allclose(low, -0.5, atol=0.02)


def test_the_meshed_ball_has_a_balls_volume() -> None:
    positions, indices = _unit_sphere(128)
    a, b, c = (positions[indices[:, k]] for k in range(3))
    volume = np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6
    assert volume == pytest.approx(4 / 3 * np.pi, rel=1e-3)


@pytest.mark.parametrize("values", [{}, {"endless": True}, {"endless": True, "top": 2.5}])
def test_air_without_bounds_is_read_back_without_them(tmp_path, values) -> None:
    scene = Scene(meshes=(Mesh(box()),), medium=Medium((0.5, 0.5, 0.5), **values))
    write_mitsuba(scene, tmp_path / "scene.xml")
    air = load(tmp_path / "scene.xml").medium
    assert air is not None and air.bounds is None and air.endless == scene.medium.endless
    if air.endless:
        assert air.top == pytest.approx(values.get("top", 0.75))  # a box of 1 m around 0
