// The arguments of passes over the first `rows` of an image of `size`: twin of `gpu.counted.CountedRows`. The including
// pass binds `arguments`.
//! use counted_stripes

const GROUP = 8u;           // texels along a side of the workgroups of passes that run by them

fn store_counted_rows(rows: u32, size: vec2u) {
    let across = select(0u, (size.x + GROUP - 1u) / GROUP, rows > 0u);
    arguments[0] = across;
    arguments[1] = (rows + GROUP - 1u) / GROUP;
    arguments[2] = min(across, 1u);
    arguments[3] = 0u;
    // A stripe is drawn as two triangles.
    arguments[4] = 6u;
    arguments[5] = (rows * STRIPES + size.y - 1u) / size.y;
    arguments[6] = FIRST_CORNER;
    arguments[7] = 0u;
}
