// One step where nothing blocks: channels need not share faces, so each invocation has one.
// `main` comes from lpv/columns.py or rows.py, light is read by open_cells.wgsl or open_pairs.wgsl.

fn gathered(
    cell: u32, here: vec4f, west: vec4f, east: vec4f, south: vec4f, north: vec4f, below: vec4f,
    above: vec4f,
) -> vec4f {
    return along_x(west, east) + along_y(south, north) + along_z(below, above);
}
