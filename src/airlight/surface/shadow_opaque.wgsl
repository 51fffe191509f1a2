//! use mesh_vertex

// Depth alone needs no more than where a vertex is.
@vertex fn vertex(
    @builtin(instance_index) instance: u32, @location(0) position: vec3f,
) -> @invariant @builtin(position) vec4f {
    return clip_position(instance, position, params.clip_from_world);
}
