"""A small scene for the viewer, in settings under which a CPU adapter draws it at once."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np

SCENE = Path(__file__).parent / "app" / "view" / "view_box.toml"
SETTINGS = {
    "resolution": 8,
    "shadow_resolution": 64,
    "sky_lights": 0,
    "surfels": 2000,
    "ambient_occlusion": False,
}
OPTIONS = [word for key, value in SETTINGS.items() for word in ("-D", f"{key}={value}".lower())]
"""The same for the command line."""


def served(errors: int) -> subprocess.Popen[str]:
    """`airlight view` of it for browsers, whose first line is the link; stderr goes to `errors`."""
    words = ("view", str(SCENE), "--in", "browser", "--no-open", "-t", "direct", *OPTIONS)
    return subprocess.Popen(
        [sys.executable, "-m", "airlight", *words],
        stdout=subprocess.PIPE,
        stderr=errors,
        text=True,
    )


def box_share(pixels: np.ndarray) -> float:
    """The share of the image that the scene's red box takes, lit or not."""
    red, green, blue = pixels[..., 0], pixels[..., 1], pixels[..., 2]
    return float(((red > 1.4 * green) & (red > 1.4 * blue) & (red > 25)).mean())
