"""USD: what stages show, where it stands, and which layers it may name."""

from __future__ import annotations

import math
import os

import numpy as np
import PIL.Image
import pytest

from airlight.app.cli import run
from airlight.errors import SceneError
from airlight.exports.vdb import VdbGrid, vdb_bytes
from airlight.scene.io import load, load_meshes
from airlight.scene.lights import AreaLight, DirectionalLight, PointLight, SpotLight

pytestmark = pytest.mark.needs("usd_core")
QUAD = """
    def Mesh "quad" (prepend apiSchemas = ["MaterialBindingAPI"])
    {
        int[] faceVertexCounts = [4]
        int[] faceVertexIndices = [0, 1, 2, 3]
        point3f[] points = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
        uniform token subdivisionScheme = "none"
        %s
    }
"""
MATERIAL = """
    def Material "red"
    {
        token outputs:surface.connect = </World/red/s.outputs:surface>
        def Shader "s"
        {
            uniform token info:id = "UsdPreviewSurface"
            color3f inputs:diffuseColor = (0.5, 0.1, 0)
            float inputs:roughness = 0.25
            float inputs:metallic = 1
            float inputs:opacity = 0.5
            color3f inputs:emissiveColor = (0, 0, 2)
            token outputs:surface
        }
    }
"""


def stage(text: str, head: str = "") -> str:
    return f'#usda 1.0\n(\n{head}\n)\ndef Xform "World"\n{{\n{text}\n}}\n'


def scene(folder, text: str, head: str = ""):
    (folder / "a.usda").write_text(stage(text, head))
    return load_meshes(folder / "a.usda")


def test_up_axis_and_unit_become_metres_upwards(tmp_path):
    made = scene(tmp_path, QUAD % "", 'upAxis = "Z"\nmetersPerUnit = 0.01')
    (mesh,) = made.meshes
    # x stays, the stage's z is up, its y goes away from the viewer.
    np.testing.assert_allclose(mesh.world_bounds, [[0, 0, -0.01], [0.01, 0, 0]], atol=1e-9)
    made = scene(tmp_path, QUAD % "", "metersPerUnit = 1")
    np.testing.assert_allclose(made.meshes[0].world_bounds, [[0, 0, 0], [1, 1, 0]])


def test_a_unit_in_single_precision_is_one(tmp_path, monkeypatch):
    from pxr import Tf, UsdGeom

    def refused(stage):  # as the library does where a file holds a float instead of a double
        Tf.RaiseRuntimeError("Requested type double does not match retrieved type float")

    monkeypatch.setattr(UsdGeom, "GetStageMetersPerUnit", refused)
    (mesh,) = scene(tmp_path, QUAD % "", "metersPerUnit = 0.5").meshes
    np.testing.assert_allclose(mesh.world_bounds, [[0, 0, 0], [0.5, 0.5, 0]])


def test_what_the_library_refuses_while_it_is_read_is_one_message(tmp_path, monkeypatch):
    from pxr import Tf, UsdGeom

    def refused(stage):
        Tf.RaiseRuntimeError("no axis")

    monkeypatch.setattr(UsdGeom, "GetStageUpAxis", refused)
    with pytest.raises(SceneError, match=r"is no readable USD \(.*no axis"):
        scene(tmp_path, QUAD % "")


def test_a_face_looks_the_way_of_its_orientation(tmp_path):
    for token, z in (("rightHanded", 1.0), ("leftHanded", -1.0)):
        (mesh,) = scene(tmp_path, QUAD % f'uniform token orientation = "{token}"').meshes
        a, b, c = mesh.geometry.positions[mesh.geometry.indices[0]]
        assert np.sign(np.cross(b - a, c - a)[2]) == z


@pytest.mark.parametrize(
    ("kind", "values"),
    [
        ("vertex", "[(0, 0), (1, 0), (1, 1), (0, 1)]"),
        ("faceVarying", "[(0, 0), (1, 0), (1, 1), (0, 1)]"),
    ],
)
def test_texture_coordinates_run_downwards(tmp_path, kind, values):
    uvs = f'texCoord2f[] primvars:st = {values} (interpolation = "{kind}")'
    (mesh,) = scene(tmp_path, QUAD % uvs).meshes
    points, uv = mesh.geometry.positions, mesh.geometry.uvs
    np.testing.assert_allclose(uv, np.stack([points[:, 0], 1 - points[:, 1]], axis=1))


def test_a_preview_surface_is_a_material(tmp_path):
    binding = "rel material:binding = </World/red>"
    (mesh,) = scene(tmp_path, QUAD % binding + MATERIAL).meshes
    material = mesh.material
    assert material.base_color == pytest.approx((0.5, 0.1, 0))
    assert (material.roughness, material.metallic) == (0.25, 1.0)
    assert material.alpha == 0.5 and material.is_blended
    assert material.emission == (0, 0, 2)


def test_an_image_is_found_from_the_layer_but_none_of_the_system(tmp_path):
    inner = tmp_path / "inner"
    inner.mkdir()
    pixels = np.zeros((2, 2, 3), np.uint8)
    pixels[0, 0] = (255, 0, 0)
    for folder in (inner, tmp_path):
        PIL.Image.fromarray(pixels).save(folder / "i.png")
    for name, is_there in (("i.png", True), ("../i.png", True), ("/proc/version", False)):
        shader = """
        color3f inputs:diffuseColor.connect = </World/red/t.outputs:rgb>
        """
        image = f"""
        def Shader "t"
        {{
            uniform token info:id = "UsdUVTexture"
            asset inputs:file = @{name}@
            float3 outputs:rgb
        }}
        """
        text = MATERIAL.replace("color3f inputs:diffuseColor = (0.5, 0.1, 0)", shader)
        text = text.replace('def Shader "s"', image + 'def Shader "s"')
        made = scene(inner, QUAD % "rel material:binding = </World/red>" + text)
        texture = made.meshes[0].material.base_color_texture
        assert texture is not None
        if is_there:
            assert texture.is_srgb and texture.pixels[0, 0, 0] == 255 and not made.warnings
        else:
            assert "is a file of the system; a magenta checker" in made.warnings[0]


def test_subsets_have_materials_of_their_own(tmp_path):
    text = """
    def Mesh "two" (prepend apiSchemas = ["MaterialBindingAPI"])
    {
        int[] faceVertexCounts = [3, 3]
        int[] faceVertexIndices = [0, 1, 2, 0, 2, 3]
        point3f[] points = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
        def GeomSubset "part" (prepend apiSchemas = ["MaterialBindingAPI"])
        {
            uniform token elementType = "face"
            uniform token familyName = "materialBind"
            int[] indices = [1]
            rel material:binding = </World/red>
        }
    }
    """
    red, rest = scene(tmp_path, text + MATERIAL).meshes
    assert red.material.metallic == 1.0 and rest.material.metallic == 0.0
    assert len(red.geometry.indices) == len(rest.geometry.indices) == 1


def test_instances_share_a_geometry(tmp_path):
    text = f"""
    def PointInstancer "many"
    {{
        rel prototypes = </World/many/quad>
        int[] protoIndices = [0, 0]
        point3f[] positions = [(5, 0, 0), (0, 7, 0)]
        {QUAD % ""}
    }}
    """
    one, two = scene(tmp_path, text, "metersPerUnit = 1").meshes
    assert one.geometry is two.geometry
    np.testing.assert_allclose(one.world_bounds[0], (5, 0, 0))
    np.testing.assert_allclose(two.world_bounds[0], (0, 7, 0))


def test_hidden_prims_are_not_shown(tmp_path):
    hidden = 'token visibility = "invisible"', 'uniform token purpose = "guide"'
    text = "".join(
        (QUAD % line).replace('"quad"', f'"q{k}"') for k, line in enumerate((*hidden, ""))
    )
    assert [mesh.name for mesh in scene(tmp_path, text).meshes] == ["/World/q2"]


LIGHTS = """
    def SphereLight "ball" { float inputs:intensity = 3; float inputs:radius = 0.5 }
    def SphereLight "point" { float inputs:radius = 0.5; bool treatAsPoint = 1; float inputs:intensity = 2 }
    def RectLight "rect" { float inputs:width = 2; float inputs:height = 4; bool inputs:normalize = 1; float inputs:intensity = 16 }
    def DiskLight "disk" { float inputs:exposure = 1; float inputs:intensity = 1; float inputs:radius = 1 }
    def DistantLight "sun" { float inputs:angle = 60; float inputs:intensity = 4 }
    def DomeLight "sky" { float inputs:intensity = 0.5; color3f inputs:color = (1, 2, 4) }
"""  # noqa: E501


def test_lights_give_what_their_units_say(tmp_path):
    text = LIGHTS.replace("; ", "\n").replace("{ ", "{\n").replace(" }", "\n}")
    made = scene(tmp_path, QUAD % "" + text, "metersPerUnit = 1")
    ball, point, rect, disk, sun = made.lights
    assert isinstance(ball, AreaLight) and ball.shape == "sphere" and ball.radius == 0.5
    assert ball.radiance[0] == 3.0
    assert isinstance(point, PointLight)
    assert point.intensity[0] == pytest.approx(2 * math.pi * 0.25)  # of a disk so wide
    assert rect.size == (2, 4) and rect.radiance[0] == pytest.approx(2.0)  # 16 over 8 m^2
    assert rect.direction == pytest.approx((0, 0, -1)) and rect.up == pytest.approx((0, 1, 0))
    assert disk.radiance[0] == pytest.approx(2.0)
    assert isinstance(sun, DirectionalLight)
    assert sun.irradiance[0] == pytest.approx(4 * math.pi * math.sin(math.radians(30)) ** 2)
    assert made.environment.radiance == pytest.approx((0.5, 1, 2))


SHAPED = """
    def SphereLight "a" (prepend apiSchemas = ["ShapingAPI"])
    {
        float inputs:intensity = 5
        float inputs:radius = 0.1
        float inputs:shaping:cone:angle = 40
        float inputs:shaping:cone:softness = 0.25
        %s
    }
"""


@pytest.mark.parametrize(
    ("more", "strength", "radius"),
    [
        ("", 5 * math.pi * 0.01, 0.1),
        ("bool treatAsPoint = 1", 5 * math.pi * 0.01, 0.0),
        ("bool inputs:normalize = 1", 5 / 4, 0.1),
        ("bool inputs:normalize = 1\nbool treatAsPoint = 1", 5 / 4, 0.0),
    ],
)
def test_a_sphere_with_a_cone_is_a_spot_light(tmp_path, more, strength, radius):
    turned = "double3 xformOp:rotateXYZ = (-90, 0, 0)"
    order = 'uniform token[] xformOpOrder = ["xformOp:rotateXYZ"]'
    made = scene(tmp_path, QUAD % "" + SHAPED % f"{more}\n{turned}\n{order}", "metersPerUnit = 1")
    (light,) = made.lights
    assert isinstance(light, SpotLight) and made.warnings == ()
    assert (light.inner_deg, light.outer_deg) == pytest.approx((30, 40))
    np.testing.assert_allclose(light.direction, (0, -1, 0), atol=1e-9)
    assert light.intensity[0] == pytest.approx(strength)
    assert light.radius == pytest.approx(radius)


def test_a_cone_of_90_degrees_is_none_and_a_whole_point_has_its_power(tmp_path):
    open_cone = (SHAPED % "").replace("angle = 40", "angle = 90")
    (light,) = scene(tmp_path, QUAD % "" + open_cone).lights
    assert isinstance(light, AreaLight)
    point = SHAPED.replace("radius = 0.1", "radius = 0").replace("angle = 40", "angle = 180")
    (light,) = scene(tmp_path, QUAD % "" + point % "bool inputs:normalize = 1").lights
    assert isinstance(light, PointLight) and light.intensity == (1.25,) * 3


@pytest.mark.parametrize(
    ("more", "emission"),
    [
        ("", (3.0, 1.5, 0.0)),
        ("bool inputs:normalize = 1", (0.75, 0.375, 0.0)),
        ('uniform token light:materialSyncMode = "noMaterialResponse"', (3.0, 1.5, 0.0)),
    ],
)
def test_a_mesh_that_is_a_light_glows(tmp_path, more, emission):
    light = f"color3f inputs:color = (1, 0.5, 0)\nfloat inputs:intensity = 3\n{more}"
    quad = (QUAD % light).replace('"MaterialBindingAPI"', '"MaterialBindingAPI", "MeshLightAPI"')
    made = scene(tmp_path, quad.replace("(1, 1, 0), (0, 1, 0)", "(1, 4, 0), (0, 4, 0)"),
                 "metersPerUnit = 1")  # fmt: skip
    (mesh,) = made.meshes
    assert mesh.material.emission == pytest.approx(emission)
    assert (max(mesh.material.base_color) == 0) == ("noMaterial" in more)
    assert not [text for text in made.warnings if "light" in text]


def test_a_glowing_material_tints_the_light_of_its_mesh(tmp_path):
    bound = "float inputs:intensity = 3\nrel material:binding = </World/red>"
    quad = (QUAD % bound).replace('"MaterialBindingAPI"', '"MaterialBindingAPI", "MeshLightAPI"')
    (mesh,) = scene(tmp_path, quad + MATERIAL).meshes
    assert mesh.material.emission == (0, 0, 6)
    alone = quad.replace(bound, bound + '\nuniform token light:materialSyncMode = "independent"')
    assert scene(tmp_path, alone + MATERIAL).meshes[0].material.emission == (3, 3, 3)


def test_a_camera_sees_the_stages_field_of_view(tmp_path):
    text = """
    def Camera "cam"
    {
        float focalLength = 10
        float verticalAperture = 20
        double3 xformOp:translate = (1, 2, 3)
        uniform token[] xformOpOrder = ["xformOp:translate"]
    }
    """
    camera = scene(tmp_path, QUAD % "" + text, "metersPerUnit = 1").camera
    assert camera.position == (1, 2, 3) and camera.fov_y_deg == pytest.approx(90)
    np.testing.assert_allclose(np.subtract(camera.target, camera.position), (0, 0, -1))


def test_a_volume_is_its_vdb_file(tmp_path):
    grid = VdbGrid("density", np.ones((2, 3, 4), np.float32), np.eye(4), "")
    (tmp_path / "smoke.vdb").write_bytes(vdb_bytes([grid], {}))
    text = """
    def Volume "smoke"
    {
        rel field:density = </World/smoke/density>
        double3 xformOp:translate = (10, 0, 0)
        uniform token[] xformOpOrder = ["xformOp:translate"]
        def OpenVDBAsset "density"
        {
            asset filePath = @smoke.vdb@
            token fieldName = "density"
        }
    }
    """
    (volume,) = scene(tmp_path, text, "metersPerUnit = 1").volumes
    assert volume.density.shape == (2, 3, 4)
    np.testing.assert_allclose((volume.world_from_volume @ [*volume.bounds[0], 1])[0], 9.5)


def test_references_are_followed_but_not_out_of_a_folder_that_is_set(tmp_path, monkeypatch):
    inner = tmp_path / "inner"
    inner.mkdir()
    for folder in (tmp_path, inner):
        (folder / "part.usda").write_text(stage(QUAD % "", 'defaultPrim = "World"'))
    (inner / "link.usda").symlink_to(tmp_path / "part.usda")

    def using(arc: str) -> str:
        return f'#usda 1.0\n(\n)\ndef Xform "A" ({arc})\n{{\n}}\n'

    (inner / "a.usda").write_text(using("prepend references = @./part.usda@"))
    assert len(load_meshes(inner / "a.usda").meshes) == 1
    for arc in (
        "prepend references = @../part.usda@",
        f"prepend references = @{tmp_path / 'part.usda'}@",
        "prepend payload = @../part.usda@",
        "prepend references = @./link.usda@",
        'variants = { string v = "a" }\nprepend variantSets = "v"',
    ):
        text = using(arc)
        if "variants" in arc:
            held = 'variantSet "v" = { "a" (prepend references = @../part.usda@) { } }'
            text = text.replace("{\n}\n", f"{{\n{held}\n}}\n")
        (inner / "b.usda").write_text(text)
        assert len(load_meshes(inner / "b.usda").meshes) == 1
        # But where someone sets a folder that does not lie around both.
        with monkeypatch.context() as bounded:
            bounded.setenv("AIRLIGHT_ROOT", str(tmp_path))
            assert len(load_meshes(inner / "b.usda").meshes) == 1
            for root in (inner, tmp_path / "elsewhere"):
                bounded.setenv("AIRLIGHT_ROOT", str(root))
                with pytest.raises(SceneError, match="or let AIRLIGHT_ROOT be one around both"):
                    load_meshes(inner / "b.usda")
    # One that refers to one that refers out of the folder.
    (inner / "c.usda").write_text(using("prepend references = @./b.usda@</A>"))
    assert len(load_meshes(inner / "c.usda").meshes) == 1
    monkeypatch.setenv("AIRLIGHT_ROOT", str(inner))
    with pytest.raises(SceneError, match="is outside of"):
        load_meshes(inner / "c.usda")


def test_a_layer_that_is_a_pipe_is_refused(tmp_path):
    os.mkfifo(tmp_path / "part.usda")
    text = '#usda 1.0\ndef Xform "A" (prepend references = @./part.usda@)\n{\n}\n'
    (tmp_path / "a.usda").write_text(text)
    with pytest.raises(SceneError, match="a pipe, not a file"):
        load_meshes(tmp_path / "a.usda")


def test_a_package_holds_layers_and_images(tmp_path):
    from pxr import UsdUtils

    (tmp_path / "part.usda").write_text(stage(QUAD % "", 'defaultPrim = "World"'))
    text = '#usda 1.0\n()\ndef "A" (prepend references = @./part.usda@)\n{\n}\n'
    (tmp_path / "a.usda").write_text(text)
    away = tmp_path / "away"
    away.mkdir()
    assert UsdUtils.CreateNewUsdzPackage(str(tmp_path / "a.usda"), str(away / "a.usdz"))
    assert len(load(away / "a.usdz").meshes) >= 1


def test_what_cannot_be_read_is_one_message(tmp_path):
    clips = """#usda 1.0
    def "A" (clips = { dictionary default = { asset[] assetPaths = [@./x.usda@] } })
    {
    }
    """
    quad, one = QUAD % "", "int faceVertexCounts = 4"
    for text, message in (
        ("no such thing", "is no readable USD"),
        ("#usda 1.0\ndef {", "is no readable USD"),
        (stage(""), "it has no triangles and no volumes"),
        (clips, "has value clips"),
        (stage(quad.replace("[0, 1, 2, 3]", "[0, 1, 2, 9]")), "a point that there is not"),
        (stage(quad.replace("[4]", "[5]")), "do not fit together"),
        (stage(quad.replace("(1, 1, 0)", "(nan, 1, 0)")), "NaN"),
        (stage(quad.replace("int[] faceVertexCounts = [4]", one)), "no whole numbers"),
        (
            stage(quad.replace("point3f[]", "point2f[]").replace(", 0)", ")")),
            "or no positions",
        ),
    ):
        (tmp_path / "a.usda").write_text(text)
        with pytest.raises(SceneError, match=r"a\.usda: ") as caught:
            load_meshes(tmp_path / "a.usda")
        assert message in str(caught.value), caught.value


def test_layers_that_the_library_cannot_read_are_left_out_with_a_warning(tmp_path):
    """As materials in MaterialX files, which usd-core's wheels do not read."""
    (tmp_path / "look.mtlx").write_text('<?xml version="1.0"?><materialx version="1.38"/>')
    arc = 'def "Materials" (prepend references = @./look.mtlx@</Materials>) { }'
    made = scene(tmp_path, QUAD % "" + arc)
    assert len(made.meshes) == 1
    assert any("look.mtlx" in line for line in made.warnings)


@pytest.mark.parametrize(("fallback", "expected"), [("", 0), ("(1, 0.5, 0, 1)", 128)])
def test_an_image_without_a_file_is_its_fallback(tmp_path, fallback, expected):
    """As Houdini writes them, for what no image says."""
    texture = f"""
        def Shader "t"
        {{
            uniform token info:id = "UsdUVTexture"
            {f"float4 inputs:fallback = {fallback}" if fallback else ""}
            float3 outputs:rgb
        }}
    """
    emission = "color3f inputs:emissiveColor.connect = </World/red/t.outputs:rgb>"
    text = MATERIAL.replace("color3f inputs:emissiveColor = (0, 0, 2)", emission)
    text = text.replace('def Shader "s"', texture + 'def Shader "s"')
    made = scene(tmp_path, QUAD % "rel material:binding = </World/red>" + text)
    image = made.meshes[0].material.emission_texture
    assert image.pixels.shape == (1, 1, 4)
    assert image.pixels[0, 0, 1] == expected
    assert "names no file: its fallback stands in" in made.warnings[0]


@pytest.mark.parametrize("written", ["int normals = 7", "normal3f normals = (0, 1, 0)"])
def test_values_of_another_type_than_the_schema_says_are_left_out(tmp_path, written):
    plain = scene(tmp_path, QUAD % "").meshes[0].geometry
    made = scene(tmp_path, QUAD % written).meshes[0].geometry
    np.testing.assert_array_equal(made.normals, plain.normals)


def told(folder, text: str, head: str = "metersPerUnit = 1") -> list[str]:
    return [
        line.partition("a.usda: ")[2] for line in scene(folder, QUAD % "" + text, head).warnings
    ]


def prim(kind: str, name: str, body: str, more: str = "") -> str:
    lines = body.replace("; ", "\n")
    return f'\ndef {kind} "{name}" {more}\n{{\n{lines}\n}}\n'


def cone(angle: object, softness: object = 0.5) -> str:
    body = f"float inputs:shaping:cone:angle = {angle}; "
    body += f"float inputs:shaping:cone:softness = {softness}"
    return prim("SphereLight", "l", body, '(prepend apiSchemas = ["ShapingAPI"])')


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (prim("SphereLight", "l", "float inputs:intensity = -3"), "intensity is -3, below 0"),
        (prim("SphereLight", "l", "float inputs:radius = -1"), "inputs:radius is -1, below 0"),
        (
            prim("SphereLight", "l", "float inputs:intensty = 3"),
            "the input 'inputs:intensty' is unknown and left out. Did you mean 'inputs:intensity'?",
        ),
        (
            prim("DiskLight", "l", "float inputs:shaping:cone:angle = 20",
                 '(prepend apiSchemas = ["ShapingAPI"])'),
            "'/World/l': inputs:shaping:cone:angle is set",
        ),
        (
            prim("SphereLight", "l", "bool inputs:shadow:enable = 0",
                 '(prepend apiSchemas = ["ShadowAPI"])'),
            "inputs:shadow:enable is set",
        ),
        (
            prim("SphereLight", "l", "rel collection:lightLink:includes = </World/quad>"),
            "collection:lightLink:includes is set",
        ),
        (prim("DistantLight", "l", "float inputs:angle = 30"), "of distant lights are sharp"),
        (prim("CylinderLight", "l", ""), "'/World/l': a CylinderLight is left out"),
        (prim("RendererLight", "l", ""), "'/World/l': a RendererLight is left out"),
        (prim("Camera", "c", "float focalLength = 0"), "focalLength is 0, which sees nothing"),
        (prim("Camera", "c", "float verticalAperture = -2"), "verticalAperture is -2, which sees"),
        (
            prim("Camera", "c", 'token projection = "orthographic"'),
            "'/World/c': only perspective cameras are used: it is left out",
        ),
        (prim("Camera", "c", "float horizontalApertureOffset = 3"), "horizontalApertureOffset is"),
        (prim("Camera", "c", "") + prim("Camera", "d", ""), "it has several cameras"),
        (prim("BasisCurves", "b", ""), "'/World/b': a BasisCurves is left out"),
        (prim("Xform", "x", "", "(prepend references = @./gone.usda@)"), "gone.usda"),
        (prim("Xform", "x", "", "(prepend payload = @./gone.usda@)"), "gone.usda"),
        (
            prim("Mesh", "m", "uniform token subdivisionScheme = \"loop\"; "
                 "int[] cornerIndices = [1]"),
            "the cage of a subdivided mesh is shown",
        ),
        (prim("Sphere", "s", "float[] primvars:displayOpacity = [0.5]"), "displayOpacity is set"),
        (
            prim("Sphere", "s", "double radius.timeSamples = {1: 1, 5: 2}"),
            "what moves stands as at the first time: '/World/s' radius",
        ),
        (
            prim("Sphere", "s", 'token visibility.timeSamples = {1: "invisible", 5: "inherited"}'),
            "'/World/s': it is invisible at the first time and appears later, which is left out",
        ),
        (cone(120), "cones of 90 degrees and more light all around: it is 120"),
        (cone(90), "cones of 90 degrees and more light all around: it is 90"),
        (cone(89.5), "inputs:shaping:cone:angle is 89.5, taken as 89 degrees"),
        (cone(-3), "inputs:shaping:cone:angle is -3, taken as 0.1 degrees"),
        (cone("nan"), "light all around: it is nan"),
        (cone(40, 1.5), "inputs:shaping:cone:softness is 1.5, taken as 1: it is a share"),
        (cone(40, -1), "inputs:shaping:cone:softness is -1, taken as 0"),
    ],
)  # fmt: skip
def test_what_a_stage_asks_for_and_does_not_get_is_named(tmp_path, text, words):
    said = [line for line in told(tmp_path, text) if words in line]
    assert len(said) == 1, told(tmp_path, text)


def test_a_missing_sublayer_is_named(tmp_path):
    assert any("gone.usda" in t for t in told(tmp_path, "", "subLayers = [@./gone.usda@]"))


def test_what_is_as_the_schema_has_it_is_no_warning(tmp_path):
    text = prim(
        "SphereLight", "l", "float inputs:diffuse = 1; float inputs:specular = 1; float a = 2"
    )
    text += prim("SphereLight", "m", "", '(prepend apiSchemas = ["ShapingAPI"])') + cone(
        180, 1
    ).replace('"l"', '"n"')
    text += prim("Sphere", "s", 'token visibility.timeSamples = {1: "invisible", 5: "invisible"}')
    text += prim("Camera", "c", "double shutter:open = 0; float horizontalApertureOffset = 0")
    text += prim("Xform", "x", 'custom string userProperties:note = "n"')
    head = "metersPerUnit = 1\nstartTimeCode = 1\nendTimeCode = 50"
    assert told(tmp_path, text, head) == []


def test_the_same_loss_of_many_prims_is_told_once(tmp_path):
    text = "".join(prim("SphereLight", f"l{k}", "float inputs:diffuse = 0.5") for k in range(4))
    said = [t for t in told(tmp_path, text) if "inputs:diffuse" in t]
    assert said == [
        "'/World/l0': inputs:diffuse is set: lights light all of a surface (and 3 more)"
    ]


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("float inputs:roughness = 7", "its roughness is 7, outside of 0 to 1: the nearest is"),
        ("color3f inputs:diffuseColor = (-1, 0, 0)", "its diffuseColor is -1, outside of 0 to 1"),
        ("float inputs:clearcoat = 1", "its clearcoat is left out"),
        ("int inputs:useSpecularWorkflow = 1", "its useSpecularWorkflow is left out"),
        ("float inputs:displacement = 0.2", "its displacement is left out"),
        (
            "float inputs:roughnes = 0.1",
            "'roughnes' is unknown and left out. Did you mean 'roughness'",
        ),
        (
            "color3f inputs:diffuseColor.connect = </World/red/n.outputs:out>",
            "its diffuseColor comes from a Noise, which is not read",
        ),
    ],
)
def test_what_a_surface_asks_for_and_does_not_get_is_named(tmp_path, line, words):
    shader = f"""
    def Material "red"
    {{
        token outputs:surface.connect = </World/red/s.outputs:surface>
        def Shader "n"
        {{
            uniform token info:id = "Noise"
            color3f outputs:out
        }}
        def Shader "s"
        {{
            uniform token info:id = "UsdPreviewSurface"
            {line}
            token outputs:surface
        }}
    }}
    """
    made = scene(tmp_path, QUAD % "rel material:binding = </World/red>" + shader)
    assert [text for text in made.warnings if words in text], made.warnings


def test_a_material_for_final_images_is_worn_where_there_is_no_other(tmp_path):
    (mesh,) = scene(tmp_path, QUAD % "rel material:binding:full = </World/red>" + MATERIAL).meshes
    assert mesh.material.metallic == 1.0


def test_an_index_of_refraction_is_a_reflectance(tmp_path):
    text = MATERIAL.replace("float inputs:metallic = 1", "float inputs:ior = 1.2")
    (mesh,) = scene(tmp_path, QUAD % "rel material:binding = </World/red>" + text).meshes
    assert mesh.material.specular == pytest.approx((0.2 / 2.2) ** 2 / 0.04)


@pytest.mark.parametrize(
    ("kind", "volume", "area"),
    [
        ("Cylinder", math.pi * 4 * 3, 2 * math.pi * 2 * 3 + 2 * math.pi * 4),
        ("Cone", math.pi * 4 * 3 / 3, math.pi * 2 * math.hypot(2, 3) + math.pi * 4),
        ("Capsule", math.pi * 4 * 3 + 4 / 3 * math.pi * 8, 2 * math.pi * 2 * 3 + 4 * math.pi * 4),
    ],
)
@pytest.mark.parametrize("axis", ["X", "Y", "Z"])
def test_shapes_of_revolution_have_their_volume_about_their_axis(
    tmp_path, kind, volume, area, axis
):
    text = prim(kind, "s", f'double radius = 2; double height = 3; uniform token axis = "{axis}"')
    (mesh,) = scene(tmp_path, text, "metersPerUnit = 1").meshes
    a, b, c = np.moveaxis(mesh.geometry.positions[mesh.geometry.indices].astype(float), 1, 0)
    faces = np.cross(b - a, c - a)
    # Chords of 64 and 16 sides a circle lose less than a hundredth.
    assert np.einsum("tx,tx->", a, np.cross(b, c)) / 6 == pytest.approx(volume, rel=0.01)
    assert np.linalg.norm(faces, axis=1).sum() / 2 == pytest.approx(area, rel=0.01)
    low, high = mesh.world_bounds
    long = 3 if kind != "Capsule" else 7
    size = [long if name == axis else 4 for name in "XYZ"]
    np.testing.assert_allclose(high - low, size, rtol=0.01)


def test_a_shape_of_no_length_is_one_message(tmp_path):
    with pytest.raises(SceneError, match="its radius -1 and height 2 are no lengths"):
        scene(tmp_path, prim("Cylinder", "c", "double radius = -1"))


def test_faces_that_are_holes_are_not_there(tmp_path):
    text = (QUAD % "int[] holeIndices = [1]").replace("[4]", "[3, 3]")
    (mesh,) = scene(tmp_path, text.replace("[0, 1, 2, 3]", "[0, 1, 2, 0, 2, 3]")).meshes
    assert len(mesh.geometry.indices) == 1


VOLUME = """
    def Volume "smoke"
    {
        %s
        def OpenVDBAsset "a"
        {
            asset filePath = @smoke.vdb@
            token fieldName = "density"
        }
        def OpenVDBAsset "b"
        {
            asset filePath = @%s@
            token fieldName = "%s"
        }
    }
"""


def burning(folder, field: str, file: str = "smoke.vdb"):
    values = np.ones((2, 3, 4), np.float32)
    grids = [VdbGrid("density", values, np.eye(4), ""), VdbGrid(field, 900 * values, np.eye(4), "")]
    (folder / "smoke.vdb").write_bytes(vdb_bytes(grids, {}))
    rels = f"rel field:density = </World/smoke/a>\n        rel field:{field} = </World/smoke/b>"
    return scene(folder, VOLUME % (rels, file, field), "metersPerUnit = 1")


def test_a_volume_with_temperatures_is_a_fire(tmp_path):
    made = burning(tmp_path, "temperature")
    (volume,) = made.volumes
    assert volume.is_emissive and volume.emission.values.shape[:3] == (2, 3, 4)
    assert any("has flames" in text for text in made.warnings)


def test_other_fields_of_a_volume_are_named(tmp_path):
    made = burning(tmp_path, "pressure")
    assert made.volumes[0].emission is None
    assert any("'/World/smoke': its field 'pressure' is left out" in t for t in made.warnings)
    made = burning(tmp_path, "temperature", "gone.vdb")
    words = "the file 'gone.vdb' of its field 'temperature' is missing"
    assert made.volumes[0].emission is None and any(words in t for t in made.warnings)


@pytest.mark.parametrize("command", ["validate", "info", "render"])
def test_commands_say_the_same(tmp_path, command, capsys, gpu):
    (tmp_path / "a.usda").write_text(
        stage(QUAD % "" + prim("Camera", "c", "float focalLength = 0"), "metersPerUnit = 1")
    )
    more = ["-o", str(tmp_path / "o.png"), "--size", "16x16"] if command == "render" else []
    assert run([command, str(tmp_path / "a.usda"), *more]) == 0
    assert "focalLength is 0, which sees nothing" in capsys.readouterr().err


def test_a_path_with_backslashes_is_followed(tmp_path):
    (tmp_path / "parts").mkdir()
    image = tmp_path / "parts" / "i.png"
    PIL.Image.fromarray(np.zeros((2, 2, 3), np.uint8)).save(image)
    shader = """
        def Shader "t"
        {
            uniform token info:id = "UsdUVTexture"
            asset inputs:file = @.\\parts\\i.png@
            float3 outputs:rgb
        }
    """
    text = MATERIAL.replace(
        "color3f inputs:diffuseColor = (0.5, 0.1, 0)",
        "color3f inputs:diffuseColor.connect = </World/red/t.outputs:rgb>",
    ).replace('def Shader "s"', shader + 'def Shader "s"')
    made = scene(tmp_path, QUAD % "rel material:binding = </World/red>" + text)
    assert made.warnings == () and made.meshes[0].material.base_color_texture is not None


ARM = """
    def SkelRoot "arm"
    {
        def Skeleton "bones" (prepend apiSchemas = ["SkelBindingAPI"])
        {
            uniform token[] joints = ["A", "A/B"]
            uniform matrix4d[] bindTransforms = [%(one)s, %(up)s]
            uniform matrix4d[] restTransforms = [%(one)s, %(up)s]
            rel skel:animationSource = </World/arm/bend>
        }
        def SkelAnimation "bend"
        {
            uniform token[] joints = ["A", "A/B"]
            quatf[] rotations%(rotations)s
            half3[] scales = [(1, 1, 1), (1, 1, 1)]
            float3[] translations = [(0, 0, 0), (0, 2, 0)]
        }
        def Mesh "body" (prepend apiSchemas = ["SkelBindingAPI"])
        {
            int[] faceVertexCounts = [4, 4]
            int[] faceVertexIndices = [0, 1, 2, 3, 3, 2, 4, 5]
            point3f[] points = [(-1,0,0), (1,0,0), (1,2,0), (-1,2,0), (1,4,0), (-1,4,0)]
            int[] primvars:skel:jointIndices = [0, 0, 0, 0, 1, 1] (
                elementSize = 1
                interpolation = "vertex"
            )
            float[] primvars:skel:jointWeights = [1, 1, 1, 1, 1, 1] (
                elementSize = 1
                interpolation = "vertex"
            )
            rel skel:skeleton = </World/arm/bones>
            uniform token subdivisionScheme = "none"
        }
    }
"""
ONE = {
    "one": "((1,0,0,0), (0,1,0,0), (0,0,1,0), (0,0,0,1))",
    "up": "((1,0,0,0), (0,1,0,0), (0,0,1,0), (0,2,0,1))",
}
BENT = "[(1, 0, 0, 0), (0.70710678, 0, 0, 0.70710678)]"
STRAIGHT = "[(1, 0, 0, 0), (1, 0, 0, 0)]"


@pytest.mark.parametrize(
    ("head", "rotations", "moves"),
    [
        ("metersPerUnit = 1", f" = {BENT}", False),
        ("metersPerUnit = 1", f".timeSamples = {{3: {BENT}, 9: {STRAIGHT}}}", True),
        (
            "metersPerUnit = 1\nstartTimeCode = 5\nendTimeCode = 9",
            f".timeSamples = {{3: {STRAIGHT}, 5: {BENT}, 9: {STRAIGHT}}}",
            True,
        ),
    ],
)
def test_a_skeleton_bends_its_mesh_into_the_first_pose(tmp_path, head, rotations, moves):
    """The second joint, 2 m up, is turned by a quarter: what was above it is beside it."""
    made = scene(tmp_path, ARM % {**ONE, "rotations": rotations}, head)
    (mesh,) = made.meshes
    low, high = mesh.world_bounds
    np.testing.assert_allclose((low, high), [(-2, 0, 0), (1, 3, 0)], atol=1e-3)  # halves turn it
    assert not any("stands at rest" in text for text in made.warnings)
    assert any("what moves stands as at" in text for text in made.warnings) == moves


def test_a_skinned_mesh_that_cannot_be_posed_is_told_to_stand_at_rest(tmp_path):
    text = ARM % {**ONE, "rotations": f" = {BENT}"}
    made = scene(tmp_path, text.replace("</World/arm/bones>", "</World/arm/nowhere>"), "")
    assert any("'/World/arm/body': its skeleton is left out" in t for t in made.warnings)
