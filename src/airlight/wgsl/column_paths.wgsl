// The mean density of a grid from a texel of its box towards a light. The including pass binds `grids` (ColumnGrid),
// `paths` (ColumnPath), `densities` with `column_linear`, and `planes`: means at all texels of a few planes, plane by
// plane from the side that the light comes from.

const MAX_COLUMN_STEPS = 256.0;
const COLUMN_FAR = 3.0e38;

// How many planes of texels lie on the lit side of a texel's. Where planes lie across no axis, none.
fn depth_of(path: ColumnPath, texel: vec3f, count: vec3f) -> f32 {
    let last = max(path.facing, vec3f(0.0)) * (count - 1.0);
    return dot(last - path.facing * texel, vec3f(1.0));
}

// Along the two axes of a plane, those after the slabs' own: (y, z), (z, x) or (x, y).
fn in_plane(path: ColumnPath, at: vec3f) -> vec2f {
    let across = abs(path.facing);
    return vec2f(dot(across.zxy, at), dot(across.yzx, at));
}

fn plane_first(slot: u32, plane: f32) -> u32 {
    return (slot * (SLABS - 1u) + u32(plane)) * params.plane_texels;
}

// Means at a point of a plane, in texels, from the four around it. `slot`: of a grid and a light.
fn plane_mean(slot: u32, plane: f32, at: vec2f, size: vec2f) -> f32 {
    let x = clamp(at, vec2f(0.0), size - 1.0);
    let low = min(floor(x), size - 2.0);
    let f = x - low;
    let row = u32(size.x);
    let first = plane_first(slot, plane) + u32(low.y) * row + u32(low.x);
    return mix(mix(planes[first], planes[first + 1u], f.x),
        mix(planes[first + row], planes[first + row + 1u], f.x), f.y);
}

// The integral of density over `reach` metres of a path from a point of the box; `along`: of the box, a metre. Steps
// of a voxel. Each grid is filtered within its own part of the texture.
fn path_column(grid: ColumnGrid, origin: vec3f, along: vec3f, reach: f32) -> f32 {
    let count = grid.grid_count;
    let steps = clamp(ceil(reach * length(along * count)), 1.0, MAX_COLUMN_STEPS);
    let dt = reach / steps;
    // Half a texel within the grid's part of the texture, or filtering would take its neighbour's.
    let texel = 1.0 / vec3f(textureDimensions(densities));
    let first = grid.grid_first * texel;
    let begin = origin * count * texel;
    let step = dt * along * count * texel;
    let low = 0.5 * texel;
    let high = (count - 0.5) * texel;
    var sum = 0.0;
    for (var i = 0.5; i < steps; i += 1.0) {
        let at = first + clamp(begin + i * step, low, high);
        sum += textureSampleLevel(densities, column_linear, at, 0.0).x;
    }
    return sum * dt;
}

// The mean density from a texel to the light, or to where its path leaves the box.
fn mean_towards(grid: ColumnGrid, path: ColumnPath, texel: vec3f, slot: u32) -> f32 {
    let count = vec3f(grid.count);
    let origin = texel / (count - 1.0);
    var along = path.towards;
    var reach = COLUMN_FAR;
    if (path.is_local != 0u) {
        let delta = path.towards - origin;
        reach = length((grid.world_from_box * vec4f(delta, 0.0)).xyz);
        along = delta / max(reach, 1e-12);
    }
    // On the border the path may have no length: then the density there is the mean.
    let is_level = along == vec3f(0.0);
    let borders = select(-origin, 1.0 - origin, along > vec3f(0.0));
    let ahead = select(borders / select(along, vec3f(1.0), is_level), vec3f(COLUMN_FAR), is_level);
    let leaves = min(min(ahead.x, ahead.y), ahead.z);
    let end = max(min(leaves, reach), 0.01 * grid.voxel);
    // To the end of the slab, and on from there by what is known.
    let depth = depth_of(path, texel, count);
    let plane = floor(depth / path.thickness);
    var own = end;
    var rest = 0.0;
    if (plane > 0.0) {
        let cells = depth + 1.0 - plane * path.thickness;
        let t = cells / dot(path.facing * along, count - 1.0);
        if (t < end) {
            own = t;
            let there = (origin + t * along) * (count - 1.0);
            rest = (end - t) * plane_mean(slot, plane - 1.0, in_plane(path, there), in_plane(path, count));
        }
    }
    return (path_column(grid, origin, along, own) + rest) / end;
}
