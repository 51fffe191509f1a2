// Surfaces between the cells of a medium; see pop/light/walls.py. Two words for each cell. The first has six bits for
// its faces, two for each axis, the lower one first; a bit where anything near is closed; and for each axis how far
// behind its middle the first surface on the path to the next cell is. The second: the reflectance of each face's surface.

const WALLS_NEAR = 64u;
const WALL_POSITIONS = 8u;  // the bit where they begin
const WALL_FREE = 255u;     // as a position: no surface
const ALL_FREE = 0xffffffu;

// Of three positions that of an axis.
fn position_of(positions: u32, axis: u32) -> u32 {
    return (positions >> (8u * axis)) & 255u;
}

// How much of diffuse light the surface before a face reflects; `reflecting`: the second word.
const REFLECTING_BITS = 5u;
const REFLECTING_STEPS = 32.0;

fn wall_reflectance(reflecting: u32, axis: u32, side: u32) -> f32 {
    return f32((reflecting >> (REFLECTING_BITS * (2u * axis + side))) & 31u) / REFLECTING_STEPS;
}

// Whether a surface closes a face; `faces`: the lowest six bits.
fn is_walled(faces: u32, axis: u32, side: u32) -> bool {
    return ((faces >> (2u * axis + side)) & 1u) != 0u;
}
