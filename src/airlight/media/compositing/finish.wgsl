// Finishes a pixel: upsamples the reduced images of media, and attenuates the surfaces by the transmittance
// of homogeneous media. What is linear over the image, or constant, comes from the vertices: CPU
// adapters read buffers in fragments lane by lane.
//! use media
//! use upsample_corner
//! needs fn add_once(once: ptr<function, Once>, texel: vec2f, likeness: f32, weight: f32)
//! needs fn set_single(out: ptr<function, Finished>, pixel: vec2i, once: Once, total: f32, sky: vec3f)
//! needs fn skylit_at(texel: vec2f) -> vec3f

struct Seen {
    @builtin(position) position: vec4f,
    @location(0) direction: vec3f,      // of the pixel's ray, one metre deep
    @location(1) medium_direction: vec3f,   // the same in the first medium's own space
    @location(2) @interpolate(flat) eye: vec3f,      // in that space
    @location(3) @interpolate(flat) sigma_t: vec3f,  // of that medium, m^-1
    @location(4) @interpolate(flat) grid: vec4f,     // pixels of a texel's side, last texel, 1/near
    @location(5) @interpolate(flat) per_texel: vec4f,   // of the reduced images, of the image
}

var<private> per_texel: vec4f;

// A sampler takes the nearest texel in half of the time that CPU adapters take to load it.
fn reduced_texel(source: texture_2d<f32>, texel: vec2f) -> vec4f {
    return textureSampleLevel(source, nearest, (texel + 0.5) * per_texel.xy, 0.0);
}

@vertex fn vertex(@builtin(vertex_index) index: u32) -> Seen {
    let corner = vec2f(f32((index << 1u) & 2u), f32(index & 2u)) * 2.0 - 1.0;
    var seen: Seen;
    seen.position = vec4f(corner, 0.0, 1.0);
    seen.direction = (rays.world_from_clip * vec4f(corner, 0.0, 1.0)).xyz;
    // The same in the first medium's space, where one homogeneous box is the unit cube.
    seen.medium_direction = (row_of_media(0).volume_from_world * vec4f(seen.direction, 0.0)).xyz;
    seen.eye = medium_coordinates(0u, rays.eye);
    seen.sigma_t = row_of_media(0).sigma_t;
    seen.grid = vec4f(f32(rays.scale), vec2f(rays.reduced) - 1.0, 1.0 / rays.world_from_clip[2].w);
    seen.per_texel = 1.0 / vec4f(vec2f(rays.reduced), vec2f(rays.size));
    return seen;
}

// The transmittance to `own` metres; of one homogeneous box by what the vertices brought.
fn transmittance_to(seen: Seen, reach: f32, own: f32) -> vec3f {
    if (!IS_ONE_BOX) {
        return exp(-media_optical_depth(rays.eye, normalize(seen.direction), 0.0, own));
    }
    let span = ray_box_interval(seen.eye, seen.medium_direction, vec3f(0.0), vec3f(1.0));
    return exp(-seen.sigma_t * (reach * max(0.0, min(span.y, own / reach) - max(span.x, 0.0))));
}

@fragment fn fragment(seen: Seen) -> Finished {
    let pixel = vec2i(seen.position.xy);
    per_texel = seen.per_texel;
    // How far the pixel's own ray goes.
    let reach = length(seen.direction);
    let shown = textureSampleLevel(depth, nearest, seen.position.xy * seen.per_texel.zw, 0);
    let own = select(min(reach * seen.grid.w / max(shown, 1e-30), EYE_RAY_FAR), EYE_RAY_FAR,
        shown <= 0.0);
    // The four texels around the pixel, whose rays are those of the middle pixels of their blocks.
    let at = (seen.position.xy - 0.5 - floor(0.5 * seen.grid.x)) / seen.grid.x;
    let last = seen.grid.yz;
    // Four different texels even at the edge of the image, so that both sides of a block are there.
    let base = clamp(floor(at), vec2f(0.0), max(last - 1.0, vec2f(0.0)));
    let t = saturate(at - base);
    // Joint bilateral upsampling by depth.
    var multiple = vec3f(0.0);
    var sky = vec3f(0.0);
    var total = 0.0;
    var once = Once(vec3f(0.0), vec3f(3e38), vec3f(0.0));
    for (var k = 0u; k < 4u; k++) {
        let corner = vec2u(k & 1u, k >> 1u);
        let texel = min(base + vec2f(corner), last);
        let share = select(1.0 - t, t, corner == vec2u(1u));
        let here = reduced_texel(reduced, texel);   // a: how far its ray goes, m
        let likeness = depth_weight(here.a, own);
        let weight = corner_weight(share.x * share.y, likeness);
        multiple += weight * here.rgb;
        sky += weight * skylit_at(texel);
        total += weight;
        add_once(&once, texel, likeness, weight);
    }
    multiple /= total;
    sky /= total;
    // The first two targets are multiplied by what is written.
    let T = transmittance_to(seen, reach, own);
    var out: Finished;
    out.direct = vec4f(T, 1.0);
    out.indirect = vec4f(T, 1.0);
    out.multiple = vec4f(multiple, 1.0);
    out.transmittance = vec4f(T, 1.0);
    set_single(&out, pixel, once, total, sky);
    return out;
}
