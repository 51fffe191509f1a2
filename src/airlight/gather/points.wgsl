// One surface point for each texel of a reduced image: that of one of its pixels, in each sample of the image
// another one.
//! use gather_point
//! use sampling

override HAS_OCCLUSION: bool = false;

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id.xy >= params.reduced)) {
        return;
    }
    let size = vec2u(params.size);
    // Pixels of the texel are tried from another one on in each sample, until one shows a surface.
    let count = params.scale * params.scale;
    let first = u32(f32(count) * r2_noise(id.x, id.y, params.sample));
    var found: GatherPoint;
    var k = 0u;
    loop {
        let within = (first + k) % count;
        let pixel = id.xy * params.scale + vec2u(within % params.scale, within / params.scale);
        if (all(pixel < size)) {
            let d = textureLoad(depth, pixel, 0);
            if (d > 0.0) {
                found = gather_point(pixel, d);
            }
        }
        k++;
        if (k >= count || found.place.w > 0.0) { break; }
    }
    textureStore(places, id.xy, found.place);
    textureStore(starts, id.xy, found.start);
    textureStore(normals, id.xy, found.facing);
    textureStore(planes, id.xy, found.plane);
}
