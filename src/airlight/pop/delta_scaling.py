"""Delta scaling of media whose phase function is sharper than the ordinates resolve.

Light that such a medium scatters hardly leaves its direction, while an ordinate spreads it over a
part of the sky: a surface behind the medium would be hidden by that blur. The forward peak of the
phase function therefore counts as unscattered, which keeps absorption and the transport coefficient
sigma_s (1 - g) (delta scaling; Joseph1976).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..maths.transforms import triple
from ..media.reduced import AnyMedium, ChangedMedia

SHARPEST = 0.97  # mean cosine; an ordinate of 64 has 0.95 to 0.99


def delta_scaling() -> ChangedMedia:
    """Scenes without a lobe sharper than SHARPEST."""
    return ChangedMedia(delta_scaled)


def delta_scaled(medium: AnyMedium) -> AnyMedium:
    """The medium without the forward peak; as much is absorbed, and sigma_s (1 - g) stays.

    Itself where its lobe is no sharper than SHARPEST.
    """
    if max(medium.g) <= SHARPEST:
        return medium
    g, albedo = np.array(medium.g), np.array(medium.albedo)
    # Of scattering the share f goes straight on: sigma_t' = (1 - albedo f) sigma_t, with f such
    # that g' = (g - f)/(1 - f) is SHARPEST (Joseph1976).
    unscattered = np.maximum(g - SHARPEST, 0.0) / (1.0 - SHARPEST)
    left = 1.0 - albedo * unscattered
    return replace(
        medium,
        g=triple(np.minimum(g, SHARPEST)),
        sigma_t=triple(np.array(medium.sigma_t) * left),
        albedo=triple(np.minimum(albedo * (1.0 - unscattered) / left, 1.0)),
    )
