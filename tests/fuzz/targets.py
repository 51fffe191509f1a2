"""Loaders, and how their inputs are made: a good file of the format, then damaged."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cache
from random import Random
from typing import Any

import numpy as np

from . import documents, mutate_bytes, mutate_tree, seeds, texts
from .mutate_tree import Words

DEEP = 20_000
"""Python's recursion limit while inputs are made; the loaders run under the usual one."""


@dataclass(frozen=True)
class Case:
    """One input: files by name, the one that is opened, and the way it is.

    `how` is "load" for `airlight.load`, "light field" for `LightField.load`, or the words of a
    command before the file's name.
    """

    files: seeds.Files
    main: str
    how: str = "load"


Maker = Callable[[Random], Case]
HOW = ("load", "load", "load", "load", "validate", "info", "info --json")


def case(loader: str, seed: int, number: int) -> Case:
    """Input `number` of a loader under a seed."""
    with deeply():
        return LOADERS[loader](Random(f"{seed}/{loader}/{number}"))


@contextmanager
def deeply() -> Iterator[None]:
    """With a recursion limit that documents of hundreds of levels can be written under."""
    before = sys.getrecursionlimit()
    sys.setrecursionlimit(DEEP)
    try:
        yield
    finally:
        sys.setrecursionlimit(before)


def _bytes(raw: bytes, random: Random, other: bytes = b"") -> bytes:
    return mutate_bytes.damaged(raw, random, other)


def _others(files: seeds.Files, random: Random) -> seeds.Files:
    """The files beside the one that is opened; now and then one of them is damaged or missing."""
    made = dict(files)
    if made and random.random() < 0.15:
        name = random.choice(sorted(made))
        raw = made.pop(name)
        if random.random() < 0.8:
            made[name] = _bytes(raw, random)
    return made


def _document(document: Any, words: Words, write: Callable[[Any], bytes], random: Random) -> bytes:
    """The file of a damaged document; one in six has damaged bytes besides, or only those."""
    roll = random.random()
    changed = document if roll < 0.08 else mutate_tree.damaged(document, random, words)
    raw = write(changed)
    return _bytes(raw, random) if roll < 0.16 else raw


# ---- Scenes ------------------------------------------------------------------------------------


@cache
def _good_gltf() -> tuple[bytes, bytes]:
    document, binary = documents.gltf()
    return texts.json_text(document), binary


def _new_gltf(uri: str | None) -> dict[str, Any]:
    """The good document, to be damaged; its buffer under `uri`."""
    document: dict[str, Any] = json.loads(_good_gltf()[0])
    if uri is not None:
        document["buffers"][0]["uri"] = uri
    return document


@cache
def _gltf_text() -> bytes:
    return texts.json_text(_new_gltf(documents.embedded(_good_gltf()[1])))


@cache
def _scene_words() -> Words:
    return documents.scene_words()


@cache
def _xml_json() -> str:
    return json.dumps(texts.xml_document(documents.XML))


def _toml(random: Random) -> Case:
    files = _others({**documents.SCENE_FILES, "thing.gltf": _gltf_text()}, random)
    table = documents.scene_table()
    # Fewer tables make an error in one of them heard: the first error ends the reading.
    for name in [name for name in table if random.random() < 0.5]:
        del table[name]
    for name in ("mesh", "light", "volume"):
        if name in table and random.random() < 0.7:
            table[name] = [random.choice(table[name])]
    if not table.keys() & {"mesh", "volume", "medium"}:
        table["mesh"] = [{"shape": "quad"}]
    raw = _document(table, _scene_words(), texts.toml_text, random)
    return Case({**files, "scene.toml": raw}, "scene.toml", random.choice(HOW))


def _gltf(random: Random) -> Case:
    binary = _good_gltf()[1]
    name, files = "thing.bin", {"t.png": seeds.image("PNG")}
    if random.random() < 0.1:
        binary = _bytes(binary, random)
    is_embedded = random.random() < 0.3
    uri = documents.embedded(binary) if is_embedded else name
    if not is_embedded:
        files[name] = binary
    raw = _document(_thinned(_new_gltf(uri), random), documents.GLTF_WORDS, texts.json_text, random)
    return Case({**_others(files, random), "a.gltf": raw}, "a.gltf", random.choice(HOW))


def _thinned(document: dict[str, Any], random: Random) -> dict[str, Any]:
    """Now and then without what is read first, so that what is read later is heard of."""
    for name in ("animations", "skins", "materials"):
        if random.random() < 0.15:
            del document[name]
            for node in document["nodes"]:
                node.pop("skin", None) if name == "skins" else None
            for mesh in document["meshes"] if name == "materials" else ():
                for primitive in mesh["primitives"]:
                    primitive.pop("material", None)
    return document


def _glb(random: Random) -> Case:
    document, binary = _new_gltf(None), _good_gltf()[1]
    roll = random.random()
    if roll < 0.35:
        binary = _bytes(binary, random)
    elif roll < 0.7:
        document = mutate_tree.damaged(_thinned(document, random), random, documents.GLTF_WORDS)
    raw = documents.glb_of(texts.json_text(document), binary)
    if roll > 0.7:
        raw = _bytes(raw, random)
    files = {"t.png": seeds.image("PNG"), "a.glb": raw}
    return Case(files, "a.glb", random.choice(HOW))


def _xml(random: Random) -> Case:
    files = {
        "t.png": seeds.image("PNG"),
        "thing.obj": seeds.OBJ,
        "thing.mtl": seeds.MTL,
        "thing.ply": seeds.PLY,
        "smoke.vol": seeds.vol(),
        "part.xml": documents.PART,
    }
    document = json.loads(_xml_json())
    # Half the shapes and lights: the first error ends the reading.
    document[texts.CHILDREN] = [
        child
        for child in document[texts.CHILDREN]
        if child[texts.TAG] not in ("shape", "emitter", "sensor") or random.random() < 0.5
    ]
    raw = _document(document, documents.XML_WORDS, texts.xml_text, random)
    return Case({**_others(files, random), "scene.xml": raw}, "scene.xml", random.choice(HOW))


# ---- Meshes ------------------------------------------------------------------------------------


def _obj(random: Random) -> Case:
    files = {"t.png": seeds.image("PNG"), "thing.mtl": seeds.MTL, "thing.obj": seeds.OBJ}
    name = random.choice(("thing.obj", "thing.obj", "thing.mtl"))
    files[name] = _bytes(files[name], random, seeds.OBJ)
    return Case(files, "thing.obj", random.choice(HOW))


def _ply(random: Random) -> Case:
    raw = random.choice((seeds.PLY, seeds.ply(), seeds.ply(big=True)))
    return Case({"a.ply": _bytes(raw, random, seeds.PLY)}, "a.ply", random.choice(HOW))


def _stl(random: Random) -> Case:
    raw = random.choice((seeds.STL, seeds.stl()))
    return Case({"a.stl": _bytes(raw, random, seeds.stl())}, "a.stl", random.choice(HOW))


# ---- Grids -------------------------------------------------------------------------------------


def _grid(name: str, raws: Callable[[], Sequence[bytes]]) -> Maker:
    def make(random: Random) -> Case:
        good = raws()
        raw = _bytes(random.choice(good), random, good[0])
        return Case({name: raw}, name, random.choice(HOW))

    return make


@cache
def _npys() -> tuple[bytes, ...]:
    smoke = seeds.smoke()
    fortran = np.asfortranarray(smoke.astype(np.float64))
    return tuple(seeds.npy(a) for a in (smoke, fortran, smoke[..., None], smoke.astype(np.uint8)))


def _npz(random: Random) -> Case:
    """Damage to the archive, or to an array within it."""
    box = np.array([(-1, 0, -1), (1, 2, 1)], float)
    if random.random() < 0.5:
        raw = seeds.npz(packed=random.random() < 0.5, density=seeds.smoke(), bounds=box)
        return Case({"a.npz": _bytes(raw, random)}, "a.npz", random.choice(HOW))
    parts = {"density.npy": seeds.npy(seeds.smoke()), "bounds.npy": seeds.npy(box)}
    name = random.choice(sorted(parts))
    parts[name] = _bytes(parts[name], random)
    return Case({"a.npz": _zip(parts)}, "a.npz", random.choice(HOW))


def _zip(parts: seeds.Files) -> bytes:
    import io
    import zipfile

    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, raw in parts.items():
            archive.writestr(zipfile.ZipInfo(name), raw)
    return stream.getvalue()


def _nvdb(random: Random) -> Case:
    is_packed = random.random() < 0.8  # unpacked it is long, and slow to write
    raw = seeds.nvdb(packed=is_packed)
    if is_packed and random.random() < 0.6:
        buffer = bytearray(seeds.nvdb_buffer(raw))
        for _ in range(random.choice((1, 2, 3))):  # in the head, where counts and offsets stand
            at = random.choice((296, 640, 672, 672, 672)) + 4 * random.randrange(30)
            value = random.choice(mutate_bytes.NUMBERS) % 2**32
            buffer[at : at + 4] = value.to_bytes(4, "little")
        raw = seeds.nvdb_repacked(bytes(buffer), raw)
    else:
        raw = _bytes(raw, random)
    return Case({"a.nvdb": raw}, "a.nvdb", random.choice(HOW))


def _lights(random: Random) -> Case:
    """An .npz of point lights, which a scene file names."""
    parts = {n: seeds.npy(np.ones((3, 3))) for n in ("positions.npy", "intensities.npy")}
    raw = _zip(parts)
    if random.random() < 0.7:
        name = random.choice(sorted(parts))
        raw = _zip({**parts, name: _bytes(parts[name], random)})
    else:
        raw = _bytes(raw, random)
    scene = {"mesh": [{"shape": "quad"}], "light": [{"type": "points", "file": "lights.npz"}]}
    files = {"lights.npz": raw, "scene.toml": texts.toml_text(scene)}
    return Case(files, "scene.toml", random.choice(HOW))


def _field(random: Random) -> Case:
    raw = _field_bytes()
    if random.random() < 0.6:
        raw = _zip(_field_parts(raw, random))
    else:
        raw = _bytes(raw, random)
    return Case({"light.npz": raw}, "light.npz", "light field")


@cache
def _field_bytes() -> bytes:
    return seeds.light_field()


def _field_parts(raw: bytes, random: Random) -> seeds.Files:
    """The arrays of a light field, one of them damaged, or its header."""
    import io
    import zipfile

    with zipfile.ZipFile(io.BytesIO(raw)) as archive:
        parts = {name: archive.read(name) for name in archive.namelist()}
    name = random.choice([*sorted(parts), *["header.npy"] * 4])
    if name != "header.npy":
        return {**parts, name: _bytes(parts[name], random)}
    header = json.loads(str(np.load(io.BytesIO(parts[name]))))
    words = Words(("lattices", "volumes", "arrays", "array"), ("volume0", "lattice0_air", "lobe"))
    text = texts.json_text(mutate_tree.damaged(header, random, words)).decode()
    return {**parts, name: seeds.npy(np.array(text))}


# ---- Images ----------------------------------------------------------------------------------


def _image(kind: str, raws: Callable[[], Sequence[bytes]]) -> Maker:
    """A damaged image on its own (`info`), as an environment, or as a texture."""

    def make(random: Random) -> Case:
        good = raws()
        raw = random.choice(good)
        raw = (
            _png_damaged(raw, random)
            if kind == "png" and random.random() < 0.6
            else (_bytes(raw, random, good[0]))
        )
        name = f"t.{kind}"
        use = random.choice(("environment", "environment", "texture", "alone"))
        if use == "alone":
            return Case({name: raw}, name, random.choice(("info", "info --json")))
        if use == "texture" and kind not in ("exr", "hdr"):
            mtl = seeds.MTL.replace(b"t.png", name.encode())
            return Case({name: raw, "thing.mtl": mtl, "thing.obj": seeds.OBJ}, "thing.obj")
        scene = {"mesh": [{"shape": "quad"}], "environment": {"file": name}}
        return Case({name: raw, "s.toml": texts.toml_text(scene)}, "s.toml", random.choice(HOW))

    return make


def _png_damaged(raw: bytes, random: Random) -> bytes:
    """A chunk's content damaged, its sum right."""
    chunks = seeds.png_chunks(raw)
    k = random.randrange(len(chunks))
    kind, content = chunks[k]
    if kind == b"IHDR" and random.random() < 0.7:
        at = random.choice((0, 4))
        size = random.choice(mutate_bytes.NUMBERS) % 2**31
        content = content[:at] + size.to_bytes(4, "big") + content[at + 4 :]
    else:
        content = _bytes(content, random)
    chunks[k : k + random.choice((1, 1, 1, 0))] = [(kind, content)]
    return seeds.png_of(chunks)


@cache
def _pngs() -> tuple[bytes, ...]:
    return tuple(seeds.image("PNG", mode) for mode in ("RGBA", "RGB", "L", "P", "1", "I;16"))


@cache
def _jpegs() -> tuple[bytes, ...]:
    return tuple(seeds.image("JPEG", mode) for mode in ("RGB", "L", "CMYK"))


@cache
def _exrs() -> tuple[bytes, ...]:
    return seeds.exr(), seeds.exr(layers=False), seeds.exr(half=True)


@cache
def _vdbs() -> tuple[bytes, ...]:
    return (seeds.vdb(),)


LOADERS: dict[str, Maker] = {
    "toml": _toml,
    "gltf": _gltf,
    "glb": _glb,
    "xml": _xml,
    "obj": _obj,
    "ply": _ply,
    "stl": _stl,
    "npy": _grid("a.npy", _npys),
    "npz": _npz,
    "vol": _grid("a.vol", lambda: (seeds.vol(),)),
    "nvdb": _nvdb,
    "vdb": _grid("a.vdb", _vdbs),
    "lights": _lights,
    "field": _field,
    "exr": _image("exr", _exrs),
    "hdr": _image("hdr", lambda: (seeds.hdr(), seeds.hdr(packed=True))),
    "png": _image("png", _pngs),
    "jpg": _image("jpg", _jpegs),
}
