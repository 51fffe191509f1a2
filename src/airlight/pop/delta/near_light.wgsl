// Fluence close to local lights that beams and diffusion miss, added to the diffuse fluence of a
// cell.
//! use medium_grid
//! use medium
//! use ordinate_kind
//! needs fn mean_loss() -> vec3f
//! needs fn reduced_depth(n: u32, cell: u32) -> vec3f
//! needs fn scattering_near(n: u32, cell: u32, r: f32) -> vec3f

const NEAR_TABLE = 64u;
const THIN_GAIN = 2.5;

// The missing fluence at a distance s, in the table's unit.
fn missing_at(s: f32) -> vec3f {
    let at = s / (1.0 + s) * f32(NEAR_TABLE - 1u);
    let low = min(u32(at), NEAR_TABLE - 2u);
    return mix(missing[low].rgb, missing[low + 1u].rgb, at - f32(low));
}

// The length within the medium's box of the first r metres of a ray, m.
fn length_in_box(begin: vec3f, direction: vec3f, r: f32) -> f32 {
    let span = ray_box_interval(begin, direction, vec3f(0.0), params.extent);
    return max(0.0, min(span.y, r) - max(span.x, 0.0));
}

// The share of a local light's surroundings that it lights, beside those towards a point r away: of
// a spot, the part of its axis that lies in the medium; see maths/point_light_beam.py.
fn axis_share(n: u32, point: vec3f, r: f32) -> f32 {
    let o = ordinates[n];
    let own = length_in_box(o.position.xyz, normalize(point - o.position.xyz + vec3f(1e-12)), r);
    let lit = length_in_box(o.position.xyz, o.direction.xyz, r);
    return select(min(1.0, lit / max(own, 1e-9)), 1.0, all(o.direction.xyz == vec3f(0.0)));
}

// Fluence that beam and diffusion miss around local light n; see maths/point_light_beam.py, near_fluence.
fn near_fluence(n: u32, cell: u32, point: vec3f) -> vec3f {
    let o = ordinates[n];
    // Within a light's own cell the fluence has no bound: the cell holds about that at .4 of its side.
    let shortest = 0.4 * (params.cell.x + params.cell.y + params.cell.z) / 3.0;
    let r = max(distance(point, o.position.xyz), shortest);
    let radius = 3.0 * params.largest_diffusivity;
    let thickness = mean_loss() * radius;
    let s = reduced_depth(n, cell) + THIN_GAIN * exp(-thickness * thickness) / radius * r;
    // The table has all channels, each looked up at a distance of its own.
    let lost = vec3f(missing_at(s.r).r, missing_at(s.g).g, missing_at(s.b).b);
    let lit = passed[(params.ordinate_count + n) * params.cells + cell];
    return o.irradiance.rgb * lit * o.spot.z * axis_share(n, point, r) * scattering_near(n, cell, r) * lost / r;
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= params.cells) {
        return;
    }
    let point = cell_centre(cell_of(id.x));
    // Local lights alone are points; a virtual one is a piece of surface.
    var sum = vec3f(0.0);
    for (var n = 0u; n < params.ordinate_count; n++) {
        if (ordinates[n].position.w == LOCAL) {
            sum += near_fluence(n, id.x, point);
        }
    }
    diffuse[id.x] = vec4f(max(diffuse[id.x].xyz + sum, vec3f(0.0)), 0.0);
}
