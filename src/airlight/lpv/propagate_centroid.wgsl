fn interacted(
    here: mat3x4f, side: vec4u, rest: vec4u, west: mat3x4f, east: mat3x4f, south: mat3x4f,
    north: mat3x4f, below: mat3x4f, above: mat3x4f,
) -> mat3x4f {
    return bounced(here, side, rest) + all_along(west, east, south, north, below, above);
}
