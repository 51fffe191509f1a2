// A face of a shadow volume: the radiance along the eye ray in front of it, as if everything were lit, is
// added where the ray enters the shadow and subtracted where it leaves it.
//! use facets
//! use eye_ray
//! use lit_interval
//! use light_reach

// The space of a map is left-handed, and so is that of an image.
const FRONT_IS_IN = true;
const PARALLEL_END = 256.0;   // depth ranges of the map at which shadows of parallel light end
const NEAR_M = 1e-4;    // from the eye plane; nothing is scattered before it

struct Corner {
    @builtin(position) clip: vec4f,
    @location(0) @interpolate(flat) plane: vec4f,   // from the eye; 0 at infinity
    @location(1) @interpolate(flat) light: u32,
}

// The row of the light whose map is drawn.
fn light_of_layer() -> u32 {
    for (var i = 0u; i < params.light_count; i++) {
        let light = row_of_lights(i);
        let is_parallel = light.kind == LIGHT_DIRECTIONAL;
        if (is_parallel == (params.is_parallel != 0u) && tree.layer >= light.first_view
            && tree.layer < light.first_view + light.view_count) {
            return i;
        }
    }
    return 0u;
}

struct WallCorner {
    at: vec2u,      // lattice point
    depth: f32,
}

// Which corner of a facet's top a triangle's vertex is.
fn top_corner(own: Facet, kind: u32, k: u32) -> vec2u {
    let size = 1u << own.level;
    let low = own.node * size;
    // A half of a top that no side divides.
    if (kind < 2u) {
        return low + corner_of(3u - select(k + kind, 0u, k == 0u)) * size;
    }
    // Else a triangle of the fan around its middle: over a whole side, or over half of one.
    let is_half = kind >= 6u;
    let side = select(kind - 2u, (kind - 6u) >> 1u, is_half);
    let p = low + corner_of(side) * size;
    let q = low + corner_of((side + 1u) & 3u) * size;
    if (k == 0u) {
        return low + size / 2u;
    }
    if (!is_half) {
        return select(p, q, k == 1u);
    }
    let middle = (p + q) / 2u;
    let is_second = ((kind - 6u) & 1u) == 1u;
    return select(select(p, middle, k == 1u), select(middle, q, k == 1u), is_second);
}

// A lattice point of the map at a depth, in the world; at NEVER, where its light goes to.
fn world_of(at: vec2u, depth: f32, light: u32) -> vec4f {
    let view = row_of_views(tree.layer);
    let ndc = vec2f(at) / f32(tree.resolution) * vec2f(2.0, -2.0) + vec2f(-1.0, 1.0);
    let near = view.world_from_clip * vec4f(ndc, 0.0, 1.0);
    let along = view.world_from_clip[2];
    if (depth < NEVER) {
        return near + depth * along;
    }
    // Parallel light would meet in one point at infinity, and walls be left without their corners.
    if (view.is_perspective == 0u) {
        return near / PARALLEL_END + along;  // so scaled, clipping cancels nothing
    }
    return vec4f(near.xyz / near.w - row_of_lights(light).position, 0.0);
}

// A corner of the j-th triangle of half h of the wall P Q (own) to P' Q' (the neighbour's): the
// halves P Q Q' and Q' P' P are fans from P and Q' over the depths where other walls end.
fn wall_corner(own: Facet, part: u32, k: u32) -> WallCorner {
    let side = part / 6u;
    let is_second = part % 6u >= 3u;
    let j = part % 3u;
    let other = beyond(tree.layer, own, side).facet;
    let ends = side_ends(own.level, own.node, side);
    if (k == 0u) {
        if (is_second) {
            return WallCorner(ends[1], depth_at(other, ends[1]));
        }
        return WallCorner(ends[0], depth_at(own, ends[0]));
    }
    let at = ends[select(1u, 0u, is_second)];
    let first = depth_at(own, at);
    let last = depth_at(other, at);
    let cuts = depths_between(tree.layer, at, own.level, first, last);
    // From own to neighbour: first, cuts, last; the second half goes back.
    let step = j + select(k - 1u, 2u - k, is_second);
    if (step == 0u) {
        return WallCorner(at, first);
    }
    let cut = select(cuts.y, cuts.x, step == 1u);
    return WallCorner(at, select(last, cut, step < 3u && cut < NEVER));
}

// The plane of a triangle, the eye its origin. A face can be a hundredth of a pixel wide and reach
// far beyond the image: interpolated values on it are not accurate enough.
fn plane_of(own: Facet, kind: u32) -> vec4f {
    // What lies at infinity cuts no ray.
    if (kind >= LID && kind < WALL) {
        return vec4f(0.0);
    }
    // In the map's space a wall stands upright on a side of its square, and a top slopes as its facet does.
    let half = 0.5 * f32(tree.resolution);
    var ndc = vec4f(0.0, 0.0, 1.0, 0.0);
    if (kind >= WALL) {
        let side = (kind - WALL) / 6u;
        let at = vec2f(side_ends(own.level, own.node, side)[0]) / half - 1.0;
        ndc = select(vec4f(1.0, 0.0, 0.0, -at.x), vec4f(0.0, 1.0, 0.0, at.y), (side & 1u) == 1u);
    } else {
        let off = vec2f(half) - (vec2f(own.node) + 0.5) * f32(1u << own.level);
        let slope = own.plane.yz;
        ndc = vec4f(-half * slope.x, half * slope.y, 1.0, -own.plane.x - dot(slope, off));
    }
    // In the world, from the eye: planes go backwards through the map's projection.
    let m = row_of_views(tree.layer).clip_from_world;
    let at_eye = m * vec4f(rays.eye, 1.0);
    return vec4f(dot(ndc, m[0]), dot(ndc, m[1]), dot(ndc, m[2]), dot(ndc, at_eye));
}

@vertex fn vertex(@builtin(vertex_index) index: u32) -> Corner {
    // A corner of the top, of the same at infinity, or of a wall.
    let packed = triangles[index / 3u];
    let kind = packed % KINDS;
    let leaf = leaf_of(packed);
    let own = facet_of(tree.layer, leaf.z, leaf.xy);
    let k = index % 3u;
    var corner: WallCorner;
    if (kind >= WALL) {
        corner = wall_corner(own, kind - WALL, k);
    } else if (kind >= LID) {
        // Seen from behind.
        corner = WallCorner(top_corner(own, kind - LID, 2u - k), NEVER);
    } else {
        corner.at = top_corner(own, kind, k);
        corner.depth = depth_at(own, corner.at);
    }
    // On the image, its plane known from the eye.
    var out: Corner;
    out.light = light_of_layer();
    let world = world_of(corner.at, corner.depth, out.light);
    out.plane = plane_of(own, kind);
    out.clip = params.clip_from_eye * vec4f(world.xyz - world.w * rays.eye, world.w);
    // Clipped at the eye plane only: what lies behind the surface counts, too.
    out.clip.z = out.clip.w - NEAR_M * world.w;
    return out;
}

@fragment fn fragment(in: Corner, @builtin(front_facing) is_front: bool) -> @location(0) vec4f {
    // The eye ray, and the stretch of it that the light reaches at all.
    let texel = vec2u(in.clip.xy);
    let centre = in.clip.xy * f32(rays.scale);
    let direction = normalize(pixel_direction(rays.world_from_clip, centre, vec2f(rays.size)));
    let reach = textureLoad(picked, vec2i(texel), 0).x;
    let light = row_of_lights(in.light);
    let hull = visible_interval(media_enter(rays.eye, direction, reach));
    let span = light_span(light, rays.eye, direction, hull);
    // Up to the face, or to the end of the stretch.
    let t = -in.plane.w / dot(in.plane.xyz, direction);
    let end = select(min(t, span.y), span.y, all(in.plane.xyz == vec3f(0.0)));
    if (span.x >= end) {
        return vec4f(0.0);
    }
    prepare_lit_intervals(light, rays.eye, direction);
    let before = lit_interval(light, in.light, rays.eye, direction, span.x, end);
    return vec4f(select(-1.0, 1.0, is_front == FRONT_IS_IN) * before, 0.0);
}
