// Where a full-screen pass has its vertices: 0 to 2 a triangle over the whole image; from 3 on the six of one of its
// stripes from the top (gpu.counted.CountedRows), in two triangles.
//! use counted_stripes

fn screen_corner(index: u32, stripe: u32) -> vec4f {
    if (index < FIRST_CORNER) {
        return vec4f(vec2f(f32((index << 1u) & 2u), f32(index & 2u)) * 2.0 - 1.0, 0.0, 1.0);
    }
    // The second triangle is the first one turned by half.
    let k = index - FIRST_CORNER;
    let j = select(k, 5u - k, k > 2u);
    let half = vec2f(f32(j & 1u), f32(j >> 1u));
    let corner = select(half, 1.0 - half, k > 2u);
    let down = (f32(stripe) + corner.y) / f32(STRIPES);
    return vec4f(2.0 * corner.x - 1.0, 1.0 - 2.0 * down, 0.0, 1.0);
}
