// What is gathered around each corner of a lattice, in fixed point: the covered share of each side
// (+x -x +y -y +z -z), each axis' covered share and its first moment, how far behind the face plane each side's
// backmost surface lies (0: none seen), and each side's covered share times reflectance (rgb). Of surfaces oblique to the
// cells, for the side that each faces most: their normals times area (xyz), how far along those they lie from the corner,
// and the squares of that; and a bit for each side of which there are such.
const AXIS_COVER = 6u;
const AXIS_MOMENT = 9u;
const SIDE_BEHIND = 12u;
const SIDE_REFLECTED = 18u;
const PLANES = 36u;
const PLANE_MOMENT = 3u;
const PLANE_SQUARE = 4u;
const PLANE_VALUES = 5u;
const PLANE_SIDES = 66u;
const CORNER_VALUES = 67u;

const BEHIND_UNITS = 4096.0;    // per cell

// An offset -0.5..0.5 along a side's outward axis, in cells, as an integer that grows backwards.
fn behind_code(outward: f32) -> i32 {
    return 1 + i32(round((0.5 - outward) * BEHIND_UNITS));
}

fn outward_of(code: f32) -> f32 {
    return 0.5 - (code - 1.0) / BEHIND_UNITS;
}
