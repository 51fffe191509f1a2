"""Reading Mitsuba scenes: what becomes of each part, what is told, what is refused."""

from __future__ import annotations

import math
import struct
from pathlib import Path

import numpy as np
import PIL.Image
import pytest
from PIL import Image

from airlight.errors import SceneError
from airlight.maths.colour import srgb_decode
from airlight.scene import AreaLight, DirectionalLight, Mesh, PointLight, Scene, SpotLight
from airlight.scene.io import load
from airlight.scene.io.mitsuba import load_mitsuba
from airlight.scene.io.mitsuba_metals import METALS
from airlight.scene.light_shapes import unit_geometry
from airlight.scene.lights.area import world_from_unit
from airlight.scene.material import DEFAULT_MATERIAL


def scene(tmp_path: Path, body: str, name: str = "scene.xml") -> Scene:
    path = tmp_path / name
    path.write_text(f'<scene version="3.0.0">{body}</scene>')
    return load_mitsuba(path)


def refusal(tmp_path: Path, body: str) -> str:
    with pytest.raises(SceneError) as caught:
        scene(tmp_path, body)
    return str(caught.value).replace(str(tmp_path) + "/", "")


SENSOR = '<sensor type="perspective"><float name="fov" value="40"/>{}</sensor>'


def test_camera_with_lookat_and_each_fov_axis(tmp_path: Path) -> None:
    body = """<sensor type="perspective">
      <float name="fov" value="60"/><string name="fov_axis" value="{axis}"/>
      <transform name="to_world"><lookat origin="1, 2, 3" target="1, 2, -5"
        up="0, 1, 0"/></transform>
      <film type="hdrfilm"><integer name="width" value="200"/><integer name="height" value="100"/>
      </film></sensor>"""
    half = math.tan(math.radians(30))
    tans = {"x": half / 2, "y": half, "smaller": half, "larger": half / 2}
    tans["diagonal"] = half / math.sqrt(5)
    for axis, tan in tans.items():
        camera = scene(tmp_path, body.format(axis=axis)).camera
        assert camera.fov_y_deg == pytest.approx(2 * math.degrees(math.atan(tan)))
    assert camera.position == (1, 2, 3)
    np.testing.assert_allclose(np.subtract(camera.target, camera.position), (0, 0, -1), atol=1e-9)
    np.testing.assert_allclose(camera.up, (0, 1, 0), atol=1e-9)


def test_focal_length_is_of_a_35_mm_film_diagonal(tmp_path: Path) -> None:
    body = """<sensor type="perspective"><string name="focal_length" value="50mm"/>
      <film type="hdrfilm"><integer name="width" value="150"/><integer name="height" value="100"/>
      </film></sensor>"""
    fov = scene(tmp_path, body).camera.fov_y_deg
    assert fov == pytest.approx(2 * math.degrees(math.atan(12 / 50)), rel=1e-6)


def test_transforms_compose_in_order(tmp_path: Path) -> None:
    body = """<shape type="rectangle"><transform name="to_world">
        <scale x="2" y="3"/><rotate x="1" angle="-90"/><translate value="1, 0, 0"/>
      </transform></shape>"""
    mesh = scene(tmp_path, body).meshes[0]
    placed = mesh.world_from_object @ np.array([1.0, 1.0, 0.0, 1.0])
    np.testing.assert_allclose(placed, [3.0, 0.0, -3.0, 1.0], atol=1e-12)
    normal = mesh.world_from_object[:3, :3] @ mesh.geometry.normals[0]
    np.testing.assert_allclose(normal, [0, 1, 0], atol=1e-12)


@pytest.mark.parametrize("kind", ["cube", "rectangle", "sphere", "cylinder", "disk"])
def test_shapes_face_outwards_with_their_true_area(tmp_path: Path, kind: str) -> None:
    geometry = scene(tmp_path, f'<shape type="{kind}"/>').meshes[0].geometry
    p = geometry.positions.astype(np.float64)[geometry.indices]
    cross = np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])
    normals = geometry.normals[geometry.indices].mean(axis=1)
    assert (np.einsum("ij,ij->i", cross, normals) > 0).all()
    areas = {"cube": 24, "rectangle": 4, "sphere": 4 * math.pi, "cylinder": 2 * math.pi}
    expected = areas.get(kind, math.pi)
    assert np.linalg.norm(cross, axis=1).sum() / 2 == pytest.approx(expected, rel=3e-3)


def test_spheres_and_cylinders_lie_where_their_points_say(tmp_path: Path) -> None:
    body = """<shape type="sphere"><point name="center" x="1" y="2" z="3"/>
        <float name="radius" value="0.5"/></shape>
      <shape type="cylinder"><point name="p1" x="0" y="4" z="0"/>
        <float name="radius" value="0.25"/></shape>"""
    sphere, cylinder = scene(tmp_path, body).meshes
    np.testing.assert_allclose(sphere.world_bounds, [[0.5, 1.5, 2.5], [1.5, 2.5, 3.5]], atol=2e-3)
    np.testing.assert_allclose(cylinder.world_bounds[0], [-0.25, 0, -0.25], atol=2e-3)
    np.testing.assert_allclose(cylinder.world_bounds[1], [0.25, 4, 0.25], atol=2e-3)


def test_obj_and_ply_files_take_the_shapes_bsdf(tmp_path: Path) -> None:
    (tmp_path / "a.obj").write_text(
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n"
    )
    (tmp_path / "a.ply").write_text(
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
        "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
        "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"
    )
    bsdf = '<bsdf type="diffuse"><rgb name="reflectance" value="0.1, 0.2, 0.3"/></bsdf>'
    body = "".join(
        f'<shape type="{k}"><string name="filename" value="a.{k}"/>{bsdf}</shape>'
        for k in ("obj", "ply")
    )
    read = scene(tmp_path, body)
    assert [m.material.base_color for m in read.meshes] == [(0.1, 0.2, 0.3)] * 2
    np.testing.assert_allclose(sorted(read.meshes[0].geometry.uvs[:, 1]), [0, 1, 1])
    body = body.replace("/><bsdf", '/><boolean name="flip_tex_coords" value="false"/><bsdf', 1)
    np.testing.assert_allclose(
        sorted(scene(tmp_path, body).meshes[0].geometry.uvs[:, 1]), [0, 0, 1]
    )


def bsdf(tmp_path: Path, text: str):
    read = scene(tmp_path, f'<shape type="cube">{text}</shape>' + SENSOR.format(""))
    return read.meshes[0].material if read.meshes else None, read.warnings


def test_materials(tmp_path: Path) -> None:
    material, warnings = bsdf(tmp_path, "")
    assert (material.base_color, material.specular, material.two_sided) == ((0.5,) * 3, 0.0, False)
    assert warnings == ()
    material, warnings = bsdf(
        tmp_path,
        '<bsdf type="twosided"><bsdf type="diffuse"><rgb name="reflectance" value="0.3"/></bsdf>'
        "</bsdf>",
    )
    assert (material.base_color, material.two_sided, warnings) == ((0.3,) * 3, True, ())
    material, warnings = bsdf(
        tmp_path,
        '<bsdf type="principled"><rgb name="base_color" value="0.9 0.5 0.1"/>'
        '<float name="roughness" value="0.3"/><float name="metallic" value="0.8"/>'
        '<float name="specular" value="0.25"/><float name="clearcoat" value="1"/></bsdf>',
    )
    assert (material.roughness, material.metallic, material.specular) == (0.3, 0.8, 0.5)
    assert any("left out: clearcoat" in w for w in warnings)
    material, _ = bsdf(
        tmp_path,
        '<bsdf type="roughconductor"><string name="material" value="Au"/>'
        '<string name="distribution" value="ggx"/><float name="alpha" value="0.25"/></bsdf>',
    )
    assert (material.metallic, material.roughness) == (1.0, 0.5)
    assert material.base_color == (1.0, 0.766, 0.336)
    material, _ = bsdf(
        tmp_path,
        '<bsdf type="conductor"><float name="eta" value="0.2"/><float name="k" value="3"/></bsdf>',
    )
    assert material.base_color[0] == pytest.approx((0.64 + 9) / (1.44 + 9))
    assert material.roughness == 0.0
    material, _ = bsdf(tmp_path, '<bsdf type="plastic"><float name="int_ior" value="1.5"/></bsdf>')
    assert material.specular == pytest.approx(1.0, abs=0.01)


def test_glass_is_thin(tmp_path: Path) -> None:
    material, warnings = bsdf(tmp_path, '<bsdf type="dielectric" id="g"/>')
    assert (material.transmission, material.roughness, material.two_sided) == (1.0, 0.0, True)
    assert material.specular == pytest.approx((0.504 / 2.504) ** 2 / 0.04, abs=0.02)
    assert warnings == (
        "bsdf 'g' (dielectric): its glass does not bend light, one sees straight through it",
    )
    material, warnings = bsdf(
        tmp_path,
        '<bsdf type="thindielectric"><float name="int_ior" value="1.333"/>'
        '<rgb name="specular_transmittance" value="1, 0.5, 0"/></bsdf>',
    )
    assert (material.base_color, warnings) == ((1.0, 0.5, 0.0), ())
    assert material.specular == pytest.approx(1.0, abs=0.01)  # 2 F / (1 + F) of F = 0.0204


def test_a_constant_opacity_blends(tmp_path: Path) -> None:
    material, warnings = bsdf(
        tmp_path,
        '<bsdf type="mask"><float name="opacity" value="0.3"/><bsdf type="diffuse"/></bsdf>',
    )
    assert (material.alpha, material.is_blended, warnings) == (0.3, True, ())


def test_unknown_bsdf_gets_a_stand_in(tmp_path: Path) -> None:
    material, warnings = bsdf(tmp_path, '<bsdf type="velvet"/>')
    assert material.base_color == (0.5,) * 3
    assert warnings == ("bsdf (velvet) is unknown, a mid grey stands in",)


def test_textures(tmp_path: Path) -> None:
    pixels = np.zeros((2, 3, 3), np.uint8)
    pixels[0, 1] = (255, 128, 0)
    Image.fromarray(pixels).save(tmp_path / "t.png")
    material, warnings = bsdf(
        tmp_path,
        '<bsdf type="diffuse"><texture type="bitmap" name="reflectance">'
        '<string name="filename" value="t.png"/><string name="wrap_mode" value="mirror"/>'
        '<transform name="to_uv"><scale x="2" y="3"/><translate x="0.5" y="0.25"/></transform>'
        "</texture></bsdf>",
    )
    texture = material.base_color_texture
    assert warnings == () and material.base_color == (1.0, 1.0, 1.0)
    np.testing.assert_array_equal(texture.pixels[..., :3], pixels)
    assert (texture.is_srgb, texture.wrap) == (True, ("mirror", "mirror"))
    assert (texture.scale, texture.offset) == ((2.0, 3.0), (0.5, 0.25))
    material, _ = bsdf(
        tmp_path,
        '<bsdf type="mask"><texture type="bitmap" name="opacity">'
        '<string name="filename" value="t.png"/></texture><bsdf type="diffuse"/></bsdf>',
    )
    assert material.alpha_cutoff == 0.5
    alpha = material.base_color_texture.pixels[..., 3]
    # The mean of its channels, decoded from sRGB: (1 + .2159 + 0) / 3.
    assert alpha[0, 1] == 103 and alpha[1, 1] == 0
    material, _ = bsdf(
        tmp_path,
        '<bsdf type="diffuse"><texture type="checkerboard" name="reflectance">'
        '<rgb name="color0" value="1"/><rgb name="color1" value="0"/></texture></bsdf>',
    )
    checker = material.base_color_texture.pixels[..., 0]
    assert (checker[0, 0], checker[0, -1], checker[-1, -1]) == (255, 0, 255)


def test_missing_textures_get_a_stand_in(tmp_path: Path) -> None:
    material, warnings = bsdf(
        tmp_path,
        '<bsdf type="diffuse"><texture type="bitmap" name="reflectance">'
        '<string name="filename" value="no.png"/></texture></bsdf>',
    )
    assert "stand-in" in material.base_color_texture.source
    assert len(warnings) == 1 and "no.png: file not found" in warnings[0]


def test_lights(tmp_path: Path) -> None:
    read = scene(
        tmp_path,
        SENSOR.format("")
        + """<emitter type="point"><point name="position" x="1" y="2" z="3"/>
            <rgb name="intensity" value="4, 5, 6"/></emitter>
          <emitter type="directional"><vector name="direction" x="0" y="-2" z="0"/>
            <float name="irradiance" value="3"/></emitter>
          <emitter type="spot"><transform name="to_world">
            <lookat origin="0, 2, 0" target="0, 0, 0" up="0, 0, 1"/></transform>
            <float name="cutoff_angle" value="40"/></emitter>
          <emitter type="constant"><rgb name="radiance" value="0.1 0.2 0.3"/></emitter>
          <emitter type="projector"/>""",
    )
    point, sun, spot = read.lights
    assert point == PointLight((1, 2, 3), (4, 5, 6))
    assert sun == DirectionalLight((0, -1, 0), (3, 3, 3))
    assert isinstance(spot, SpotLight)
    np.testing.assert_allclose(spot.direction, (0, -1, 0), atol=1e-12)
    assert (spot.position, spot.inner_deg, spot.outer_deg) == ((0, 2, 0), 30, 40)
    assert read.environment.radiance == (0.1, 0.2, 0.3)
    assert len(read.warnings) == 2
    assert read.warnings[1] == "emitter (projector) is left out: emitters of this kind are not read"


GLOW = '<emitter type="area"><rgb name="radiance" value="1 2 3"/></emitter>'
BLACK = '<bsdf type="diffuse"><rgb name="reflectance" value="0 0 0"/></bsdf>'


def placed(kind: str, matrix: np.ndarray, inside: str = GLOW) -> str:
    numbers = " ".join(f"{x:.17g}" for x in matrix.ravel())
    place = f'<transform name="to_world"><matrix value="{numbers}"/></transform>'
    return SENSOR.format("") + f'<shape type="{kind}">{place}{inside}</shape>'


def test_area_emitters_are_area_lights(tmp_path: Path) -> None:
    read = scene(tmp_path, SENSOR.format("") + f'<shape type="rectangle">{GLOW}</shape>')
    (light,) = read.lights
    assert read.meshes == ()
    # Mitsuba's default BSDF reflects a half.
    assert light == AreaLight(
        (0, 0, 0),
        (1, 2, 3),
        direction=(0, 0, 1),
        up=(0, 1, 0),
        size=(2, 2),
        radius=1.0,
        reflectance=0.5,
    )


def test_an_area_emitter_that_shapes_refer_to_lights_by_them_alone(tmp_path: Path) -> None:
    named = GLOW.replace('type="area"', 'type="area" id="lamp"')
    shape = '<shape type="{}"><ref id="lamp"/></shape>'
    # Before, between and after its shapes; a cube is a mesh that glows.
    text = shape.format("rectangle") + named + shape.format("cube")
    read = scene(tmp_path, SENSOR.format("") + text)
    (light,) = read.lights
    assert light.radiance == (1, 2, 3)
    assert [mesh.material.emission for mesh in read.meshes] == [(1, 2, 3)]
    assert read.warnings == ()
    alone = scene(tmp_path, SENSOR.format("") + named)
    assert alone.lights == () and alone.meshes == ()
    assert alone.warnings == ("emitter 'lamp' (area) lights nothing: no shape refers to it",)


@pytest.mark.parametrize("kind", ["rectangle", "disk", "sphere"])
@pytest.mark.parametrize("mirror", [1.0, -1.0])
@pytest.mark.parametrize("flipped", [False, True])
def test_an_area_light_is_where_its_triangles_are(
    tmp_path: Path, kind: str, mirror: float, flipped: bool
) -> None:
    """The shape without its emitter is a mesh: the same surface, facing the same way."""
    turn, _ = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))
    size = (1.5, 0.5, 2.0) if kind == "rectangle" else (1.5, 1.5, 1.5)
    matrix = np.eye(4)
    matrix[:3, :3] = turn * size * (1.0, 1.0, mirror * np.sign(np.linalg.det(turn)))
    matrix[:3, 3] = (1, 2, 3)
    flip = '<boolean name="flip_normals" value="true"/>' if flipped else ""
    read = scene(tmp_path, placed(kind, matrix, GLOW + BLACK + flip))
    (mesh,) = scene(tmp_path, placed(kind, matrix, BLACK + flip)).meshes
    if kind == "sphere" and flipped:  # it glows inwards, which no light says
        assert not read.lights
        return
    (light,) = read.lights
    assert light.reflectance == (0, 0, 0)
    own = Mesh(unit_geometry(light.shape), DEFAULT_MATERIAL, world_from_unit(light))
    for extreme in (np.min, np.max):  # triangles of rims and balls differ
        np.testing.assert_allclose(extreme(_world(own), 0), extreme(_world(mesh), 0), atol=0.02)
    if kind != "sphere":
        np.testing.assert_allclose(_normal(own), _normal(mesh), atol=1e-5)


def _world(mesh: Mesh) -> np.ndarray:
    m = mesh.world_from_object
    return mesh.geometry.positions @ m[:3, :3].T + m[:3, 3]


def _normal(mesh: Mesh) -> np.ndarray:
    """Of the front of the first triangle."""
    a, b, c = mesh.geometry.positions[mesh.geometry.indices[0]].astype(np.float64)
    m = mesh.world_from_object[:3, :3]
    front = np.cross(m @ (b - a), m @ (c - a)) * np.sign(np.linalg.det(m))
    return front / np.linalg.norm(front)


@pytest.mark.parametrize(
    ("kind", "matrix", "inside"),
    [
        ("rectangle", [[1, 0.5, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]], GLOW),
        ("disk", np.diag((1.0, 2.0, 1.0, 1.0)), GLOW),
        ("sphere", np.diag((1.0, 2.0, 1.0, 1.0)), GLOW),
        ("cube", np.eye(4), GLOW),
        ("rectangle", np.eye(4), GLOW + '<bsdf type="plastic"/>'),
        ("rectangle", np.diag((1.0, 0.0, 1.0, 1.0)), GLOW),
    ],
    ids=["skewed", "oval", "egg", "cube", "gloss", "flat"],
)
def test_what_no_area_light_says_stays_a_surface_that_glows(
    tmp_path: Path, kind: str, matrix: np.ndarray, inside: str
) -> None:
    read = scene(tmp_path, placed(kind, np.asarray(matrix), inside))
    assert not read.lights
    material = read.meshes[0].material
    assert (material.emission, material.two_sided) == ((1, 2, 3), False)


def test_turned_environment_maps(tmp_path: Path) -> None:
    pixels = np.zeros((8, 16, 3), np.uint8)
    pixels[:, 3] = 255
    Image.fromarray(pixels).save(tmp_path / "sky.png")
    body = (
        SENSOR.format("") + '<emitter type="envmap"><string name="filename" value="sky.png"/>'
        '<transform name="to_world"><rotate {} angle="{}"/></transform></emitter>'
    )
    environment = scene(tmp_path, body.format('y="1"', 45)).environment
    assert environment.rotation_deg == pytest.approx(45)
    np.testing.assert_allclose(environment.map[0, 3], 1.0)
    half_turn = scene(tmp_path, body.format('x="1"', 180))
    assert "resampled" in half_turn.warnings[-1]
    # About x by 180 degrees: u -> 1/2 - u, v -> 1 - v.
    np.testing.assert_allclose(half_turn.environment.map[4, (8 - 4) % 16], 1.0, atol=1e-5)


def test_media(tmp_path: Path) -> None:
    grid = np.arange(24, dtype="<f4").reshape(2, 3, 4) / 24
    header = b"VOL\x03" + struct.pack("<5i6f", 1, 4, 3, 2, 1, 0, 0, 0, 1, 1, 1)
    (tmp_path / "smoke.vol").write_bytes(header + grid.tobytes())
    read = scene(
        tmp_path,
        SENSOR.format("")
        + """<medium type="homogeneous" id="fog"><rgb name="sigma_t" value="0.1 0.2 0.4"/>
            <float name="scale" value="2"/><rgb name="albedo" value="0.9"/>
            <phase type="hg"><float name="g" value="0.3"/></phase></medium>
          <shape type="cube"><transform name="to_world"><scale value="2, 3, 4"/></transform>
            <bsdf type="null"/><ref name="interior" id="fog"/></shape>
          <shape type="cube"><transform name="to_world"><translate x="10"/></transform>
            <bsdf type="null"/>
            <medium type="heterogeneous" name="interior">
              <volume type="gridvolume" name="sigma_t"><string name="filename" value="smoke.vol"/>
                <transform name="to_world"><scale value="2"/><translate x="9" y="-1" z="-1"/>
                </transform></volume>
              <float name="scale" value="6"/><float name="albedo" value="0.7"/></medium></shape>""",
    )
    assert read.warnings == ()
    assert read.medium.bounds == ((-2, -3, -4), (2, 3, 4))
    np.testing.assert_allclose(read.medium.sigma_t, (0.2, 0.4, 0.8))
    assert (read.medium.albedo, read.medium.g) == ((0.9,) * 3, (0.3,) * 3)
    (volume,) = read.volumes
    np.testing.assert_allclose(volume.density * volume.sigma_t[1], 6 * grid, rtol=1e-5)
    low, high = (volume.world_from_volume @ [*corner, 1.0] for corner in volume.bounds)
    np.testing.assert_allclose([low[:3], high[:3]], [[9, -1, -1], [11, 1, 1]])
    assert (volume.albedo, volume.g) == ((0.7,) * 3, (0.0,) * 3)
    assert read.meshes == ()


def test_defaults_parameters_includes_and_references(tmp_path: Path) -> None:
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts" / "materials.xml").write_text(
        '<scene version="3.0.0"><bsdf type="diffuse" id="red">'
        '<rgb name="reflectance" value="$tone, 0, 0"/></bsdf></scene>'
    )
    read = scene(
        tmp_path,
        SENSOR.format("")
        + """<default name="to" value="9"/><default name="tone" value="0.25"/>
          <default name="tone" value="0.75"/><include filename="parts/materials.xml"/>
          <shape type="cube"><transform name="to_world"><translate x="$to"/></transform>
            <ref id="red"/></shape><shape type="cube"><ref id="red"/></shape>""",
    )
    assert [m.material.base_color for m in read.meshes] == [(0.25, 0, 0)] * 2
    assert read.meshes[0].world_from_object[0, 3] == 9
    assert read.warnings == ()


def test_old_names_are_understood(tmp_path: Path) -> None:
    body = '<shape type="cube"><transform name="toWorld"><translate x="2"/></transform></shape>'
    assert scene(tmp_path, body).meshes[0].world_from_object[0, 3] == 2


def test_without_a_sensor_the_camera_frames_the_scene(tmp_path: Path) -> None:
    read = scene(tmp_path, '<shape type="sphere"/>')
    assert read.warnings == ("there is no sensor: the camera frames the scene",)
    assert np.linalg.norm(read.camera.position) > 1.0


BILLION_LAUGHS = """<!DOCTYPE lolz [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;&a;&a;">
<!ENTITY c "&b;&b;&b;&b;&b;&b;">]><scene version="3.0.0"><string name="x" value="&c;"/></scene>"""


@pytest.mark.parametrize(
    "text",
    [BILLION_LAUGHS, '<!DOCTYPE scene SYSTEM "http://127.0.0.1/x.dtd"><scene version="3.0.0"/>'],
)
def test_entity_bombs_are_refused(tmp_path: Path, text: str) -> None:
    path = tmp_path / "bomb.xml"
    path.write_text(text)
    with pytest.raises(SceneError) as caught:
        load(path)
    assert str(caught.value) == f"{path}: a document type (<!DOCTYPE ...>) is refused. Remove it."


def test_includes_follow_the_rule_of_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    inner = tmp_path / "inner"
    inner.mkdir()
    (tmp_path / "part.xml").write_text('<scene version="3.0.0"><shape type="cube"/></scene>')
    for name in ("../part.xml", str(tmp_path / "part.xml")):
        body = f'<include filename="{name}"/>'
        assert scene(inner, body).triangle_count == 12
        with monkeypatch.context() as bounded:
            bounded.setenv("AIRLIGHT_ROOT", str(inner))
            assert f"which is outside of '{inner}'" in refusal(inner, body)


@pytest.mark.parametrize(
    ("body", "message"),
    [
        (
            '<shape type="cubee"/>',
            "scene.xml: shape (cubee) is no shape of Mitsuba's. Did you mean 'cube'?",
        ),
        (
            '<emitter type="pont"/>',
            "scene.xml: emitter (pont) is no emitter of Mitsuba's. Did you mean 'point'?",
        ),
        ("<shap/>", "scene.xml: <shap> is no element of a scene. Did you mean 'shape'?"),
        ("<shape/>", "scene.xml: <shape> without a type"),
        (
            '<ref id="x"/>',
            "scene.xml: it refers to 'x', which is nowhere. A part of a scene is read by the file "
            "that includes it.",
        ),
        ('<include filename="scene.xml"/>', "scene.xml: elements are nested more than 60 deep"),
        (
            '<float name="x" value="$y"/>',
            "scene.xml: the parameter $y has no value. "
            "Give it one: --param y=VALUE, in Python "
            'parameters={"y": ...}, or in the file <default>.',
        ),
        ('<float name="x" value="1e"/>', "scene.xml: <float name='x'> is '1e', not a number"),
        (
            '<rgb name="x" value="1 2"/>',
            "scene.xml: <rgb name='x'> has 2 numbers, it must have 1 or 3",
        ),
        (
            '<bsdf type="twosided" id="a"><ref id="a"/></bsdf>',
            "scene.xml: bsdf 'a' (twosided) contains itself",
        ),
        ('<shape type="obj"/>', "scene.xml: shape (obj) names no file"),
        ("<b>", "scene.xml: not readable XML (mismatched tag: line 1, column 28)"),
        (
            '<shape type="cube"><transform name="to_world"><skew/></transform></shape>',
            "scene.xml: <skew> is no step of a transform",
        ),
    ],
)
def test_bad_scenes_get_one_message(tmp_path: Path, body: str, message: str) -> None:
    assert refusal(tmp_path, body) == message


@pytest.mark.parametrize(
    "body",
    [
        '<sensor type="perspective"><string name="fov" value="wide"/></sensor>',
        '<shape type="sphere"><string name="radius" value="big"/></shape>',
        '<shape type="cube"><float name="to_world" value="2"/></shape>',
        '<shape type="cube"><bsdf type="diffuse"><string name="reflectance" value="red"/></bsdf>'
        "</shape>",
        '<emitter type="envmap"><string name="filename" value="scene.xml"/></emitter>',
    ],
)
def test_values_of_the_wrong_kind_get_one_message(tmp_path: Path, body: str) -> None:
    assert refusal(tmp_path, body).startswith("scene.xml: ")


def test_deep_nesting_is_refused(tmp_path: Path) -> None:
    body = '<bsdf type="twosided">' * 500 + "</bsdf>" * 500
    assert refusal(tmp_path, body) == "scene.xml: elements are nested more than 60 deep"


def test_not_a_scene(tmp_path: Path) -> None:
    path = tmp_path / "page.xml"
    path.write_text("<html/>")
    with pytest.raises(SceneError, match="its root is <html>, not <scene>"):
        load_mitsuba(path)
    with pytest.raises(SceneError, match="file not found"):
        load_mitsuba(tmp_path / "no.xml")


def test_unsupported_shapes_are_told(tmp_path: Path) -> None:
    read = scene(tmp_path, SENSOR.format("") + '<shape type="hair"/>')
    assert read.warnings == ("shape (hair) is left out: shapes of this kind are not read",)


TRIANGLE = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"
MESH = '<shape type="obj"><string name="filename" value="mesh.obj"/></shape>'


def test_files_are_looked_for_in_search_paths_the_last_one_first(tmp_path: Path) -> None:
    for folder, text in (("one", TRIANGLE), ("two", TRIANGLE + "f 3 2 1\n")):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "mesh.obj").write_text(text)
    both = '<path value="one"/><path value="two"/>'
    assert scene(tmp_path, both + MESH).triangle_count == 2
    assert scene(tmp_path, '<path value="one"/>' + MESH).triangle_count == 1
    (tmp_path / "two" / "part.xml").write_text(f'<scene version="3.0.0">{MESH}</scene>')
    assert scene(tmp_path, both + '<include filename="part.xml"/>').triangle_count == 2
    (tmp_path / "mesh.obj").write_text(TRIANGLE)
    assert scene(tmp_path, '<path value="nowhere"/>' + MESH).triangle_count == 1
    assert "search path" in scene(tmp_path, '<path value="nowhere"/>' + MESH).warnings[0]


def test_a_search_path_leads_up_but_out_of_no_folder_that_is_set(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    inner = tmp_path / "scenes" / "deep"
    (tmp_path / "common").mkdir()
    inner.mkdir(parents=True)
    (tmp_path / "common" / "mesh.obj").write_text(TRIANGLE)
    body = '<path value="../../common"/>'
    assert scene(inner, body + MESH).triangle_count == 1
    for root in (tmp_path / "scenes", tmp_path / "common"):
        monkeypatch.setenv("AIRLIGHT_ROOT", str(root))
        with pytest.raises(SceneError, match=r"'\.\./\.\./common' is no folder") as error:
            scene(inner, body + MESH)
        assert "AIRLIGHT_ROOT" in str(error.value)
        (warning,) = scene(inner, body + '<shape type="cube"/>').warnings[:1]
        assert "the search path '../../common' is no folder" in warning
    monkeypatch.setenv("AIRLIGHT_ROOT", str(tmp_path))
    assert scene(inner, body + MESH).triangle_count == 1
    with pytest.raises(SceneError, match="is outside of"):
        scene(inner, MESH.replace("mesh.obj", "../../../mesh.obj"))


def test_textures_of_roughness_are_read(tmp_path: Path) -> None:
    """Ours is the root of Mitsuba's alpha; of two widths that of their geometric mean."""
    for name, level in (("a", 64), ("b", 16)):
        PIL.Image.fromarray(np.full((4, 4, 3), level, np.uint8)).save(tmp_path / f"{name}.png")

    def image(role: str, file: str) -> str:
        return (
            f'<texture type="bitmap" name="{role}"><string name="filename" value="{file}.png"/>'
            '<boolean name="raw" value="true"/></texture>'
        )

    def made(inner: str) -> tuple[float, bool]:
        held = scene(
            tmp_path,
            f'{SENSOR.format("")}<shape type="cube"><bsdf type="roughconductor">{inner}'
            '<string name="distribution" value="ggx"/></bsdf></shape>',
        )
        found = held.meshes[0].material
        texture = found.metallic_roughness_texture
        assert texture is not None and texture.pixels[0, 0, 2] == 255 and found.metallic == 1.0
        assert not any("left out" in text for text in held.warnings)
        roughness = found.roughness * texture.pixels[0, 0, 1] / 255
        return roughness, any("anisotropic" in text for text in held.warnings)

    # Texels are whole numbers: half of one is .004 of the roughness at worst.
    a, b = 64 / 255, 16 / 255
    for inner, alpha, is_mean in (
        (image("alpha", "a"), a, False),
        (image("alpha_u", "a") + image("alpha_v", "a"), a, False),
        (image("alpha_u", "a") + image("alpha_v", "b"), np.sqrt(a * b), True),
        (image("alpha_u", "a") + '<float name="alpha_v" value="0.3"/>', np.sqrt(a * 0.3), True),
    ):
        roughness, told = made(inner)
        assert roughness == pytest.approx(np.sqrt(alpha), abs=0.004)
        assert told == is_mean


def test_a_default_may_stand_behind_its_use_in_a_file_that_is_included(tmp_path: Path) -> None:
    shape = '<shape type="Sphere"><float name="radius" value="$radius"/></shape>'
    path = tmp_path / "a.xml"
    path.write_text(f'<scene version="3.0.0">{shape}<include filename="b.xml"/></scene>')
    part = '<scene version="3.0.0"><default name="radius" value="{}"/>{}</scene>'
    # The first default wins, and a file that includes itself is looked at once.
    again = '<include filename="c.xml"/>'
    (tmp_path / "b.xml").write_text(part.format(3, again))
    (tmp_path / "c.xml").write_text(part.format(7, ""))
    (mesh,) = load(path).meshes
    np.testing.assert_allclose(np.array(mesh.world_bounds)[:, 0], [-3, 3], atol=1e-5)
    (tmp_path / "c.xml").write_text(part.format(7, again * 9))
    with pytest.raises(SceneError, match=r"files are included|nested"):
        load(path)


def test_values_of_defaults_further_on_hold_values_themselves(tmp_path: Path) -> None:
    shape = '<shape type="sphere"><float name="radius" value="$radius"/></shape>'
    path = tmp_path / "a.xml"
    path.write_text(f'<scene version="3.0.0">{shape}<include filename="b.xml"/></scene>')
    part = '<scene version="3.0.0"><default name="radius" value="$size.5"/>{}</scene>'
    (tmp_path / "b.xml").write_text(part.format('<default name="size" value="3"/>'))
    (mesh,) = load(path).meshes
    np.testing.assert_allclose(np.array(mesh.world_bounds)[:, 0], [-3.5, 3.5], atol=1e-5)
    # Values that need themselves, at once or by others, are one message.
    (tmp_path / "b.xml").write_text(part.format('<default name="size" value="$radius"/>'))
    with pytest.raises(SceneError, match=r"has no end: \$radius -> \$size -> \$radius"):
        load(path)


def test_a_part_of_a_scene_says_that_it_may_be_one(tmp_path: Path) -> None:
    path, told = tmp_path / "a.xml", "A part of a scene is read by the file that includes it."
    shape = '<shape type="obj"><string name="filename" value="meshes/a.obj"/></shape>'
    for held in (shape, '<shape type="sphere"><ref id="wood"/></shape>'):
        path.write_text(f'<scene version="3.0.0">{held}</scene>')
        with pytest.raises(SceneError) as caught:
            load(path)
        assert told in str(caught.value)
    with pytest.raises(SceneError) as caught:
        load(tmp_path / "none.xml")
    assert told not in str(caught.value)


def test_parameters_are_given_from_outside_and_win_over_defaults(tmp_path: Path) -> None:
    path = tmp_path / "a.xml"
    path.write_text(
        '<scene version="3.0.0"><default name="radius" value="2"/>'
        '<shape type="sphere"><float name="radius" value="$radius"/>'
        '<point name="center" x="$x" y="0" z="0"/></shape></scene>'
    )
    (mesh,) = load(path, parameters={"x": 5}).meshes
    np.testing.assert_allclose(np.array(mesh.world_bounds)[:, 0], [3, 7], atol=1e-5)
    (mesh,) = load(path, parameters={"x": "5", "radius": 1.0}).meshes
    np.testing.assert_allclose(np.array(mesh.world_bounds)[:, 0], [4, 6], atol=1e-5)
    with pytest.raises(SceneError, match=r"\$x has no value\. Give it one: --param x=VALUE"):
        load(path)
    with pytest.raises(SceneError, match=r"no \$radus stands in .* Did you mean 'radius'\?"):
        load(path, parameters={"x": 1, "radus": 1})
    (tmp_path / "a.obj").write_text(TRIANGLE)
    with pytest.raises(SceneError, match="parameters are for Mitsuba's files"):
        load(tmp_path / "a.obj", parameters={"x": 1})


def test_surfaces_are_black_behind_but_where_twosided_says_otherwise(tmp_path: Path) -> None:
    for kind in ("diffuse", "plastic", "roughconductor", "principled"):
        bsdf = f'<bsdf type="{kind}"/>'
        both = f'<bsdf type="twosided">{bsdf}</bsdf>'
        held = scene(
            tmp_path,
            "".join(f'<shape type="rectangle">{b}</shape>' for b in (bsdf, both))
            + '<shape type="rectangle"/>'
            + SENSOR.format(""),
        )
        sides = [(m.material.two_sided, m.material.has_black_back) for m in held.meshes]
        assert sides == [(False, True), (True, False), (False, True)]
        assert not any("one-sided" in w or "black" in w for w in held.warnings)


GROUP = """<shape type="shapegroup" id="pair">
  <shape type="cube"><transform name="to_world"><translate x="2"/></transform>
    <bsdf type="diffuse"><rgb name="reflectance" value="0.2"/></bsdf></shape>
  <shape type="sphere"/>
</shape>
<shape type="instance"><ref id="pair"/></shape>
<shape type="instance" id="high"><ref id="pair"/>
  <transform name="to_world"><scale value="2"/><translate y="5"/></transform></shape>"""


def test_instances_of_a_group_share_its_geometry(tmp_path: Path) -> None:
    """The group itself is not there; each instance is all of it, where it is placed."""
    read = scene(tmp_path, GROUP + SENSOR.format(""))
    assert [mesh.name for mesh in read.meshes][2:] == ["high", "high"]
    assert len({id(mesh.geometry) for mesh in read.meshes}) == 2
    assert len({id(mesh.material) for mesh in read.meshes}) == 2
    cube, _, high, _ = read.meshes
    np.testing.assert_allclose(cube.world_bounds, [[1, -1, -1], [3, 1, 1]], atol=1e-6)
    np.testing.assert_allclose(high.world_bounds, [[2, 3, -2], [6, 7, 2]], atol=1e-6)
    assert read.warnings == ()


def test_an_instance_of_nothing_is_refused(tmp_path: Path) -> None:
    with pytest.raises(SceneError, match="has no shapegroup inside"):
        scene(tmp_path, '<shape type="instance"><shape type="cube"/></shape>')


def test_merged_shapes_are_shapes(tmp_path: Path) -> None:
    inner = '<shape type="cube"/><shape type="rectangle"/>'
    read = scene(tmp_path, f'<shape type="merge">{inner}</shape>' + SENSOR.format(""))
    assert [mesh.geometry.indices.shape[0] for mesh in read.meshes] == [12, 2]


def test_an_emitter_may_stand_where_shapes_refer_to_it(tmp_path: Path) -> None:
    read = scene(
        tmp_path,
        '<shape type="cube"><ref id="glow"/></shape><emitter type="area" id="glow">'
        '<rgb name="radiance" value="3, 2, 1"/></emitter>' + SENSOR.format(""),
    )
    assert read.meshes[0].material.emission == (3.0, 2.0, 1.0)
    assert read.warnings == ()


def test_a_film_and_a_focus_are_taken_without_a_word(tmp_path: Path) -> None:
    """Images have the film's size, and pinholes are sharp wherever they focus."""
    body = """<sensor type="perspective"><float name="focus_distance" value="1000"/>
      <film type="hdrfilm"><integer name="width" value="256"/><integer name="height" value="128"/>
      </film></sensor>"""
    found = scene(tmp_path, body)
    assert found.camera.focus_m is None
    assert found.camera.film_px == found.camera.image_size == (256, 128)
    assert not found.warnings


def test_spectra_are_light_in_emitters_and_seen_by_daylight_elsewhere(tmp_path: Path) -> None:
    """Mitsuba's numbers for both; a constant reflects grey, and as light it is illuminant E."""
    emitted = "700:18.4, 400:0, 500:8, 600:15.6"
    made = scene(
        tmp_path,
        f"""<shape type="cube"><bsdf type="diffuse">
          <spectrum name="reflectance" value="400:0.1, 500:.4, 600:.7, 700:.2"/></bsdf></shape>
        <shape type="cube"><bsdf type="diffuse"><spectrum name="reflectance" value=".5"/></bsdf>
          <emitter type="area"><spectrum name="radiance" value="{emitted}"/></emitter></shape>
        <emitter type="point"><spectrum name="intensity" value="2.5"/></emitter>
        <emitter type="point"><rgb name="intensity" value="2.5"/></emitter>""",
    )
    red, grey = (mesh.material for mesh in made.meshes)
    np.testing.assert_allclose(red.base_color, (0.65549576, 0.54143965, 0.22374783), rtol=3e-3)
    assert grey.base_color == (0.5, 0.5, 0.5)
    np.testing.assert_allclose(grey.emission, (20.710836, 10.854634, 2.771152), rtol=3e-3)
    light, plain = (light.intensity for light in made.lights)
    np.testing.assert_allclose(light, (3.0119848, 2.3707275, 2.2722902), rtol=3e-3)
    assert plain == (2.5, 2.5, 2.5)
    assert made.warnings[0] == "spectra are reduced to red, green and blue"


def test_images_of_numbers_are_decoded_unless_raw_and_their_alpha_says_nothing(
    tmp_path: Path,
) -> None:
    PIL.Image.fromarray(np.array([[[188, 250]]], np.uint8), "LA").save(tmp_path / "t.png")
    image = '<texture type="bitmap" name="{}"><string name="filename" value="t.png"/>{}</texture>'
    raw = '<boolean name="raw" value="true"/>'
    for more, found in (("", 128), (raw, 188)):
        material, _ = bsdf(
            tmp_path, f'<bsdf type="principled">{image.format("roughness", more)}</bsdf>'
        )
        assert abs(int(material.metallic_roughness_texture.pixels[0, 0, 1]) - found) <= 1
        masked, _ = bsdf(
            tmp_path,
            f'<bsdf type="mask">{image.format("opacity", more)}<bsdf type="diffuse"/></bsdf>',
        )
        assert abs(int(masked.base_color_texture.pixels[0, 0, 3]) - found) <= 1
    normals, _ = bsdf(
        tmp_path,
        f'<bsdf type="normalmap">{image.format("normalmap", "")}<bsdf type="diffuse"/></bsdf>',
    )
    assert normals.normal_texture.pixels[0, 0, 0] == 188


PARTS = (
    '<bsdf type="diffuse"><rgb name="reflectance" value=".8 .4 .2"/></bsdf>',
    '<bsdf type="roughconductor"><string name="material" value="none"/>'
    '<float name="alpha" value=".25"/>'
    '<rgb name="specular_reflectance" value=".9 .6 .3"/></bsdf>',
)


@pytest.mark.parametrize("weight", [0.0, 0.3, 1.0])
def test_a_blend_reflects_the_mean_of_its_parts(tmp_path: Path, weight: float) -> None:
    number = f'<float name="weight" value="{weight}"/>'
    made, told = bsdf(tmp_path, f'<bsdf type="blendbsdf">{number}{"".join(PARTS)}</bsdf>')
    one, two = (bsdf(tmp_path, part)[0] for part in PARTS)
    assert not any("stands for both" in text for text in told)

    def parts(material):
        base = np.array(material.base_color)
        return base * (1.0 - material.metallic), base.mean() * material.metallic

    # What is diffuse keeps its colour up to the metal's, what is mirrored its brightness.
    diffuse, mirrored = parts(made)
    assert diffuse.mean() == pytest.approx((1 - weight) * parts(one)[0].mean())
    assert mirrored == pytest.approx(weight * parts(two)[1])
    base = (1 - weight) * np.array(one.base_color) + weight * np.array(two.base_color)
    np.testing.assert_allclose(made.base_color, base)
    assert weight == 0.0 or made.roughness == pytest.approx(two.roughness)


def test_an_image_blends_texel_by_texel(tmp_path: Path) -> None:
    PIL.Image.fromarray(np.array([[0, 255]], np.uint8)).save(tmp_path / "w.png")
    image = (
        '<texture type="bitmap" name="weight"><string name="filename" value="w.png"/>'
        '<string name="wrap_mode" value="clamp"/></texture>'
    )
    made, _ = bsdf(tmp_path, f'<bsdf type="blendbsdf">{image}{"".join(PARTS)}</bsdf>')
    color = made.base_color_texture
    assert color.wrap == ("clamp", "clamp") and made.base_color == (1.0, 1.0, 1.0)
    linear = srgb_decode(color.pixels[0, :, :3] / 255.0)
    np.testing.assert_allclose(linear, [(0.8, 0.4, 0.2), (0.9, 0.6, 0.3)], atol=5e-3)
    np.testing.assert_array_equal(made.metallic_roughness_texture.pixels[0, :, 2], [0, 255])


def test_a_blend_with_glass_is_the_heavier_of_both(tmp_path: Path) -> None:
    glass = '<bsdf type="thindielectric"/>'
    made, told = bsdf(
        tmp_path,
        f'<bsdf type="blendbsdf"><float name="weight" value=".4"/>{PARTS[0]}{glass}</bsdf>',
    )
    assert made.base_color == (0.8, 0.4, 0.2)
    assert "as one lets light pass" in told[-1]


def test_conductors_that_mitsuba_knows_are_known(tmp_path: Path) -> None:
    """From their indices, beside those that Lagarde2011 tabled: the same to .03."""
    carbon, told = bsdf(
        tmp_path, '<bsdf type="conductor"><string name="material" value="a-C"/></bsdf>'
    )
    assert told == () and carbon.base_color == METALS["a-C"] and carbon.metallic == 1.0
    nickel, _ = bsdf(
        tmp_path, '<bsdf type="conductor"><string name="material" value="Ni_palik"/></bsdf>'
    )
    np.testing.assert_allclose(nickel.base_color, (0.660, 0.609, 0.526), atol=0.03)
    _, told = bsdf(tmp_path, '<bsdf type="conductor"><string name="material" value="Xx"/></bsdf>')
    assert "the metal 'Xx' is not known" in told[0]


def test_half_of_the_light_passes_a_polariser(tmp_path: Path) -> None:
    made, told = bsdf(
        tmp_path,
        '<bsdf type="polarizer"><spectrum name="transmittance" value=".8"/></bsdf>',
    )
    assert made.alpha == pytest.approx(0.6)
    assert made.is_blended and made.base_color == (0.0, 0.0, 0.0)
    assert made.is_translucent and "half of it passes" in told[0]


def plastic(tmp_path: Path, kind: str, color: str, more: str = "") -> np.ndarray:
    made, _ = bsdf(
        tmp_path,
        f'<bsdf type="{kind}"><float name="int_ior" value="1.5"/><float name="ext_ior" value="1"/>'
        f'<rgb name="diffuse_reflectance" value="{color}"/>{more}</bsdf>',
    )
    return np.array(made.base_color)


def test_rough_and_nonlinear_plastics_are_as_dark_as_mitsubas(tmp_path: Path) -> None:
    """Diffuse albedo at .5 rad over that of a smooth white plastic, from Mitsuba 3.9's `eval`."""
    wide = '<float name="alpha" value="0.4"/><string name="distribution" value="ggx"/>'
    nonlinear = '<boolean name="nonlinear" value="true"/>'
    np.testing.assert_allclose(plastic(tmp_path, "plastic", ".9 .5 .1"), (0.9, 0.5, 0.1))
    found = plastic(tmp_path, "roughplastic", "1 .5 0", wide)
    np.testing.assert_allclose(found, (0.593, 0.2965, 0.0), atol=2e-3)
    found = plastic(tmp_path, "plastic", "1 .5 0", nonlinear)
    np.testing.assert_allclose(found, (1.0, 0.5 * 0.575, 0.0), atol=5e-3)
    found = plastic(tmp_path, "roughplastic", ".9 .5 0", wide + nonlinear)
    np.testing.assert_allclose(found, (0.9 * 0.593 * 0.949, 0.5 * 0.593 * 0.789, 0), atol=3e-3)


def test_a_nonlinear_plastic_darkens_texel_by_texel(tmp_path: Path) -> None:
    PIL.Image.fromarray(np.array([[[255, 188, 0]]], np.uint8)).save(tmp_path / "t.png")
    made, _ = bsdf(
        tmp_path,
        '<bsdf type="plastic"><boolean name="nonlinear" value="true"/><texture type="bitmap" '
        'name="diffuse_reflectance"><string name="filename" value="t.png"/></texture></bsdf>',
    )
    linear = srgb_decode(made.base_color_texture.pixels[0, 0, :3] / 255.0)
    as_number = plastic(tmp_path, "plastic", "1 .5 0", '<boolean name="nonlinear" value="true"/>')
    np.testing.assert_allclose(linear, as_number, atol=6e-3)  # 8 bits, and an index of 1.49


def test_a_thin_principled_sheet_passes_light_and_an_image_of_it_counts_by_its_mean(
    tmp_path: Path,
) -> None:
    checker = (
        '<texture name="spec_trans" type="checkerboard"><float name="color0" value=".2"/>'
        '<float name="color1" value=".8"/></texture>'
    )
    made, told = bsdf(
        tmp_path,
        f'<bsdf type="principledthin"><rgb name="base_color" value=".8 .4 .2"/>{checker}'
        '<float name="diff_trans" value=".5"/></bsdf>',
    )
    assert made.transmission == pytest.approx(0.5, abs=2e-3)
    np.testing.assert_allclose(made.base_color, (0.6, 0.3, 0.15))
    assert (made.two_sided, made.has_black_back) == (True, False)
    assert any("'spec_trans' the mean is taken" in text for text in told)
    assert any("to its other side is left out" in text for text in told)


def written_attributes(path: Path) -> None:
    """Two triangles of four vertices, whose corners and faces have colours."""
    head = ["ply", "format binary_little_endian 1.0", "element vertex 4"]
    head += [f"property float {name}" for name in ("x", "y", "z", "color_0", "color_1", "color_2")]
    head += ["element face 2", "property list uchar int vertex_indices"]
    head += [f"property float color_{k}" for k in range(3)] + ["end_header", ""]
    corners = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
    rows = [struct.pack("<6f", *at, 0.1 * k, 0.5, 0.25) for k, at in enumerate(corners)]
    rows += [struct.pack("<B3i3f", 3, 0, 1, 2, 1, 0, 0), struct.pack("<B3i3f", 3, 0, 2, 3, 0, 1, 0)]
    path.write_bytes("\n".join(head).encode() + b"".join(rows))


@pytest.mark.parametrize("attribute", ["vertex_color", "face_color", "face_weight", ""])
def test_colours_that_a_mesh_names_are_those_of_its_corners_or_faces(
    tmp_path: Path, attribute: str
) -> None:
    written_attributes(tmp_path / "m.ply")
    texture = (
        f'<texture type="mesh_attribute" name="reflectance"><string name="name" '
        f'value="{attribute}"/></texture>'
    )
    made = scene(
        tmp_path,
        '<shape type="ply"><string name="filename" value="m.ply"/><bsdf type="twosided">'
        f'<bsdf type="diffuse">{texture if attribute else ""}</bsdf></bsdf></shape>',
    )
    (mesh,) = made.meshes
    colors, faces = mesh.geometry.colors, mesh.geometry.indices
    if attribute == "vertex_color":
        np.testing.assert_allclose(colors[:, :3], [(0.1 * k, 0.5, 0.25) for k in range(4)])
    elif attribute == "face_color":
        np.testing.assert_allclose(colors[faces[0], :3], [(1, 0, 0)] * 3)
        np.testing.assert_allclose(colors[faces[1], :3], [(0, 1, 0)] * 3)
    else:
        assert colors is None
    if attribute in ("vertex_color", "face_color"):
        assert mesh.material.base_color == (1.0, 1.0, 1.0)
    told = [text for text in made.warnings if "only colours" in text]
    assert len(told) == (attribute == "face_weight")


def test_a_spot_has_the_mean_of_the_texture_that_it_projects(tmp_path: Path) -> None:
    """Of a white disk in a black square: only the circle that the cone shows counts."""
    y, x = np.mgrid[-1:1:65j, -1:1:65j]
    disk = (255 * (x * x + y * y <= 1.0)).astype(np.uint8)
    PIL.Image.fromarray(disk).save(tmp_path / "t.png")
    made = scene(
        tmp_path,
        '<emitter type="spot"><rgb name="intensity" value="4 2 1"/><texture name="texture" '
        'type="bitmap"><string name="filename" value="t.png"/></texture></emitter>'
        '<shape type="cube"/>',
    )
    np.testing.assert_allclose(made.lights[0].intensity, (4.0, 2.0, 1.0), rtol=1e-6)
    assert any("the mean is taken, in its circle" in text for text in made.warnings)
    PIL.Image.fromarray(disk // 2).save(tmp_path / "t.png")
    half = load(tmp_path / "scene.xml").lights[0].intensity
    np.testing.assert_allclose(half, 0.2122 * np.array([4.0, 2.0, 1.0]), rtol=2e-3)  # 127 decoded


@pytest.mark.parametrize("kind", ["heterogeneous", "homogeneous"])
def test_a_constant_volume_fills_the_unit_cube_where_it_stands(tmp_path: Path, kind: str) -> None:
    """Of a heterogeneous medium: what is around that cube is empty, within its shape, too."""
    made = scene(
        tmp_path,
        f'<shape type="cube"><transform name="to_world"><scale value="2"/></transform>'
        f'<bsdf type="null"/><medium name="interior" type="{kind}"><float name="scale" value="2"/>'
        '<volume type="constvolume" name="sigma_t"><rgb name="value" value=".5 .25 .125"/>'
        '<transform name="to_world"><translate x="-1"/></transform></volume></medium></shape>',
    )
    # Air that is the same everywhere fills its shape.
    (air,) = made.volumes or (made.medium,)
    if kind == "heterogeneous":
        np.testing.assert_allclose(made.whole_bounds, [(-1, 0, 0), (0, 1, 1)], atol=1e-6)
    else:
        np.testing.assert_allclose(air.bounds, [(-2, -2, -2), (2, 2, 2)], atol=1e-6)
    np.testing.assert_allclose(air.sigma_t, (1.0, 0.5, 0.25))
