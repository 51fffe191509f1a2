// Irradiance of pixels from the gather points around them that lie on about the same plane. Source: Kopf et al. 2007
// (joint bilateral upsampling).
//! use pixel_point
//! use gather

const LEAST = 1e-4;         // weight of neighbours where none is alike

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(vec2f(id.xy) >= params.size)) {
        return;
    }
    let d = textureLoad(depth, id.xy, 0);
    var surfaces = vec4f(0.0);
    var sky = vec4f(0.0);
    let position = vec2f(id.xy) + 0.5;
    let p = pixel_point(position, d);
    let n = normalize(textureLoad(normal, id.xy, 0).xyz);
    let texel_m = params.texel * length(p - params.eye);
    let last = vec2i(params.reduced) - 1;
    let middle = position / f32(params.scale) - 0.5;
    let base = floor(middle);
    let t = middle - base;
    var k = 0;
    loop {
        if (d <= 0.0) { break; }
        let corner = vec2f(f32(k & 1), f32(k >> 1u));
        let at = clamp(vec2i(base + corner), vec2i(0), last);
        let place = textureLoad(places, at, 0);
        let its = textureLoad(normals, at, 0).xyz;
        let near = mix(1.0 - t, t, corner) + LEAST;
        let like = likeness(p, n, place.xyz, its, texel_m) + LEAST;
        let weight = select(0.0, near.x * near.y * like, place.w > 0.0);
        let index = 2u * u32(at.y * i32(params.reduced.x) + at.x);
        surfaces += weight * sums[index];
        sky += weight * sums[index + 1u];
        k++;
        if (k > 3) { break; }
    }
    // Of cosine-distributed rays, pi times the mean radiance.
    let scale = select(0.0, 3.14159265 / sky.w, sky.w > 0.0);
    textureStore(irradiance, id.xy, vec4f(surfaces.rgb * scale, 1.0));
    textureStore(irradiance_of_sky, id.xy, vec4f(sky.rgb * scale, 1.0));
}
