"""Meshes where they are placed, and glowing textures that Mitsuba can or cannot map."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.reference.mitsuba_files import FileStore
from airlight.reference.mitsuba_shapes import _emission_parts, mesh_shapes
from airlight.scene import Geometry, Material, Mesh, Texture
from airlight.scene.mesh import in_world
from airlight.scene.shapes import box, quad


def screen(scale: float = 1.0, copies: int = 1) -> Geometry:
    base = quad()
    indices = np.concatenate([base.indices + 4 * k for k in range(copies)])
    return Geometry(
        np.tile(base.positions, (copies, 1)),
        indices,
        normals=np.tile(base.normals, (copies, 1)),
        uvs=np.tile(base.uvs * np.float32(scale), (copies, 1)),
    )


PIXELS = np.zeros((4, 4, 4), np.uint8)
PIXELS[:, :2, :3], PIXELS[..., 3] = 255, 255  # the left half glows
GLOW = Material(emission=(2, 4, 6), emission_texture=Texture(PIXELS), base_color=(0, 0, 0))


def test_a_screen_keeps_its_image() -> None:
    (part,) = _emission_parts(GLOW, screen(), notes := [])
    assert part.texture is GLOW.emission_texture and part.radiance == (2, 4, 6) and not notes


@pytest.mark.parametrize("geometry", [screen(scale=3.0), screen(copies=2), screen(copies=7)])
def test_repeated_or_overlapping_textures_become_means(geometry: Geometry) -> None:
    parts = _emission_parts(GLOW, geometry, notes := [])
    assert len(notes) == 1 and "repeats or overlaps" in notes[0]
    assert all(part.texture is None for part in parts)
    power = sum(part.triangles.sum() * np.array(part.radiance) for part in parts)
    np.testing.assert_allclose(power / len(geometry.indices), (1, 2, 3), rtol=0.12)


def test_both_sides_of_a_sheet_glow_unless_it_has_one(tmp_path) -> None:
    two = mesh_shapes(Mesh(quad(), GLOW), 10.0, FileStore(tmp_path, "."), [])
    assert [shape.get("id")[-6:] for shape in two] == ["_front", "1_back"]
    single = Material(emission=(1, 1, 1), two_sided=False)
    (one,) = mesh_shapes(Mesh(quad(), single), 10.0, FileStore(tmp_path, "."), [])
    assert one.get("id") == "mesh_0"


def test_an_absent_surface_is_no_shape(tmp_path) -> None:
    gone = Material(alpha=0.1, alpha_cutoff=0.5)
    assert mesh_shapes(Mesh(quad(), gone), 1.0, FileStore(tmp_path, "."), []) == []


def test_mirrored_and_flattened_placements_stay_finite() -> None:
    for diagonal in ([-1, 1, 1, 1], [2, 0, 1, 1]):
        placed = in_world(Mesh(box(), Material(), np.diag(np.array(diagonal, np.float64))))
        assert np.isfinite(placed.normals).all() and np.isfinite(placed.positions).all()


def test_copies_share_a_file_and_keep_their_places(tmp_path) -> None:
    geometry, files = box(), FileStore(tmp_path, ".")
    turned = np.array([[0.6, 0, 0.8, 1], [0, 2, 0, 2], [-0.8, 0, 0.6, 3], [0, 0, 0, 1.0]])
    shapes = [
        mesh_shapes(Mesh(geometry, Material(), m), 1.0, files, [])[0] for m in (np.eye(4), turned)
    ]
    names = [shape.find("string[@name='filename']").get("value") for shape in shapes]
    assert names[0] == names[1] and shapes[0].find("transform") is None
    values = [float(v) for v in shapes[1].find("transform/matrix").get("value").split()]
    np.testing.assert_allclose(np.reshape(values, (4, 4)), turned, rtol=1e-11)


def test_what_is_mirrored_or_glows_is_written_in_world_space(tmp_path) -> None:
    mirror = np.diag([-1.0, 1.0, 1.0, 1.0])
    moved = np.eye(4)
    moved[:3, 3] = 1.0
    for mesh in (Mesh(box(), Material(), mirror), Mesh(quad(), GLOW, moved)):
        for shape in mesh_shapes(mesh, 1.0, FileStore(tmp_path, "."), []):
            assert shape.find("transform") is None
