"""What the fuzzer found, made small: each row was a failure once, and is said in words now."""

from __future__ import annotations

import json
import struct

import numpy as np
import pytest

from airlight.errors import AirlightError
from fuzz import seeds, texts
from fuzz.targets import Case
from fuzz.trial import Ground, _opened

QUAD = {"mesh": [{"shape": "quad"}]}
TRIANGLE = b"v 0 0 0\nv 1 0 0\nv 0 1 0\n"


def toml(**tables) -> Case:
    return Case({"s.toml": texts.toml_text({**QUAD, **tables})}, "s.toml")


def one(name: str, raw: bytes, how: str = "load") -> Case:
    return Case({name: raw}, name, how)


def obj(lines: bytes, mtl: bytes | None = None, how: str = "load") -> Case:
    files = {"a.obj": lines} if mtl is None else {"a.obj": lines, "a.mtl": mtl}
    return Case(files, "a.obj", how)


def tiles(count: int) -> bytes:
    """A NanoVDB grid whose root says that it has so many tiles."""
    raw = seeds.nvdb(packed=True)
    buffer = bytearray(seeds.nvdb_buffer(raw))
    root = 672 + struct.unpack_from("<4q", buffer, 672)[3]
    struct.pack_into("<I", buffer, root + 24, count)
    return seeds.nvdb_repacked(bytes(buffer), raw)


def exr(**attributes) -> bytes:
    import OpenEXR

    flat = np.ones((2, 2), np.float32)
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage, **attributes}

    def save(path):
        OpenEXR.File(header, dict.fromkeys("RGB", flat)).write(str(path))

    return seeds._saved("a.exr", save)


def light_field(eye) -> bytes:
    header = {
        "format": "airlight light field",
        "version": 1,
        "technique": "pop",
        "scene": "s",
        "lattices": [],
        "arrays": {"volume0": {}},
        "volumes": [{"array": "volume0", "world_from_unit": np.eye(4).tolist(), "eye_m": eye}],
    }
    return seeds.npz(header=np.array(json.dumps(header)), volume0=np.ones((2, 2, 2, 3), np.float32))


FAR = b"solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex %s 0 0\nvertex 0 1 0\n"
EYE = {"position": [0, 1, 4], "target": [0, 1, 0], "between": "linear"}
FINDS: dict[str, tuple[Case, str]] = {
    "how keyframes are joined, without any": (toml(camera=EYE), ""),
    "the same of an environment": (toml(environment={"radiance": 1, "between": "step"}), ""),
    "a key of two lines": (toml(**{"a\nb": 1}), r"unknown key outside any table, 'a\nb'"),
    "a text without an end": (toml(camera={"x" * 10**5: 1}), "x ... x"),
    "a colour without an end": (
        one(
            "a.xml",
            b'<scene version="3.0.0"><shape type="cube"><bsdf type="diffuse"><rgb '
            b'name="reflectance" value="%s"/></bsdf></shape></scene>' % (b"9" * 5000),
        ),
        " ... ",
    ),
    "a number that turns the line": (
        one(
            "a.xml",
            '<scene version="3.0.0"><shape type="cube"><transform name="to_world">'
            '<translate x="\u202e1"/></transform></shape></scene>'.encode(),
        ),
        r"'\u202e1', not a number",
    ),
    "a version that deletes": (
        one("a.gltf", b'{"asset": {"version": "\x7f.0"}}'),
        r"version '\x7f.0' is not supported",
    ),
    "an extension that is a number": (
        one(
            "a.gltf",
            json.dumps(
                {
                    "asset": {"version": "2.0"},
                    "scenes": [{"nodes": [0]}],
                    "nodes": [{"mesh": 0}],
                    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}],
                    "accessors": [{"componentType": 5126, "count": 3, "type": "VEC3"}],
                    "materials": [{"extensions": {"KHR_materials_ior": 7}}],
                }
            ).encode(),
        ),
        "materials[0].extensions.KHR_materials_ior: must be an object, not 7",
    ),
    "a null in a position": (obj(b"v \0"), r"'v \x00' is not"),
    "a null in a corner": (obj(TRIANGLE + b"f \0"), r"'f \x00' is not"),
    "a null in a material": (obj(b"mtllib a.mtl\n", b"newmtl a\nd \0"), r"'d \x00' is not"),
    "a material's name that beeps": (obj(TRIANGLE + b"usemtl \7\nf 1 2 3"), ""),
    "a library's name that is a null": (obj(b"mtllib \0\n" + TRIANGLE + b"f 1 2 3"), ""),
    "a texture's name that beeps": (
        obj(b"mtllib a.mtl\n" + TRIANGLE + b"usemtl a\nf 1 2 3", b"newmtl a\nmap_Kd \7.png"),
        "",
    ),
    "two hundred materials that are not there": (
        obj(TRIANGLE + b"".join(b"usemtl m%d\nf 1 2 3\n" % k for k in range(200)), how="validate"),
        "",
    ),
    "a property without an end": (
        one(
            "a.ply",
            b"ply\nformat ascii 1.0\nelement vertex 1\nproperty %s x\nend_header\n0\n"
            % (b"[" * 3000),
        ),
        "",
    ),
    "a vertex at infinity": (one("a.stl", FAR % b"inf" + b"endloop\nendfacet\nendsolid a"), ""),
    "a vertex beyond single precision": (
        one("a.stl", FAR % b"1e39" + b"endloop\nendfacet\nendsolid a"),
        "",
    ),
    "densities beyond single precision": (
        one("a.npy", seeds.npy(np.full((2, 2, 2), 1e300))),
        "8 of its 8 values are infinite",
    ),
    "a header that is not quite Python": (
        one("a.npy", seeds.npy(seeds.smoke()).replace(b"False, 'shape'", b"0or 1, 'shape'")),
        "",
    ),
    "a root of more tiles than it has": (one("a.nvdb", tiles(512)), ""),
    "an exposure that is a text": (
        one("a.exr", exr(airlight_exposure_stops="x"), "info"),
        "attributes are damaged",
    ),
    "statistics that are a number": (
        one("a.exr", exr(airlight_stats="7"), "info"),
        "attributes are damaged",
    ),
    "an eye 10^400 m away": (
        one("a.npz", light_field([10**400, 0, 0]), "light field"),
        "not a readable light field",
    ),
    "an image of 8 x 16646144 pixels in 100 bytes": (
        one(
            "a.png",
            seeds.png_of(
                [
                    (kind, content[:4] + (0xFE0006).to_bytes(4, "big") + content[8:])
                    if kind == b"IHDR"
                    else (kind, content)
                    for kind, content in seeds.png_chunks(seeds.image("PNG"))
                ]
            ),
            "info",
        ),
        "too few for an image",
    ),
}


@pytest.mark.parametrize("name", FINDS)
def test_what_was_found_is_said_in_words(tmp_path, name):
    case, words = FINDS[name]
    ground = Ground(tmp_path)
    failure = ground.attempt(case)
    assert failure is None, failure
    if words:
        with pytest.raises(AirlightError) as caught:
            _opened(ground.folder / case.main, case.how)
        assert words in str(caught.value)


def test_names_in_a_vdb_that_are_no_text(tmp_path):
    raw = seeds.vdb().replace(b"fog volume", b"fog\xff\xfeolume")
    assert Ground(tmp_path).attempt(one("a.vdb", raw)) is None
