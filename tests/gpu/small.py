"""Settings of lattices and maps for frames that are drawn in no time."""

SMALL = {
    "resolution": 8,
    "shadow_resolution": 64,
    "map_resolution": 32,
    "sky_lights": 4,
    "surfels": 2000,
}
