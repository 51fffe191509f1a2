// What a sample of a light sees. The including pass binds `area_shadows`, `shadow_compare` and, in `params`, of a
// hemisphere's maps and a cube's: `map_texel`, of the distance along a view's axis, and `map_scale`, over what a map spans.

// A point before the views of a sample: in the sample's axes, its normal too.
struct Viewed {
    own: vec3f,         // from the sample, m
    n: vec3f,
    v: vec3f,           // towards the eye
    slope: f32,         // the sum of the normal's coordinates, without signs
}

// How much of a point a sample sees; `depth`: as `EmitterData.depth`. Twin: area/table.py.
fn sample_visibility(first_view: u32, is_cube: bool, depth: vec2f, at: Viewed) -> f32 {
    // The axis that the point lies nearest to; the other two follow in turn.
    let size = select(at.own, abs(at.own), is_cube);
    let is_y = size.y > size.x && size.y >= size.z;
    let is_z = size.z > size.x && !is_y;
    let along = select(select(at.own.x, at.own.y, is_y), at.own.z, is_z);
    let ahead = select(1.0, sign(along), is_cube);
    // The point is moved along its normal so far that its own plane lies behind it in all four texels
    // that are compared: by what the plane rises towards the light over a texel along both sides.
    let texel_m = select(params.map_texel.x, params.map_texel.y, is_cube) * abs(along);
    let steepness = at.slope - abs(select(select(at.n.x, at.n.y, is_y), at.n.z, is_z));
    let raised = at.own + at.n * (texel_m * (1.05 * steepness + 0.1));
    let moved = select(select(raised, raised.yzx, is_y), raised.zxy, is_z);
    let inverse = 1.0 / max(moved.x * ahead, 1e-9);
    let plane = vec2f(moved.z * ahead, moved.y) * inverse;
    let scale = select(params.map_scale.x, params.map_scale.y, is_cube);
    let uv = vec2f(scale, -scale) * (plane + select(0.5, 0.0, is_cube)) + 0.5;
    let z = depth.x - depth.y * inverse;
    if (z <= 0.0 || z >= 1.0) {
        return 1.0;
    }
    let layer = first_view + select(select(0u, 1u, is_y), 2u, is_z)
        + select(0u, 3u, ahead < 0.0);
    return textureSampleCompareLevel(area_shadows, shadow_compare, uv, layer, z);
}
