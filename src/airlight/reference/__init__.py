"""References that share no code with the techniques that they judge.

   mitsuba      any scene, path traced          tracer    fluence, exits, directions in a box
   quadrature   closed forms and integrals      shdom, flatland, harmonics   other solvers
   metrics      errors of an image              stored    references stored with the tests

Imports scene and maths only. Mitsuba, Numba and FLIP come with the `reference` extra and are
imported when they are used; without them a ReferenceFailure says what to install.
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
    """Score an image and its layers against a reference: see `metrics.Metrics`.

    `perceptual`: FLIP, too, where flip-evaluator is installed. Raises ReferenceFailure for images
    of different sizes or with NaN.
    """
    from .metrics import compare as compare_images

    return compare_images(image, reference, perceptual=perceptual)
