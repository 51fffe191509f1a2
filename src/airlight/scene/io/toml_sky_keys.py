"""[sky] of a scene file: its keys, part of `toml_tables`."""

from __future__ import annotations

from .. import checks
from ..keys import Key, local_date, local_time, within
from .toml_schema import Table, fraction

SKY = Table(
    "sky",
    "A clear sky with its sun, computed: instead of an [environment]. The sun is a light of its "
    "own and seen as a disk. Say where it stands by angles, or by place and time. Radiances are "
    "those of the real sky (the sun gives some 500 W m^-2): without an exposure_stops the image is "
    "exposed by itself.",
    (
        Key("elevation_deg", checks.number, "number", "above the horizon, -18 to 90", "degrees"),
        Key("azimuth_deg", checks.number, "number", "from north (-Z) by east (+X)", "degrees"),
        Key("latitude_deg", checks.number, "number", "of the place, instead of angles", "degrees"),
        Key("longitude_deg", checks.number, "number", "of the place, eastwards", "degrees"),
        Key("date", local_date, "date", "such as 2026-06-21, without quotes"),
        Key("time", local_time, "time", "such as 17:30:00, without quotes"),
        Key(
            "utc_offset_h",
            within(-14.0, 14.0),
            "number",
            "hours by which that clock is before UTC (in summer, too)",
            "hours",
            "the longitude's / 15, whole",
        ),
        Key(
            "north_deg",
            checks.number,
            "number",
            "where the scene's north lies: from -Z by +X",
            "degrees",
            "0",
        ),
        Key(
            "turbidity",
            checks.number,
            "number",
            "haze, 1 to 10: 2 very clear, 3 clear, 6 hazy",
            default="2.5",
        ),
        Key("ground", fraction, "number", "albedo below the horizon", default="0.2"),
        Key("scale", checks.number, "number", "multiplies sun and sky", default="1"),
        Key("disk", checks.boolean, "boolean", "the sun is seen", default="true"),
    ),
)
