//! use packed_maps
//! use two_words
//! needs fn maps_seen(maps: vec4u, uv: vec2f, dx: vec2f, dy: vec2f) -> PackedTexel

// The surface point of a pixel, from the triangle that it sees. Who uses it binds `triangles`, `instances`,
// `materials`, `uv_transforms` and `texels`, as surface/visibility_buffer.py does, and `params` with `clip_from_world`
// and `inv_size`.

override HAS_MAP_TRANSFORM: bool = true;

struct VisiblePoint {
    world: vec3f,
    normal: vec3f,          // world, facing the viewer, no map in it
    world_dx: vec3f,        // to the next pixel's right, and down
    world_dy: vec3f,
    uv_dx: vec2f,
    uv_dy: vec2f,
    material: PackedMaterial,
    texel: PackedTexel,
    is_black: bool,         // the back of what reflects on its front alone
}

struct Corner {
    world: vec3f,       // the first corner, and the edges from it
    edge_1: vec3f,
    edge_2: vec3f,
    // A pixel (x, y, 1) sees the point at `share_1` and `share_2` of the edges, over `whole`.
    share_1: vec3f,
    share_2: vec3f,
    whole: vec3f,
}

struct PackedMaterial {
    color: vec4f,       // base colour, metallic
    emission: vec4f,    // W m^-2 sr^-1, specular
    roughness: f32,
    normal_scale: f32,
    maps: vec4u,        // as packed_maps_at has them
}

// A row of `MATERIAL` (surface/triangle_table.py): half floats, two to a word, then where the maps lie.
fn material_of(index: u32) -> PackedMaterial {
    let bits = materials[index];
    let color = two_words(bits.x);
    let emission = two_words(bits.y);
    let rest = two_words(bits.z);
    let corner = two_words(bits.w);
    let gloss = unpack2x16float(rest.x);
    return PackedMaterial(vec4f(unpack2x16float(color.x), unpack2x16float(color.y)),
        vec4f(unpack2x16float(emission.x), unpack2x16float(emission.y)), gloss.x, gloss.y,
        vec4u(corner, rest.y & 0xffffu, rest.y >> 16u));
}

fn transform_of(index: u32) -> mat4x4f {
    let at = 9u * index;       // pairs of words of an InstanceData
    let x = bitcast<vec4f>(four_words(instances[at]));
    let y = bitcast<vec4f>(four_words(instances[at + 1u]));
    let z = bitcast<vec4f>(four_words(instances[at + 2u]));
    return mat4x4f(x, y, z, bitcast<vec4f>(four_words(instances[at + 3u])));
}

fn shares(on: Corner, at: vec2f) -> vec2f {
    let d = vec3f(at, 1.0);
    return vec2f(dot(d, on.share_1), dot(d, on.share_2)) / dot(d, on.whole);
}

// x, y and w of the clip space of a world vector (w 0) or point (w 1).
fn clip_xyw(p: vec4f) -> vec3f {
    return (params.clip_from_world * p).xyw;
}

// From the words of a triangle's row. Cross products in clip space are planes through the eye: a pixel's distances to
// them are the shares of both edges, in perspective.
fn corner_of(a: vec4u, b: vec4u, c_x: u32, world_from_object: mat4x4f) -> Corner {
    let p = bitcast<vec4f>(a);
    let e = bitcast<vec4f>(b);
    var made: Corner;
    made.world = (world_from_object * vec4f(p.xyz, 1.0)).xyz;
    made.edge_1 = (world_from_object * vec4f(p.w, e.xy, 0.0)).xyz;
    made.edge_2 = (world_from_object * vec4f(e.zw, bitcast<f32>(c_x), 0.0)).xyz;
    let corner = clip_xyw(vec4f(made.world, 1.0));
    let edge_1 = clip_xyw(vec4f(made.edge_1, 0.0));
    let edge_2 = clip_xyw(vec4f(made.edge_2, 0.0));
    made.share_1 = cross(corner, edge_2);
    made.share_2 = cross(edge_1, corner);
    made.whole = cross(edge_2, edge_1);
    return made;
}

// Three normals of three 16-bit numbers, two to a word, between which `at` is the share of each edge.
fn normals_at(d: vec4u, e: vec4u, at: vec2f) -> vec3f {
    let p0 = unpack2x16snorm(d.w);
    let p1 = unpack2x16snorm(e.x);
    let p2 = unpack2x16snorm(e.y);
    let p3 = unpack2x16snorm(e.z);
    let n0 = vec3f(p0, p1.x);
    let n1 = vec3f(p1.y, p2);
    let n2 = vec3f(p3, unpack2x16snorm(e.w).x);
    return n0 + at.x * (n1 - n0) + at.y * (n2 - n0);
}

// What the pixel around `position` has of `seen`: a triangle's number and 1, instance | material << 16.
fn visible_point(seen: vec2u, position: vec2f) -> VisiblePoint {
    let row = 5u * (max(seen.x, 1u) - 1u);
    let a = four_words(triangles[row]);
    let b = four_words(triangles[row + 1u]);
    let c = four_words(triangles[row + 2u]);
    let d = four_words(triangles[row + 3u]);
    let e = four_words(triangles[row + 4u]);
    let world_from_object = transform_of(seen.y & 0xffffu);
    let m = material_of(seen.y >> 16u);
    let on = corner_of(a, b, c.x, world_from_object);

    // Differences over the pixel's quad, as drivers take them.
    let pace = vec2f(2.0, -2.0) * params.inv_size;
    let at = shares(on, position * pace + vec2f(-1.0, 1.0));
    let quad = (floor(position * 0.5) * 2.0 + 0.5) * pace + vec2f(-1.0, 1.0);
    let at_quad = shares(on, quad);
    let dx = shares(on, quad + vec2f(pace.x, 0.0)) - at_quad;
    let dy = shares(on, quad + vec2f(0.0, pace.y)) - at_quad;
    let inside = clamp(at, vec2f(0.0), vec2f(1.0));

    // Texture coordinates and their differences, which choose the mip level.
    let uv_0 = bitcast<vec2f>(c.yz);
    let uv_1 = bitcast<vec2f>(vec2u(c.w, d.x));
    let uv_2 = bitcast<vec2f>(d.yz);
    var uv = uv_0 + inside.x * uv_1 + inside.y * uv_2;
    var uv_dx = dx.x * uv_1 + dx.y * uv_2;
    var uv_dy = dy.x * uv_1 + dy.y * uv_2;
    if (HAS_MAP_TRANSFORM) {
        let transform = uv_transforms[seen.y >> 16u];
        uv = uv * transform.xy + transform.zw;
        uv_dx *= transform.xy;
        uv_dy *= transform.xy;
    }
    // What the maps have there, and the place.
    var point: VisiblePoint;
    point.material = m;
    point.texel = maps_seen(m.maps, uv, uv_dx, uv_dy);
    point.texel.light = select(vec3f(1.0), point.texel.light, (m.maps.z & MAPS_BASE) != 0u);
    point.world = on.world + inside.x * on.edge_1 + inside.y * on.edge_2;
    point.world_dx = dx.x * on.edge_1 + dx.y * on.edge_2;
    point.world_dy = dy.x * on.edge_1 + dy.y * on.edge_2;
    point.uv_dx = uv_dx;
    point.uv_dy = uv_dy;

    // Cofactors keep normals at right angles to their surface, mirrored ones outside.
    let columns = mat3x3f(world_from_object[0].xyz, world_from_object[1].xyz, world_from_object[2].xyz);
    let cofactors = mat3x3f(cross(columns[1], columns[2]), cross(columns[2], columns[0]),
        cross(columns[0], columns[1]));
    let mirrored = select(1.0, -1.0, dot(columns[0], cofactors[0]) < 0.0);
    let is_front = dot(vec3f(position * pace + vec2f(-1.0, 1.0), 1.0), on.whole) * mirrored < 0.0;
    let turned = select(-mirrored, mirrored, is_front);
    point.is_black = !is_front && (m.maps.z & MAPS_ONE_SIDED) != 0u;
    point.normal = normalize(cofactors * normals_at(d, e, inside)) * turned;
    return point;
}
