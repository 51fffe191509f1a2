// What goes from every cell towards the eye as diffuse light per unit of extinction, the extinction that it
// meets, m^-1, and what the medium scatters there smoothly. Behind what the cells hold of diffuse light already.
//! use medium_grid
//! use outgoing_light
//! needs fn absorbing(cell: u32) -> vec3f
//! needs fn leaving_beams(cell: u32) -> vec3f
//! needs fn leaving_forward(cell: u32) -> vec3f
//! needs fn leaving_phase(cell: u32, mu: vec3f, sharpness: vec3f) -> vec3f
//! needs fn unturned() -> vec3f
//! needs fn smooth_light(cell: u32, fluence: vec3f, x: vec3f, y: vec3f, z: vec3f, travel: vec3f) -> vec3f

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    let n = params.cells;
    if (id.x >= n) {
        return;
    }
    let cell = id.x;
    let travel = normalize(eye.position - cell_centre(cell_of(cell)) + vec3f(1e-12));
    let leaving = leaving_beams(cell);
    // What leaves the beams here; the direction that those had, and how sharp they were together.
    let power = deposits[cell].xyz;
    let kept = power * leaving_forward(cell) / max(leaving, vec3f(1e-30));
    let scale = select(vec3f(0.0), 1.0 / kept, abs(kept) > vec3f(1e-30));
    let x = deposits[n + cell].xyz * scale;
    let y = deposits[2u * n + cell].xyz * scale;
    let z = deposits[3u * n + cell].xyz * scale;
    let size = sqrt(x * x + y * y + z * z);
    let along = (x * travel.x + y * travel.y + z * travel.z) / max(size, vec3f(1e-20));
    let mu = clamp(along, vec3f(-1.0), vec3f(1.0));
    let volume = params.cell.x * params.cell.y * params.cell.z;
    let first = power / volume * leaving_phase(cell, mu, min(size, vec3f(1.0)));
    // What diffuse light scatters smoothly.
    let again = smooth_light(cell, diffuse[cell].xyz, diffuse[n + cell].xyz, diffuse[2u * n + cell].xyz,
        diffuse[3u * n + cell].xyz, travel);
    let extinction = absorbing(cell) + leaving;
    diffuse[4u * n + cell] = vec4f((first + again) / max(extinction, vec3f(1e-30)), 0.0);
    diffuse[5u * n + cell] = vec4f(extinction, f32(walls[2u * cell] & 63u));
    // What the medium itself scatters smoothly, per unit of its scattering.
    let smooth_own = smooth_scattering(diffuse[cell].xyz, diffuse[n + cell].xyz, diffuse[2u * n + cell].xyz,
        diffuse[3u * n + cell].xyz, travel, params.g, unturned());
    diffuse[6u * n + cell] = vec4f((1.0 - forward_share(params.g)) * smooth_own, 0.0);
}
