"""Every key of every table of a scene file, written and read again: the same scene in motion."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from datetime import date, time

import numpy as np
import pytest

from airlight.app.view.state import same
from airlight.scene import Camera
from airlight.scene.animation import Animation, Curve
from airlight.scene.animation.density import MadeDensity, VolumeTrack
from airlight.scene.animation.tracks import CameraTrack, LightTrack
from airlight.scene.io import load
from airlight.scene.io.images import save_image
from airlight.scene.io.toml_keys import KEYS
from airlight.scene.io.toml_tables import TABLES
from airlight.scene.io.toml_text import scene_text

OBJ = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"
VALUES: dict[str, object] = {  # by "table.key", else by the key; others by their kind
    "mesh.file": "tri.obj",
    "environment.file": "sky.hdr",
    "volume.file": "smoke.npy",
    "light.file": "many.npz",
    "volume.sequence": "smoke.*.npy",
    "grid": "density",
    "sigma_t_grid": "flame",
    "sigma_s_grid": "flame",
    "sigma_a_grid": "flame",
    "albedo_grid": "flame",
    "g_grid": "flame",
    "emission_grid": "flame",
    "temperature_grid": "temperature",
    "channels": "density",
    "clip_start_s": 0.25,
    "clip_speed": 1.5,
    "clip": "wave",
    "fov_y_deg": 33.5,
    "time_s": 0.0,
    "inner_deg": 11.0,
    "outer_deg": 88.0,
    "detail": 0.25,
    "up": [0, 0.6, 0.8],
    "mesh.up": "z",
    "volume.up": "z",
    "scale": 1.75,
    "fps": 12.5,
    "start_s": 0.125,
    "end_s": 4.5,
    "g": [0.5, 0.25, -0.125],
    "volume.bounds": [[-2, 0, -2], [1, 3, 1]],
    "turbidity": 4.5,
    "matrix": [0, 0, 1, 2, 0, 1, 0, 3, -1, 0, 0, 4, 0, 0, 0, 1],
}
KINDS: dict[str, object] = {
    "vector": [0.1, 1.2, 5.3],
    "unit vector (normalised for you)": [0, -1, 0],
    "colour": [0.75, 0.5, 0.25],
    "number": 0.375,
    "boolean": None,
    "two corners": [[-3, -1, -3], [3, 2, 3]],
    "number or vector": [1, 2, 3],
    "two numbers": [0.5, 2.5],
    "two whole numbers": [640, 480],
    'number or "auto"': "auto",
}
NEEDS = {  # keys that cannot stand alone
    "mesh": {"shape": "box"},
    "camera": {"position": [0, 1, 5], "target": [0, 1, 0]},
    "environment": {"radiance": 0.5},
    "medium": {"sigma_t": 0.2},
    "volume": {"shape": "sphere", "sigma_t": 3.0},
    "volume.sigma_a": {"sigma_s": 1.5},
    "medium.sigma_a": {"sigma_s": 0.5},
    "light directional": {"direction": [0, -1, 0], "irradiance": [3, 2, 1]},
    "light point": {"position": [0, 3, 0], "intensity": 9},
    "light spot": {"position": [0, 3, 0], "direction": [0, -1, 0], "intensity": 9},
    "light area": {"position": [0, 3, 0], "radiance": 9},
    "light points": {"file": "many.npz"},
}
INSTEAD = {
    "file": ("shape", "radiance"),
    "sequence": ("shape",),
    "shape": ("file",),
    "sigma_s": ("sigma_t",),
    "sigma_a": ("sigma_t",),
    "detail": ("shape",),
    "sigma_t_grid": ("shape",),
    "sigma_s_grid": ("shape", "sigma_t"),
    "sigma_a_grid": ("shape", "sigma_t"),
    "albedo_grid": ("shape",),
    "g_grid": ("shape",),
    "emission_grid": ("shape",),
    "temperature_grid": ("shape",),
    "temperature_scale": ("shape",),
    "temperature_offset": ("shape",),
}
BESIDE = {
    "detail": {"file": "smoke.npy"},
    "grid": {"file": "smoke.npy"},
    "channels": {"file": "smoke.npy"},
    "sigma_t_grid": {"file": "fire.npz"},
    "sigma_s_grid": {"file": "fire.npz", "sigma_a": 0.5},
    "sigma_a_grid": {"file": "fire.npz", "sigma_s": 0.5},
    "albedo_grid": {"file": "fire.npz"},
    "g_grid": {"file": "fire.npz"},
    "emission_grid": {"file": "fire.npz"},
    "temperature_grid": {"file": "fire.npz"},
    "temperature_scale": {"file": "fire.npz", "temperature_grid": "temperature"},
    "temperature_offset": {"file": "fire.npz", "temperature_grid": "temperature"},
    "top": {"endless": True},
}
PLACE = {  # keys of a [sky] that stand together
    "latitude_deg": 48.125,
    "longitude_deg": 11.5,
    "date": date(2026, 6, 21),
    "time": time(17, 30),
}
DIRECTIONS = ([0, -1, 0], [0, -0.6, 0.8], [0.6, -0.8, 0])
SEQUENCE = {"sequence": "smoke.*.npy"}


def value_of(table: str, key, usual: object = None) -> object:
    for name in (f"{table}.{key.name}", key.name):
        if name in VALUES:
            return VALUES[name]
    if key.kind.words == "boolean":
        return key.default != "true"
    choices = re.findall(r'"(\w+)"', key.kind.words)
    if key.kind.words not in KINDS and choices:
        return choices[-1]
    return KINDS[key.kind.words]


def cases() -> list:
    return list(_cases())


def _cases():
    for table in TABLES:
        for kind, extra in (table.variants or {"": ()}).items():
            for key in (*table.keys, *extra):
                if key.name != "type":
                    yield pytest.param(table.name, kind, key, id=f"{table.name}-{kind}-{key.name}")


def key_cases() -> list:
    return list(_key_cases())


def _key_cases():
    for name, table in KEYS.items():
        for kind, extra in (table.variants or {"": ()}).items():
            for key in (*table.keys, *extra):
                if key.name != "time_s":
                    yield pytest.param(name, kind, key, id=f"{name}-{kind}-{key.name}")


def written(value: object) -> str:
    return value.isoformat() if isinstance(value, (date, time)) else json.dumps(value)


def text_of(tables: dict[str, dict[str, object]], tail: str = "") -> str:
    """Scene text of one table each, with something to see and a light."""
    many = {"mesh", "light", "volume"}
    parts = []
    for name, table in tables.items():
        header = f"[[{name}]]" if name in many else f"[{name}]"
        parts.append("\n".join([header, *(f"{k} = {written(v)}" for k, v in table.items())]))
    return "\n".join(parts) + "\n" + tail


def base(table: str, kind: str) -> dict[str, dict[str, object]]:
    tables: dict[str, dict[str, object]] = {"mesh": {"shape": "box"}}
    tables["light"] = {"type": "point", "position": [0, 3, 0], "intensity": 9}
    needed = NEEDS.get(f"{table} {kind}".strip(), {})
    tables[table] = {**({"type": kind} if kind else {}), **needed}
    return tables


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    made = tmp_path_factory.mktemp("scenes")
    (made / "tri.obj").write_text(OBJ)
    rng = np.random.default_rng(1)
    for name in ("smoke.npy", "smoke.1.npy", "smoke.2.npy", "smoke.10.npy"):
        np.save(made / name, rng.random((3, 4, 5), dtype=np.float32))
    fire = {name: rng.random((3, 4, 5), dtype=np.float32) for name in ("density", "flame")}
    np.savez(made / "fire.npz", **fire, temperature=3000.0 * fire["flame"] + 1.0)
    np.savez(made / "many.npz", positions=np.ones((2, 3)), intensities=np.ones((2, 3)))
    from airlight.scene.image import Image

    save_image(Image(rng.random((4, 8, 3), dtype=np.float32)), made / "sky.hdr")
    return made


def same_again(folder, text: str):
    """The scene of a text, held to what comes back from its own text, at three times."""
    source, copy = folder / "scene.toml", folder / "copy.toml"
    source.write_text(text)
    scene = replace(load(source), name="")
    copy.write_text(scene_text(scene, load(source), str(source), folder), encoding="utf-8")
    back = replace(load(copy), name="")
    assert same(scene, back), copy.read_text()
    for time_s in (0.0, 0.7, 3.0):
        assert same(scene.at(time_s), back.at(time_s))
    return scene


@pytest.mark.parametrize(("table", "kind", "key"), cases())
def test_every_key_comes_back(folder, table, kind, key):
    if key.name == "variant":
        return  # needs a file that has some: test_gltf_variants.py
    tables = base(table, kind)
    own = tables[table]
    for other in INSTEAD.get(key.name, ()):
        own.pop(other, None)
    if table == "medium":
        own |= BESIDE.get(key.name, {})
    if table == "volume" and key.name in BESIDE:
        own.pop("shape", None)
        own |= BESIDE[key.name]
    if table == "volume" and (key.name.startswith("sequence_") or key.name == "between"):
        own.pop("shape", None)
        own |= SEQUENCE
    own |= {"sigma_s": 1.5} if key.name == "sigma_a" else {}
    own |= PLACE if key.name in (*PLACE, "utc_offset_h") else {}
    own[key.name] = PLACE.get(key.name) or value_of(table, key)
    tail = ""
    if key.name == "between" and table != "volume" and kind != "points":
        tail = keyframes(table, kind, "")
    if table == "animation":
        tables = {k: v for k, v in tables.items() if k != "animation"} | {"animation": own}
        tail = keyframes("camera", "", "")
        tables["camera"] = dict(NEEDS["camera"])
        tables = {k: tables[k] for k in ("mesh", "light", "animation", "camera")}
    elif tail:
        tables = {k: tables[k] for k in (*(k for k in tables if k != table), table)}
    if key.name.startswith("clip"):
        return  # needs an animated file: test_an_animated_file_keeps_its_clip
    scene = same_again(folder, text_of(tables, tail))
    assert (scene.animation is not None) == bool(tail or "sequence" in own)


def keyframes(table: str, kind: str, only: str) -> str:
    described = KEYS[table]
    keys = (*described.keys, *(described.variants or {}).get(kind, ()))
    names = [key for key in keys if key.name != "time_s" and (not only or key.name == only)]
    rows = []
    for time_s, factor in ((0.0, 1.0), (1 / 3, 0.5), (2.0, 0.75)):
        values = {key.name: np.multiply(moving(key), factor).tolist() for key in names}
        if "direction" in values:
            values["direction"] = {1.0: [0, -1, 0], 0.5: [0, -0.6, 0.8], 0.75: [0.6, -0.8, 0]}[
                factor
            ]
        lines = [f"{k} = {written(v)}" for k, v in {"time_s": time_s, **values}.items()]
        rows.append("\n".join([f"[[{table}.key]]", *lines]))
    return "\n".join(rows) + "\n"


def moving(key) -> object:
    value = VALUES.get(key.name, KINDS[key.kind.words])
    return [0.5, 1.5, 0.25] if key.name == "target" else value


@pytest.mark.parametrize(("table", "kind", "key"), key_cases())
def test_every_keyframe_comes_back(folder, table, kind, key):
    tables = base(table, kind)
    last = {table: tables.pop(table)}
    scene = same_again(folder, text_of({**tables, **last}, keyframes(table, kind, key.name)))
    assert len(scene.animation.tracks) == 1
    assert not same(scene.at(0.0), scene.at(2.0))


def test_other_folders_and_changed_motion(folder):
    text = text_of(
        {
            "mesh": {"shape": "box"},
            "volume": {"sigma_t": 2.0, **SEQUENCE},
            "camera": NEEDS["camera"],
        },
        keyframes("camera", "", "position"),
    )
    source, deep = folder / "scene.toml", folder / "deep"
    deep.mkdir(exist_ok=True)
    source.write_text(text)
    scene = load(source)
    (deep / "copy.toml").write_text(scene_text(scene, scene, str(source), deep))
    back = load(deep / "copy.toml")
    assert same(scene.at(0.02).volumes[0].density, back.at(0.02).volumes[0].density)
    slow = Curve(np.array([0.0, 8.0]), np.array([[0.0, 1.0, 5.0], [1.0, 1.0, 5.0]]), "linear")
    sun = Curve(np.array([1.0]), np.array([[7.0, 7.0, 7.0]]))
    tracks = (CameraTrack({"position": slow}), LightTrack(0, {"irradiance": sun}))
    changed = replace(scene, animation=Animation(tracks, fps=30.0))
    (deep / "copy.toml").write_text(scene_text(changed, scene, str(source), deep))
    back = load(deep / "copy.toml")
    assert same(back.at(4.0).camera, changed.at(4.0).camera)
    assert back.at(0.0).lights[0].irradiance == (7.0, 7.0, 7.0)
    assert back.animation.fps == 30.0


def test_what_moves_but_cannot_be_written_is_said(folder):
    scene = load("builtin:cornell")
    turning = {
        "position": Curve(np.array([0.0, 1.0]), np.zeros((2, 3))),
        "fov_y_deg": Curve(np.array([0.0, 2.0]), np.array([[20.0], [30.0]])),
    }
    smoke = VolumeTrack(0, MadeDensity(lambda time_s: np.zeros((2, 2, 2), np.float32)))
    moving = replace(scene, camera=Camera(), animation=Animation((CameraTrack(turning), smoke)))
    text = scene_text(moving, scene, "builtin:cornell", folder)
    assert "# How the camera moves cannot be said in a scene file: it is static." in text
    assert "# How a volume moves cannot be said in a scene file" in text
    assert "[animation]" not in text


def test_an_animated_file_keeps_its_clip(folder, draft):
    moves, times = np.array([(0, 0, 0), (1, 0, 0), (1, 4, 0)]), [0.0, 1.0, 3.0]
    draft.single(draft.triangle())
    draft.json["animations"] = [
        {
            "name": "wave",
            "channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}],
            "samplers": [{"input": draft.array(times, "f4"), "output": draft.array(moves, "f4")}],
        }
    ]
    path = draft.glb()
    clip = {
        "file": str(path),
        "clip": "wave",
        "clip_start_s": 0.25,
        "clip_speed": 1.5,
        "clip_loop": True,
    }
    light = {"type": "directional", "direction": [0, -1, 0], "irradiance": 1.0}
    scene = same_again(folder, text_of({"mesh": clip, "light": light}))
    assert not same(scene.at(0.7).meshes, scene.at(3.0).meshes)
