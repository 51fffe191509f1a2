"""The room's closed body: slabs 0.2 m thick with one window, skirting and window frame."""

from __future__ import annotations

from ..mesh import Geometry
from .patch import merged, moved, placed_at
from .profile import arc, around_rectangle, profile
from .solids import box, rounded_box

LOW_M = (-2.6, 0.0, -2.0)
HIGH_M = (2.6, 2.7, 2.6)
"""The inner corners; y = 0 is the floor."""

WALL_M = 0.2

WINDOW_Y_M, WINDOW_Z_M = (0.85, 2.30), (-0.75, 1.05)
"""The opening in the wall at -x."""


def floor_slab() -> Geometry:
    """The floor, under the walls too."""
    (x0, _, z0), (x1, _, z1), t = LOW_M, HIGH_M, WALL_M
    return box((x0 - t, -t, z0 - t), (x1 + t, 0.0, z1 + t))


def plain_walls() -> Geometry:
    """Ceiling, the wall at +x, the one at +z, and the one at -x around its window."""
    (x0, y0, z0), (x1, y1, z1), t = LOW_M, HIGH_M, WALL_M
    (sill, head), (near, far) = WINDOW_Y_M, WINDOW_Z_M
    # Ceiling, the walls at +x and +z, then four pieces around the window.
    return merged(
        [
            box((x0 - t, y1, z0 - t), (x1 + t, y1 + t, z1 + t)),
            box((x1, y0, z0 - t), (x1 + t, y1, z1 + t)),
            box((x0, y0, z1), (x1, y1, z1 + t)),
            box((x0 - t, y0, z0 - t), (x0, sill, z1 + t)),
            box((x0 - t, head, z0 - t), (x0, y1, z1 + t)),
            box((x0 - t, sill, z0 - t), (x0, head, near)),
            box((x0 - t, sill, far), (x0, head, z1 + t)),
        ]
    )


def colored_wall() -> Geometry:
    """The wall at -z."""
    (x0, y0, z0), (x1, y1, _), t = LOW_M, HIGH_M, WALL_M
    return box((x0, y0, z0 - t), (x1, y1, z0))


def skirting() -> Geometry:
    """A board 9 cm high along the foot of all walls."""
    shape = profile([(0.014, 0.0), (0.014, 0.075), *arc((0.0, 0.075), 0.014, 0.0, 90.0, 3)])
    half_x, half_z = (HIGH_M[0] - LOW_M[0]) / 2.0, (HIGH_M[2] - LOW_M[2]) / 2.0
    centre = placed_at((HIGH_M[0] + LOW_M[0]) / 2.0, 0.0, (HIGH_M[2] + LOW_M[2]) / 2.0)
    return moved(around_rectangle(shape, half_x, half_z, inwards=True), centre)


def window_frame() -> Geometry:
    """A casement with one mullion and one transom, and a sill board; no glass."""
    (sill, head), (near, far) = WINDOW_Y_M, WINDOW_Z_M
    x0, x1 = LOW_M[0] - 0.13, LOW_M[0] - 0.07
    middle, third = (near + far) / 2.0, sill + 0.68 * (head - sill)
    # Outer frame, mullion, then the two halves of the transom, which lie a little deeper so that no
    # faces coincide.
    bars = [
        ((x0, sill, near), (x1, sill + 0.06, far)),
        ((x0, head - 0.06, near), (x1, head, far)),
        ((x0, sill + 0.06, near), (x1, head - 0.06, near + 0.06)),
        ((x0, sill + 0.06, far - 0.06), (x1, head - 0.06, far)),
        ((x0 + 0.005, sill + 0.06, middle - 0.03), (x1 - 0.005, head - 0.06, middle + 0.03)),
        ((x0 + 0.01, third - 0.02, near + 0.06), (x1 - 0.01, third + 0.02, middle - 0.03)),
        ((x0 + 0.01, third - 0.02, middle + 0.03), (x1 - 0.01, third + 0.02, far - 0.06)),
    ]
    # A sill board that stands out into the room.
    board = rounded_box(
        (LOW_M[0] - 0.07, sill, near - 0.05), (LOW_M[0] + 0.12, sill + 0.03, far + 0.05), 0.01
    )
    return merged([*(rounded_box(low, high, 0.008) for low, high in bars), board])
