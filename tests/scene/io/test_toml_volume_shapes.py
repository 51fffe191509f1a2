"""Media in meshes: scene files, Python, and what is written of them."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.app.cli import run
from airlight.errors import SceneError
from airlight.scene import Mesh, Volume
from airlight.scene.io import load
from airlight.scene.shapes import box, sphere

BOX = "".join(f"v {x} {y} {z}\n" for z in (0, 3) for y in (0, 2) for x in (0, 1))
FACES = ("1 3 4 2", "5 6 8 7", "1 2 6 5", "3 7 8 4", "1 5 7 3", "2 4 8 6")


def obj(path, faces=FACES):
    path.write_text(BOX + "".join(f"f {face}\n" for face in faces))
    return path


def volume_of(tmp_path, keys="sigma_t = 2\n", shape="a.obj"):
    (tmp_path / "a.toml").write_text(f'[[volume]]\nshape = "{shape}"\n{keys}')
    scene = load(tmp_path / "a.toml")
    return scene, scene.volumes[0]


def held_m3(volume):
    low, high = np.array(volume.bounds)
    voxel = np.prod((high - low) / volume.density.shape[::-1])
    return float(volume.density.sum(dtype=np.float64)) * voxel


def test_a_mesh_is_filled_with_density_1(tmp_path):
    obj(tmp_path / "a.obj")
    scene, volume = volume_of(tmp_path, "sigma_t = 2\ng = 0.5\nalbedo = 0.9\nemission = 3\n")
    assert held_m3(volume) == pytest.approx(6.0, rel=1e-6)
    assert volume.density.max() == 1 and volume.g == (0.5,) * 3 and volume.albedo == (0.9,) * 3
    assert volume.emission.radiance == (3, 3, 3)
    assert not [text for text in scene.warnings if "open" in text]


@pytest.mark.parametrize(
    ("keys", "extent"),
    [
        ("translate = [10, 0, 0]\n", ((10, 0, 0), (11, 2, 3))),
        ("scale = 2\n", ((0, 0, 0), (2, 4, 6))),
        ("rotate_deg = [0, 90, 0]\n", ((0, 0, -1), (3, 2, 0))),
        ('up = "z"\n', ((0, 0, -2), (1, 3, 0))),
    ],
)
def test_it_is_placed_as_a_mesh_is(tmp_path, keys, extent):
    obj(tmp_path / "a.obj")
    _, volume = volume_of(tmp_path, "sigma_t = 2\n" + keys)
    np.testing.assert_allclose(volume.body.extent, extent, atol=1e-5)
    size = np.ptp(extent, axis=0)
    assert held_m3(volume) == pytest.approx(np.prod(size), rel=1e-6)


def test_an_open_mesh_is_closed_and_told(tmp_path):
    obj(tmp_path / "a.obj", FACES[:-1])
    scene, volume = volume_of(tmp_path)
    assert held_m3(volume) == pytest.approx(6.0, rel=1e-6)
    told = "[[volume]] 1: 'a.obj' is open: its medium ends at lids across its holes (1)"
    assert told in scene.warnings


def test_what_the_mesh_file_itself_says_is_told(tmp_path):
    file = obj(tmp_path / "a.obj")
    file.write_text(file.read_text() + "curv 0 1 1 2\n")
    scene, _ = volume_of(tmp_path)
    (own,) = (text for text in load(file).warnings if "a.obj" in text)
    assert own in scene.warnings


@pytest.mark.parametrize(
    ("shape", "keys", "words"),
    [
        ("cone", "", "shape must be 'box', 'sphere' or the path of a mesh file, not 'cone'"),
        ("a.vdb", "", "'a.vdb' is a density grid. Name it as the file."),
        ("a.fbx", "", "'a.fbx' is no mesh file. Known endings: .obj, "),
        ("none.obj", "", "file 'none.obj' does not exist"),
        ("flat.obj", "", "'flat.obj': the meshes enclose nothing"),
        ("a.obj", "bounds = [[0, 0, 0], [1, 1, 1]]\n", "not of the mesh 'a.obj'. It is where its"),
        ("a.obj", 'grid = "x"\n', "grid belongs to a file, not to a shape"),
        ("a.obj", 'sigma_s_grid = "x"\n', "sigma_s_grid belongs to a file, not to a shape"),
    ],
)
def test_mistakes_are_told(tmp_path, shape, keys, words):
    obj(tmp_path / "a.obj")
    (tmp_path / "flat.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    extinction = "" if "sigma_s" in keys else "sigma_t = 1\n"
    with pytest.raises(SceneError) as caught:
        volume_of(tmp_path, extinction + keys, shape)
    assert "[[volume]] 1" in str(caught.value) and words in str(caught.value)


def test_python_fills_meshes_where_they_stand():
    moved = np.diag([2.0, 2.0, 2.0, 1.0])
    moved[:3, 3] = 5.0
    meshes = [Mesh(sphere()), Mesh(box(), world_from_object=moved)]
    volume = Volume.in_meshes(meshes, sigma_t=3.0, albedo=0.5)
    assert held_m3(volume) == pytest.approx(8.0 + np.pi / 6.0, rel=0.02)
    with pytest.raises(SceneError, match="enclose nothing"):
        Volume.in_meshes([], sigma_t=1.0)


def test_a_scene_file_that_is_written_again_finds_the_mesh(tmp_path):
    obj(tmp_path / "a.obj")
    volume_of(tmp_path, "sigma_t = 2\ntranslate = [1, 0, 0]\n")
    (tmp_path / "sub").mkdir()
    assert run(["convert", str(tmp_path / "a.toml"), str(tmp_path / "sub" / "b.toml")]) == 0
    assert 'shape = "../a.obj"' in (tmp_path / "sub" / "b.toml").read_text()
    again = load(tmp_path / "sub" / "b.toml").volumes[0]
    assert again.body.extent[0][0] == pytest.approx(1.0)


def test_media_of_mitsubas_meshes_become_shapes_of_a_scene_file(tmp_path):
    obj(tmp_path / "a.obj")
    (tmp_path / "a.xml").write_text(
        '<scene version="3.0.0"><sensor type="perspective"/><emitter type="constant"/>'
        '<shape type="obj"><string name="filename" value="a.obj"/><bsdf type="null"/>'
        '<medium type="homogeneous" name="interior"><float name="sigma_t" value="2"/>'
        '<rgb name="albedo" value="0.5, 0.6, 0.7"/></medium></shape></scene>'
    )
    assert run(["convert", str(tmp_path / "a.xml"), str(tmp_path / "b.toml")]) == 0
    assert (tmp_path / "b_volume_1.glb").is_file()
    before, after = (load(tmp_path / name).volumes[0] for name in ("a.xml", "b.toml"))
    assert after.sigma_t == before.sigma_t and after.albedo == pytest.approx(before.albedo)
    np.testing.assert_allclose(after.density, before.density, atol=1e-6)
    np.testing.assert_allclose(after.bounds, before.bounds, atol=1e-6)
