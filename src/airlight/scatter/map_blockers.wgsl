// Texels of six maps along the axes of the lattice, added to what blocks around its corners.
//! use blocker_side
//! use light_texel
//! use nearest_corner

// Layer 2 axis + k sees the sides that face +axis (k = 0) or -axis.
@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= params.resolution || id.y >= params.resolution || id.z >= 6u) {
        return;
    }
    let d = textureLoad(depth, vec2i(id.xy), id.z, 0);
    if (d >= 1.0) {
        return;
    }
    // The corner nearest to what the texel sees.
    let view = row_of_views(id.z);
    let world = texel_point(view, texel_centre(id.xy, params.resolution), d);
    let axis = id.z / 2u;
    var n = vec3f(0.0);
    n[axis] = select(1.0, -1.0, (id.z & 1u) == 1u);
    let corner = nearest_corner(world, n);
    if (corner.index == NO_CORNER) {
        return;
    }
    // Its area along the map's axis covers a share of a face; walls block on both sides.
    let offset = corner.offset[axis];
    let area = view.texel.x * view.texel.y / (lattice.cell * lattice.cell);
    let units = i32(round(area * params.units));
    let reflectance = view.flux_unit * textureLoad(flux, vec2i(id.xy), id.z, 0).rgb;
    let first = CORNER_VALUES * corner.index;
    add_side(first, id.z, units, offset, reflectance);
    add_side(first, id.z ^ 1u, units, offset, reflectance);
    add_axis(first, axis, units, offset);
}
