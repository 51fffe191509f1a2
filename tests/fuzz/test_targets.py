"""Every loader takes what the fuzzer starts from, and its inputs depend on their numbers alone."""

from __future__ import annotations

import numpy as np
import pytest

from airlight import AreaLight, LightField
from airlight.scene.io import load
from airlight.scene.io.images import load_image
from fuzz import documents, seeds, targets, texts


def good() -> dict[str, bytes]:
    document, binary = documents.gltf()
    document["buffers"][0]["uri"] = documents.embedded(binary)
    files = {
        **documents.SCENE_FILES,
        "thing.gltf": texts.json_text(document),
        "scene.toml": texts.toml_text(documents.scene_table()),
        "scene.xml": documents.XML,
        "part.xml": documents.PART,
        "smoke.vol": seeds.vol(),
        "a.glb": documents.glb_of(texts.json_text(documents.gltf()[0]), binary),
        "a.nvdb": seeds.nvdb(packed=True),
        "b.nvdb": seeds.nvdb(packed=False),
        "a.ply": seeds.ply(),
        "b.ply": seeds.ply(big=True),
        "a.stl": seeds.stl(),
        "b.stl": seeds.STL,
        "a.npz": seeds.npz(density=seeds.smoke()),
    }
    files["a.vdb"] = seeds.vdb()
    return files


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    root = tmp_path_factory.mktemp("good")
    for name, raw in good().items():
        (root / name).parent.mkdir(exist_ok=True)
        (root / name).write_bytes(raw)
    return root


OPENED = [n for n in good() if not n.startswith(("frames", "part", "t.png", "lights", "thing.mtl"))]


@pytest.mark.parametrize("name", OPENED)
def test_the_fuzzer_starts_from_good_scenes(folder, name):
    scene = load(folder / name)
    assert scene.meshes or scene.volumes


def test_the_good_documents_use_much_of_their_format(folder):
    scene = load(folder / "scene.toml")
    assert scene.animation and scene.medium and scene.light_groups and len(scene.volumes) == 3
    scene = load(folder / "thing.gltf")
    assert scene.animation and len(scene.meshes) == 2 and scene.lights
    scene = load(folder / "scene.xml")
    assert scene.medium and scene.environment and len(scene.meshes) == 7
    assert any(isinstance(light, AreaLight) for light in scene.lights)


@pytest.mark.parametrize(
    ("name", "raw"),
    [
        ("a.exr", seeds.exr()),
        ("b.exr", seeds.exr(layers=False, half=True)),
        ("a.hdr", seeds.hdr()),
        ("b.hdr", seeds.hdr(packed=True)),
        ("a.png", seeds.image("PNG", "I;16")),
        ("a.jpg", seeds.image("JPEG", "CMYK")),
        ("b.png", seeds.png_of(seeds.png_chunks(seeds.image("PNG")))),
    ],
)
def test_the_fuzzer_starts_from_good_images(tmp_path, name, raw):
    (tmp_path / name).write_bytes(raw)
    assert load_image(tmp_path / name).radiance.shape[1:] == (8, 3)


def test_the_fuzzer_starts_from_a_good_light_field(tmp_path):
    (tmp_path / "a.npz").write_bytes(seeds.light_field())
    field = LightField.load(tmp_path / "a.npz")
    assert field.lattices[0].count == (2, 2, 2) and len(field.volumes) == 1


def test_a_repacked_grid_is_the_same_grid():
    raw = seeds.nvdb(packed=True)
    assert seeds.nvdb_buffer(seeds.nvdb_repacked(seeds.nvdb_buffer(raw), raw)) == (
        seeds.nvdb_buffer(raw)
    )


@pytest.mark.parametrize("loader", targets.LOADERS)
def test_an_input_is_known_by_its_number(loader):
    cases = [targets.case(loader, 1, number) for number in range(12)]
    assert [targets.case(loader, 1, number) for number in range(12)] == cases
    assert len({tuple(sorted(case.files.items())) for case in cases}) > 6
    assert targets.case(loader, 2, 0) != cases[0]
    assert all(case.main in case.files for case in cases)
    assert np.mean([sum(map(len, case.files.values())) for case in cases]) < 1_000_000
