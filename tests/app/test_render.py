"""`airlight render`: options reach the renderer, mistakes are caught before any work."""

from __future__ import annotations

import json

import numpy as np
import PIL.Image
import pytest

import airlight.rendering
from airlight.app import cli, render
from airlight.errors import DeviceError
from airlight.scene import Scene
from airlight.scene.image import Image
from airlight.scene.io import load

SCENE = '[[mesh]]\nshape = "box"\n[[light]]\ntype = "point"\nposition = [0, 2, 0]\nintensity = 3\n'


@pytest.fixture
def scene_file(tmp_path):
    path = tmp_path / "box.toml"
    path.write_text(SCENE)
    return str(path)


@pytest.fixture
def calls(monkeypatch):
    """What the command asked the renderer for; the image is grey."""
    asked: list[dict] = []

    def grey(scene: Scene, **options) -> Image:
        options["progress"]("solve", 0.5)
        options["progress"]("solve", 1.0)
        asked.append({"scene": scene, **options})
        width_px, height_px = options["size"]
        return Image(
            np.full((height_px, width_px, 3), 0.18, np.float32),
            layers={"direct": np.full((height_px, width_px, 3), 0.18, np.float32)},
            stats={"device": "none", "lattice": np.int64(32)},
        )

    monkeypatch.setattr(airlight.rendering, "render", grey)
    return asked


def test_every_option_reaches_the_renderer(scene_file, tmp_path, calls, capsys):
    out, stats = tmp_path / "box.exr", tmp_path / "stats.json"
    code = cli.run(
        [
            "render",
            scene_file,
            "-o",
            str(out),
            "--technique",
            "lpv",
            "--size",
            "8x4",
            "--samples",
            "3",
            "-D",
            "resolution=16",
            "--layers",
            "--stats",
            str(stats),
            "--adapter",
            "cpu",
        ]
    )
    assert code == 0
    (call,) = calls
    assert call["scene"].name == "box"
    assert call["technique"] == "lpv"
    assert call["size"] == (8, 4)
    assert call["samples"] == 3
    assert call["settings"] == {"resolution": "16"}
    assert call["adapter"] == "cpu"
    assert call["timed"] is True
    streams = capsys.readouterr()
    assert streams.out == f"{out}\n"
    assert "loading ...\nsolve ...\nwriting ...\n" in streams.err

    written = json.loads(stats.read_text())
    assert written["device"] == "none"
    assert written["lattice"] == 32
    assert 0.0 < written["load_s"] <= written["first_image_s"]


def test_defaults(scene_file, tmp_path, calls):
    assert cli.run(["render", scene_file, "-o", str(tmp_path / "a.png"), "-q"]) == 0
    (call,) = calls
    assert (call["technique"], call["size"], call["adapter"]) == ("auto", (1280, 720), "auto")
    assert "samples" not in call
    assert call["timed"] is False
    assert PIL.Image.open(tmp_path / "a.png").size == (1280, 720)


def test_the_adapter_switch_is_the_default(scene_file, tmp_path, calls, monkeypatch):
    monkeypatch.setenv("AIRLIGHT_ADAPTER", "gpu")
    assert cli.run(["render", scene_file, "-o", str(tmp_path / "a.png"), "--size", "4x4"]) == 0
    assert calls[0]["adapter"] == "gpu"


def test_exposure_brightens_the_display_and_layers_stay_out_unasked(scene_file, tmp_path, calls):
    from airlight.scene.io.images import load_image

    for name, options in {"dark.png": [], "bright.png": ["--exposure", "2"], "a.exr": []}.items():
        arguments = ["render", scene_file, "-o", str(tmp_path / name), "--size", "4x4", "-q"]
        assert cli.run([*arguments, "--tone-map", "neutral", *options]) == 0
    dark, bright = (
        np.asarray(PIL.Image.open(tmp_path / name)).mean() for name in ("dark.png", "bright.png")
    )
    assert bright > dark + 20
    exr = load_image(tmp_path / "a.exr")
    np.testing.assert_allclose(exr.radiance, 0.18)
    assert not exr.layers


def test_exposure_auto_leaves_the_exposure_to_the_image(scene_file, tmp_path, calls):
    for option, stops in (("auto", None), ("2", 2.0)):
        out = str(tmp_path / "a.png")
        assert (
            cli.run(["render", scene_file, "-o", out, "--size", "4x4", "--exposure", option]) == 0
        )
        assert calls[-1]["scene"].camera.exposure_stops == stops


MISTAKES = [
    (
        ["-o", "{out}/a.bmp"],
        "error: {out}/a.bmp: cannot write an image that ends in '.bmp'. "
        "End its name in one of .exr, .hdr, .png, .jpg, .jpeg.",
    ),
    (
        ["-o", "{out}/gone/a.png"],
        "error: {out}/gone/a.png: the folder '{out}/gone' does not exist. Create it first.",
    ),
    (["-o", "{out}/folder.png"], "error: {out}/folder.png: this is a folder, not a file"),
    (
        ["-o", "{out}/a.png", "--layers"],
        "error: {out}/a.png: --layers needs an .exr, .png holds one image",
    ),
    (
        ["-o", "{out}/a.exr", "--stats", "{out}/a.exr"],
        "error: {out}/a.exr: two outputs of the command are one file",
    ),
    (
        ["-o", "{out}/a.png", "--stats", "{out}/gone/s.json"],
        "error: {out}/gone/s.json: the folder '{out}/gone' does not exist. Create it first.",
    ),
    (["-o", "{out}/a.png", "-t", "lpw"], "error: unknown technique 'lpw'. Did you mean 'lpv'?"),
    (
        ["-o", "{out}/a.png", "-t", "lpv", "-D", "resolutoin=3"],
        "error: technique lpv: unknown setting 'resolutoin'. Did you mean 'resolution'?",
    ),
    (["-o", "{out}/a.png", "--size", "0x5"], "'0x5' is outside 1x1 to 16384x16384"),
    (["-o", "{out}/a.png", "--size", "99999999999999999999x5"], "is outside 1x1 to 16384x16384"),
    (["-o", "{out}/a.png", "--size", "12"], "'12' is not a size such as 1280x720"),
    (["-o", "{out}/a.png", "--size", "-3x4"], "'-3x4' is not a size such as 1280x720"),
    (["-o", "{out}/a.png", "-D", "resolution"], "'resolution' is not written as key=value"),
    (["-o", "{out}/a.png", "--samples", "0"], "0 is not in the range 1<=x<=4096"),
    (["-o", "{out}/a.png", "--tone-map", "flat"], "'flat' is not one of"),
    ([], "Missing option '-o' / '--output'"),
]


@pytest.mark.parametrize(("options", "expected"), MISTAKES, ids=[m[1][:60] for m in MISTAKES])
def test_mistakes_are_found_before_any_work(
    options, expected, scene_file, tmp_path, calls, capsys, monkeypatch
):
    monkeypatch.setattr(render, "load_scene", lambda _: pytest.fail("the scene was loaded"))
    out = tmp_path / "out"
    (out / "folder.png").mkdir(parents=True)
    code = cli.run(["render", scene_file, *(option.format(out=out) for option in options)])
    err = capsys.readouterr().err
    assert code == 2
    assert expected.format(out=out) in err
    assert "Traceback" not in err
    assert calls == []
    assert sorted(path.name for path in out.iterdir()) == ["folder.png"]


def test_a_failing_renderer_leaves_no_partial_file(scene_file, tmp_path, monkeypatch, capsys):
    from airlight.errors import DeviceError

    def no_driver(scene, **options):
        raise DeviceError("no graphics driver was found", remedy="Install one")

    monkeypatch.setattr(airlight.rendering, "render", no_driver)
    assert cli.run(["render", scene_file, "-o", str(tmp_path / "a.png")]) == 2
    assert "error: no graphics driver was found. Install one\n" in capsys.readouterr().err
    assert sorted(path.name for path in tmp_path.iterdir()) == ["box.toml"]


def test_an_interrupted_render_leaves_no_partial_file(scene_file, tmp_path, monkeypatch):
    def interrupted(scene, **options):
        raise KeyboardInterrupt

    monkeypatch.setattr(airlight.rendering, "render", interrupted)
    assert cli.run(["render", scene_file, "-o", str(tmp_path / "a.png")]) == 130
    assert sorted(path.name for path in tmp_path.iterdir()) == ["box.toml"]


def test_warnings_of_the_scene_are_shown(tmp_path, calls, capsys):
    np.save(tmp_path / "smoke.npy", np.ones((2, 2, 2), np.float32))
    (tmp_path / "smoke.toml").write_text('[[volume]]\nfile = "smoke.npy"\nsigma_t = 1\n')
    arguments = ["render", str(tmp_path / "smoke.toml"), "-o", str(tmp_path / "a.png")]
    assert cli.run([*arguments, "--size", "4x4"]) == 0
    assert "warning: smoke.npy does not say where it is" in capsys.readouterr().err


def test_an_image_of_what_is_no_number_is_doubted(tmp_path, capsys, monkeypatch):
    empty = Image(np.full((4, 4, 3), np.nan, np.float32))
    monkeypatch.setattr(airlight.rendering, "render", lambda scene, **options: empty)
    arguments = ["render", "builtin:cornell", "-o", str(tmp_path / "a.png"), "--size", "4x4"]
    assert cli.run(arguments) == 0
    assert "warning: 16 of 16 pixels are NaN or infinite" in capsys.readouterr().err


def test_the_help_names_every_technique(capsys):
    from airlight.techniques import TECHNIQUES

    assert cli.run(["render", "--help"]) == 0
    told = "".join(capsys.readouterr().out.split())  # names are broken at their hyphens
    assert all(name in told for name in [*TECHNIQUES, "auto"])


def test_the_first_image_is_timed_before_the_timing_frames():
    finished_s: list[float] = []
    seen: list[tuple[str, float]] = []
    report = render._stamped(lambda *call: seen.append(call), finished_s)
    report("render", 0.5)
    assert finished_s == []
    report("render", 1.0)
    assert len(finished_s) == 1
    assert seen == [("render", 0.5), ("render", 1.0)]


def test_a_time_is_that_of_the_scenes_animation(scene_file, tmp_path, calls, capsys):
    out = str(tmp_path / "a.png")
    assert cli.run(["render", scene_file, "-o", out, "--time", "1", "-q"]) == 2
    assert capsys.readouterr().err == "error: nothing moves in 'box'. Leave --time out.\n"
    keys = "".join(f"[[light.key]]\ntime_s = {t}\nintensity = {t}\n" for t in (1, 3))
    moving = tmp_path / "moving.toml"
    moving.write_text(SCENE + keys)
    assert cli.run(["render", str(moving), "-o", out, "--time", "1.5", "-q"]) == 0
    assert calls[-1]["time"] == 1.5


def test_an_image_at_a_time_is_that_frame_of_a_sequence(tmp_path):
    small = {"resolution": 8, "shadow_resolution": 64, "sky_lights": 0, "surfels": 2000}
    moving = tmp_path / "moving.toml"
    moving.write_text(
        SCENE + "[[light.key]]\ntime_s = 0\nintensity = 1\n[[light.key]]\n"
        "time_s = 2\nintensity = 9\n"
    )
    scene = load(moving)
    try:
        image = airlight.rendering.render(
            scene, "direct", (16, 9), settings=small, samples=2, time=1.5
        )
    except DeviceError as error:
        pytest.skip(str(error))
    with airlight.rendering.Renderer(scene, "direct", (16, 9), settings=small) as renderer:
        renderer.frame(time=0.25, samples=2)
        frame = renderer.frame(time=1.5, samples=2)
        other = renderer.frame(time=0.25, samples=2)
    assert np.array_equal(image.radiance, frame.radiance)
    assert image.radiance.max() > 1.5 * other.radiance.max()
