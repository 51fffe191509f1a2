// What a lattice scatters towards the eye. The including pass binds what `lattice` needs and adds
// what samples textures at `lattice_at` (march/march.py).
//! use air
//! use lattice

var<private> lattice_at: vec4f;     // texture coordinates of the step's middle, and their weight

fn lattice_enter(p: vec3f) {
    lattice_at = vec4f(0.0, 0.0, 0.0, lattice_weight(lattice, p));
    if (lattice_at.w > 0.0) {
        lattice_at = vec4f(lattice_coordinates(lattice, p, vec3f(0.0)), lattice_at.w);
    }
}

fn lattice_radiance(state: vec4f, travel: vec3f, direct: f32) -> f32 {
    return max(0.0, state.x + direct * dot(state.yzw, travel));
}
