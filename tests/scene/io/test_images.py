"""Textures of every pixel format, radiance maps, images out and back."""

from __future__ import annotations

import io

import numpy as np
import PIL.Image
import pytest

from airlight.errors import OutputError, SceneError
from airlight.maths.colour import srgb_decode
from airlight.scene.image import Image
from airlight.scene.io import image_sizes, images
from airlight.scene.io.images import load_image, read_radiance, read_texture, save_image


def encoded(image: PIL.Image.Image, kind: str = "PNG", **options) -> bytes:
    file = io.BytesIO()
    image.save(file, kind, **options)
    return file.getvalue()


def small_image() -> Image:
    rng = np.random.default_rng(0)
    shape = (6, 9)
    return Image(
        radiance=rng.random((*shape, 3), dtype=np.float32) * 9,
        layers={
            "direct": rng.random((*shape, 3), dtype=np.float32),
            "transmittance": rng.random(shape, dtype=np.float32),
            "depth": rng.random(shape, dtype=np.float32) * 1000 + 0.1,
            "normal": rng.normal(size=(*shape, 3)).astype(np.float32),
        },
        exposure_stops=1.5,
        tone_map="neutral",
        stats={"frame_ms": 3.5},
    )


@pytest.mark.parametrize(
    ("image", "first"),
    [
        (PIL.Image.new("RGB", (3, 2), (10, 20, 30)), [10, 20, 30, 255]),
        (PIL.Image.new("RGBA", (3, 2), (10, 20, 30, 40)), [10, 20, 30, 40]),
        (PIL.Image.new("L", (3, 2), 77), [77, 77, 77, 255]),
        (PIL.Image.new("LA", (3, 2), (77, 5)), [77, 77, 77, 5]),
        (PIL.Image.new("1", (3, 2), 1), [255, 255, 255, 255]),
        (PIL.Image.new("I;16", (3, 2), 257 * 77), [77, 77, 77, 255]),
        (PIL.Image.new("RGB", (3, 2), (9, 8, 7)).convert("P"), None),
    ],
)
def test_every_kind_of_png_becomes_rgba(image, first):
    texture = read_texture(encoded(image), is_srgb=True, source="x")
    assert texture.pixels.shape == (2, 3, 4)
    expected = first or [*image.convert("RGB").getpixel((0, 0)), 255]
    assert texture.pixels[0, 0].tolist() == expected


def test_palette_transparency_jpeg_and_cmyk():
    palette = PIL.Image.new("P", (2, 2), 1)
    palette.putpalette([0, 0, 0, 200, 100, 50])
    texture = read_texture(encoded(palette, transparency=1), is_srgb=True)
    assert texture.pixels[0, 0].tolist() == [200, 100, 50, 0]
    cmyk = read_texture(encoded(PIL.Image.new("CMYK", (8, 8)), "JPEG"), is_srgb=True)
    assert cmyk.pixels[0, 0].tolist() == [255, 255, 255, 255]


def test_top_row_comes_first(tmp_path):
    image = PIL.Image.new("RGB", (2, 2), "black")
    image.putpixel((0, 0), (255, 0, 0))
    image.save(tmp_path / "a.png")
    texture = read_texture(tmp_path / "a.png", is_srgb=False)
    assert texture.pixels[0, 0].tolist() == [255, 0, 0, 255]
    assert texture.source == str(tmp_path / "a.png")
    assert not texture.is_srgb


def test_bombs_and_junk_are_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(image_sizes, "MAX_TEXTURE_PIXELS", 100)
    with pytest.raises(SceneError, match="x: image of 11 x 10 pixels is too large"):
        read_texture(encoded(PIL.Image.new("L", (11, 10))), is_srgb=True, source="x")
    monkeypatch.setattr(PIL.Image, "MAX_IMAGE_PIXELS", 10)
    with pytest.raises(SceneError, match="x: image has too many pixels"):
        read_texture(encoded(PIL.Image.new("L", (11, 10))), is_srgb=True, source="x")
    with pytest.raises(SceneError, match="x: not a readable image"):
        read_texture(b"nothing", is_srgb=True, source="x")
    whole = encoded(PIL.Image.effect_noise((64, 64), 50))
    monkeypatch.undo()
    with pytest.raises(SceneError, match="x: not a readable image"):
        read_texture(whole[: len(whole) // 2], is_srgb=True, source="x")
    with pytest.raises(SceneError, match="file not found"):
        read_texture(tmp_path / "none.png", is_srgb=True)


def test_radiance_from_an_8_bit_image_is_linear_and_said(tmp_path):
    PIL.Image.new("RGB", (4, 2), (255, 188, 0)).save(tmp_path / "sky.png")
    warnings: list[str] = []
    pixels = read_radiance(tmp_path / "sky.png", warnings)
    np.testing.assert_allclose(pixels[0, 0], [1, 0.5029, 0], atol=1e-4)
    assert "8-bit image used as light" in warnings[0]


def test_environments_of_others(shared_data):
    for name, shape in (("envmap.exr", (256, 512, 3)), ("cathedral.hdr", (512, 1024, 3))):
        pixels = read_radiance(shared_data / "environment" / name)
        assert pixels.shape == shape
        assert pixels.dtype == np.float32
        assert np.isfinite(pixels).all()
        assert pixels.max() > 1


def test_nan_and_infinite_radiance(tmp_path):
    pixels = np.ones((2, 2, 3), dtype=np.float32)
    pixels[0, 0, 0] = np.inf
    save_image(Image(radiance=pixels), tmp_path / "a.exr")
    warnings: list[str] = []
    assert read_radiance(tmp_path / "a.exr", warnings).max() == 65504
    assert "infinite pixels" in warnings[0]
    pixels[0, 0, 0] = np.nan
    save_image(Image(radiance=pixels), tmp_path / "a.exr")
    with pytest.raises(SceneError, match=r"a\.exr: 1 values are NaN"):
        read_radiance(tmp_path / "a.exr")


def test_a_float_exr_comes_back_bit_for_bit(tmp_path):
    image = small_image()
    save_image(image, tmp_path / "a.exr")
    back = load_image(tmp_path / "a.exr")
    np.testing.assert_array_equal(back.radiance, image.radiance)
    assert set(back.layers) == set(image.layers)
    for name, layer in image.layers.items():
        np.testing.assert_array_equal(back.layers[name], layer)
    assert (back.exposure_stops, back.tone_map) == (1.5, "neutral")
    assert back.stats == {"frame_ms": 3.5}
    assert [p.name for p in tmp_path.iterdir()] == ["a.exr"]


def test_png_and_jpeg_are_what_the_tone_curve_says(tmp_path):
    from airlight.maths.tone import display_srgb8

    image = small_image()
    save_image(image, tmp_path / "a.png")
    written = np.asarray(PIL.Image.open(tmp_path / "a.png"))
    wanted = display_srgb8(image.radiance, 1.5, "neutral", dither=True)
    np.testing.assert_array_equal(written, wanted)
    flat = Image(radiance=np.full((16, 16, 3), 0.4, dtype=np.float32))
    save_image(flat, tmp_path / "b.JPG")
    jpeg = np.asarray(PIL.Image.open(tmp_path / "b.JPG"), dtype=int)
    assert np.abs(jpeg - display_srgb8(flat.radiance, 0.0, "agx")).max() <= 2


def test_hdr_out_and_back(tmp_path):
    image = small_image()
    save_image(image, tmp_path / "a.hdr")
    back = load_image(tmp_path / "a.hdr")
    peak = image.radiance.max(axis=2, keepdims=True)
    assert np.all(np.abs(back.radiance - image.radiance) <= peak / 127)


def test_image_save_ends_here(tmp_path):
    small_image().save(tmp_path / "a.exr", layers=False)
    assert load_image(tmp_path / "a.exr").layers == {}


@pytest.mark.parametrize("name", ["a.bmp", "a", "a.exr.txt"])
def test_unknown_endings(tmp_path, name):
    with pytest.raises(OutputError) as error:
        save_image(small_image(), tmp_path / name)
    assert str(error.value).endswith("End its name in one of .exr, .hdr, .png, .jpg, .jpeg.")
    assert list(tmp_path.iterdir()) == []


def test_unknown_tone_curve_leaves_no_file(tmp_path):
    image = Image(radiance=np.ones((2, 2, 3), dtype=np.float32), tone_map="sepia")
    with pytest.raises(OutputError, match="sepia"):
        save_image(image, tmp_path / "a.png")
    assert list(tmp_path.iterdir()) == []


def test_an_image_that_does_not_fit_into_memory_is_named_with_its_size(tmp_path, monkeypatch):
    def full(image):
        raise MemoryError

    path = tmp_path / "large.png"
    path.write_bytes(encoded(PIL.Image.new("RGB", (7, 5))))
    monkeypatch.setattr(images, "_rgba", full)
    for read in (lambda: read_texture(path, is_srgb=True), lambda: read_radiance(path)):
        with pytest.raises(SceneError, match="7 x 5 pixels does not fit into memory") as caught:
            read()
        assert str(path) in str(caught.value)


def test_light_from_8_bits_is_decoded_in_bands(tmp_path, monkeypatch):
    values = np.random.default_rng(3).integers(0, 256, (11, 6, 3), dtype=np.uint8)
    path = tmp_path / "sky.png"
    path.write_bytes(encoded(PIL.Image.fromarray(values)))
    whole = read_radiance(path)
    monkeypatch.setattr(images, "_BAND_ROWS", 3)
    np.testing.assert_array_equal(read_radiance(path), whole)
    np.testing.assert_array_equal(whole, srgb_decode(values / 255.0).astype(np.float32))
