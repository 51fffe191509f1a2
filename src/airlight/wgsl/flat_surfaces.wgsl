// Flat surfaces in the maps of lights, where nothing is close before them. The including pass binds the uniforms `lattice`
// and `params` (of which `resolution` is the maps'), and `depth` of reflective shadow maps; it declares LightViewData.
// Twins: maths.flat_surfaces.
//! use lattice_axes
//! use light_texel

const ON_PLANE = 0.1;    // cells: how far from a plane what counts as part of it may be
const OFF_PLANE = 0.25;  // cells: from how far on it is another surface, or a curved one
const WALL = 0.6;        // cells before it: from how far on it is a wall
const BEFORE_FLAT = 1.0; // cells before a flat surface oblique to them: hardly any that it cuts are so far

// The k-th axis across n, a unit vector, and its weight; those of all three are 2. It changes smoothly with n.
fn axis_across(n: vec3f, k: u32) -> vec4f {
    let along = n[k];
    let weight = 1.0 - along * along;
    var across = -along * n;
    across[k] += 1.0;
    return vec4f(across * inverseSqrt(max(weight, 1e-6)), weight);
}

// How far what is so many cells off a plane is a part of it, 0 to 1.
fn is_on_plane(off: f32) -> f32 {
    return 1.0 - smoothstep(ON_PLANE, OFF_PLANE, abs(off));
}

// How far what a view shows past a point before a plane is not a wall before that: it is so many cells above it.
fn is_open(height: f32) -> f32 {
    return 1.0 - smoothstep(OFF_PLANE, WALL, height);
}

// A plane through p across n (along the lattice's axes) in a view: p in clip coordinates, and what makes of the clip
// coordinates of a shown point its height above the plane, cells, times w, and w.
struct Sight { clip_from_world: mat4x4f, clip: vec4f, height: vec4f, w: vec4f }

fn sight_of(view: LightViewData, p: vec3f, n: vec3f) -> Sight {
    let up = world_from_lattice(lattice, n) / lattice.cell;
    let rows = transpose(view.world_from_clip);
    return Sight(view.clip_from_world, view.clip_from_world * vec4f(p, 1.0), rows * vec4f(up, -dot(up, p)), rows[3]);
}

// A direction along the lattice's axes, a cell long, in clip coordinates.
fn clip_cell(sight: Sight, direction: vec3f) -> vec4f {
    return sight.clip_from_world * vec4f(lattice.cell * world_from_lattice(lattice, direction), 0.0);
}

// What the view shows on its line through the point so far, in clip coordinates, from p, if that is in its map.
struct Shown { is_known: bool, depth: f32, height: f32 }

fn shown_on_line(sight: Sight, layer: u32, away: vec4f) -> Shown {
    let clip = sight.clip + away;
    let uv = vec2f(0.5, -0.5) * clip.xy / clip.w + 0.5;
    let is_known = clip.w > 0.0 && all(uv >= vec2f(0.0)) && all(uv < vec2f(1.0));
    let texel = vec2u(saturate(uv) * (f32(params.resolution) - 1e-3));
    let d = textureLoad(depth, texel, layer, 0);
    let point = vec4f(texel_centre(texel, params.resolution), d, 1.0);
    return Shown(is_known, d, dot(sight.height, point) / dot(sight.w, point));
}

// 1 where a view shows the plane so far from p, less where that is off it.
fn shown_flat(sight: Sight, layer: u32, away: vec4f) -> f32 {
    let shown = shown_on_line(sight, layer, away);
    return select(0.0, is_on_plane(shown.height), shown.is_known && shown.depth < 1.0);
}

// How flat a view shows what is around a plane's point, 0 to 1: the share of six points, half a cell away across n, that
// it shows near the plane. A ball smaller than a cell is not, nor is what is not in the map.
fn flatness(sight: Sight, layer: u32, n: vec3f) -> f32 {
    var near = 0.0;
    var k = 0u;
    loop {
        let axis = axis_across(n, k);
        let away = 0.5 * clip_cell(sight, axis.xyz);
        near += axis.w * (shown_flat(sight, layer, away) + shown_flat(sight, layer, -away));
        k++;
        if (k >= 3u) { break; }
    }
    return 0.25 * near;
}

// How far a view shows nothing else between a plane and BEFORE_FLAT before it, 0 to 1. Seen past points there it shows
// the plane, or what is behind it, but a wall that is nearer, or that hides them from the light, before it. What is not
// in its map is not known to be open.
fn clearance(sight: Sight, layer: u32, n: vec3f) -> f32 {
    let up = clip_cell(sight, n);
    var open = 1.0;
    var k = 0u;
    loop {
        let shown = shown_on_line(sight, layer, mix(0.5, BEFORE_FLAT, 0.5 * f32(k)) * up);
        let passes = select(is_open(shown.height), 1.0, shown.depth >= 1.0);
        open = min(open, select(0.0, passes, shown.is_known));
        k++;
        if (k >= 3u) { break; }
    }
    return open;
}
