"""Rays towards what lights shine on: spheres around lit surfaces, and how likely each is chosen.

Twin of `wgsl/light_guide.wgsl`.
"""

from __future__ import annotations

PATCHES = 16
"""Spheres around all that lights shine on."""
