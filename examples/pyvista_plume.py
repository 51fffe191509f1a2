"""Smoke and a hill from PyVista into an image, and the light on the hill back into PyVista.

    python examples/pyvista_plume.py

You should see a plume drift over a green hill, with its shadow on the slope (pyvista_plume.png),
and in hill_with_light.vtp, which ParaView and PyVista open, the hill with the light that the sky
and the slopes send to each of its points. Bring your own grid and surface instead: any that PyVista
reads. Needs the extra: pip install "airlight[vtk]".
"""

import numpy as np
import pyvista as pv

import airlight as al

# VTK's data is mostly z-up; airlight is y-up. What pointed along +Z points along +Y.
Y_UP = np.array([[1.0, 0, 0, 0], [0, 0, 1.0, 0], [0, -1.0, 0, 0], [0, 0, 0, 1.0]])


def made_hill() -> pv.PolyData:
    """A hill of 40 m over 300 m of land, with its normals."""
    x, y = np.meshgrid(np.linspace(-150, 150, 121), np.linspace(-150, 150, 121))
    z = 40 * np.exp(-((x - 30) ** 2 + (y - 20) ** 2) / 3200) + 6 * np.sin(x / 23) * np.cos(y / 31)
    surface = pv.StructuredGrid(x, y, z).extract_surface(algorithm="dataset_surface")
    return surface.triangulate().compute_normals(flip_normals=True)


def made_plume() -> pv.ImageData:
    """A plume from a chimney that the wind bends, as a model of dispersion gives it."""
    grid = pv.ImageData(dimensions=(97, 49, 41), spacing=(2.5, 2.5, 2.5), origin=(-130, -60, 8))
    x, y, z = grid.points.T
    along = np.maximum(x + 118.0, 1e-3)  # from the chimney
    rise = 22 + 5.0 * along ** (1 / 3)
    wide, high = 2.5 + 0.09 * along, 2.0 + 0.06 * along
    wave = 4 * np.sin(along / 17) * np.minimum(along / 90, 1)
    puffs = 0.7 + 0.5 * np.sin(along / 6.5 + y / 9) * np.sin(z / 7)
    across = ((y - wave) / wide) ** 2 + ((z - rise) / high) ** 2
    grid["smoke"] = np.where(x > -118, puffs * np.exp(-across / 2) / (wide * high), 0).astype("f4")
    return grid


def mesh_of(surface: pv.PolyData, material: al.Material) -> al.Mesh:
    """A surface of triangles as airlight has it."""
    triangles = surface.faces.reshape(-1, 4)[:, 1:].astype(np.uint32)
    normals = np.asarray(surface.point_data["Normals"], np.float32)
    points = np.asarray(surface.points, np.float32)
    return al.Mesh(al.Geometry(points, triangles, normals=normals), material, Y_UP)


def volume_of(grid: pv.ImageData, name: str, **optics: float) -> al.Volume:
    """A grid's points as voxels: x varies fastest in VTK, so that the array is (z, y, x)."""
    density = np.asarray(grid[name]).reshape(grid.dimensions[::-1])
    low = np.array(grid.origin) - 0.5 * np.array(grid.spacing)
    high = low + np.array(grid.spacing) * grid.dimensions
    return al.Volume(density=density, bounds=(low, high), world_from_volume=Y_UP, **optics)


hill, plume = made_hill(), made_plume()
grass = al.Material("grass", (0.13, 0.19, 0.07), roughness=0.9, specular=0.3)
scene = al.Scene(
    meshes=(mesh_of(hill, grass),),
    volumes=(volume_of(plume, "smoke", sigma_t=22.0, albedo=0.9),),
    camera=al.Camera(position=(-60, 95, 200), target=(5, 14, -5), fov_y_deg=40),
)
scene = al.with_sky(scene, al.Sky(elevation_deg=38, azimuth_deg=245))
al.render(scene, size=(640, 360)).save("pyvista_plume.png")

# Light goes back as arrays of the surface's points: W m^-2 of red, green and blue.
light = al.export_lattice(scene, technique="lpv")
turned = Y_UP[:3, :3]
points, normals = hill.points @ turned.T, hill.point_data["Normals"] @ turned.T
hill["indirect"] = light.irradiance(points, normals)
hill.save("hill_with_light.vtp")
