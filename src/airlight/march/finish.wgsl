// What is left to do for a pixel once the reduced pictures of air are there: they at full size, the
// transmittance of even air, and the surfaces behind it.
//! use air
//! use upsample_corner

@fragment fn fragment(@builtin(position) position: vec4f) -> Finished {
    let pixel = vec2i(position.xy);
    let direction = pixel_direction(rays.world_from_clip, position.xy, vec2f(rays.size));
    let own = pixel_distance(rays.world_from_clip, direction, textureLoad(depth, pixel, 0));
    var multiple = vec3f(0.0);
    var sky = vec3f(0.0);
    var total = 0.0;
    for (var k = 0u; k < 4u; k++) {
        let corner = corner_of(position.xy, k);
        let here = textureLoad(reduced, corner.texel, 0);   // a: how far its ray goes, m
        let weight = corner_weight(corner.share, depth_weight(here.a, own));
        multiple += weight * here.rgb;
        sky += weight * skylit_at(corner.texel);
        total += weight;
    }
    multiple /= total;
    let T = exp(-air_optical_depth(rays.eye, normalize(direction), 0.0, own));
    var out: Finished;
    out.direct = textureLoad(direct, pixel, 0) * vec4f(T, 1.0);
    out.indirect = textureLoad(indirect, pixel, 0) * vec4f(T, 1.0);
    out.multiple = vec4f(multiple, 1.0);
    out.transmittance = vec4f(T, 1.0);
    set_single(&out, pixel, sky / total);
    return out;
}
