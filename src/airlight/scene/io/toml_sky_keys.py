"""[sky] of a scene file: its keys, part of `toml_tables`."""

from __future__ import annotations

from ..keys import BOOLEAN, FRACTION, LOCAL_DATE, LOCAL_TIME, NUMBER, Key, within
from .toml_schema import Table

SKY = Table(
    "sky",
    "A clear sky with its sun, computed: instead of an [environment]. The sun is a light of its "
    "own and seen as a disk. Say where it stands by angles, or by place and time. Radiances are "
    "those of the real sky (the sun gives some 500 W m^-2): without an exposure_stops the image is "
    "exposed by itself.",
    (
        Key("elevation_deg", NUMBER, "above the horizon, -18 to 90", "degrees"),
        Key("azimuth_deg", NUMBER, "from north (-Z) by east (+X)", "degrees"),
        Key("latitude_deg", NUMBER, "of the place, instead of angles", "degrees"),
        Key("longitude_deg", NUMBER, "of the place, eastwards", "degrees"),
        Key("date", LOCAL_DATE, "such as 2026-06-21, without quotes"),
        Key("time", LOCAL_TIME, "such as 17:30:00, without quotes"),
        Key(
            "utc_offset_h",
            within(-14.0, 14.0),
            "hours by which that clock is before UTC (in summer, too)",
            "hours",
            "the longitude's / 15, whole",
        ),
        Key("north_deg", NUMBER, "where the scene's north lies: from -Z by +X", "degrees", "0"),
        Key("turbidity", NUMBER, "haze, 1 to 10: 2 very clear, 3 clear, 6 hazy", default="2.5"),
        Key("ground", FRACTION, "albedo below the horizon", default="0.2"),
        Key("scale", NUMBER, "multiplies sun and sky", default="1"),
        Key("disk", BOOLEAN, "the sun is seen", default="true"),
    ),
)
