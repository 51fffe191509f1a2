// Vertices of meshes. A pass that uses this binds `instances`.

struct VertexIn {
    @builtin(instance_index) instance: u32,
    @location(0) position: vec3f,
    @location(1) normal: vec4f,
    @location(2) uv: vec2f,
    @location(3) color: vec4f,
}

struct VertexOut {
    @invariant @builtin(position) clip: vec4f,
    @location(0) world: vec3f,
    @location(1) normal: vec3f,
    @location(2) uv: vec2f,
    @location(3) color: vec4f,
    @location(4) @interpolate(flat) material: u32,
    @location(5) @interpolate(flat) size: f32,
}

fn clip_position(instance: u32, position: vec3f, clip_from_world: mat4x4f) -> vec4f {
    return clip_from_world * (instances[instance].world_from_object * vec4f(position, 1.0));
}

fn placed_vertex(in: VertexIn, clip_from_world: mat4x4f) -> VertexOut {
    let instance = instances[in.instance];
    var out: VertexOut;
    let world = instance.world_from_object * vec4f(in.position, 1.0);
    out.clip = clip_from_world * world;
    out.world = world.xyz;
    out.normal = (instance.normal_from_object * vec4f(in.normal.xyz, 0.0)).xyz;
    out.uv = in.uv;
    out.color = in.color;
    out.material = instance.material;
    out.size = instance.size;
    return out;
}
