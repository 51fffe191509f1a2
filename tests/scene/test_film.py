"""The size of images that a file's camera has, through every format, and what is drawn of it."""

from __future__ import annotations

import json
import struct
from dataclasses import replace
from pathlib import Path

import pytest

from airlight.app.convert import command as convert
from airlight.app.info import scene_facts
from airlight.app.render import command as render_command
from airlight.errors import SceneError
from airlight.rendering import render
from airlight.scene.camera import USUAL_PX, Camera, film_of
from airlight.scene.io import load

BOX = """<scene version="3.0.0">
  <sensor type="perspective"><float name="fov" value="40"/>
    <transform name="to_world"><lookat origin="0,1,4" target="0,1,0" up="0,1,0"/></transform>{film}
  </sensor>
  <shape type="cube"/><emitter type="constant"/>
</scene>"""
FILM = (
    '<film type="hdrfilm"><integer name="width" value="60"/><integer name="height" value="48"/>'
    "</film>"
)
CHEAP = ["-t", "direct", "--samples", "1", "-D", "shadow_resolution=64", "-D", "sky_lights=2"]


@pytest.fixture
def box(tmp_path: Path) -> Path:
    path = tmp_path / "box.xml"
    path.write_text(BOX.format(film=FILM))
    return path


def run(command, *words: object) -> None:
    command.main([str(word) for word in words], standalone_mode=False)


def test_a_file_without_a_film_has_that_of_mitsuba(tmp_path: Path) -> None:
    path = tmp_path / "box.xml"
    path.write_text(BOX.format(film=""))
    assert load(path).camera.image_size == (768, 576)


def test_what_has_no_size_has_the_usual_one() -> None:
    assert Camera().image_size == USUAL_PX == (1280, 720)
    assert load("builtin:room").camera.image_size == USUAL_PX


@pytest.mark.parametrize("film", [(0, 10), (10.5, 10), (1, 2, 3), (20000, 10), "wide"])
def test_an_impossible_size_is_refused(film) -> None:
    with pytest.raises(SceneError, match="film_px"):
        Camera(film_px=film)


@pytest.mark.parametrize("aspect", [0.02, 0.5, 1.0, 4 / 3, 16 / 9, 2.39, 50.0])
def test_a_film_of_an_aspect_has_it_and_the_usual_area(aspect: float) -> None:
    width, height = film_of(aspect)
    assert width % 2 == height % 2 == 0
    shortest = min(width, height)  # rounded by at most one pixel
    assert width / height == pytest.approx(aspect, rel=2.0 / shortest)
    assert width * height == pytest.approx(1280 * 720, rel=2.0 / shortest)
    assert film_of(16 / 9) == USUAL_PX


@pytest.mark.parametrize(
    ("film", "near", "within"),
    [
        (None, (640, 360), (640, 360)),
        ((60, 48), (536, 430), (60, 48)),
        ((640, 360), (640, 360), (640, 360)),
        ((1920, 1080), (640, 360), (640, 360)),
        ((2000, 2000), (480, 480), (480, 480)),
        ((4096, 1), (640, 360), (4096, 1)),
    ],
)
def test_windows_and_comparisons_have_the_shape_of_the_film(film, near, within) -> None:
    camera = Camera(film_px=film)
    assert camera.size_near((640, 360)) == near
    assert camera.size_within((640, 360)) == within


def test_the_viewer_and_compare_take_it(box: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from airlight.app.compare import cli as comparing
    from airlight.app.view import cli as viewing
    from airlight.app.view import window

    class Stop(Exception):
        pass

    # Both stop as soon as the size is known.
    sizes = []

    def opened(session, size) -> None:
        sizes.append(size)

    def compared(scene, label, names, plan, **rest):
        sizes.append(plan.size)
        raise Stop

    monkeypatch.setattr(window, "open_window", opened)
    monkeypatch.setattr(comparing, "compare_scene", compared)
    for size in ((), ("--size", "20x10")):
        run(viewing.command, box, *size)
        with pytest.raises(Stop):
            run(comparing.command, box, "-o", box.with_name("compared"), "-q", *size)
    assert sizes == [(1074, 858), (60, 48), (20, 10), (20, 10)]


@pytest.mark.parametrize("aspect", [0.0, -1.0, 1e-9, 1e9, float("nan"), float("inf")])
def test_no_film_has_an_aspect_that_no_image_has(aspect: float) -> None:
    assert film_of(aspect) is None


def test_images_have_the_size_of_the_film_unless_another_is_asked_for(gpu, box: Path) -> None:
    from airlight.scene.io.images import load_image

    image = box.with_name("box.png")
    run(render_command, box, "-o", image, "-q", *CHEAP)
    assert load_image(image).radiance.shape == (48, 60, 3)
    run(render_command, box, "-o", image, "-q", "--size", "20x10", *CHEAP)
    assert load_image(image).radiance.shape == (10, 20, 3)
    settings = {"shadow_resolution": 64, "sky_lights": 2}
    found = render(load(box), "direct", samples=1, settings=settings)
    assert found.radiance.shape == (48, 60, 3)
    assert scene_facts(load(box))["image_size_px"] == [60, 48]


@pytest.mark.parametrize("ending", [".xml", ".toml"])
def test_a_converted_file_keeps_the_size(box: Path, ending: str) -> None:
    other = box.with_name("other" + ending)
    run(convert, box, other)
    assert load(other).camera.film_px == (60, 48)


def test_gltf_keeps_the_proportion(box: Path) -> None:
    other = box.with_name("other.glb")
    run(convert, box, other)
    assert load(other).camera.film_px == film_of(60 / 48) == (1074, 858)


def test_gltf_without_a_proportion_has_no_film(box: Path) -> None:
    other = box.with_name("other.glb")
    scene = load(box)
    from airlight.scene.io.gltf_write import write_gltf

    write_gltf(replace(scene, camera=replace(scene.camera, film_px=None)), other)
    data = other.read_bytes()
    length = struct.unpack_from("<I", data, 12)[0]
    document = json.loads(data[20 : 20 + length])
    assert "aspectRatio" not in document["cameras"][0]["perspective"]
    assert load(other).camera.film_px is None
