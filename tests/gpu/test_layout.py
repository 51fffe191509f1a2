"""Struct offsets, held against WGSL itself: a shader reads every field back."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.gpu.layout import (
    Struct,
    f32,
    i32,
    mat4x4f,
    pack_array,
    u32,
    vec2f,
    vec2u,
    vec3f,
    vec3u,
    vec4f,
)
from airlight.gpu.memory import Buffer, buffer_of
from airlight.gpu.slots import storage, uniform


class ScalarAfterVector(Struct):
    """A scalar fits into the gap that a vec3 leaves."""

    a = vec3f()
    b = f32()
    c = vec3f()
    d = u32()


class VectorAfterScalar(Struct):
    """Gaps before and after."""

    a = f32()
    b = vec3f()
    c = vec2f()
    d = i32()
    e = vec2u()
    f = u32()


class Matrices(Struct):
    """Matrices between smaller things; the last needs padding at the end."""

    a = f32()
    b = mat4x4f()
    c = vec3u()
    d = mat4x4f()
    e = vec4f()
    f = f32()


STRUCTS = (ScalarAfterVector, VectorAfterScalar, Matrices)


def scalars(struct: type[Struct], place: str) -> list[str]:
    """WGSL expressions, as u32, of every scalar of `place`, matrices column by column."""
    found = []
    for name, field in struct.fields.items():
        if field.shape == ():
            found.append(f"{place}.{name}")
        elif len(field.shape) == 1:
            found += [f"{place}.{name}.{c}" for c in "xyzw"[: field.shape[0]]]
        else:
            found += [f"{place}.{name}[{c}][{r}]" for c in range(4) for r in range(4)]
    return [f"bitcast<u32>({text})" for text in found]


def values_of(struct: type[Struct], seed: int) -> dict[str, np.ndarray]:
    rng = np.random.default_rng(seed)
    return {
        name: (rng.normal(size=field.shape) * 1000).astype(field.dtype)
        if field.dtype is np.float32
        else rng.integers(0, 1 << 30, size=field.shape).astype(field.dtype)
        for name, field in struct.fields.items()
    }


def expected_words(values: dict[str, np.ndarray]) -> np.ndarray:
    # WGSL indexes a matrix by column first
    flat = [np.asarray(v).T.reshape(-1).view(np.uint32) for v in values.values()]
    return np.concatenate(flat)


@pytest.mark.parametrize("struct", STRUCTS)
def test_a_shader_reads_what_python_wrote(gpu, commands, kernel, owned, struct):
    rows = [values_of(struct, seed) for seed in range(4)]
    whole = values_of(struct, 9)
    size = len(scalars(struct, "given"))
    stores = [
        f"    results[id.x * {size}u + {k}u] = {text};"
        for k, text in enumerate(scalars(struct, "rows[id.x]"))
    ]
    stores += [
        f"    results[{4 * size + k}u] = {text};" for k, text in enumerate(scalars(struct, "given"))
    ]
    body = "\n".join(
        [
            "@compute @workgroup_size(WX, WY, WZ)",
            "fn main(@builtin(global_invocation_id) id: vec3u) {",
            "    if (id.x >= 4u) { return; }",
            *stores,
            "}",
        ]
    )
    slots = (
        uniform("given", struct),
        storage("rows", struct),
        storage("results", "u32", "read_write"),
    )
    read_back = kernel(body, slots)
    results = owned(Buffer(gpu, "results", 5 * size * 4))
    table = owned(buffer_of(gpu, "rows", pack_array(struct, rows)))
    read_back.dispatch(commands, (4,), given=struct(**whole), rows=table, results=results)
    commands.submit()
    expected = np.concatenate([expected_words(v) for v in (*rows, whole)])
    np.testing.assert_array_equal(results.read(np.uint32), expected)


def test_the_wgsl_names_every_field_with_its_unit():
    class Air(Struct):
        """Air."""

        sigma_t = vec3f("m^-1")
        g = f32()

    assert Air.wgsl == "struct Air {\n    sigma_t: vec3f,  // m^-1\n    g: f32,\n}\n"


def test_values_must_be_the_fields():
    with pytest.raises(TypeError, match=r"ScalarAfterVector: missing \['d'\], unknown \['x'\]"):
        ScalarAfterVector(a=(0, 0, 0), b=1, c=(0, 0, 0), x=1)


def test_an_array_of_structs_is_never_empty():
    assert pack_array(Matrices, []).shape == (1,)


def test_kept_parameters_are_packed_once():
    class Step(Struct):
        """A size and a share."""

        count = vec3u()
        share = f32()

    kept = Step.of(count=(1, 2, 3), share=0.5)
    assert Step.of(count=(1, 2, 3), share=0.5) is kept
    assert Step.of(count=(1, 2, 3), share=0.25) is not kept
    assert kept.data == Step(count=(1, 2, 3), share=0.5).record.tobytes()
    with pytest.raises(TypeError, match=r"^Step: missing \['share'\], unknown \[\]$"):
        Step.of(count=(1, 2, 3))
