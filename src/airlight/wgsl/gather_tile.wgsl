// Tiles of gather points. The including pass is given their side, TILE (gather/found.py).
//! use tone

fn tiles_of(points: vec2u) -> vec2u {
    return (points + TILE - 1u) / TILE;
}

fn surface_luminance(sums: PointSums) -> f32 {
    return luminance(sums.near + sums.far + sums.later);
}
