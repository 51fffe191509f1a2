// What of a ray's light stays with its gather point. What single rays find by luck, a small place that shines brighter by
// far than all around, would be blots: a ray counts at most `params.most` times the mean of those around, and what it
// found more is given to all points around. The including pass binds `tiles`, of which each has the luminance of its
// points' sums, and how many rays they had.
//! use gather_tile

// Mean luminance that rays of a tile and of those beside it found.
fn mean_around(tile: vec2u) -> f32 {
    let last = vec2i(tiles_of(params.reduced)) - 1;
    var sum = vec2f(0.0);
    for (var k = 0; k < 9; k++) {
        let at = vec2i(tile) + vec2i(k % 3, k / 3) - 1;
        if (all(at >= vec2i(0)) && all(at <= last)) {
            sum += textureLoad(tiles, at, 0).xy;
        }
    }
    return sum.x / max(sum.y, 1.0);
}

// The share of a point's light that stays with it: its brightest ray counts for as much as it may.
fn staying_share(sums: PointSums, mean: f32) -> f32 {
    let excess = max(sums.brightest - params.most * mean, 0.0);
    return 1.0 - excess / max(surface_luminance(sums), 1e-30);
}
