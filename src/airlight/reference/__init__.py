"""References that share no code with the techniques that they judge.

    scene -> mitsuba -> mitsuba_scene: XML that mitsuba_process renders -> Image -> metrics

mitsuba_scene     of a scene the XML (mitsuba_xml) and files (mitsuba_files): mitsuba_shapes,
                  mitsuba_material, mitsuba_textures, mitsuba_lights; mitsuba_media, each with its
                  mitsuba_boundary and mitsuba_emission
mitsuba_process   the child that renders, asked by mitsuba_child; mitsuba_llvm finds its compiler
mitsuba_paths     our integrator, by mitsuba_steps; mitsuba_brdf, mitsuba_glass: of surfaces
tracer            fluence, exits and directions in a box of scattering medium, by our own photons:
                  tracer_setup (what is asked) -> tracer_kernel (photons, compiled)
quadrature        closed forms and integrals: the first truth for every technique
shdom, flatland   discrete ordinates in a medium; propagation in the plane; harmonics: their bands
metrics           errors of an image and of its layers; metrics_display: as a display shows them
stored            references stored with the tests
All of them import scene and maths only.

Mitsuba, Numba and FLIP come with the `reference` extra and are imported when they are used; without
them a ReferenceFailure says what to install.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ..scene.image import Image
    from ..scene.scene import Scene
    from .metrics import Metrics

__all__ = ["compare", "render"]


def render(scene: Scene, **options: Any) -> Image:
    """The unbiased image of a scene by Mitsuba, with its variance in layers["variance"].

    `options` are those of `airlight.reference.mitsuba.render`: spp, size, ...
    Raises ReferenceFailure where Mitsuba is missing, refuses the scene, or fails.
    """
    from .mitsuba import render as render_with_mitsuba

    return render_with_mitsuba(scene, **options)


def compare(image: Image, reference: Image, *, perceptual: bool = True) -> Metrics:
    """Score an image and its layers against a reference, as Metrics.

    `perceptual`: FLIP, too, where flip-evaluator is installed. Raises ReferenceFailure for images
    of different sizes or with NaN.
    """
    from .metrics import compare as compare_images

    return compare_images(image, reference, perceptual=perceptual)
