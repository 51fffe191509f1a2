"""Scene files, and everything they name, to scenes and back.

    a user's file -> files, ledger -> the reader of its suffix -> arrays, checked
      -> meshes, materials, lights, volumes -> defaults -> a Scene, with doubts
    a Scene, changed -> toml_text*, gltf_write* or images, exr -> writing -> a file

toml, toml_*     airlight's scene files: toml_tables, toml_media_tables and toml_keys list keys,
                 toml_schema checks, toml_meshes, _volumes (_volume_shapes), _sky and _animation
                 read what they name; toml_text* write, as toml_syntax spells; toml_page prints the
                 reference
light_groups     thousands of point lights in an .npz file
gltf, gltf_*     glTF 2.0 and GLB: gltf_json, _buffers and _compressed (meshopt: its streams) give
                 values; _nodes, _camera, _mesh, _tangents, _material, _uv, _variants, _deform and
                 _animation the scene; _extensions, _losses and _schema say what is not read, or
                 impossible; gltf_write, _write_material write
obj, obj_parse   Wavefront: number_blocks parses its lines; mtl, mtl_statements its materials
meshfile         PLY and STL; mesh_headers: whether they can be true
usd, usd_*       OpenUSD, by an extra: usd_stage -> _mesh, _skel, _material, _lights, _volume;
                 _motion; usd_losses says what is not read
mitsuba*         a subset of Mitsuba's scenes: mitsuba_xml -> _nodes, _values -> _shapes (_ply,
                 _serialized, _sdf), _materials (_lobes, _metals, _plastic, _blend, _bumps),
                 _textures, _emitters, _lights, _camera; _media: where (_bodies), what of
                 (_coefficients)
polygons, normals   faces of many corners cut into triangles; normals of what has none
images           textures, radiance maps, images: rgbe, exr, ktx2; image_sizes bounds them, cube
                 reads tables of colours, texture_files finds them, texture_mix packs two into one,
                 texture_bake draws one again where gltf_frames brings coordinates together
volumes          density grids of every kind: numpy_files, vol, nanovdb, openvdb, openvdb_tree,
                 vti with vti_values, and netcdf, netcdf_* (_coordinates and _axes: where cells are,
                 and which way they go, gridded: in metres, cloud_water: their units) -> dense_grid;
                 upright: which way is up; coefficient_files, emission_files: the grids beside a
                 density; grid_series: those of a folder; grid_times: those of a sequence;
                 volume_scene: grids as a scene, volume_times: that follow each other
model_options    what may be asked for beside each kind of file
defaults         a camera where there is none: framing, viewpoint, by the scene's outline, or the
                 dense_part of air; where there is no light a studio, in rooms daylight; ground
                 under a bare model; probe: the rays that find walls and windows
"""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any, Literal

from ...errors import SceneError, nearest
from .. import checks
from ..camera import Camera
from ..limits import check_extent
from ..scene import Scene
from ..sun_sky import Sky, chosen_sky, with_sky
from .files import naming, regular_file

BUILTIN_PREFIX = "builtin:"
GLTF_SUFFIXES = (".glb", ".gltf")
USD_SUFFIXES = (".usd", ".usda", ".usdc", ".usdz")
MESH_SUFFIXES = (".obj", *GLTF_SUFFIXES, ".ply", ".stl", *USD_SUFFIXES)
VOLUME_SUFFIXES = (".npy", ".npz", ".vol", ".nvdb", ".vdb", ".vti", ".nc", ".nc4", ".zarr")
OTHER_SUFFIXES = (".fbx", ".dae", ".blend", ".3ds", ".abc")
"""Of other programs' scenes, which are not read."""
_BUILTIN = "For a scene that ships with airlight, write builtin:NAME."
_EXPORT = "Export it as glTF (.glb) from the program that made it."
_AS_GRIDS = {
    **dict.fromkeys(
        (".vtk", ".vtu", ".vtr", ".vts", ".pvti"),
        "Save it as .vti: ParaView's filter Resample To Image makes a grid of it.",
    ),
    ".pvd": "Name the folder of the .vti files that it lists: those say when they are.",
    **dict.fromkeys((".grib", ".grib2", ".grb", ".grb2"), "Write it as .nc, by xarray and cfgrib."),
    **dict.fromkeys((".h5", ".hdf5", ".hdf"), "Write it as .nc, by xarray's to_netcdf."),
    **dict.fromkeys(
        (".tif", ".tiff", ".nii", ".nrrd", ".mhd", ".fits", ".mat", ".raw"),
        "Write its numbers as .npy (z, y, x), by numpy.save.",
    ),
}
"""Of files of grids that are not read: what is."""
SCENE_SUFFIXES = (".toml", ".xml", *MESH_SUFFIXES, *VOLUME_SUFFIXES)


def load(
    path: str | Path,
    *,
    up: Literal["y", "z"] | None = None,
    scale: float = 1.0,
    variant: str | None = None,
    grid: str | None = None,
    channels: str | None = None,
    sequence_fps: float | None = None,
    sun: Sky | str | None = None,
    ground: bool | None = False,
    parameters: Mapping[str, Any] | None = None,
) -> Scene:
    """A scene from the file at `path`, or from `builtin:NAME`. A folder of grids is a sequence.

    Of a mesh file or a density grid, `up` is the axis that points upwards (None: y, unless the file
    says it) and `scale` how many metres its unit is; of a glTF file `variant` names one of its
    material variants. `grid` and `channels` choose among several grids of a file, and of grids that
    follow each other `sequence_fps` are shown in a second (None: 24; 12 of NetCDF, zarr and .vti
    that say when they are), as keys of a [[volume]] have it. Scene files say so themselves.
    Coefficients of a grid are per metre of the world, whatever the scale. `parameters` are values,
    as text or numbers, of the $names in a Mitsuba file; they win over its defaults.
    `sun` (a Sky, or text as for `--sun`) replaces directional lights and the environment. `ground`
    True: a mesh file or a grid that shows no room, has no floor and gets its light here stands
    on one, and a warning says why if it does not; None: mesh files do, without a word.

    Mesh files (OBJ, glTF, PLY, STL, USD) without light get a studio, in rooms a sun and a sky, and
    without a camera one that frames them; density grids (NumPy, VDB, VTK, NetCDF, Mitsuba .vol) a
    sun, a sky and a camera. Scene files (TOML, Mitsuba XML) say themselves. What was dropped,
    replaced or approximated is in the scene's `warnings`. Raises SceneError.
    """
    from .model_options import model_keys

    # Options that do not go with this kind of file are refused before anything is read.
    written = checks.path_text(path, "a scene that is loaded")
    asked = {"up": up, "scale": scale, "variant": variant, "grid": grid, "channels": channels}
    asked["sequence_fps"] = sequence_fps
    model = model_keys(written, parameters=parameters, **asked)
    sky = chosen_sky(sun)
    # Scenes that ship are made, not read; like scene files they say everything themselves.
    if written.startswith(BUILTIN_PREFIX):
        from ..builtin import builtin_scene

        scene = builtin_scene(written.removeprefix(BUILTIN_PREFIX))
        return _grounded(with_sky(scene, sky) if sky else scene, Path("builtin.toml"), ground)
    file = Path(written)
    # Errors from here on name the file.
    with naming(file):
        scene = _loaded(file, model, sky)
        check_extent(scene)
        return _grounded(scene, file, ground)


def _grounded(scene: Scene, file: Path, ground: bool | None) -> Scene:
    """The scene on the ground that `load` was asked for, or a warning that it has none."""
    from .grid_series import kind_of
    from .ground import NONE, with_ground

    suffix = kind_of(file)
    # Only bare models and grids can lack a floor.
    if ground and suffix not in (*MESH_SUFFIXES, *VOLUME_SUFFIXES):
        said = NONE.format(why="scene files say what there is")
        return replace(scene, warnings=(*scene.warnings, said))
    if ground or (ground is None and suffix in MESH_SUFFIXES):
        return with_ground(scene, is_asked=bool(ground))
    return scene


def _loaded(file: Path, model: dict[str, Any], sky: Sky | None) -> Scene:
    from .grid_series import series_of

    # A folder or a pattern of one grid is that grid.
    series = series_of(file)
    named, file = file, series[0] if series else file
    suffix = file.suffix.lower()
    # Scene files say everything themselves; a sky that was asked for replaces theirs.
    if suffix == ".toml":
        from .doubts import doubts
        from .toml import load_toml

        scene = load_toml(file)
        scene = replace(scene, warnings=(*scene.warnings, *doubts(scene)))
        return with_sky(scene, sky) if sky else scene
    if suffix == ".xml":
        from .mitsuba import load_mitsuba

        scene = load_mitsuba(file, model.get("parameters"))
        return with_sky(scene, sky) if sky else scene
    # Bare grids and meshes get what they lack.
    if suffix in VOLUME_SUFFIXES:
        from .volume_scene import load_series_scene, load_volume_scene

        is_one = len(series) < 2
        scene = (
            load_volume_scene(file, model) if is_one else load_series_scene(series, named, model)
        )
    else:
        # Keys of placement, as a [[mesh]] would have them.
        scene = load_meshes(file, model.get("variant"))
        if model:
            from .toml_meshes import placed

            scene = placed(scene, model)
    if sky:
        from .defaults import with_default_camera

        # Framed before it is exposed: a camera that says how is one of the file's own.
        scene = with_default_camera(scene) if scene.camera == Camera() else scene
        scene = with_sky(scene, sky)
    return with_defaults(scene)


def load_meshes(file: Path, variant: str | None = None) -> Scene:
    """What a mesh file says and nothing more: no default light; Camera() where it has none.

    `variant` names one of a glTF file's material variants. Raises SceneError.
    """
    with naming(file):
        if variant is None:
            return _mesh_reader(file)(file)
        # Other kinds of files have no variants, so the name would be lost without a word.
        if file.suffix.lower() not in GLTF_SUFFIXES:
            raise SceneError(
                f"the variant '{variant}' is asked for, and only glTF files have variants",
                where=file,
            )
        from .gltf import load_gltf

        return load_gltf(file, variant)


def _mesh_reader(file: Path) -> Callable[[Path], Scene]:
    suffix = file.suffix.lower()
    if suffix == ".obj":
        from .obj import load_obj

        return load_obj
    if suffix in GLTF_SUFFIXES:
        from .gltf import load_gltf

        return load_gltf
    if suffix in (".ply", ".stl"):
        from .meshfile import load_mesh_file

        return load_mesh_file
    if suffix in USD_SUFFIXES:
        from .usd import load_usd

        return load_usd
    # No suffix: a missing file, or the name of a builtin scene.
    if not suffix:
        try:
            regular_file(file)
        except SceneError as error:
            raise SceneError(error.problem, where=file, remedy=_BUILTIN) from None
    raise SceneError(
        f"a scene file cannot end in '{file.suffix}'",
        where=file,
        remedy=_EXPORT
        if suffix in OTHER_SUFFIXES
        else _AS_GRIDS.get(suffix, nearest(suffix, SCENE_SUFFIXES)),
    )


def with_defaults(scene: Scene) -> Scene:
    """The scene with a framing camera, and with light, where it has none.

    A camera like Camera() counts as none; lights, an environment, or bright surfaces in a room
    as light. Where a light was added and the camera's exposure is 0 it is chosen, too.
    """
    from .defaults import with_default_camera, with_default_lights
    from .probe import Probe

    checks.instance(scene, "the scene", Scene)
    # Both look at the same triangles; of large meshes the largest take a while to find.
    probe = functools.cache(lambda: Probe.of(scene))
    framed = with_default_camera(scene, probe) if scene.camera == Camera() else scene
    return with_default_lights(framed, probe)


__all__ = [
    "GLTF_SUFFIXES",
    "MESH_SUFFIXES",
    "SCENE_SUFFIXES",
    "VOLUME_SUFFIXES",
    "load",
    "load_meshes",
    "with_defaults",
]
