//! use tone

override is_encoding: bool = false;

struct Corner {
    @builtin(position) position: vec4f,
    @location(0) uv: vec2f,
}

@vertex fn vertex(@builtin(vertex_index) index: u32) -> Corner {
    let corner = vec2f(f32((index << 1u) & 2u), f32(index & 2u));
    return Corner(vec4f(corner * 2.0 - 1.0, 0.0, 1.0), vec2f(corner.x, 1.0 - corner.y));
}

@fragment fn fragment(in: Corner) -> @location(0) vec4f {
    let c = textureSampleLevel(shown, linear_clamp, in.uv, 0.0).rgb;
    return vec4f(select(c, srgb_decode(c), is_encoding), 1.0);
}
