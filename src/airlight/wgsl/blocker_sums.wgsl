// What is summed around each corner of a lattice, in fixed point: the covered share of each side
// (+x -x +y -y +z -z), each axis' covered share and its first moment about the face plane, and
// each side's covered share times reflectance (rgb).
const AXIS_COVER = 6u;
const AXIS_MOMENT = 9u;
const SIDE_REFLECTED = 12u;
const CORNER_VALUES = 30u;
