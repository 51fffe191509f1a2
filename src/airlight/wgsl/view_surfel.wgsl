// The surfel that a texel of a view shows. The including pass binds views, depth, normal and
// reflectance and `lattice`, and its params say resolution, view and first_layer.
//! use light_texel
//! use lattice_axes
//! use nearest_corner

const GRAZING = 0.1;    // the least cosine: texels there stand for more than they show

struct ViewSurfel {
    corner: u32,            // around which it counts, half a cell beside the lattice; or NO_CORNER
    offset: vec3f,          // cells from there
    normal: vec3f,          // along the lattice's axes
    area: f32,              // of the surface that the texel shows, over a cell face's
    reflectance: vec3f,
}

// The direction that its light travels in, or an eye looks in, towards a world point.
fn view_direction(view: LightViewData, world: vec3f, centre: vec2f) -> vec3f {
    let near = view.world_from_clip * vec4f(centre, 0.0, 1.0);
    return normalize(world - near.xyz / near.w);
}

// Where the eye of a view in perspective is, m.
fn view_eye(view: LightViewData) -> vec3f {
    // All rays meet where w vanishes: the point that clip_from_world takes to (0, 0, z, 0).
    let p = view.world_from_clip * vec4f(0.0, 0.0, 1.0, 0.0);
    return p.xyz / p.w;
}

// m^2 of the surface that a texel shows.
fn surfel_area(view: LightViewData, world: vec3f, n: vec3f, centre: vec2f) -> f32 {
    let towards = view_direction(view, world, centre);
    var across = texel_measure(view, centre, params.resolution);
    if (view.is_perspective != 0u) {
        let reach = world - view_eye(view);
        across *= dot(reach, reach);
    }
    return across / max(abs(dot(n, towards)), GRAZING);
}

fn view_surfel(id: vec3u) -> ViewSurfel {
    var seen = ViewSurfel(NO_CORNER, vec3f(0.0), vec3f(0.0), 0.0, vec3f(0.0));
    if (any(id.xy >= vec2u(params.resolution))) {
        return seen;
    }
    let layer = params.first_layer + id.z;
    let d = textureLoad(depth, vec2i(id.xy), layer, 0);
    if (d >= 1.0) {
        return seen;
    }
    // Where the texel's surface is.
    let view = row_of_views(params.view);
    let centre = texel_centre(id.xy, params.resolution);
    let world = texel_point(view, centre, d);
    // The lattice's corner nearest to it.
    let n = normalize(textureLoad(normal, vec2i(id.xy), layer, 0).xyz);
    seen.normal = lattice_from_world(lattice, n);
    let corner = nearest_corner(world, seen.normal);
    if (corner.index == NO_CORNER) {
        return seen;
    }
    seen.corner = corner.index;
    seen.offset = corner.offset;
    // Its area over a cell face's, and what it reflects.
    seen.area = surfel_area(view, world, n, centre) / (lattice.cell * lattice.cell);
    seen.reflectance = textureLoad(reflectance, vec2i(id.xy), layer, 0).rgb;
    return seen;
}
