"""Compute passes: parameters per dispatch, refused names, bind groups made once."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.errors import DeviceError
from airlight.gpu.compute import ComputePass, shader_path
from airlight.gpu.layout import Struct, f32, u32
from airlight.gpu.memory import Buffer, Texture, linear_sampler
from airlight.gpu.slots import image, sampler, storage, texture, uniform


class Put(Struct):
    """A value and where it goes."""

    index = u32()
    value = f32()


PUT_SLOTS = (uniform("params", Put), storage("results", "f32", "read_write"))
PUT = """
@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x == 0u) { results[params.index] = params.value; }
}
"""


@pytest.fixture
def put(kernel):
    return kernel(PUT, PUT_SLOTS)


def test_dispatches_of_one_submit_keep_their_own_parameters(gpu, commands, put, owned):
    # A uniform buffer that is rewritten between dispatches shows its last value to all of them.
    results = owned(Buffer(gpu, "results", 40 * 4))
    for index in range(40):
        params = Put(index=index, value=100.0 + index)
        put.dispatch(commands, (1,), params=params, results=results)
    commands.submit()
    np.testing.assert_array_equal(results.read(), np.arange(100.0, 140.0))


def test_the_next_submit_restarts(gpu, commands, put, owned):
    results = owned(Buffer(gpu, "results", 16))
    for value in (1.0, 2.0):
        put.dispatch(commands, (1,), params=Put(index=0, value=value), results=results)
        commands.submit()
        assert results.read()[0] == value
    commands.submit()  # nothing encoded: nothing happens
    assert results.read()[0] == 2.0


def test_the_same_parameters_object_serves_many_dispatches(gpu, commands, put, owned):
    shared = Put(index=1, value=7.0)
    buffers = [owned(Buffer(gpu, "results", 16)) for _ in range(3)]
    for buffer in buffers:
        put.dispatch(commands, (1,), params=shared, results=buffer)
    commands.submit()
    assert [buffer.read()[1] for buffer in buffers] == [7.0, 7.0, 7.0]


def test_missing_and_unknown_names_are_refused(commands, put):
    with pytest.raises(TypeError, match=r"^Kernel: missing \['results'\], unknown \['result'\]$"):
        put.dispatch(commands, (1,), params=Put(index=0, value=0), result=None)


def test_parameters_must_be_a_struct(gpu, commands, put, owned):
    results = owned(Buffer(gpu, "results", 16))
    with pytest.raises(TypeError, match=r"^uniform parameters must be a Struct, not dict$"):
        put.dispatch(commands, (1,), params={"index": 0, "value": 1.0}, results=results)


def test_bind_groups_are_made_once(gpu, commands, put, owned, monkeypatch):
    made = []
    cls = type(gpu.device)
    original = cls.create_bind_group

    def counting(self, **named):
        made.append(named["label"])
        return original(self, **named)

    monkeypatch.setattr(cls, "create_bind_group", counting)
    buffers = [owned(Buffer(gpu, "results", 16)) for _ in range(2)]
    for frame in range(5):
        for buffer in buffers:
            put.dispatch(commands, (1,), params=Put(index=0, value=frame), results=buffer)
        commands.submit()
    assert made == ["Kernel", "Kernel"]
    assert [buffer.read()[0] for buffer in buffers] == [4.0, 4.0]


def test_the_grid_covers_every_invocation_in_three_dimensions(gpu, commands, kernel, owned):
    count = kernel(
        "@compute @workgroup_size(WX, WY, WZ)\n"
        "fn main(@builtin(global_invocation_id) id: vec3u) {\n"
        "    if (all(id < vec3u(5u, 3u, 2u))) {\n"
        "        atomicAdd(&results[(id.z * 3u + id.y) * 5u + id.x], 1);\n    }\n}\n",
        (storage("results", "atomic<i32>", "read_write"),),
        workgroup=(4, 2, 1),
    )
    results = owned(Buffer(gpu, "results", 30 * 4))
    count.dispatch(commands, (5, 3, 2), results=results)
    commands.submit()
    np.testing.assert_array_equal(results.read(np.int32)[:30], 1)


def test_a_grid_beyond_the_limits_is_refused(gpu, commands, put, owned):
    results = owned(Buffer(gpu, "results", 16))
    limit = "max-compute-workgroups-per-dimension"
    with pytest.raises(DeviceError) as caught:
        put.dispatch(commands, (1 << 30,), params=Put(index=0, value=0), results=results)
    assert str(caught.value) == (
        f"pass 'Kernel' needs {limit} = {(1 << 30) // 64}, {gpu.info.name} has "
        f"{gpu.limits[limit]}. Make it smaller"
    )


def test_overrides_are_set_when_the_pass_is_made(gpu, commands, kernel, owned, tmp_path):
    path = tmp_path / "override.wgsl"
    path.write_text(
        "override FACTOR: f32 = 1.0;\n@compute @workgroup_size(WX, WY, WZ)\n"
        "fn main(@builtin(global_invocation_id) id: vec3u) {\n"
        "    if (id.x == 0u) { results[0] = FACTOR * generated(); }\n}\n"
    )
    members = {
        "__module__": __name__,
        "file": str(path),
        "workgroup": (64, 1, 1),
        "slots": (storage("results", "f32", "read_write"),),
    }
    cls = type("Override", (ComputePass,), members)
    results = owned(Buffer(gpu, "results", 16))
    text = "fn generated() -> f32 { return 3.0; }"
    for constants, expected in ((None, 3.0), ({"FACTOR": 2.5}, 7.5)):
        made = cls(gpu, constants=constants, generated=text)
        made.dispatch(commands, (1,), results=results)
        commands.submit()
        assert results.read()[0] == expected


def test_textures_samplers_and_images_are_bound(gpu, commands, kernel, owned):
    halve = kernel(
        "@compute @workgroup_size(WX, WY, WZ)\n"
        "fn main(@builtin(global_invocation_id) id: vec3u) {\n"
        "    let value = textureSampleLevel(source, linear, vec3f(0.5), 0.0);\n"
        "    textureStore(target_image, id.xy, value);\n}\n",
        (texture("source", "3d"), sampler("linear"), image("target_image", "rgba32float")),
        workgroup=(1, 1, 1),
    )
    volume = owned(Texture(gpu, "volume", (2, 2, 2), "rgba16float", dimension="3d"))
    volume.write(np.arange(32, dtype=np.float16).reshape(2, 2, 2, 4))
    target = owned(Texture(gpu, "target", (1, 1), "rgba32float", written=True))
    halve.dispatch(commands, (1,), source=volume, linear=linear_sampler(gpu), target_image=target)
    commands.submit()
    np.testing.assert_allclose(target.read()[0, 0], [14.0, 15.0, 16.0, 17.0], atol=1e-2)


def test_the_shader_lies_beside_its_class():
    class Beside(ComputePass):
        """No file named."""

    class Named(ComputePass):
        """A file named."""

        file = "other.wgsl"

    assert shader_path(Beside).name == "test_compute.wgsl"
    assert shader_path(Named).parent == shader_path(Beside).parent
    assert shader_path(Named).name == "other.wgsl"
