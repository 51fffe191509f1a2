"""Light fields written and read back, as others would read them, and what is refused."""

from __future__ import annotations

import json
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

import airlight as al
from airlight.errors import OutputError, SceneError
from airlight.exports.light_field import LatticeLight, LightField, VolumeLight

EXAMPLES = Path(__file__).parents[2] / "examples"
COMPILERS = ("c++", "g++", "clang++")
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


@pytest.fixture(scope="module")
def programs(tmp_path_factory) -> dict[str, list[str | Path]]:
    """Words that run the examples, by language, as far as they can be run here."""
    found = dict[str, list[str | Path]]()
    node = shutil.which("node") or shutil.which("nodejs")
    if node:
        found["javascript"] = [node, EXAMPLES / "read_light.mjs"]
    compiler = next(filter(None, map(shutil.which, COMPILERS)), None)
    if compiler:
        made = tmp_path_factory.mktemp("cpp") / "read_light"
        strict = ("-std=c++17", "-O1", "-Wall", "-Wextra", "-pedantic", "-Werror")
        subprocess.run([compiler, *strict, EXAMPLES / "read_light.cpp", "-o", made], check=True)
        found["c++"] = [made]
    return found


LANGUAGES = [
    pytest.param("javascript", marks=pytest.mark.needs(("node", "nodejs"))),
    pytest.param("c++", marks=pytest.mark.needs(COMPILERS)),
]


def said_by(program: list[str | Path], folder: Path, point, normal) -> list[float]:
    words = [*program, folder, *(str(v) for v in (*point, *normal))]
    done = subprocess.run(words, capture_output=True, text=True, check=True)
    return [float(v) for v in done.stdout.split()]


@pytest.mark.parametrize("language", LANGUAGES)
@pytest.mark.parametrize(
    ("words", "told"),
    [
        ("", "usage: "),
        ("light 1 2 3", "usage: "),
        ("light.npz 1 2 3 0 1 0", "names a folder"),
    ],
)
def test_examples_say_what_they_are_to_be_asked(programs, language, words, told, tmp_path):
    done = subprocess.run(
        [*programs[language], *words.split()], capture_output=True, text=True, cwd=tmp_path
    )
    assert done.returncode == 2 and told in done.stderr and done.stderr.count("\n") == 1


@pytest.mark.parametrize("language", LANGUAGES)
def test_examples_look_up_what_numpy_does(programs, language, tmp_path):
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
        said = said_by(programs[language], tmp_path / "light", point, normal)
        # Half a cell before the surface, by the first order's formula.
        at = np.array([2.3, 1.8, 3.1]) + 0.5 * turned @ normal
        wanted = 2.0 + at @ np.random.default_rng(3).random((3, 12)) * 0.1
        wanted = wanted.reshape(3, 4) * np.array([1.0, 0.2, 0.1, -0.1])
        along = wanted[:, 1:] @ (turned @ normal)
        expected = np.pi * (wanted[:, 0] - 2.0 / 3.0 * along)
        np.testing.assert_allclose(said, expected, rtol=1e-4)


@pytest.mark.parametrize("language", LANGUAGES)
def test_examples_come_near_airlights_own_lookup(gpu, programs, language, tmp_path):
    """Of a solved room: the same where a surface faces an axis between open cells (the back wall),
    within a tenth on the ceiling, where cells end at other places (measured: .92 to 1.05)."""
    folder = tmp_path / "light"
    settings = {"resolution": 12}
    field = al.export_lattice(al.scenes.cornell(), folder, technique="lpv", settings=settings)
    rng = np.random.default_rng(1)
    for place, normal, tolerance in (
        (lambda x, y: (x, y + 2.7, -2.8), (0.0, 0.0, 1.0), 2e-3),
        (lambda x, y: (x, 5.4, y), (0.0, -1.0, 0.0), 0.1),
    ):
        for x, y in rng.uniform(-2.0, 2.0, (4, 2)):
            point = place(x, y)
            own = field.irradiance(np.array([point]), np.array([normal]))[0]
            said = said_by(programs[language], folder, point, normal)
            assert min(own) > 0.05
            np.testing.assert_allclose(said, own, rtol=tolerance)


@pytest.mark.parametrize("language", LANGUAGES)
def test_a_folder_that_holds_no_light_is_refused_in_one_line(programs, language, tmp_path):
    done = subprocess.run(
        [*programs[language], tmp_path, *"000010"], capture_output=True, text=True, check=False
    )
    assert done.returncode == 2
    assert str(tmp_path) in done.stderr and done.stderr.count("\n") == 1


def test_what_is_no_path_is_said_to_be_none():
    with pytest.raises(SceneError, match="a light field's file must be a path, not 3"):
        LightField.load(3)
