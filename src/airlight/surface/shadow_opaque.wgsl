//! use mesh_vertex

// Depth alone needs no more than where a vertex is.
@vertex fn vertex(
    @location(0) position: vec3f, at: InstanceTransform,
) -> @invariant @builtin(position) vec4f {
    return params.clip_from_world * world_position(at, position);
}
