"""Files made to break their readers: one message each, and quickly, before much is allocated."""

from __future__ import annotations

import io
import struct
import time
import tracemalloc
import zipfile
import zlib
from pathlib import Path

import numpy as np
import pytest

from airlight import load
from airlight.errors import SceneError
from airlight.scene.io.images import load_image, read_texture
from airlight.scene.io.light_groups import read_point_lights
from airlight.scene.io.volumes import read_volume

MOST_S, MOST_BYTES = 5.0, 400 << 20


@pytest.fixture(autouse=True)
def _is_quick_and_small():
    """What a file claims costs nothing."""
    began = time.process_time()
    tracemalloc.start()
    yield
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert time.process_time() - began < MOST_S
    assert peak < MOST_BYTES


def refusal(read, path: Path) -> str:
    """The message for a file; that it names it is checked."""
    with pytest.raises(SceneError) as caught:
        read(path)
    assert str(caught.value).startswith(str(path))
    return str(caught.value)


HUGE = "1" + "0" * 400


@pytest.mark.parametrize("number", [HUGE, f"{HUGE}.5", f"-{HUGE}", "1e999", "1" + "0" * 5000])
@pytest.mark.parametrize(
    "place",
    [
        "accessors.0.count",
        "accessors.0.byteOffset",
        "nodes.0.scale.0",
        "nodes.0.mesh",
        "cameras.0.perspective.yfov",
        "bufferViews.0.byteLength",
        "scene",
    ],
)
def test_gltf_numbers(bent_triangle, number, place):
    def bend(document):
        document["cameras"] = [{"type": "perspective", "perspective": {"yfov": 1}}]
        document["nodes"][0] |= {"camera": 0, "scale": [1, 1, 1]}
        document["scene"] = 0
        *path, last = [int(p) if p.isdigit() else p for p in place.split(".")]
        for key in path:
            document = document[key]
        document[last] = "NUMBER"

    path = bent_triangle(bend)
    path.write_text(path.read_text().replace('"NUMBER"', number))
    refusal(load, path)


@pytest.mark.parametrize("value", [3, "x", [{}], [[1]], True])
def test_gltf_extensions_that_are_no_objects(bent_triangle, value):
    def bend(document):
        document["materials"] = [{"extensions": {"KHR_materials_ior": value}}]
        document["meshes"][0]["primitives"][0]["material"] = 0

    assert "must be an object" in refusal(load, bent_triangle(bend))


def _sparse_of(count):
    def bend(document):
        accessor = document["accessors"][0]
        del accessor["bufferView"]
        accessor["count"] = count
        accessor["sparse"] = {
            "count": 1,
            "indices": {"bufferView": 1, "componentType": 5121},
            "values": {"bufferView": 0},
        }

    return bend


@pytest.mark.parametrize("count", [10**8, 2**30, 10**12])
def test_gltf_zeros(bent_triangle, count):
    assert "accessors[0]" in refusal(load, bent_triangle(_sparse_of(count)))


def test_gltf_zeros_of_many_accessors(bent_triangle):
    def bend(document):
        _sparse_of(1_000_000)(document)
        document["accessors"] += [document["accessors"][0]] * 100
        first = document["meshes"][0]["primitives"][0]
        document["meshes"][0]["primitives"] += [
            {**first, "attributes": {"POSITION": 2 + k}} for k in range(100)
        ]

    assert "its zeros are too many" in refusal(load, bent_triangle(bend))


def npy(shape: str, descr: str = "'<f4'", fortran: str = "False", end: str = "}") -> bytes:
    """An .npy file of 120 zeros whose header says these things."""
    text = f"{{'descr': {descr}, 'fortran_order': {fortran}, 'shape': {shape}{end}\n".encode()
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(text)) + text + bytes(480)


NPY = {
    "negative": npy("(-1, 5, 6)"),
    "very negative": npy("(-2147483649, 4294967295, 6)"),
    "beyond int64": npy("(0, 99999999999999999999, 6)"),
    "fractions": npy("(4.0, 5.0, 6.0)"),
    "text": npy("('4', '5', '6')"),
    "no tuple": npy("456"),
    "booleans": npy("(True, 5, 6)"),
    "no bytes each": npy("(4, 5, 6)", "'|S0'"),
    "void": npy("(4, 5, 6)", "'|V0'"),
    "nonsense type": npy("(4, 5, 6)", "'<q9'"),
    "no type": npy("(4, 5, 6)", "None"),
    "records": npy("(4, 5, 6)", "[('a', '<f4')]"),
    "objects": npy("(4, 5, 6)", "'|O'"),
    "dates": npy("(4, 5, 6)", "'<M8[D]'"),
    "no brace": npy("(4, 5, 6)", end=""),
    "no end": npy("(4, 5, 6", end=""),
    "call": npy("__import__('os').getpid()"),
    "deep": npy("(" * 5000 + ")" * 5000),
    "many": npy("(1,) * 9"),
    "digits": npy(f"({'9' * 5000}, 5, 6)"),
    "many axes": npy("(" + "1," * 100 + ")"),
    "huge": npy("(65536, 65536, 65536)"),
    "larger than it is": npy("(400, 500, 600)"),
    "null byte": npy("(4, 5, 6)\0"),
    "long header": b"\x93NUMPY\x02\x00" + struct.pack("<I", 1 << 31) + bytes(500),
}


@pytest.mark.parametrize("name", NPY)
def test_npy_headers(tmp_path, name):
    (tmp_path / "a.npy").write_bytes(NPY[name])
    refusal(read_volume, tmp_path / "a.npy")
    with zipfile.ZipFile(tmp_path / "a.npz", "w") as held:
        for array in ("density", "positions", "intensities"):
            held.writestr(f"{array}.npy", NPY[name])
    refusal(read_volume, tmp_path / "a.npz")
    refusal(read_point_lights, tmp_path / "a.npz")


@pytest.mark.parametrize("bounds", [3.0, [1, 2], [[0, 0, 0]], [[1, 1, 1], [0, 0, 0]], "text"])
def test_npz_bounds(tmp_path, bounds):
    np.savez(tmp_path / "a.npz", density=np.ones((2, 2, 2)), bounds=bounds)
    refusal(read_volume, tmp_path / "a.npz")


@pytest.mark.parametrize("read", [read_volume, read_point_lights])
def test_an_archive_that_unpacks_to_all_memory(tmp_path, read):
    shape = (1024, 1024, 1024)
    head = io.BytesIO()
    np.lib.format.write_array_header_1_0(
        head, {"descr": "<f4", "fortran_order": False, "shape": shape}
    )
    # Deflate packs zeros 1032 times; a directory may say so, whatever is there.
    with zipfile.ZipFile(tmp_path / "a.npz", "w", zipfile.ZIP_DEFLATED) as held:
        for array in ("density", "positions", "intensities"):
            held.writestr(f"{array}.npy", head.getvalue() + bytes(1 << 20))
    raw = (tmp_path / "a.npz").read_bytes()
    small = struct.pack("<I", len(head.getvalue()) + (1 << 20))
    (tmp_path / "a.npz").write_bytes(raw.replace(small, struct.pack("<I", (4 << 30) - 1)))
    assert "too many to be true" in refusal(read, tmp_path / "a.npz")


def hdr(header: str = "", size: str = "-Y 4 +X 4", body: bytes = bytes(64)) -> bytes:
    return f"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n{header}\n{size}\n".encode() + body


@pytest.mark.parametrize(
    "raw",
    [
        hdr("EXPOSURE=-\n"),
        hdr("EXPOSURE=\n"),
        hdr("EXPOSURE=1e\n"),
        hdr("EXPOSURE=1e400\n"),
        hdr("EXPOSURE=nan\n"),
        hdr("EXPOSURE=0\n"),
        hdr("EXPOSURE=1e9\nEXPOSURE=1e9\n"),
        hdr(size=f"-Y {'9' * 5000} +X 4"),
        hdr(size=f"-Y 4 +X {'9' * 5000}"),
        hdr(size="-Y 0 +X 4"),
        hdr(size="-Y 16000 +X 16000"),
        hdr(size="-Y 1000 +X 32767", body=b"\x02\x02\x7f\xff"),
    ],
)
def test_hdr(tmp_path, raw):
    (tmp_path / "a.hdr").write_bytes(raw)
    refusal(load_image, tmp_path / "a.hdr")


def png(width: int, height: int, *, bits: int = 8, color: int = 2) -> bytes:
    """A PNG that claims a size, with some rows of black."""

    def chunk(name: bytes, body: bytes) -> bytes:
        return (
            struct.pack(">I", len(body)) + name + body + struct.pack(">I", zlib.crc32(name + body))
        )

    head = struct.pack(">IIBBBBB", width, height, bits, color, 0, 0, 0)
    return (
        b"\x89PNG\r\n\x1a\n"
        + chunk(b"IHDR", head)
        + chunk(b"IDAT", zlib.compress(bytes(100_000)))
        + chunk(b"IEND", b"")
    )


@pytest.mark.parametrize(
    "raw",
    [
        png(12000, 12000),
        png(2**31 - 1, 2**31 - 1),
        png(16384, 16384, bits=1, color=0),
        png(65000, 65000),
        b"GIF89a" + struct.pack("<HH", 65535, 65535) + bytes(50),
        b"%!PS-Adobe-3.0 EPSF-3.0\n%%BoundingBox: 0 0 9999 9999\n(/etc/passwd) run\n",
    ],
)
def test_images(raw):
    with pytest.raises(SceneError, match=r"^a\.png: "):
        read_texture(raw, is_srgb=True, source="a.png")


def exr(low: tuple[int, int], high: tuple[int, int]) -> bytes:
    """An EXR of a data window, with no pixel."""

    def attribute(name: str, kind: str, body: bytes) -> bytes:
        return f"{name}\0{kind}\0".encode() + struct.pack("<I", len(body)) + body

    window = struct.pack("<4i", *low, *high)
    channels = b"".join(name + b"\0" + struct.pack("<iiii", 2, 0, 1, 1) for name in (b"B", b"G"))
    return (
        struct.pack("<II", 20000630, 2)
        + attribute("channels", "chlist", channels + b"\0")
        + attribute("compression", "compression", b"\3")
        + attribute("dataWindow", "box2i", window)
        + attribute("displayWindow", "box2i", window)
        + attribute("lineOrder", "lineOrder", b"\0")
        + attribute("pixelAspectRatio", "float", struct.pack("<f", 1))
        + attribute("screenWindowCenter", "v2f", struct.pack("<ff", 0, 0))
        + attribute("screenWindowWidth", "float", struct.pack("<f", 1))
        + bytes(200)
    )


@pytest.mark.parametrize(
    ("low", "high"),
    [
        ((0, 0), (12000, 12000)),
        ((0, 0), (2**30, 2**30)),
        ((-(2**31), 0), (2**31 - 1, 5)),
        ((5, 5), (0, 0)),
    ],
)
def test_exr(tmp_path, low, high):
    (tmp_path / "a.exr").write_bytes(exr(low, high))
    refusal(load_image, tmp_path / "a.exr")


STL_HEAD = b"made by hand".ljust(80)


@pytest.mark.parametrize(
    ("name", "raw"),
    [
        ("a.stl", STL_HEAD + struct.pack("<I", 4_000_000_000) + bytes(50)),
        ("a.stl", STL_HEAD + struct.pack("<I", 3) + bytes(50)),
        ("a.stl", STL_HEAD + struct.pack("<I", 1) + bytes(500)),
        ("a.stl", b"solid" + STL_HEAD[5:] + struct.pack("<I", 2) + bytes(50)),
        ("a.stl", b"\xff\xfe\x00" * 20),
        (
            "a.ply",
            b"ply\nformat binary_little_endian 1.0\nelement vertex 999999999999\n"
            b"property float x\nproperty float y\nproperty float z\nend_header\n" + bytes(36),
        ),
        ("a.ply", b"ply\nformat ascii 1.0\nelement vertex 900000000000000000\nend_header\n"),
        ("a.ply", b"ply\nformat ascii 1.0\nelement vertex " + b"9" * 5000 + b"\nend_header\n"),
        ("a.ply", b"ply\nformat ascii 1.0\nelement vertex -4\nproperty float x\nend_header\n0\n"),
        (
            "a.ply",
            b"ply\nformat ascii 1.0\nelement face 99999\nproperty list uchar int i\n"
            b"end_header\n3 0 1 2\n",
        ),
    ],
)
def test_mesh_counts(tmp_path, name, raw):
    (tmp_path / name).write_bytes(raw)
    refusal(load, tmp_path / name)


def xml(body: str) -> str:
    return f'<scene version="3.0.0">{body}</scene>'


def test_xml_parameters_that_double(tmp_path):
    lines = ['<default name="a0" value="' + "x" * 10 + '"/>']
    lines += [f'<default name="a{k}" value="{f"$a{k - 1}" * 10}"/>' for k in range(1, 12)]
    (tmp_path / "a.xml").write_text(xml("".join(lines)))
    assert "its parameters expand to more than" in refusal(load, tmp_path / "a.xml")


def test_xml_parameters_still_hold_parameters(tmp_path):
    (tmp_path / "a.xml").write_text(
        xml(
            '<default name="n" value="2"/><default name="nn" value="3"/>'
            '<default name="both" value="$nn$n"/>'
            '<shape type="cube"><transform name="to_world"><translate x="$both"/></transform>'
            "</shape>"
        )
    )
    assert load(tmp_path / "a.xml").meshes[0].world_from_object[0, 3] == 32.0


def test_an_xml_blend_of_nothing(tmp_path):
    (tmp_path / "a.xml").write_text(xml('<shape type="cube"><bsdf type="blendbsdf"/></shape>'))
    scene = load(tmp_path / "a.xml")
    assert any("has no BSDF inside" in warning for warning in scene.warnings)


def test_two_thousand_xml_spheres_share_their_triangles(tmp_path):
    (tmp_path / "a.xml").write_text(xml('<shape type="sphere"/>' * 2000))
    scene = load(tmp_path / "a.xml")
    assert len({id(mesh.geometry) for mesh in scene.meshes}) == 1


@pytest.mark.parametrize(
    "text",
    [
        ".".join(["a"] * 100_000) + " = 1\n",
        "[" + ".".join(["a"] * 100_000) + "]\n",
        "a = {" + ".".join(['"b c"'] * 100_000) + " = 1}\n",
        "[[" + " . ".join(["a"] * 100_000),
    ],
)
def test_toml_keys_of_many_parts(tmp_path, text):
    (tmp_path / "a.toml").write_text("\n" + text)
    message = refusal(load, tmp_path / "a.toml")
    assert "a.toml:2: a key of more than 32 parts" in message


def test_toml_text_is_searched_in_linear_time(tmp_path):
    (tmp_path / "a.toml").write_text('x = "' + "a" * 500_000 + '"\ny = "' + '" "' * 75_000)
    refusal(load, tmp_path / "a.toml")


def nvdb(size: int, *, packed: bytes = b"", codec: int = 0, high: int = 7) -> bytes:
    """A NanoVDB file of one grid that says that it unpacks to `size` bytes."""
    from airlight.scene.io.nanovdb import _FILE, _RECORD

    record = _RECORD.pack(
        size,
        len(packed),
        0,
        0,
        1,
        0,
        *[0.0] * 6,
        0,
        0,
        0,
        high,
        high,
        high,
        *[0.0] * 3,
        8,
        0,
        0,
        0,
        0,
        0,
        0,
        0,
        codec,
        0,
        0,
    )
    return _FILE.pack(b"NanoVDB0", 32 << 21, 1, codec) + record + b"density\0" + packed


@pytest.mark.parametrize("size", [1 << 63, (1 << 64) - 1, 1 << 40])
@pytest.mark.parametrize("codec", [0, 1, 2, 9])
def test_nvdb_sizes(tmp_path, size, codec):
    packed = bytes(8) + zlib.compress(bytes(5000))
    (tmp_path / "a.nvdb").write_bytes(nvdb(size, packed=packed, codec=codec))
    refusal(read_volume, tmp_path / "a.nvdb")


@pytest.mark.parametrize("high", [999, 1 << 20, (1 << 31) - 1])
def test_nvdb_spans(tmp_path, high):
    packed = bytes(8) + zlib.compress(bytes(5000))
    (tmp_path / "a.nvdb").write_bytes(nvdb(5000, packed=packed, codec=1, high=high))
    assert "too many" in refusal(read_volume, tmp_path / "a.nvdb")


OUT_OF_RANGE = {
    "[[mesh]] 1: scale": '[[mesh]]\nshape = "box"\nscale = 1e30\n',
    "[[mesh]] 1: emission": '[[mesh]]\nshape = "box"\nemission = 1e38\n',
    "mesh 'box' reaches": '[[mesh]]\nshape = "box"\nscale = 1e8\ntranslate = [900000000, 0, 0]\n',
    "[environment]: radiance": '[[mesh]]\nshape = "box"\n[environment]\nradiance = 1e38\n',
    "[environment]: scale": '[[mesh]]\nshape = "box"\n[environment]\nscale = 1e30\n',
    "[medium]: sigma_t": '[[mesh]]\nshape = "box"\n[medium]\nsigma_t = 1e308\n',
    "[[volume]] 1: sigma_s": '[[volume]]\nshape = "box"\nsigma_s = 1e308\n',
    "[camera]: position": '[[mesh]]\nshape = "box"\n[camera]\nposition = [1e30, 0, 0]\n'
    "target = [0, 0, 0]\n",
    "[camera]: exposure_stops": '[[mesh]]\nshape = "box"\n[camera]\nposition = [1, 0, 0]\n'
    "target = [0, 0, 0]\nexposure_stops = 1e308\n",
    "[[light]] 1: intensity": '[[mesh]]\nshape = "box"\n[[light]]\ntype = "point"\n'
    "position = [0, 2, 0]\nintensity = 1e38\n",
}


@pytest.mark.parametrize("key", OUT_OF_RANGE)
def test_numbers_out_of_range_are_named(tmp_path, key):
    (tmp_path / "a.toml").write_text(OUT_OF_RANGE[key])
    assert f"a.toml: {key}" in refusal(load, tmp_path / "a.toml")


def test_clip_speed(draft, tmp_path):
    draft.single(draft.triangle())
    times, values = draft.array([0.0, 1.0], "f4"), draft.array([(0, 0, 0), (1, 0, 0)], "f4")
    draft.json["animations"] = [
        {
            "channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}],
            "samplers": [{"input": times, "output": values}],
        }
    ]
    draft.glb()
    for speed in ("1e308", "-1", "0"):
        (tmp_path / "a.toml").write_text(f'[[mesh]]\nfile = "thing.glb"\nclip_speed = {speed}\n')
        assert "[[mesh]] 1: clip_speed" in refusal(load, tmp_path / "a.toml")
