"""Six ways to draw a foggy scene (Billeter2012 Fig. 5 a to f)."""

from __future__ import annotations

import dataclasses
from typing import Any

from ..app.compare.images import shown
from ..reference.metrics import compare
from ..scene.builtin import one_iteration
from ..scene.camera import Camera
from ..scene.image import Image
from ..scene.lights import SpotLight
from ..scene.medium import Medium, extinction_and_albedo
from ..scene.mesh import Mesh
from ..scene.scene import Scene
from .panels import Drawn, Request, exposed, exposure_of, mean_light, rendered, sheet
from .truths import as_large_as, told_of, truth_of, without_noise

TECHNIQUES = {
    "a  ours": "lpv-scatter",
    "b  shadow map": "direct",
    "c  lattice": "lpv",
    "d  single scattering": "single",
    "e  marched lattice": "lpv-march",
    "f  d and e": "lpv-sum",
}
SCATTERING = 0.12  # per metre
BOARD = 0.15  # its reflectance


def dark_hall() -> Scene:
    """A closed hall in fog whose one lamp shines on a dark board.

    Most of what lights the walls is the light of the beam that fog scatters: modes without it leave
    them dark, as in the paper.
    """
    # The hall of Fig. 6 c, its camera and light moved so that a beam lights the walls.
    scene = one_iteration()
    camera = Camera((-2.4, 2.2, 2.8), (0.4, 1.5, -1.2), fov_y_deg=75.0, exposure_stops=None)
    spot = SpotLight((-3.2, 3.2, 0.4), (3.2, -2.0, -0.4), (90.0, 81.0, 67.5), 9.0, 12.0)
    medium = Medium(*extinction_and_albedo(SCATTERING, 0.0))

    # Boards are dark, or they would light the hall by reflection.
    meshes = tuple(
        _of_reflectance(mesh, BOARD) if mesh.name.startswith("board") else mesh
        for mesh in scene.meshes
    )
    return dataclasses.replace(
        scene,
        name="dark hall",
        meshes=meshes,
        lights=(spot,),
        camera=camera,
        medium=medium,
        settings={},
    )


def _of_reflectance(mesh: Mesh, reflectance: float) -> Mesh:
    material = dataclasses.replace(mesh.material, base_color=(reflectance,) * 3)
    return Mesh(mesh.geometry, material, mesh.world_from_object, mesh.name)


def draw(request: Request) -> Drawn:
    """Six techniques in the papers' order, exposed alike; scores where a truth is traced."""
    # All techniques, and their scores beside the truth where there is one.
    scene = dark_hall()
    truth = truth_of(request, scene)
    images: dict[str, Image] = {}
    numbers: dict[str, Any] = {"scene": scene.name, "techniques": {}}
    for label, technique in TECHNIQUES.items():
        request.report(label, len(images) / len(TECHNIQUES))
        images[label] = image = rendered(request, scene, technique=technique)
        told: dict[str, Any] = {"technique": technique, "mean": mean_light(image.radiance)}
        if truth is not None:
            found = compare(as_large_as(image, truth.image.radiance), truth.image)
            told |= {
                name: found[name]
                for name in ("relmse", "relative_l2", "flip", "hdr_flip", "energy_ratio")
            }
        numbers["techniques"][label] = told

    # The first one's exposure for all, in two rows.
    stops = exposure_of(scene, next(iter(images.values())).radiance)
    panels = exposed([(name, image.radiance) for name, image in images.items()], stops)
    rows: list[Any] = [("", panels[:3]), ("", panels[3:])]
    if truth is not None:
        light = without_noise(truth, next(iter(images.values())))
        rows.append(("", [(told_of(truth), shown(light, stops))]))
    return Drawn(sheet(request, "Six ways to draw fog", rows), numbers)
