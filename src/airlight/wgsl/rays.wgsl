//! use ray_boxes
//! use ray_triangles

// Rays against the triangles of a scene, through hierarchies laid out by rays/words.py: one of all that is static,
// in the world, and one of the instances that have moved, whose leaves lead to those of meshes. Who uses it binds
// RAY_SLOTS (rays/rays.py).

override RAYS_MEET_MASKS: bool = true;      // whether any instance has holes
override RAYS_MEET_INSTANCES: bool = true;  // whether any has moved

const NO_HIT = 0xffffffffu;
const RAY_LEVELS = 25u;                     // of nodes, of instances and of a mesh together, and one
const RAY_NO_INSTANCE = 0xffffffffu;
const RAY_INSTANCE_ROWS = 10u;

// `instance` is its row in the scene's order; `bary` are the shares of the second and of the third corner.
struct RayHit {
    t: f32,
    triangle: u32,
    instance: u32,
    bary: vec2f,
}

fn ray_in_instance(instance: u32, origin: vec3f, direction: vec3f) -> RayIn {
    let row = RAY_INSTANCE_ROWS * instance;
    let x = bitcast<vec4f>(row_of_ray_instances(row));
    let y = bitcast<vec4f>(row_of_ray_instances(row + 1u));
    let z = bitcast<vec4f>(row_of_ray_instances(row + 2u));
    let point = vec4f(origin, 1.0);
    return ray_in(vec3f(dot(x, point), dot(y, point), dot(z, point)),
        vec3f(dot(x.xyz, direction), dot(y.xyz, direction), dot(z.xyz, direction)));
}

fn ray_still_node() -> u32 {
    return row_of_ray_instances(8u).z;
}

fn ray_first_node(instance: u32) -> u32 {
    return row_of_ray_instances(RAY_INSTANCE_ROWS * instance + 6u).x;
}

// Each turn visits a node, tests a triangle and finds what comes next, all of it for all rays, with selects for
// branches: CPU adapters run both sides of a branch, and what they read or write for some lanes alone costs them more
// than for all. A leaf's triangles are tested while the next nodes are visited. A hit that may lie in a hole ends the
// turns, which go on where they were once that is known.
fn ray_traced(origin: vec3f, direction: vec3f, t_min: f32, t_max: f32, is_any: bool) -> RayHit {
    let world = ray_in(origin, direction);
    var hit = RayHit(t_max, NO_HIT, RAY_NO_INSTANCE, vec2f(0.0));
    var before = hit;
    var ray = world;
    var stack: array<u32, RAY_LEVELS>;      // groups, of which children are left
    var depth = 0u;
    var group = 0u;                         // the one whose children come next
    var node = select(ray_still_node(), 0u, RAYS_MEET_INSTANCES);
    var has_node = true;
    var triangle = 0u;
    var left = 0u;                          // triangles of a leaf that are to be tested
    var instance = RAY_NO_INSTANCE;         // whose hierarchy it is
    var entered = 0u;                       // the depth at which that ends
    loop {
        var is_done = false;
        var is_doubtful = false;
        loop {
            // The node: the children that the ray meets are the next group, the last one waits on the stack.
            let found = ray_group(node, ray, t_min, hit.t);
            let opens = has_node && (found & 15u) != 0u;
            stack[depth] = group;
            depth += select(0u, 1u, opens && (group & 15u) != 0u);
            group = select(group, found, opens);

            // A triangle of the leaf.
            let tried = ray_nearer(hit, ray, triangle, instance, select(3e38, t_min, left > 0u));
            if (RAYS_MEET_MASKS) {
                is_doubtful = tried.is_doubtful;
                before = hit;
            }
            hit = tried.hit;
            triangle += 1u;
            left -= select(0u, 1u, left > 0u);

            // The group on the stack, once this one is empty; outside, once the instance's triangles are tested.
            let is_inside = RAYS_MEET_INSTANCES && instance != RAY_NO_INSTANCE;
            let ends = is_inside && (group & 15u) == 0u && depth == entered;
            let leaves = ends && left == 0u;
            let pops = (group & 15u) == 0u && depth > 0u && (!ends || leaves);
            if (leaves) {
                ray = world;
                instance = RAY_NO_INSTANCE;
            }
            depth -= select(0u, 1u, pops);
            group = select(group, stack[depth], pops);

            // What comes next of the group: a node, an instance to enter, or a leaf once the last one is tested.
            let is_empty = (group & 15u) == 0u;
            let child = ray_child(group);
            let is_leaf = child >= RAY_LEAF;
            let enters = RAYS_MEET_INSTANCES && is_leaf && !is_empty && instance == RAY_NO_INSTANCE;
            let takes = !is_empty && (!is_leaf || enters || left == 0u);
            let fills = takes && is_leaf && !enters;
            has_node = takes && !fills;
            node = select(node, child, has_node);
            triangle = select(triangle, child & RAY_INDEX, fills);
            left = select(left, ((child >> 28u) & 7u) + 1u, fills);
            group = select(group, group & (group - 1u), takes);
            if (enters) {
                stack[depth] = group;
                depth += select(0u, 1u, (group & 15u) != 0u);
                group = 0u;
                entered = depth;
                instance = child & RAY_INDEX;
                ray = ray_in_instance(instance, origin, direction);
                node = ray_first_node(instance);
            }
            is_done = is_empty && left == 0u;
            if (is_done || is_doubtful || (is_any && hit.triangle != NO_HIT)) { break; }
        }
        if (RAYS_MEET_MASKS && is_doubtful && !ray_is_there(hit)) {
            hit = before;
        }
        if (is_done || (is_any && hit.triangle != NO_HIT)) { break; }
    }
    return hit;
}

// The nearest triangle that origin + t * direction meets with t_min <= t < t_max, from whichever side; NO_HIT as
// its triangle where there is none.
fn nearest_hit(origin: vec3f, direction: vec3f, t_min: f32, t_max: f32) -> RayHit {
    return ray_traced(origin, direction, t_min, t_max, false);
}

// Whether it meets any.
fn any_hit(origin: vec3f, direction: vec3f, t_min: f32, t_max: f32) -> bool {
    return ray_traced(origin, direction, t_min, t_max, true).triangle != NO_HIT;
}
