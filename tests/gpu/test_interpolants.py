"""Parameters that pixels have from their triangle, held against those that were given."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.gpu.fullscreen import FullscreenPass
from airlight.gpu.interpolants import MOST_WORDS, interpolated
from airlight.gpu.layout import Struct, f32, i32, mat4x4f, pack_array, u32, vec2f, vec3f, vec3u
from airlight.gpu.memory import Texture, buffer_of
from airlight.gpu.slots import storage, uniform


class Kinds(Struct):
    """A field of each kind."""

    matrix = mat4x4f()
    place = vec3f()
    count = u32()
    cells = vec3u()
    step = i32()
    size = vec2f()


class Light(Struct):
    """A row of a table."""

    colour = vec3f()
    unread = vec3f()
    power = f32()


WGSL = """
@fragment fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let light = first_lights();
    let all = array(params.matrix[0], params.matrix[3], vec4f(params.place, f32(params.count)),
        vec4f(vec3f(params.cells), f32(params.step)),
        vec4f(params.size, light.power, light.colour.y),
        lights[1].colour.xyzz);
    return all[u32(position.x)];
}
"""


def test_pixels_read_what_was_given(gpu, commands, owned, tmp_path):
    (tmp_path / "kinds.wgsl").write_text(WGSL)
    members = {
        "__module__": __name__,
        "file": str(tmp_path / "kinds.wgsl"),
        "targets": ("rgba32float",),
        "slots": (uniform("params", Kinds), storage("lights", Light)),
    }
    made = type("KindsPass", (FullscreenPass,), members)(gpu, firsts={"lights": ("unread",)})
    assert made.label == "KindsPass"
    matrix = np.arange(16.0).reshape(4, 4)
    params = Kinds(
        matrix=matrix,
        place=(0.5, 1e-30, -3e9),
        count=4_000_000,
        cells=(1, 2, 3),
        step=-7,
        size=(8, 9),
    )
    rows = [
        {"colour": (1, 2, 3), "unread": (9, 9, 9), "power": 0.25},
        {"colour": (4, 5, 6), "unread": (9, 9, 9), "power": 0},
    ]
    lights = owned(buffer_of(gpu, "lights", pack_array(Light, rows)))
    target = owned(Texture(gpu, "target", (6, 1), "rgba32float", target=True, written=True))
    made.draw(commands, (target,), params=params, lights=lights)
    commands.submit()
    expected = [
        matrix[:, 0],
        matrix[:, 3],
        (0.5, 1e-30, -3e9, 4e6),
        (1, 2, 3, -7),
        (8, 9, 0.25, 2),
        (4, 5, 6, 6),
    ]
    np.testing.assert_array_equal(target.read()[0], np.asarray(expected, np.float32))


def test_as_much_is_interpolated_as_fits():
    slots = (uniform("params", Kinds), *(storage(f"table{i}", Kinds) for i in range(3)))
    names = {slot.name: () for slot in slots[1:]}
    made = interpolated(slots, names, WGSL)
    assert made.entry == "interpolated_fragment"
    words = sum(field.size // 4 for field in Kinds.fields.values())
    assert MOST_WORDS // words == 2
    assert "return carried_table0;" in made.generated
    assert "return table1[0];" in made.generated
    assert "return table2[0];" in made.generated
    assert "var<uniform> stored_params: Kinds;" in made.slots[0].declaration


@pytest.mark.parametrize("entry", ["in: Corner", "@builtin(position) at: vec4f"])
def test_other_entries_are_left_as_they_are(entry):
    text = f"@fragment fn fragment({entry}) -> @location(0) vec4f {{ return vec4f(); }}"
    slots = (uniform("params", Kinds),)
    made = interpolated(slots, {}, text)
    assert (made.slots, made.text, made.entry) == (slots, text, "fragment")
