// How extinction is spread in a lattice's cell (media/volume_blockers.py): SAMPLES of it along each axis make COLUMNS
// along each axis, of which both halves, from the middle of the cell to a face, count by themselves.

const SAMPLES = 5u;
const SAMPLE_COUNT = 125u;
const COLUMNS = 25u;
// Four bits for each of 6 x COLUMNS halves, over the largest; then the largest over the mean of the cell, as float;
// 0: the columns are alike.
const HALVES = 150u;
const HALVES_PER_WORD = 8u;
const LARGEST_WORD = 19u;
const SPREAD_WORDS = 20u;
const HALF_STEPS = 15.0;

// The half of a column towards face 0..5 (+x -x +y -y +z -z).
fn half_column(face: u32, column: u32) -> u32 {
    return COLUMNS * face + column;
}
