"""Full-screen passes that compute and store: the same images as passes that draw."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.gpu.fullscreen import FullscreenPass
from airlight.gpu.layout import Struct, f32
from airlight.gpu.memory import Texture
from airlight.gpu.slots import texture, uniform
from airlight.gpu.stored import is_storable

SIZE = (13, 9)  # no multiple of a workgroup's side
FORMATS = ("rgba32float", "rgba16float", "rgba32uint")


class Scaled(Struct):
    """A factor."""

    by = f32()


WGSL = """
struct Three {
    @location(2) place: vec4u,
    @location(0) twice: vec4f,
    @location(1) root: vec4f,
}
@fragment fn fragment(@builtin(position) position: vec4f) -> Three {
    let c = textureLoad(before, vec2u(position.xy), 0) * params.by;
    return Three(vec4u(vec4f(position.xy, 2.5, 7.0)), 2.0 * c, sqrt(c));
}
"""


def made(gpu, folder, text=WGSL, targets=FORMATS, **named):
    path = folder / "three.wgsl"
    path.write_text(text)
    members = {
        "__module__": __name__,
        "file": str(path),
        "targets": targets,
        "slots": (uniform("params", Scaled), texture("before", "2d", "unfilterable-float")),
        **named,
    }
    return type("ThreePass", (FullscreenPass,), members)(gpu)


def stage_of(gpu):
    return "compute" if gpu.paths.stored_screens else "fragment"


@pytest.mark.both_paths
@pytest.mark.parametrize("count", [1, 3])
def test_every_pixel_of_every_target_is_written(gpu, commands, owned, tmp_path, count):
    before = owned(Texture(gpu, "before", SIZE, "rgba32float"))
    values = np.random.default_rng(1).random((SIZE[1], SIZE[0], 4)).astype(np.float32)
    before.write(values)
    targets = [owned(Texture(gpu, f, SIZE, f, target=True, written=True)) for f in FORMATS[:count]]
    one = made(gpu, tmp_path, targets=FORMATS[:count])
    assert one.stage == stage_of(gpu)
    # The second time with what the first one stored: passes see what those before them wrote.
    one.draw(commands, tuple(targets), params=Scaled(by=1.0), before=before)
    again = [owned(Texture(gpu, f, SIZE, f, target=True, written=True)) for f in FORMATS[:count]]
    one.draw(commands, tuple(again), params=Scaled(by=0.5), before=targets[0])
    commands.submit()
    np.testing.assert_array_equal(again[0].read(), 2.0 * values)
    if count == 3:
        np.testing.assert_allclose(again[1].read(), np.sqrt(values), rtol=1e-3)
        y, x = np.indices(SIZE[::-1])
        place = np.stack([x, y, np.full_like(x, 2), np.full_like(x, 7)], axis=-1)
        np.testing.assert_array_equal(again[2].read(), place)


@pytest.mark.parametrize(
    "text",
    [
        WGSL.replace("let c", "if (position.x < 1.0) { discard; }\n    let c"),
        WGSL.replace("return Three", "let slope = dpdx(c.x);\n    return Three"),
        WGSL.replace("@builtin(position) position: vec4f", "seen: Seen"),
        WGSL.replace("struct Three", "struct Other"),
    ],
)
def test_what_only_fragments_have_is_drawn(text):
    assert is_storable(WGSL, FORMATS)
    assert not is_storable(text, FORMATS)


@pytest.mark.parametrize("format", ["bgra8unorm", "rgba8unorm-srgb", "depth32float"])
def test_formats_that_cannot_be_stored_are_drawn(format):
    assert not is_storable(WGSL, (*FORMATS, format))


@pytest.mark.both_paths
def test_more_targets_than_a_device_stores_are_drawn(gpu, tmp_path, monkeypatch):
    limit = "max-storage-textures-per-shader-stage"
    monkeypatch.setattr(gpu, "limits", {**gpu.limits, limit: 2})
    assert made(gpu, tmp_path).stage == "fragment"
    assert made(gpu, tmp_path, targets=FORMATS[:2]).stage == stage_of(gpu)
