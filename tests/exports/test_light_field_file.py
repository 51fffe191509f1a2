"""Light fields written and read back, as others would read them, and what is refused."""

from __future__ import annotations

import json
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

from airlight.errors import OutputError, SceneError
from airlight.exports.light_field import LatticeLight, LightField, VolumeLight

EXAMPLE = Path(__file__).parents[2] / "examples" / "read_light.mjs"
RNG = np.random.default_rng(5)
SHAPE = (4, 3, 2)


@pytest.fixture
def field() -> LightField:
    cells = LatticeLight(
        origin=(1.0, 2.0, 3.0),
        cell=0.25,
        fade=RNG.random((4, 3)),
        openness=RNG.random((*SHAPE, 6)).astype(np.float32),
        surfaces=RNG.random((*SHAPE, 3, 4)).astype(np.float32),
        walls=RNG.random((*SHAPE, 3)).astype(np.float32),
        air=RNG.random((*SHAPE, 3, 4)).astype(np.float32),
        dead_ends=RNG.integers(0, 64, SHAPE).astype(np.uint8),
    )
    volume = VolumeLight(
        RNG.random((5, 4, 3, 3)).astype(np.float32), np.diag([2.0, 3, 4, 1]), (0.0, 1.0, 9.0)
    )
    return LightField("auto", "a scene", (cells,), (volume,))


@pytest.mark.parametrize("name", ["light.npz", "light"])
def test_what_is_written_reads_back(field, tmp_path, name):
    field.save(tmp_path / name)
    back = LightField.load(tmp_path / name)
    assert (back.technique, back.scene) == ("auto", "a scene")
    (read,), (written,) = back.lattices, field.lattices
    assert (read.origin, read.cell, read.count) == ((1.0, 2.0, 3.0), 0.25, (2, 3, 4))
    for part in ("fade", "surfaces", "air", "openness", "walls", "dead_ends"):
        np.testing.assert_allclose(getattr(read, part), getattr(written, part), rtol=1e-6)
    np.testing.assert_array_equal(back.volumes[0].radiance, field.volumes[0].radiance)
    np.testing.assert_array_equal(back.volumes[0].world_from_unit, np.diag([2.0, 3, 4, 1]))
    assert back.volumes[0].eye == (0.0, 1.0, 9.0)


def test_the_header_is_enough_for_someone_who_does_not_know_us(field, tmp_path):
    field.save(tmp_path / "light")
    header = json.loads((tmp_path / "light" / "header.json").read_text())
    assert header["lattices"][0]["origin_m"] == [1.0, 2.0, 3.0]
    for name, about in header["arrays"].items():
        array = np.load(tmp_path / "light" / f"{name}.npy")
        assert list(array.shape) == about["shape"]
        dtype = "uint8" if name.endswith("dead_ends") else "float32"
        assert array.dtype == about["dtype"] == dtype
        assert about["meaning"]
    # Radiance along +z off the spherical harmonics alone is a + bz.
    sh = np.load(tmp_path / "light" / "lattice0_surfaces.npy")
    y = np.array([0.282095, 0.0, 0.488603, 0.0])
    states = field.lattices[0].surfaces
    np.testing.assert_allclose(sh @ y, states[..., 0] + states[..., 3], rtol=1e-5)


def test_without_a_lattice_there_are_volumes_alone(field, tmp_path):
    LightField("pop", "smoke", (), field.volumes).save(tmp_path / "light.npz")
    back = LightField.load(tmp_path / "light.npz")
    assert back.lattices == ()
    assert len(back.volumes) == 1


def test_what_is_no_light_field_is_refused(field, tmp_path):
    with pytest.raises(SceneError, match=r"nowhere.npz: file not found. Check the path.$"):
        LightField.load(tmp_path / "nowhere.npz")
    (tmp_path / "text.npz").write_text("no")
    with pytest.raises(SceneError, match="not a readable light field"):
        LightField.load(tmp_path / "text.npz")
    np.savez(tmp_path / "other.npz", density=np.ones(3))
    with pytest.raises(SceneError, match="not a readable light field"):
        LightField.load(tmp_path / "other.npz")
    field.save(tmp_path / "light")
    header = tmp_path / "light" / "header.json"
    header.write_text(header.read_text().replace('"version": 1', '"version": 2'))
    with pytest.raises(SceneError, match="not an airlight light field of version 1"):
        LightField.load(tmp_path / "light")


def test_where_it_cannot_be_written_is_said(field, tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(OutputError, match="cannot be made a folder"):
        field.save(tmp_path / "file" / "light")
    with pytest.raises(OutputError, match="does not exist"):
        field.save(tmp_path / "nowhere" / "light.npz")


@pytest.mark.needs(("node", "nodejs"))
def test_javascript_looks_up_what_numpy_does(tmp_path):
    """A lattice that is turned and linear in space, where its own lookup is exact."""
    rng = np.random.default_rng(3)
    count = np.array([5, 4, 6])
    z, y, x = (np.arange(n) + 0.5 for n in count[::-1])
    place = np.stack(np.meshgrid(z, y, x, indexing="ij"), axis=-1)[..., ::-1]
    bands = 2.0 + place @ rng.random((3, 12)) * 0.1  # a stays well above b
    bands = bands.reshape(*count[::-1], 3, 4) * np.array([1.0, 0.2, 0.1, -0.1])
    turned = np.array([[0.6, 0.8, 0.0], [-0.8, 0.6, 0.0], [0.0, 0.0, 1.0]])
    far = np.array([[-99.0] * 3, [1.0] * 3, [99.0] * 3, [1.0] * 3])
    cells = LatticeLight(
        origin=(0.5, -1.0, 2.0),
        cell=0.25,
        fade=far,
        surfaces=bands.astype(np.float32),
        openness=np.ones((*count[::-1], 6), np.float32),
        walls=np.zeros((*count[::-1], 3), np.float32),
        axes=turned,
        rule="linear",
    )
    LightField("lpv", "a", (cells,)).save(tmp_path / "light")
    for normal in (turned[0], turned[1], -turned[2]):
        own = np.array(cells.origin) + 0.25 * np.array([2.3, 1.8, 3.1])
        point = own @ turned
        words = [str(v) for v in (*point, *normal)]
        said = subprocess.run(
            [_node(), EXAMPLE, tmp_path / "light", *words],
            capture_output=True,
            text=True,
            check=True,
        ).stdout
        # Half a cell before the surface, by the first order's formula.
        at = np.array([2.3, 1.8, 3.1]) + 0.5 * turned @ normal
        wanted = 2.0 + at @ np.random.default_rng(3).random((3, 12)) * 0.1
        wanted = wanted.reshape(3, 4) * np.array([1.0, 0.2, 0.1, -0.1])
        along = wanted[:, 1:] @ (turned @ normal)
        expected = np.pi * (wanted[:, 0] - 2.0 / 3.0 * along)
        np.testing.assert_allclose([float(v) for v in said.split()], expected, rtol=1e-4)


def _node() -> str:
    return shutil.which("node") or shutil.which("nodejs") or ""
