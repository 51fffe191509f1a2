// The visibility of a light by its shadow map, filtered, for points in media and cells: without the offsets of
// surfaces (wgsl/shadow.wgsl). Nothing shades a point beside the map; one beyond it is
// shaded by all that the map shows.

const DEEPEST = 0.9999999;  // before what maps are cleared to

// `coordinates`: u, v and depth in the map's layer.
fn map_visibility(
    maps: texture_depth_2d_array, compare: sampler_comparison, layer: u32, coordinates: vec3f,
) -> f32 {
    let uv = coordinates.xy;
    if (any(uv < vec2f(0.0)) || any(uv > vec2f(1.0))) {
        return 1.0;
    }
    return textureSampleCompareLevel(maps, compare, uv, layer, min(coordinates.z, DEEPEST));
}

// Of clip space after the division by w.
fn map_coordinates(ndc: vec3f) -> vec3f {
    return vec3f(ndc.xy * vec2f(0.5, -0.5) + 0.5, ndc.z);
}
