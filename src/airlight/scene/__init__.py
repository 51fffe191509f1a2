"""Scenes: frozen values that say what is to be rendered; no GPU.

    io, builtin -> Scene (camera, lights, meshes, media, environment) -> at(time) by animation
      -> shown: as techniques take it -> an Image

scene        all of it in one value           camera, environment
sun_sky      a clear sky and its sun            studio     a backdrop without an edge
mesh         triangles and their transforms   material   how they reflect, texels of their textures
lights       point, spot, directional, area   point_lights   thousands of them in arrays
medium       homogeneous, with or without bounds    volume   density grids, boxes, balls
emission     light that volumes give off themselves
image, denoise   a rendered image, and without noise    settings   of techniques
keys, checks, limits   how values are described, checked and bounded; fingerprint tells scenes apart
shapes, light_shapes   meshes by name; of area lights         coefficients   by voxel
one_grid     grids that lie anywhere, on the voxels of one box   enclosed   what meshes enclose
placing, nearby, along moved by a matrix; to an origin near the camera; boxes along other axes
lens, map_suns, shown  samples of lens and shutter; suns in maps; scenes as techniques take them
io/          files <-> these    builtin/   scenes that ship    animation/   scenes in time
"""

from .camera import Camera
from .emission import Emission
from .environment import Environment
from .lights import AreaLight, DirectionalLight, Light, PointLight, SpotLight
from .material import Material, Texture
from .medium import Medium
from .mesh import Geometry, Mesh
from .point_lights import PointLights
from .scene import Scene
from .sun_sky import Sky, with_sky
from .volume import Volume

__all__ = [
    "AreaLight",
    "Camera",
    "DirectionalLight",
    "Emission",
    "Environment",
    "Geometry",
    "Light",
    "Material",
    "Medium",
    "Mesh",
    "PointLight",
    "PointLights",
    "Scene",
    "Sky",
    "SpotLight",
    "Texture",
    "Volume",
    "with_sky",
]
