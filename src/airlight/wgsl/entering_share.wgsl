// How open the face is that a hop crosses into a cell, of the cell's `face_visibility` (lattice.blockers):
// bytes for hops along +x -x +y -y, and +z -z.
fn entering_share(packed: vec2u, hop: u32) -> f32 {
    return select(unpack4x8unorm(packed.y)[hop & 3u], unpack4x8unorm(packed.x)[hop & 3u], hop < 4u);
}
