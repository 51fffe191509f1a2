"""A pass over every pixel of its targets."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.gpu.fullscreen import FullscreenPass
from airlight.gpu.layout import Struct, vec4f
from airlight.gpu.memory import Texture
from airlight.gpu.slots import uniform


class Tint(Struct):
    """What is added to the pixel's place."""

    value = vec4f()


WGSL = """
@fragment fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    return vec4f(position.xy, 0.0, 0.0) + params.value;
}
"""


def fullscreen(gpu, folder, **named):
    path = folder / "tint.wgsl"
    path.write_text(WGSL)
    members = {
        "__module__": __name__,
        "file": str(path),
        "targets": ("rgba32float",),
        "slots": (uniform("params", Tint),),
        **named,
    }
    return type("TintPass", (FullscreenPass,), members)(gpu)


def test_every_pixel_is_written_at_its_centre_top_row_first(gpu, commands, owned, tmp_path):
    target = owned(Texture(gpu, "target", (7, 4), "rgba32float", target=True, written=True))
    fullscreen(gpu, tmp_path).draw(commands, (target,), params=Tint(value=(0, 0, 5, 1)))
    commands.submit()
    x, y = np.meshgrid(np.arange(7) + 0.5, np.arange(4) + 0.5)
    expected = np.stack([x, y, np.full_like(x, 5.0), np.ones_like(x)], axis=-1)
    np.testing.assert_array_equal(target.read(), expected)


def test_a_blending_pass_keeps_what_was_there(gpu, commands, owned, tmp_path):
    add = {"src_factor": "one", "dst_factor": "one", "operation": "add"}
    made = fullscreen(gpu, tmp_path, blend={"color": add, "alpha": add}, targets=("rgba16float",))
    target = owned(Texture(gpu, "target", (2, 2), "rgba16float", target=True, written=True))
    target.write(np.ones((2, 2, 4), np.float16))
    for _ in range(2):
        made.draw(commands, (target,), params=Tint(value=(0, 0, 3, 0)))
    commands.submit()
    np.testing.assert_array_equal(target.read()[0, 1], [4.0, 2.0, 7.0, 1.0])


def test_some_targets_are_blended_with_and_others_replaced(gpu, commands, owned, tmp_path):
    times = {"src_factor": "zero", "dst_factor": "src", "operation": "add"}
    pair = WGSL.replace("@location(0) vec4f {", "Pair {").replace("return ", "let v = ")
    pair = "struct Pair { @location(0) a: vec4f, @location(1) b: vec4f }\n" + pair
    path = tmp_path / "pair.wgsl"
    path.write_text(pair.replace("params.value;", "params.value; return Pair(v, v);"))
    made = fullscreen(
        gpu,
        tmp_path,
        file=str(path),
        blend={"color": times, "alpha": times},
        blended=1,
        targets=("rgba16float", "rgba16float"),
    )
    targets = [
        owned(Texture(gpu, n, (2, 2), "rgba16float", target=True, written=True)) for n in "ab"
    ]
    for target in targets:
        target.write(np.full((2, 2, 4), 2.0, np.float16))
    made.draw(commands, tuple(targets), params=Tint(value=(0, 0, 3, 1)))
    commands.submit()
    np.testing.assert_array_equal(targets[0].read()[0, 1], [3.0, 1.0, 6.0, 2.0])
    np.testing.assert_array_equal(targets[1].read()[0, 1], [1.5, 0.5, 3.0, 1.0])


def test_missing_and_unknown_names_are_refused(gpu, commands, owned, tmp_path):
    target = owned(Texture(gpu, "target", (2, 2), "rgba32float", target=True, written=True))
    made = fullscreen(gpu, tmp_path)
    with pytest.raises(TypeError, match=r"^TintPass: missing \['params'\], unknown \['tint'\]$"):
        made.draw(commands, (target,), tint=Tint(value=(0, 0, 0, 0)))
