"""Mitsuba's grids of distances as triangles: where its own rays meet them, and what is refused."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np
import pytest

from airlight.errors import SceneError
from airlight.scene.io.mitsuba import load_mitsuba
from airlight.scene.io.mitsuba_sdf import sdf_geometry

SCENE = """<scene version="3.0.0"><sensor type="perspective"/>
<shape type="sdfgrid"><string name="filename" value="d.vol"/>{}
<transform name="to_world"><scale value="2"/></transform></shape></scene>"""


def distances(n=16, radius=0.3):
    z, y, x = np.meshgrid(*[np.linspace(0.0, 1.0, n)] * 3, indexing="ij")
    return np.sqrt((x - 0.5) ** 2 + (y - 0.5) ** 2 + (z - 0.5) ** 2) - radius


def written(folder: Path, values, more="", channels=1):
    nz, ny, nx = values.shape
    head = struct.pack("<3sBiiiii6f", b"VOL", 3, 1, nx, ny, nz // channels, channels, *[0.0] * 6)
    (folder / "d.vol").write_bytes(head + values.astype("<f4").tobytes())
    (folder / "a.xml").write_text(SCENE.format(more))
    return folder / "a.xml"


def test_a_ball_of_distances_is_a_ball(tmp_path):
    mesh, *_ = load_mitsuba(written(tmp_path, distances())).meshes
    from_middle = mesh.geometry.positions - 0.5
    radius = np.linalg.norm(from_middle, axis=1)
    # The trilinear field of 15 cells has its zeros a little further in.
    assert radius.min() > 0.29
    assert radius.max() < 0.3005
    cosine = np.einsum("ij,ij->i", from_middle / radius[:, None], mesh.geometry.normals)
    assert cosine.min() > 0.999
    low, high = mesh.world_bounds
    np.testing.assert_allclose(high - low, 1.2, atol=0.02)


def test_analytic_normals_are_those_of_the_field_in_each_cell(tmp_path):
    more = '<string name="normals" value="analytic"/>'
    mesh, *_ = load_mitsuba(written(tmp_path, distances(), more)).meshes
    from_middle = mesh.geometry.positions - 0.5
    from_middle /= np.linalg.norm(from_middle, axis=1, keepdims=True)
    cosine = np.einsum("ij,ij->i", from_middle, mesh.geometry.normals)
    assert 0.97 < cosine.min() < 0.999
    assert len(mesh.geometry.positions) == 3 * len(mesh.geometry.indices)


def test_flipped_ones_face_in(tmp_path):
    more = '<boolean name="flip_normals" value="true"/>'
    mesh, *_ = load_mitsuba(written(tmp_path, distances(), more)).meshes
    outwards = np.einsum("ij,ij->i", mesh.geometry.positions - 0.5, mesh.geometry.normals)
    assert outwards.max() < 0.0


@pytest.mark.parametrize(
    ("values", "channels", "words"),
    [
        (np.ones((3, 3, 3)), 1, "d.vol: its distances are of one sign"),
        (np.full((3, 3, 3), np.nan), 1, "d.vol: has distances that are NaN or infinite"),
        (np.ones((3, 3, 1)), 1, "d.vol: has 1 channels and 1 x 3 x 3 points"),
        (np.ones((4, 3, 3)), 2, "d.vol: has 2 channels"),
    ],
)
def test_what_is_no_surface_is_refused(tmp_path, values, channels, words):
    with pytest.raises(SceneError, match=words):
        load_mitsuba(written(tmp_path, values, channels=channels))


@pytest.mark.needs("mitsuba")
def test_mitsuba_s_rays_meet_it_there():
    """Down z through many cells: in the median the triangles are within a 370th of a cell."""
    import mitsuba as mi

    mi.set_variant("scalar_rgb")
    values = distances(12) + 0.02 * np.random.default_rng(3).normal(size=(12, 12, 12))
    grid = mi.TensorXf(values[..., None].astype(np.float32))
    theirs = mi.load_dict({"type": "scene", "s": {"type": "sdfgrid", "grid": grid}})
    geometry = sdf_geometry(values.astype(np.float32).astype(np.float64))
    mesh = mi.Mesh("ours", len(geometry.positions), len(geometry.indices))
    params = mi.traverse(mesh)
    params["vertex_positions"] = geometry.positions.ravel()
    params["faces"] = geometry.indices.ravel()
    params.update()
    ours = mi.load_dict({"type": "scene", "s": mesh})
    points = np.random.default_rng(4).uniform(0.3, 0.7, (200, 2))
    depth = np.array(
        [
            [
                float(scene.ray_intersect(mi.Ray3f([x, y, -1.0], [0.0, 0.0, 1.0])).t)
                for x, y in points
            ]
            for scene in (theirs, ours)
        ]
    )
    both = np.isfinite(depth).all(axis=0)
    assert both.mean() > 0.98
    assert np.median(np.abs(depth[0] - depth[1])[both]) < 1.0 / 11.0 / 300.0
