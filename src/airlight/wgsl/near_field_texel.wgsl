//! use octahedron
//! use occlusion

// Texels of two reduced images, 16 bytes each: reading them is what their passes wait for. Numbers turn
// into floats as signed ones, for which processors have an instruction.

// Light to a part in 2^bits of its largest channel: rgb, and in w the exponent that they share, 8 bits.
fn shared_exponent(light: vec3f, bits: u32) -> vec4u {
    let top = clamp(max(light.x, max(light.y, light.z)), 1e-30, 1e30);
    let exponent = bitcast<u32>(top) >> 23u;
    let scale = bitcast<f32>((253u + bits - exponent) << 23u);
    let most = f32((1u << bits) - 1u);
    let units = vec3i(clamp(round(light * scale), vec3f(0.0), vec3f(most)));
    return vec4u(bitcast<vec3u>(units), exponent);
}

fn with_exponent(shared_light: vec4u, bits: u32) -> vec3f {
    return vec3f(bitcast<vec3i>(shared_light.xyz)) * bitcast<f32>((shared_light.w + 1u - bits) << 23u);
}

// What is seen in a texel of the image, and which of its pixels stands for it.
struct SurfaceTexel {
    inverse: f32,       // m^-1, of the distance along the view axis; 0 where nothing is
    pixel: vec2u,       // 0 or 1, from the texel's first one
    normal: vec3f,      // world, of any length
    light: vec3f,       // sent to the eye, W m^-2 sr^-1
}

fn packed_surface(s: SurfaceTexel) -> vec4u {
    let light = shared_exponent(s.light, 18u);
    return vec4u(bitcast<u32>(s.inverse), octahedron_pack16(s.normal),
        light.x | (light.y << 18u),
        (light.y >> 14u) | (light.z << 4u) | (light.w << 22u) | (s.pixel.x << 30u) | (s.pixel.y << 31u));
}

fn surface_pixel(texel: vec4u) -> vec2u {
    return vec2u(texel.w >> 30u, texel.w >> 31u) & vec2u(1u);
}

// The normal, but not of unit length.
fn surface_normal(texel: vec4u) -> vec3f {
    return octahedron_point(unpack2x16snorm(texel.y));
}

fn surface_light(texel: vec4u) -> vec3f {
    let rgb = vec3u(texel.z, (texel.z >> 18u) | (texel.w << 14u), texel.w >> 4u) & vec3u(0x3ffffu);
    return with_exponent(vec4u(rgb, (texel.w >> 22u) & 0xffu), 18u);
}

// What stands nearer to a surface than cells resolve.
struct NearField {
    open: f32,      // the share of the hemisphere that near occluders leave
    light: vec3f,   // radiance of those that show it, times the share that they fill
    direction: vec3f,     // mean direction to them times that share
    hidden: f32,    // that share
}

// In w the depth, m along the view axis, 0 where nothing is; its last bits are what is not open.
fn packed_near_field(near: NearField, depth: f32) -> vec4u {
    let light = shared_exponent(near.light, 13u);
    let direction = bitcast<vec3u>(vec3i(round(clamp(near.direction, vec3f(-1.0), vec3f(1.0)) * 1023.0)))
        & vec3u(0x7ffu);
    let hidden = bitcast<u32>(i32(round(saturate(near.hidden) * 65535.0)));
    return vec4u(light.x | (light.y << 13u) | (direction.z << 26u),
        light.z | (light.w << 13u) | (direction.x << 21u),
        hidden | (direction.y << 16u) | ((direction.z >> 6u) << 27u),
        bitcast<u32>(packed_depth(depth, 1.0 - near.open)));
}

fn near_field_of(texel: vec4u) -> NearField {
    let rgb = vec3u(texel.x, texel.x >> 13u, texel.y) & vec3u(0x1fffu);
    let light = with_exponent(vec4u(rgb, (texel.y >> 13u) & 0xffu), 13u);
    let high = vec3u(texel.y, texel.z << 5u, (texel.z & 0xf8000000u) | ((texel.x >> 26u) << 21u));
    let direction = vec3f(bitcast<vec3i>(high) >> vec3u(21u)) / 1023.0;
    let hidden = f32(bitcast<i32>(texel.z & 0xffffu)) / 65535.0;
    return NearField(1.0 - packed_hidden(bitcast<f32>(texel.w)), light, direction, hidden);
}
