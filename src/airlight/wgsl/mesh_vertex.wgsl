//! use tangent_angle

// Vertices of meshes, and where their instance stands: attributes too, which CPU adapters read
// once for many vertices, and storage buffers once for each.

struct InstanceTransform {
    @location(4) x: vec4f,      // columns of world_from_object
    @location(5) y: vec4f,
    @location(6) z: vec4f,
    @location(7) w: vec4f,
}

struct VertexIn {
    @location(0) position: vec3f,
    @location(1) normal: vec4f,
    @location(2) uv: vec2f,
    @location(3) color: vec4f,
    @location(8) normal_x: vec3f,       // columns of normal_from_object
    @location(9) normal_y: vec3f,
    @location(10) normal_z: vec3f,
    @location(11) material: u32,
    @location(12) size: f32,
}

struct VertexOut {
    @invariant @builtin(position) clip: vec4f,
    @location(0) world: vec3f,
    @location(1) normal: vec3f,
    @location(2) uv: vec2f,
    @location(3) color: vec4f,
    @location(4) @interpolate(flat) material: u32,
    @location(5) @interpolate(flat) size: f32,
    @location(6) tangent: vec4f,    // world, not unit; w: the side of the bitangent; 0 where there is none
}

fn world_position(at: InstanceTransform, position: vec3f) -> vec4f {
    return mat4x4f(at.x, at.y, at.z, at.w) * vec4f(position, 1.0);
}

// The tangent goes with the surface; a mirroring placement has the bitangent on the other side.
fn world_tangent(at: InstanceTransform, normal: vec4f) -> vec4f {
    let tangent = tangent_of(normal);
    let side = select(1.0, -1.0, dot(at.x.xyz, cross(at.y.xyz, at.z.xyz)) < 0.0);
    return vec4f(mat3x3f(at.x.xyz, at.y.xyz, at.z.xyz) * tangent.xyz, tangent.w * side);
}

fn transformed_vertex(in: VertexIn, at: InstanceTransform, clip_from_world: mat4x4f) -> VertexOut {
    var out: VertexOut;
    let world = world_position(at, in.position);
    out.clip = clip_from_world * world;
    out.world = world.xyz;
    out.normal = mat3x3f(in.normal_x, in.normal_y, in.normal_z) * in.normal.xyz;
    out.tangent = world_tangent(at, in.normal);
    out.uv = in.uv;
    out.color = in.color;
    out.material = in.material;
    out.size = in.size;
    return out;
}
