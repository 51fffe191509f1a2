// The open shares of a cell's six incoming hops (+x -x +y -y +z -z), and where the walls on its
// three low faces really are.

const VALUES = 12u;     // per corner, see blockers.wgsl
const CLOSING = 1.5;    // closes a wall that falls between two layers of corners
const LARGEST_SHIFT = 0.45;

fn value(corner: vec3u, index: u32) -> f32 {
    let n = params.count + 1u;
    return f32(sums[VALUES * ((corner.z * n.y + corner.y) * n.x + corner.x) + index]);
}

// The mean over the four corners of the face at `first` spanned by two axes.
fn on_face(first: vec3u, across: vec3u, up: vec3u, index: u32) -> f32 {
    return 0.25 / params.units * (value(first, index) + value(first + across, index)
        + value(first + up, index) + value(first + across + up, index));
}

// Light that travels along `hop` is stopped by what faces it: the other side of the same axis.
fn open_share(first: vec3u, across: vec3u, up: vec3u, hop: u32) -> f32 {
    return 1.0 - saturate(CLOSING * on_face(first, across, up, hop ^ 1u));
}

// How far, in cells, the surface counted on a face lies from it; 0 where little is there.
fn wall_shift(first: vec3u, across: vec3u, up: vec3u, axis: u32) -> f32 {
    let cover = on_face(first, across, up, 6u + axis);
    let moment = on_face(first, across, up, 9u + axis);
    let shift = moment / max(cover, 1e-6) * smoothstep(0.25, 0.6, cover);
    return clamp(shift, -LARGEST_SHIFT, LARGEST_SHIFT);
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id >= params.count)) {
        return;
    }
    let x = vec3u(1u, 0u, 0u);
    let y = vec3u(0u, 1u, 0u);
    let z = vec3u(0u, 0u, 1u);
    // A hop along +x enters through the cell's low x face, one along -x through its high face.
    let xy = vec4f(open_share(id, y, z, 0u), open_share(id + x, y, z, 1u),
        open_share(id, x, z, 2u), open_share(id + y, x, z, 3u));
    let zz = vec4f(open_share(id, x, y, 4u), open_share(id + z, x, y, 5u), 1.0, 1.0);
    let cell = (id.z * params.count.y + id.y) * params.count.x + id.x;
    openness[cell] = vec2u(pack4x8unorm(xy), pack4x8unorm(zz));
    textureStore(open_a, id, xy);
    textureStore(open_b, id, zz);
    textureStore(walls, id, vec4f(wall_shift(id, y, z, 0u), wall_shift(id, x, z, 1u),
        wall_shift(id, x, y, 2u), 0.0));
}
