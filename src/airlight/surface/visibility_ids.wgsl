//! use mesh_vertex

// Which triangle each pixel sees: its number, and its instance and material.

struct Seen {
    @invariant @builtin(position) clip: vec4f,
    @location(0) @interpolate(flat) what: vec2u,
}

@vertex fn vertex(
    @location(0) position: vec3f, at: InstanceTransform, @location(8) first: u32, @location(9) what: u32,
    @builtin(vertex_index) index: u32,
) -> Seen {
    return Seen(params.clip_from_world * world_position(at, position), vec2u(first + index, what));
}

@fragment fn fragment(in: Seen) -> @location(0) vec2u {
    return in.what;
}
