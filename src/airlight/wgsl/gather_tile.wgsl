// Tiles of gather points.
//! use tone

const TILE = 8u;            // points along a side

fn tiles_of(points: vec2u) -> vec2u {
    return (points + TILE - 1u) / TILE;
}

fn surface_luminance(sums: PointSums) -> f32 {
    return luminance(sums.near + sums.far + sums.later);
}
