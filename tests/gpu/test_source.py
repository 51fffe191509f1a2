"""Shader text: `//! use`, and compile errors at the line a person wrote."""

from __future__ import annotations

import pytest

from airlight.errors import ShaderError
from airlight.gpu import source as shader_source
from airlight.gpu.slots import storage
from airlight.gpu.source import Source

OUT = (storage("results", "f32", "read_write"),)


@pytest.fixture
def library(tmp_path, monkeypatch):
    """library(name, text) adds a file to a library that replaces ours."""
    folder = tmp_path / "wgsl"
    folder.mkdir()
    monkeypatch.setattr(shader_source, "LIBRARIES", (folder,))
    return lambda name, text: (folder / f"{name}.wgsl").write_text(text)


def test_a_library_comes_once_and_before_its_users(library):
    library("inner", "const A = 1;")
    library("outer", "//! use inner\nconst B = A;")
    source = Source()
    source.add("//! use outer\n//! use inner\nconst C = B;", "pass.wgsl")
    code = [line for line in source.lines if not line.startswith("//!")]
    assert code == ["const A = 1;", "const B = A;", "const C = B;"]
    assert len(source.origins) == len(source.lines)


def test_a_library_that_uses_itself_ends(library):
    library("loop", "//! use loop\nconst A = 1;")
    source = Source()
    source.add("//! use loop", "pass.wgsl")
    assert source.lines.count("const A = 1;") == 1


@pytest.mark.parametrize("nested", [False, True])
def test_an_unknown_library_names_who_asked(library, nested):
    library("outer", "const A = 1;\n//! use phaze")
    source = Source()
    text = "\n//! use outer" if nested else "\n\n//! use phaze"
    with pytest.raises(ShaderError) as caught:
        source.add(text, "media/march/march.wgsl")
    where = "wgsl/outer.wgsl:2" if nested else "media/march/march.wgsl:3"
    assert str(caught.value) == f"{where}: there is no shader library 'phaze'"


def test_a_compile_error_names_the_pass_file_and_line(kernel, tmp_path):
    body = (
        "//! use phase\n"
        "@compute @workgroup_size(WX, WY, WZ)\n"
        "fn main(@builtin(global_invocation_id) id: vec3u) {\n"
        "    results[id.x] = no_such_name;\n"
        "}\n"
    )
    with pytest.raises(ShaderError) as caught:
        _ = kernel(body, OUT).pipeline
    message = str(caught.value)
    assert f"{tmp_path.name}/kernel.wgsl:4:21" in message
    assert "no_such_name" in message
    assert message.startswith("Kernel: ")


def test_a_compile_error_inside_a_library_names_the_library(kernel, library):
    library("broken", "// first\nfn half(x: f32) -> f32 {\n    return x * missing_half;\n}\n")
    body = (
        "//! use broken\n"
        "@compute @workgroup_size(WX, WY, WZ)\n"
        "fn main(@builtin(global_invocation_id) id: vec3u) {\n"
        "    results[id.x] = half(1.0);\n"
        "}\n"
    )
    with pytest.raises(ShaderError, match=r"wgsl/broken\.wgsl:3:16"):
        _ = kernel(body, OUT).pipeline


def test_a_message_about_no_known_line_stays_as_it_is():
    assert Source().mapped("at wgsl:7:1") == "at wgsl:7:1"
