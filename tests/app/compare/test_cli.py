"""The comparison: its arguments, its cache, its arithmetic and what lands in the folder."""

from __future__ import annotations

import dataclasses
import json
import re
import sys
from html.parser import HTMLParser
from types import ModuleType
from typing import ClassVar

import numpy as np
import PIL.Image
import pytest

from airlight.app import cli
from airlight.app.compare import cli as compare
from airlight.app.compare import images as compare_images
from airlight.app.compare import page as compare_page
from airlight.app.compare import result as compare_result
from airlight.app.compare import style as compare_style
from airlight.app.compare.reference import reference_for, scene_hash
from airlight.errors import ReferenceFailure, SettingsError
from airlight.lighting.kit import SurfaceSettings
from airlight.lpv.settings import LpvSettings
from airlight.reference import mitsuba
from airlight.scene import Camera, Geometry, Material, Medium, Mesh, PointLight, Scene
from airlight.scene.image import Image

SIZE = (32, 20)
RAMP = (np.linspace(0.05, 1.0, 32)[None, :, None] * np.ones((20, 32, 3))).astype(np.float32)
SHARES = {"all": 1.0, "direct": 0.7, "one_bounce": 0.2, "indirect": 0.3}


class FakeMitsuba:
    """Stands in for the renderer: known means, known noise; counts what it was asked."""

    def __init__(self, noise=0.2):
        self.noise = noise
        self.asked = []

    def render_layers(self, scene, names, *, size, spp, seed, timeout_s, progress):
        self.asked.append((spp, seed))
        rng = np.random.default_rng(seed)
        images = {}
        for name in names:
            mean = RAMP * SHARES.get(name, 0.0)
            variance = (self.noise * mean) ** 2 / spp
            noisy = mean + rng.normal(size=mean.shape) * np.sqrt(variance)
            stats = {"spp": spp, "seconds": 0.5 * spp, "approximations": ["a note"]}
            layers = {"variance": variance.astype(np.float32)}
            images[name] = Image(noisy.astype(np.float32), layers, stats=stats)
        progress(1.0)
        return images


@pytest.fixture
def truth(monkeypatch, tmp_path):
    fake = FakeMitsuba()
    monkeypatch.setattr(mitsuba, "render_layers", fake.render_layers)
    monkeypatch.setenv("AIRLIGHT_CACHE", str(tmp_path / "cache"))
    return fake


@pytest.fixture
def techniques(monkeypatch):
    """`dim` is right but 20% too dark indirectly, `exact` the truth; others fail.

    Of one bounce `dim` has 30% too much; `exact` cannot leave later ones out.
    """

    class Renderer:
        def __init__(self, scene, technique, size, *, adapter, settings=None):
            if technique not in ("dim", "exact", "broken"):
                raise SettingsError(f"unknown technique '{technique}'")
            self.technique, self.settings = technique, settings or {}

        def __enter__(self):
            return self

        def __exit__(self, *_):
            return None

        def frame(self, *, samples=1, read=True):
            if self.technique == "broken":
                raise ZeroDivisionError("division by zero")
            scale = 0.8 if self.technique == "dim" else 1.0
            if not self.settings.get("bounces", True):
                scale = 1.3 * 0.2 / 0.3
            layers = {"direct": 0.7 * RAMP, "indirect": 0.3 * scale * RAMP}
            total = layers["direct"] + layers["indirect"]
            return Image(total, layers, stats={"device": "a test"}) if read else None

    module = ModuleType("airlight.rendering")
    module.Renderer = Renderer
    monkeypatch.setitem(sys.modules, "airlight.rendering", module)

    def settings_class(technique, scene):
        return LpvSettings if technique == "dim" else SurfaceSettings

    monkeypatch.setattr("airlight.techniques.settings_class", settings_class)
    monkeypatch.setattr(
        "airlight.techniques.TECHNIQUES",
        {"dim": LpvSettings, "exact": SurfaceSettings, "broken": SurfaceSettings},
    )


def triangle_scene(**changes):
    geometry = Geometry(
        np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], np.float32), np.array([[0, 1, 2]], np.uint32)
    )
    scene = Scene(meshes=(Mesh(geometry),), lights=(PointLight((0, 1, 2), (1, 1, 1)),))
    return dataclasses.replace(scene, **changes)


def compared(names, tmp_path, settings=None):
    return compare.compare_scene(
        triangle_scene(),
        "a scene.toml",
        names,
        compare.Plan(size=SIZE, spp=64, samples=4, settings=settings or {}),
        output=tmp_path,
    )


def test_the_folder_holds_page_sheet_and_numbers(truth, techniques, tmp_path):
    comparison = compared(("dim", "exact"), tmp_path)
    compare.write(comparison, tmp_path)
    numbers = json.loads((tmp_path / "results.json").read_text())
    dim = numbers["techniques"]["dim"]
    assert dim["metrics"]["energy_ratio"] == pytest.approx(0.94, abs=0.01)
    assert dim["metrics"]["layers"]["indirect"]["energy_ratio"] == pytest.approx(0.8, abs=0.01)
    assert dim["metrics"]["layers"]["one_bounce"]["energy_ratio"] == pytest.approx(1.3, abs=0.02)
    assert "one_bounce" not in numbers["techniques"]["exact"]["metrics"]["layers"]
    assert dim["metrics"]["black"]["relmse"] > 0.9
    assert numbers["techniques"]["exact"]["metrics"]["within_noise"] is True
    assert numbers["reference"]["noise_floor"] == pytest.approx(0.04 / 64, rel=0.1)
    # 0.04 / N at half a second a sample.
    equal = dim["equal_time"]
    assert equal["error_at_time"] == pytest.approx(0.04 * 0.5 / dim["seconds"], rel=0.1)
    for name, error in (("equal_time", "relmse"), ("equal_time_l2", "relative_l2")):
        own = dim["metrics"][error] ** (2 if error == "relative_l2" else 1) - 0.04 / 64
        assert dim[name]["seconds_to_match"] == pytest.approx(0.04 / own * 0.5, rel=0.1)
    sheet = PIL.Image.open(tmp_path / "contact_sheet.png")
    assert sheet.width > 1600
    page = (tmp_path / "index.html").read_text("utf-8")
    assert not re.search(r'(src|href)="(?!data:)', page), "the page must hold everything itself"
    assert not re.search(r"https?://", page)
    assert page.count("<img ") == 4 + (2 * 3 + 1) * 3  # whole, direct, indirect of two; one bounce
    assert "airlight compare &#x27;a scene.toml&#x27; --technique dim exact" in page


def test_every_tag_of_the_page_is_closed(truth, techniques, tmp_path):
    class Balance(HTMLParser):
        open: ClassVar[list[str]] = []

        def handle_starttag(self, tag, attributes):
            if tag not in ("meta", "img"):
                self.open.append(tag)

        def handle_endtag(self, tag):
            assert self.open.pop() == tag

    balance = Balance()
    balance.feed(compare_page.page(compared(("dim", "nope"), tmp_path)))
    assert balance.open == []


def test_layers_without_light_are_left_out_and_the_whole_comes_first(truth, techniques, tmp_path):
    views = compared(("dim",), tmp_path).views
    assert [view.name for view in views] == [
        compare_result.WHOLE,
        "direct",
        "indirect",
        "one_bounce",
    ]
    assert views[2].title == "Indirect light (all bounces)"
    assert views[2].panels[0].signed[..., 0].mean() > views[2].panels[0].signed[..., 1].mean()


def test_every_class_that_the_page_uses_has_a_style(truth, techniques, tmp_path):
    page = compare_page.page(compared(("dim", "nope"), tmp_path))
    used = {name for names in re.findall(r'class="([^"]+)"', page) for name in names.split()}
    assert used
    assert not [name for name in used if f".{name}" not in compare_style.CSS]


def test_a_failed_technique_is_told_on_the_page_and_the_others_stand(truth, techniques, tmp_path):
    comparison = compared(("dim", "broken", "<none>"), tmp_path)
    errors = [o.error for o in comparison.outcomes]
    assert errors == [
        "",
        "internal error: ZeroDivisionError: division by zero",
        "unknown technique '<none>'",
    ]
    page = compare_page.page(comparison)
    assert "<b>&lt;none&gt;</b> made no image" in page
    assert "dim" in page
    assert comparison.to_json()["techniques"]["broken"]["metrics"] is None


def test_a_reference_is_rendered_once_and_refined_with_new_samples(truth):
    scene = triangle_scene()
    first = reference_for(scene, SIZE, 16)
    again = reference_for(triangle_scene(name="renamed"), SIZE, 8)
    assert truth.asked == [(16, 0)]
    assert (first.is_from_cache, again.is_from_cache, again.spp) == (False, True, 16)
    assert np.array_equal(first.image.radiance, again.image.radiance)
    assert again.notes == ("a note",)
    better = reference_for(scene, SIZE, 64)
    assert truth.asked == [(16, 0), (48, 16)]
    assert (better.spp, better.seconds) == (64, 32.0)
    # The merged variance is that of 64 samples, and the error agrees with it.
    np.testing.assert_allclose(better.image.layers["variance"], (0.2 * RAMP) ** 2 / 64, rtol=1e-4)
    z = (better.image.radiance - RAMP) / np.sqrt(better.image.layers["variance"])
    assert np.std(z) == pytest.approx(1.0, abs=0.1)


def test_a_cache_that_is_a_file_costs_a_warning_and_the_work(
    truth, techniques, tmp_path, capsys, monkeypatch
):
    (tmp_path / "cache").write_bytes(b"mine")
    for _ in range(2):
        made = reference_for(triangle_scene(), SIZE, 16)
        assert "cache" in made.not_cached and "Not a directory" in made.not_cached
        assert not made.is_from_cache
    assert truth.asked == [(16, 0), (16, 0)]
    words = ["compare", "builtin:cornell", "-t", "exact", "--spp", "16", "--size", "32x20", "-q"]
    assert cli.run([*words, "-o", str(tmp_path / "out")]) == 0
    warnings = [line for line in capsys.readouterr().err.splitlines() if "not kept" in line]
    (warning,) = warnings
    assert warning.startswith("warning: the reference is not kept for the next time: ")
    assert warning.endswith("Set AIRLIGHT_CACHE to a folder that can be written.")
    assert (tmp_path / "cache").read_bytes() == b"mine"
    monkeypatch.setenv("AIRLIGHT_CACHE", str(tmp_path / "writable"))
    assert reference_for(triangle_scene(), SIZE, 16).not_cached == ""


def test_a_cache_of_nobodys_is_refused_before_any_work(truth, tmp_path, capsys, monkeypatch):
    monkeypatch.setenv("AIRLIGHT_CACHE", "~nosuchuser/x")
    assert cli.run(["compare", "builtin:cornell", "-q", "-o", str(tmp_path / "out")]) == 2
    assert capsys.readouterr().err.startswith("error: AIRLIGHT_CACHE: there is no home folder")
    assert truth.asked == []


def test_without_a_libllvm_the_whole_has_a_reference_and_layers_come_with_one(truth, monkeypatch):
    scene, all_layers = triangle_scene(medium=Medium((0.1, 0.1, 0.1))), truth.render_layers

    def whole_alone(scene, names, **asked):
        if names != ("all",):
            raise mitsuba.NoLayers("no libLLVM 16 is found", remedy="Install it.")
        return all_layers(scene, names, **asked)

    monkeypatch.setattr(mitsuba, "render_layers", whole_alone)
    first, again = (reference_for(scene, SIZE, 16) for _ in range(2))
    assert not first.has_layers and first.image.layers.keys() == {"variance"}
    assert (
        first.notes
        == again.notes
        == (
            "only the whole image has a reference: no libLLVM 16 is found. Install it",
            "a note",
        )
    )
    assert (again.is_from_cache, truth.asked) == (True, [(16, 0)])
    # Once one is installed, what was kept without layers does not stand in their way.
    monkeypatch.setattr(mitsuba, "render_layers", all_layers)
    later = reference_for(scene, SIZE, 16)
    assert later.has_layers and later.notes == ("a note",)
    assert truth.asked == [(16, 0), (16, 0)]


def test_noise_asks_for_as_many_samples_as_the_floor_needs(truth):
    reference = reference_for(triangle_scene(), SIZE, 16, noise=2e-4)
    assert reference.floor <= 2e-4
    assert reference.spp == pytest.approx(0.04 / 2e-4 * 1.1, rel=0.05)


def test_a_broken_cache_is_rendered_again(truth, tmp_path):
    scene = triangle_scene()
    reference_for(scene, SIZE, 16)
    (kept,) = (tmp_path / "cache" / "references").glob("*.npz")
    kept.write_bytes(kept.read_bytes()[:1000])
    assert reference_for(scene, SIZE, 16).spp == 16
    assert len(truth.asked) == 2
    # So is one with pixels that are no numbers.
    with np.load(kept) as archive:
        arrays = dict(archive)
    arrays["radiance"][0, 0] = np.nan
    np.savez(kept, **arrays)
    assert np.isfinite(reference_for(scene, SIZE, 16).image.radiance).all()
    assert len(truth.asked) == 3


@pytest.mark.parametrize(
    "change",
    [
        {"camera": Camera(fov_y_deg=40.0)},
        {"medium": Medium((0.1, 0.1, 0.1))},
        {"lights": (PointLight((0, 1, 2), (1, 1, 2)),)},
    ],
)
def test_the_hash_is_of_content(change):
    scene = triangle_scene()
    assert scene_hash(scene, SIZE) == scene_hash(triangle_scene(), SIZE)
    assert scene_hash(scene, SIZE) == scene_hash(triangle_scene(warnings=("w",)), SIZE)
    assert scene_hash(scene, SIZE) != scene_hash(triangle_scene(**change), SIZE)
    assert scene_hash(scene, SIZE) != scene_hash(scene, (33, 20))
    repainted = Mesh(scene.meshes[0].geometry, Material(base_color=(0.1, 0.8, 0.8)))
    assert scene_hash(scene, SIZE) != scene_hash(triangle_scene(meshes=(repainted,)), SIZE)


@pytest.mark.parametrize(
    ("given", "meant"),
    [
        (
            "s.toml --technique a b c -o out",
            "s.toml -o out --technique a --technique b --technique c",
        ),
        ("--technique a b s.toml -o out", "s.toml -o out --technique a --technique b"),
        ("s.toml -t a --technique b -o out", "s.toml -o out --technique a --technique b"),
        ("-o out s.toml -t a b", "-o out s.toml --technique a --technique b"),
        ("-q s.toml -t a b", "-q s.toml --technique a --technique b"),
    ],
)
def test_one_option_names_several_techniques(given, meant):
    assert compare._one_each(given.split(), {"-o"}) == meant.split()


def test_the_command_line_says_the_numbers(truth, techniques, tmp_path, capsys):
    scene = tmp_path / "s.toml"
    scene.write_text(
        '[[mesh]]\nshape = "quad"\n[[light]]\ntype = "point"\nposition = [0, 1, 0]\nintensity = 1\n'
    )
    out = tmp_path / "new" / "out"
    code = cli.run(
        ["compare", str(scene), "--technique", "dim", "broken", "-o", str(out), "--size", "32x20"]
    )
    said = capsys.readouterr()
    assert code == 0, said.err
    assert re.search(r"dim: relmse 0\.00\d+, energy 0\.9\d+, flip", said.out)
    assert "warning: broken made no image: internal error: ZeroDivisionError" in said.err
    assert (out / "index.html").is_file()
    assert cli.run(["compare", str(scene), "-t", "broken", "-o", str(out), "--size", "32x20"]) == 2
    assert "no technique made an image" in capsys.readouterr().err


def test_settings_go_to_the_techniques_that_have_them(truth, techniques, tmp_path, monkeypatch):
    given = []

    class Recording(sys.modules["airlight.rendering"].Renderer):
        def __init__(self, scene, technique, size, *, adapter, settings=None):
            given.append((technique, settings))
            super().__init__(scene, technique, size, adapter=adapter, settings=settings)

    monkeypatch.setattr(sys.modules["airlight.rendering"], "Renderer", Recording)
    comparison = compared(("dim", "exact"), tmp_path, {"iterations": "4", "resolution": "8"})
    both = {"iterations": "4", "resolution": "8"}
    assert given == [
        ("dim", both),
        ("dim", {**both, "bounces": False}),
        ("exact", {"resolution": "8"}),
    ]
    assert comparison.command.endswith("-D iterations=4 -D resolution=8")
    ours = [outcome.command.partition("--samples 4")[2] for outcome in comparison.outcomes]
    assert ours == [" -D iterations=4 -D resolution=8", " -D resolution=8"]


@pytest.mark.parametrize(
    ("setting", "message"),
    [
        (
            "resolutoin=8",
            "techniques exact, dim: unknown setting 'resolutoin'. Did you mean 'resolution'?",
        ),
        (
            "resolution=1",
            "technique exact: setting resolution = '1' is out of range. It goes from 4 to 256",
        ),
        ("resolution", "'resolution' is not written as key=value"),
    ],
)
def test_a_setting_that_cannot_be_is_refused_before_any_work(
    truth, techniques, tmp_path, capsys, setting, message
):
    words = ["compare", "builtin:cornell", "-t", "exact", "dim", "-D", setting]
    assert cli.run([*words, "-o", str(tmp_path / "out")]) == 2
    assert message in capsys.readouterr().err
    assert truth.asked == []


def test_an_unknown_technique_is_refused_before_any_work(truth, techniques, tmp_path, capsys):
    """Beside known ones, too: nothing is rendered, and no folder made."""
    words = ["compare", "builtin:cornell", "-t", "exact", "exakt", "-o", str(tmp_path / "out")]
    assert cli.run(words) == 2
    said = capsys.readouterr().err
    assert said == "error: unknown technique 'exakt'. Did you mean 'exact'?\n"
    assert truth.asked == []
    assert not (tmp_path / "out").exists()


def test_without_a_reference_there_is_one_message(monkeypatch, tmp_path, capsys):
    def refuse(*_, **__):
        raise ReferenceFailure("Mitsuba is not installed", remedy="Type: pip install it")

    monkeypatch.setattr(mitsuba, "render_layers", refuse)
    monkeypatch.setenv("AIRLIGHT_CACHE", str(tmp_path / "cache"))
    code = cli.run(
        ["compare", "builtin:cornell", "-t", "direct", "-o", str(tmp_path / "out"), "-q"]
    )
    assert code == 2
    assert capsys.readouterr().err == "error: Mitsuba is not installed. Type: pip install it\n"


def test_a_folder_that_is_a_file_is_refused(tmp_path, capsys):
    (tmp_path / "out").write_text("here")
    assert cli.run(["compare", "builtin:cornell", "-o", str(tmp_path / "out")]) == 2
    assert "this is a file, not a folder" in capsys.readouterr().err


def test_differences_are_green_where_too_bright_and_red_where_too_dark():
    grey = np.full((4, 4, 3), 0.2, np.float32)
    bright = compare_images.signed_map(grey * 1.5, grey, 0.0)[0, 0].astype(int)
    dark = compare_images.signed_map(grey * 0.5, grey, 0.0)[0, 0].astype(int)
    assert bright[1] > 1.5 * bright[0] > 0
    assert dark[0] > 2 * dark[1] > 0
    assert compare_images.signed_map(grey, grey, 0.0).max() == 0


def test_numbers_are_written_with_three_digits():
    values = (None, 0.0, 0.012345, 12.0, 123456.0, 1e-7, float("inf"), 1.0)
    written = [compare_page.number(v) for v in values]
    assert written == ["–", "0", "0.0123", "12.0", "1.23e+05", "1.00e-07", "∞", "1.00"]
    assert [compare_page.seconds(s) for s in (0.04, 3.0, 600.0)] == [
        "40.0 ms",
        "3.00 s",
        "10.0 min",
    ]
