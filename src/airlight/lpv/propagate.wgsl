// One step among blockers: what every cell receives of its six neighbours, and what its own closed faces return.
// `main`, which marches columns of cells, comes from lpv/columns.py or rows.py, light and faces are
// read by light_cells.wgsl or light_pairs.wgsl. `faces` is lattice.blockers.Blockers.faces.

override IS_REFLECTING: bool = false;   // blocked light bounces

const BOUNCE_LOBE = 2.0;                // a cosine lobe off the face

// What a face makes of the share p of a cell's power that goes to it. The two-band light of a
// stream has the wrong sign behind it: such power is handed back whole, so that energy does not
// grow. What was handed back is negative all over, and surfaces absorb it like the light that it
// takes back: kept for ever, it would end up as a dark fog (`even` has the sign of the light).
fn returned(p: vec3f, even: vec3f, face: u32) -> vec3f {
    let shares = unpack4x8unorm(face);
    let reflected = select(vec3f(0.0), shares.rgb, IS_REFLECTING);
    return p * select(vec3f(shares.w * params.kept), reflected, p * even > vec3f(0.0));
}

// Light that leaves towards closed faces comes back into its own cell.
fn bounced(v: mat3x4f, side: vec4u, rest: vec4u) -> mat3x4f {
    let even = HOP_EVEN * vec3f(v[0].x, v[1].x, v[2].x);
    let x = HOP_DIRECT * vec3f(v[0].y, v[1].y, v[2].y);
    let y = HOP_DIRECT * vec3f(v[0].z, v[1].z, v[2].z);
    let z = HOP_DIRECT * vec3f(v[0].w, v[1].w, v[2].w);
    let plus = mat3x3f(returned(even + x, even, side.x), returned(even + y, even, side.z),
        returned(even + z, even, rest.x));
    let minus = mat3x3f(returned(even - x, even, side.y), returned(even - y, even, side.w),
        returned(even - z, even, rest.y));
    let a = plus[0] + plus[1] + plus[2] + minus[0] + minus[1] + minus[2];
    let b = BOUNCE_LOBE * (minus - plus);
    return mat3x4f(a.r, b[0].r, b[1].r, b[2].r, a.g, b[0].g, b[1].g, b[2].g,
        a.b, b[0].b, b[1].b, b[2].b);
}

fn gathered(
    cell: u32, here: mat3x4f, west: mat3x4f, east: mat3x4f, south: mat3x4f, north: mat3x4f,
    below: mat3x4f, above: mat3x4f,
) -> mat3x4f {
    let own = faces_at(cell);
    let side = own.side;
    let rest = own.rest;
    let xy = unpack4x8unorm(rest.z);
    let z = unpack4x8unorm(rest.w);
    return interacted(here, side, rest, xy.x * west, xy.y * east, xy.z * south, xy.w * north,
        z.x * below, z.y * above);
}

fn all_along(
    west: mat3x4f, east: mat3x4f, south: mat3x4f, north: mat3x4f, below: mat3x4f, above: mat3x4f,
) -> mat3x4f {
    return mat3x4f(
        along_x(west[0], east[0]) + along_y(south[0], north[0]) + along_z(below[0], above[0]),
        along_x(west[1], east[1]) + along_y(south[1], north[1]) + along_z(below[1], above[1]),
        along_x(west[2], east[2]) + along_y(south[2], north[2]) + along_z(below[2], above[2]));
}
