"""No command writes over a file that it reads, under whatever name: scenes and all they name."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import PIL.Image
import pytest

from airlight.app.cli import run
from airlight.scene.image import Image
from airlight.scene.io.images import save_image

pytestmark = pytest.mark.skipif(os.name != "posix", reason="links")

SCENE = """
[environment]
file = "sky.exr"
[[mesh]]
file = "wall.obj"
[[mesh]]
file = "tile.gltf"
[[volume]]
sequence = "smoke_*.npy"
sequence_fps = 2
sigma_t = 1.0
[[light]]
type = "points"
file = "sparks.npz"
"""
OBJ = (
    "mtllib wall.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl a\nf 1/1 2/2 3/3\n"
)
GLTF = """{"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
"nodes": [{"mesh": 0}], "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
"accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
"min": [0, 0, 0], "max": [1, 1, 0]}], "bufferViews": [{"buffer": 0, "byteLength": 36}],
"buffers": [{"uri": "tile.bin", "byteLength": 36}]}"""
INPUTS = (
    "s.toml",
    "sky.exr",
    "wall.obj",
    "wall.mtl",
    "brick.png",
    "tile.gltf",
    "tile.bin",
    "smoke_0.npy",
    "smoke_1.npy",
    "smoke_2.npy",
    "sparks.npz",
)
REFUSAL = "the command reads this file, and will not write over it"


@pytest.fixture
def folder(tmp_path) -> Path:
    (tmp_path / "s.toml").write_text(SCENE)
    save_image(Image(np.ones((4, 8, 3), np.float32)), tmp_path / "sky.exr")
    (tmp_path / "wall.obj").write_text(OBJ)
    (tmp_path / "wall.mtl").write_text("newmtl a\nmap_Kd brick.png\n")
    PIL.Image.fromarray(np.zeros((2, 2, 3), np.uint8)).save(tmp_path / "brick.png")
    (tmp_path / "tile.gltf").write_text(GLTF)
    (tmp_path / "tile.bin").write_bytes(np.float32([[0, 0, 0], [1, 0, 0], [0, 1, 0]]).tobytes())
    for k in range(3):
        np.save(tmp_path / f"smoke_{k}.npy", np.full((2, 2, 2), k + 1.0, np.float32))
    sparks = {"positions": np.zeros((1, 3)), "intensities": np.ones((1, 3))}
    np.savez(tmp_path / "sparks.npz", **sparks)
    return tmp_path


@pytest.fixture(autouse=True)
def no_rendering(monkeypatch):
    """A refusal comes before any work."""
    for work in (
        "rendering.render",
        "app.sequence.frames.FrameMaker",
        "app.bench.cli.measured",
        "app.compare.cli.compare_scene",
        "exports.solved.export_lattice",
    ):
        monkeypatch.setattr(
            f"airlight.{work}", lambda *_, **__: pytest.fail("something was rendered")
        )


def contents(folder: Path) -> dict[str, bytes]:
    return {file.name: file.read_bytes() for file in folder.iterdir() if file.is_file()}


@pytest.mark.parametrize("name", INPUTS)
@pytest.mark.parametrize("alias", ["itself", "soft", "hard", "relative"])
def test_statistics_never_replace_an_input(folder, capsys, monkeypatch, name, alias):
    target = folder / name
    if alias == "relative":
        monkeypatch.chdir(folder)
        target = Path("..") / folder.name / name
    elif alias != "itself":
        target = folder / f"{alias}.json"
        getattr(target, "symlink_to" if alias == "soft" else "hardlink_to")(folder / name)
    before = contents(folder)
    words = ["render", str(folder / "s.toml"), "-o", str(folder / "o.png"), "--stats", str(target)]
    assert run(words) == 2
    error = capsys.readouterr().err
    assert f"error: {target}: {REFUSAL}" in error
    assert contents(folder) == before


@pytest.mark.parametrize("name", ["sky.exr", "brick.png"])
def test_images_never_replace_an_input(folder, capsys, name):
    before = contents(folder)
    assert run(["render", str(folder / "s.toml"), "-o", str(folder / name)]) == 2
    assert REFUSAL in capsys.readouterr().err
    assert contents(folder) == before


def command_words(command: str, scene: Path, target: Path) -> list[str]:
    """The command writing to `target`, a link in a folder of its own to what it reads."""
    folder = target.parent
    return {
        "compare": ["compare", str(scene), "-o", str(folder)],
        "sequence": ["sequence", str(scene), "-o", str(folder), "-q"],
        "video": ["sequence", str(scene), "-o", str(target), "-q"],
        "export": ["export-lattice", str(scene), "-o", str(target)],
        "export-folder": ["export-lattice", str(scene), "-o", str(folder)],
        "convert-scene": ["convert", str(scene), str(target)],
        "bench": ["bench", "--scene", str(scene), "-o", str(target), "--quick", "-q"],
    }[command]


@pytest.mark.parametrize(
    ("command", "name"),
    [
        ("compare", "contact_sheet.png"),
        ("compare", "results.json"),
        ("compare", "index.html"),
        ("sequence", "frame-00000.png"),
        ("video", "a.mp4"),
        ("export", "a.npz"),
        ("convert-scene", "a.xml"),
        ("convert-scene", "a.toml"),
    ],
)
@pytest.mark.parametrize("source", ["s.toml", "brick.png", "smoke_2.npy"])
def test_no_command_replaces_an_input(folder, capsys, monkeypatch, command, name, source):
    if command == "video":
        monkeypatch.setattr("airlight.app.sequence.cli.check_video", lambda: None)
    if command == "sequence" and source == "brick.png":
        pytest.skip("a whole frame that is there already is not written")
    out = folder / "out"
    out.mkdir()
    (out / name).symlink_to(folder / source)
    if command == "sequence":  # frames of a sequence that goes on
        monkeypatch.setattr("airlight.app.sequence.folder.FrameFolder.open", lambda *_, **__: None)
    before = contents(folder)
    assert run(command_words(command, folder / "s.toml", out / name)) == 2
    error = capsys.readouterr().err.splitlines()[-1]
    assert error.startswith(f"error: {out / name}: {REFUSAL}")
    assert contents(folder) == before
    assert (out / name).is_symlink()


def test_a_benchmark_never_replaces_its_scene(folder, capsys):
    before = contents(folder)
    words = command_words("bench", folder / "s.toml", folder / "s.toml")
    assert run(words) == 2
    assert REFUSAL in capsys.readouterr().err
    assert contents(folder) == before


def test_an_image_is_not_converted_into_itself(folder, capsys):
    before = contents(folder)
    (folder / "link.png").symlink_to(folder / "brick.png")
    for target in ("brick.png", "link.png", "../" + folder.name + "/brick.png"):
        assert run(["convert", str(folder / "brick.png"), f"{folder}/{target}"]) == 2
        assert REFUSAL in capsys.readouterr().err
    assert contents(folder) == {**before, "link.png": before["brick.png"]}


INCLUDED = """<scene version="3.0.0"><shape type="obj">
<string name="filename" value="{name}"/></shape></scene>"""


def test_a_scene_that_is_converted_loses_nothing_it_includes(folder, capsys):
    (folder / "inner.xml").write_text(INCLUDED.format(name="wall.obj"))
    (folder / "outer.xml").write_text(
        '<scene version="3.0.0"><include filename="inner.xml"/></scene>'
    )
    before = contents(folder)
    assert run(["convert", str(folder / "outer.xml"), str(folder / "inner.xml")]) == 2
    assert REFUSAL in capsys.readouterr().err
    assert contents(folder) == before


@pytest.mark.parametrize("is_input", [True, False])
def test_the_folder_beside_a_mitsuba_scene_is_not_cleared_of_others_files(folder, capsys, is_input):
    beside = folder / "room_files"
    beside.mkdir()
    kept = beside / ("mesh_0000.ply" if is_input else "notes.txt")
    kept.write_text(
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
        "property float z\nelement face 1\nproperty list uchar int vertex_indices\n"
        "end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"
    )
    (folder / "room.toml").write_text(
        '[[mesh]]\nfile = "room_files/mesh_0000.ply"\n' if is_input else '[[mesh]]\nshape = "box"\n'
    )
    before = kept.read_bytes()
    assert run(["convert", str(folder / "room.toml"), str(folder / "room.xml")]) == 2
    assert (REFUSAL if is_input else "holds 'notes.txt'") in capsys.readouterr().err
    assert kept.read_bytes() == before
    assert not (folder / "room.xml").exists()
    kept.unlink()
    (folder / "room.toml").write_text('[[mesh]]\nshape = "box"\n')
    for _ in range(2):  # its own folder is replaced
        assert run(["convert", str(folder / "room.toml"), str(folder / "room.xml")]) == 0


@pytest.mark.parametrize("length", [250, 255, 256, 300])
@pytest.mark.parametrize(
    "words",
    [
        ["render", "builtin:cornell", "-o", "{long}.png"],
        ["render", "builtin:cornell", "-o", "a.png", "--stats", "{long}.json"],
        ["sequence", "builtin:smoke", "-o", "{long}.mp4"],
        ["sequence", "builtin:smoke", "-o", "{long}"],
        ["compare", "builtin:cornell", "-o", "{long}"],
        ["convert", "builtin:cornell", "{long}.xml"],
        ["convert", "builtin:cornell", "{long}.toml"],
        ["export-lattice", "builtin:cornell", "-o", "{long}.npz"],
        ["export-lattice", "builtin:cornell", "-o", "{long}"],
        ["bench", "-o", "{long}.json", "--scene", "none.toml", "-q"],
        ["figure", "clpv-1", "-o", "{long}"],
    ],
)
def test_long_names_are_written_or_one_message(tmp_path, monkeypatch, capsys, length, words):
    monkeypatch.chdir(tmp_path)
    reached = RuntimeError("the work began")

    def stop(*_, **__):
        raise reached

    for work in (
        "rendering.render",
        "app.sequence.cli.make_frames",
        "app.compare.cli.compare_scene",
        "app.figure._draw_all",
        "app.bench.cli.measured",
        "exports.solved.export_lattice",
    ):
        monkeypatch.setattr(f"airlight.{work}", stop)
    monkeypatch.setattr("airlight.app.sequence.cli.check_video", lambda: None)
    ending = next(word.partition("}")[2] for word in words if "{long}" in word)
    name = "x" * (length - len(ending))
    code = run([word.replace("{long}", name) for word in words])
    error = capsys.readouterr().err
    has_begun = "the work began" in error
    assert code == (1 if has_begun else 0 if words[0] == "convert" and "error" not in error else 2)
    assert "Traceback" not in error
    assert not has_begun or length <= 255
    if length > 255:
        assert code == 2
        assert "name too long" in error.lower()
