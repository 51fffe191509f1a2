// The stripes of an image of which passes draw the first: twins of the numbers in `gpu.counted`.

const STRIPES = 64u;        // of its height
const FIRST_CORNER = 3u;    // the number of a stripe's first vertex
