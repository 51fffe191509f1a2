"""Moving glTF files: nodes, skins and morph targets against loops and closed forms."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation, Slerp

from airlight.errors import SceneError
from airlight.scene.io import load
from airlight.scene.io.gltf import load_gltf

HALF = math.sqrt(0.5)
TIMES = [0.0, 1.0, 3.0]


def add_clip(draft, channels, name="clip", **sampler):
    """One animation; `channels` are (node, path, times, values)."""
    clip = {"name": name, "channels": [], "samplers": []}
    for node, path, times, values in channels:
        clip["channels"].append(
            {"sampler": len(clip["samplers"]), "target": {"node": node, "path": path}}
        )
        clip["samplers"].append(
            {"input": draft.array(times, "f4"), "output": draft.array(values, "f4"), **sampler}
        )
    draft.json.setdefault("animations", []).append(clip)
    return draft


def place(scene, time, mesh=0):
    return scene.at(time).meshes[mesh].world_from_object


def test_nodes_follow_straight_lines_and_great_arcs(draft):
    turns = Rotation.from_euler("xyz", [(0, 0, 0), (0, 90, 0), (30, 90, 60)], degrees=True)
    moves = np.array([(0, 0, 0), (1, 0, 0), (1, 4, 0)])
    draft.single(draft.triangle(), scale=[2, 2, 2])
    add_clip(draft, [(0, "translation", TIMES, moves), (0, "rotation", TIMES, turns.as_quat())])
    scene = load_gltf(draft.glb())
    assert scene.animation.last_s == 3.0
    for time in (0.0, 0.3, 1.0, 2.2, 3.0, 9.0):
        inside = min(time, 3.0)
        expected = np.eye(4)
        expected[:3, :3] = 2.0 * Slerp(TIMES, turns)(inside).as_matrix()
        expected[:3, 3] = [np.interp(inside, TIMES, moves[:, k]) for k in range(3)]
        np.testing.assert_allclose(place(scene, time), expected, atol=1e-6)


def test_steps_and_cubic_splines(draft):
    moves = np.array([(0, 0, 0), (1, 0, 0), (1, 4, 0)])
    draft.single(draft.triangle())
    add_clip(draft, [(0, "translation", TIMES, moves)], interpolation="STEP")
    scene = load_gltf(draft.glb())
    np.testing.assert_array_equal(place(scene, 2.9)[:3, 3], moves[1])
    draft.json["animations"] = []
    flat = np.stack([np.zeros((3, 3)), moves, np.zeros((3, 3))], axis=1)  # no speed at keyframes
    add_clip(draft, [(0, "translation", TIMES, flat.reshape(-1, 3))], interpolation="CUBICSPLINE")
    scene = load_gltf(draft.glb())
    u = 0.25
    np.testing.assert_allclose(place(scene, u)[0, 3], 3 * u**2 - 2 * u**3, atol=1e-6)
    np.testing.assert_allclose(place(scene, 2.0)[1, 3], 2.0, atol=1e-6)


def test_children_lights_and_the_camera_go_along(draft):
    draft.single(draft.triangle())
    draft.json["nodes"] = [
        {"children": [1, 2, 3]},
        {"mesh": 0, "translation": [1, 0, 0]},
        {"extensions": {"KHR_lights_punctual": {"light": 0}}, "translation": [0, 2, 0]},
        {"camera": 0, "translation": [0, 0, 5]},
    ]
    draft.json["cameras"] = [{"type": "perspective", "perspective": {"yfov": 0.7}}]
    draft.json["extensions"] = {"KHR_lights_punctual": {"lights": [{"type": "spot"}]}}
    add_clip(draft, [(0, "rotation", [0, 2], [(0, 0, 0, 1), (0, 1, 0, 0)])])
    quarter = load_gltf(draft.glb()).at(1.0)  # about +Y: +X to -Z, +Z to +X
    np.testing.assert_allclose(quarter.meshes[0].world_from_object[:3, 3], [0, 0, -1], atol=1e-6)
    np.testing.assert_allclose(quarter.lights[0].position, [0, 2, 0], atol=1e-6)
    np.testing.assert_allclose(quarter.lights[0].direction, [-1, 0, 0], atol=1e-6)
    np.testing.assert_allclose(quarter.camera.position, [5, 0, 0], atol=1e-6)
    np.testing.assert_allclose(quarter.camera.target, [4, 0, 0], atol=1e-6)
    assert quarter.camera.fov_y_deg == pytest.approx(math.degrees(0.7))


RING = 8


def add_tube(draft, skin_node=0, **node):
    """A tube of rings at heights 0..4 m, its upper half more and more with joint 2 than joint 1."""
    angle = np.arange(RING) / RING * 2.0 * np.pi
    ring = np.stack([np.cos(angle), np.zeros(RING), np.sin(angle)], axis=1)
    positions = np.concatenate([ring + np.array([0, y, 0]) for y in range(5)])
    normals = np.tile(ring, (5, 1))
    a = np.arange(4 * RING)
    b = a // RING * RING + (a + 1) % RING
    indices = np.stack([a, a + RING, b, b, a + RING, b + RING], axis=1)
    upper = np.clip((positions[:, 1] - 1.0) / 2.0, 0.0, 1.0)
    weights = np.stack([1.0 - upper, upper, 0 * upper, 0 * upper], axis=1)
    draft.single(
        {
            "attributes": {
                "POSITION": draft.array(positions, "f4"),
                "NORMAL": draft.array(normals, "f4"),
                "JOINTS_0": draft.array(np.tile([0, 1, 0, 0], (len(positions), 1)), "u1"),
                "WEIGHTS_0": draft.array(weights, "f4"),
            },
            "indices": draft.array(indices.reshape(-1), "u2"),
        },
        skin=0,
        **node,
    )
    draft.json["nodes"] += [{"translation": [0, 0, 0], "children": [2]}, {"translation": [0, 2, 0]}]
    draft.json["scenes"] = [{"nodes": [0, 1]}]
    bind = np.tile(np.eye(4), (2, 1, 1))
    bind[1, 1, 3] = -2.0
    draft.json["skins"] = [
        {
            "joints": [1, 2],
            "inverseBindMatrices": draft.array(bind.transpose(0, 2, 1).reshape(2, 16), "f4"),
        }
    ]
    return positions, normals, weights


def test_a_skin_bends_as_a_loop_over_vertices_says(draft):
    positions, normals, weights = add_tube(draft, translation=[50, 0, 0])
    add_clip(
        draft,
        [
            (2, "rotation", [0, 1], [(0, 0, 0, 1), (0, 0, HALF, HALF)]),
            (1, "translation", [0, 1], [(0, 0, 0), (3, 0, 0)]),
        ],
    )
    scene = load_gltf(draft.glb())
    for time in (0.0, 0.4, 1.0):
        (mesh,) = scene.at(time).meshes
        lower = np.eye(4)
        lower[0, 3] = 3.0 * time
        knee = np.eye(4)
        knee[:3, :3] = Rotation.from_euler("z", 90 * time, degrees=True).as_matrix()
        knee[1, 3] = 2.0
        unbind = np.eye(4)
        unbind[1, 3] = -2.0
        bones = [lower, lower @ knee @ unbind]
        # The node's own 50 m do not count: a skin follows its joints alone.
        np.testing.assert_array_equal(mesh.world_from_object, np.eye(4))
        for k, p in enumerate(positions):
            blended = weights[k, 0] * bones[0] + weights[k, 1] * bones[1]
            np.testing.assert_allclose(
                mesh.geometry.positions[k], (blended @ [*p, 1.0])[:3], atol=1e-5
            )
            n = np.linalg.inv(blended[:3, :3]).T @ normals[k]
            np.testing.assert_allclose(mesh.geometry.normals[k], n / np.linalg.norm(n), atol=1e-5)


def test_a_skin_without_animation_stands_as_its_joints_do(draft):
    positions, _, _ = add_tube(draft)
    draft.json["nodes"][1]["translation"] = [0, 7, 0]
    scene = load_gltf(draft.glb())
    assert scene.animation is None
    np.testing.assert_allclose(
        scene.meshes[0].geometry.positions, positions + np.array([0, 7, 0]), atol=1e-6
    )


def test_nodes_that_share_a_skinned_mesh_deform_each_for_itself(draft):
    add_tube(draft)
    draft.json["nodes"].append({"mesh": 0, "skin": 0})
    draft.json["scenes"] = [{"nodes": [0, 1, 3]}]
    first, second = load_gltf(draft.glb()).meshes
    assert first.geometry is not second.geometry


def test_morph_targets_move_vertices_by_their_weights(draft):
    one, two = np.eye(3) * 2.0, np.full((3, 3), -1.0)
    tilt = np.tile([1.0, 0.0, 0.0], (3, 1))
    primitive = draft.triangle(NORMAL=draft.array(np.tile([0, 0, 1.0], (3, 1)), "f4"))
    primitive["targets"] = [
        {"POSITION": draft.array(one, "f4"), "NORMAL": draft.array(tilt, "f4")},
        {"POSITION": draft.array(two, "f4")},
    ]
    draft.single(primitive)
    draft.json["meshes"][0]["weights"] = [0.0, 0.5]
    base = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0)], float)
    still = load_gltf(draft.glb())
    np.testing.assert_allclose(still.meshes[0].geometry.positions, base + 0.5 * two, atol=1e-6)
    add_clip(draft, [(0, "weights", [0, 1], [[0.0], [0.0], [1.0], [0.5]])])
    (mesh,) = load_gltf(draft.glb()).at(0.5).meshes
    expected = base + 0.5 * one + 0.25 * two
    np.testing.assert_allclose(mesh.geometry.positions, expected, atol=1e-6)
    slanted = np.array([0.5, 0.0, 1.0]) / np.linalg.norm([0.5, 0.0, 1.0])
    np.testing.assert_allclose(mesh.geometry.normals, np.tile(slanted, (3, 1)), atol=1e-6)


def test_without_normals_the_faces_give_them_each_time(draft):
    primitive = draft.triangle()
    lift = np.array([(0, 0, 0), (0, 0, 1.0), (0, 0, 0)])
    primitive["targets"] = [{"POSITION": draft.array(lift, "f4")}]
    draft.single(primitive)
    add_clip(draft, [(0, "weights", [0, 1], [[0.0], [1.0]])])
    (mesh,) = load_gltf(draft.glb()).at(1.0).meshes
    face = np.cross((1, 0, 1), (0, 1, 0)) / math.sqrt(2.0)
    np.testing.assert_allclose(mesh.geometry.normals, np.tile(face, (3, 1)), atol=1e-6)


def test_scene_files_choose_a_clip_and_place_what_moves(draft, tmp_path):
    draft.single(draft.triangle())
    add_clip(draft, [(0, "translation", [0, 1], [(0, 0, 0), (1, 0, 0)])], name="walk")
    add_clip(draft, [(0, "translation", [0, 2], [(0, 0, 0), (0, 0, 8)])], name="run")
    draft.glb()
    text = """
[[mesh]]
shape = "box"
[[mesh]]
file = "thing.glb"
clip = "run"
clip_start_s = 1
clip_speed = 2
clip_loop = true
scale = 10
key = [{ time_s = 0, translate = [0, 0, 0] }, { time_s = 10, translate = [0, 100, 0] }]
between = "linear"
"""
    path = tmp_path / "scene.toml"
    path.write_text(text)
    scene = load(path)
    # At 1.25 s the clip is at 0.5 s, a quarter of 8 m, ten times as large; in 1 s it is back there.
    for time in (1.25, 2.25):
        np.testing.assert_allclose(place(scene, time, 1)[:3, 3], [0, 10 * time, 20], atol=1e-5)
    path.write_text(text.replace('"run"', '"runs"'))
    with pytest.raises(SceneError, match=r"no clip 'runs'. Did you mean 'run'\?"):
        load(path)


def spoil_values(draft):
    add_clip(draft, [(0, "translation", TIMES, np.zeros((2, 3)))])


def spoil_times(draft):
    add_clip(draft, [(0, "translation", [0, 1, 1], np.zeros((3, 3)))])


def spoil_kind(draft):
    add_clip(draft, [(0, "scale", TIMES, np.ones((3, 3)))], interpolation="BEZIER")


def spoil_node(draft):
    add_clip(draft, [(9, "scale", TIMES, np.ones((3, 3)))])


@pytest.mark.parametrize(
    ("spoil", "message"),
    [
        (spoil_values, "animations[0].samplers[0]: has 2 values for 3 keyframes"),
        (spoil_times, "animations[0].samplers[0]: keyframe times must rise, but 1 s comes after"),
        (spoil_kind, "animations[0].samplers[0]: has the unknown interpolation 'BEZIER'"),
        (spoil_node, "animations[0].channels[0].target.node: is 9, but the file has 1 nodes"),
    ],
)
def test_broken_animations_are_named(draft, spoil, message):
    draft.single(draft.triangle())
    spoil(draft)
    path = draft.glb()
    with pytest.raises(SceneError) as caught:
        load_gltf(path)
    assert str(caught.value).startswith(f"{path}: {message}")


def spoil_joint(draft):
    draft.json["skins"][0]["joints"] = [1]


def spoil_scene(draft):
    draft.json["scenes"] = [{"nodes": [0]}]


def spoil_bind(draft):
    draft.json["skins"][0]["inverseBindMatrices"] = draft.array(np.zeros((1, 16)), "f4")


@pytest.mark.parametrize(
    ("spoil", "message"),
    [
        (spoil_joint, "joint 1 is out of range: there are 1"),
        (spoil_scene, "nodes[1]: is a joint outside of the scene"),
        (spoil_bind, "skins[0]: has 1 inverse bind matrices for 2 joints"),
    ],
)
def test_broken_skins_are_named(draft, spoil, message):
    add_tube(draft)
    spoil(draft)
    with pytest.raises(SceneError) as caught:
        load_gltf(draft.glb())
    assert message in str(caught.value)
