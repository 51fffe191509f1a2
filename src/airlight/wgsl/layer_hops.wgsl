// What a layer's cells send to the 26 beside them, by sums along x and then along y: three rows of
// a column's neighbours give what reaches it, and the cells below and above it.

struct Row { c: vec4f, e: vec4f, o: vec4f }     // the middle; the two beside it: sum, difference
struct Sent { below: vec4f, here: vec4f, above: vec4f }

// Per kind of hop what arrives in even and direct parts, alone and times rho over its length.
struct Weights { e: vec3f, d: vec3f, es: vec3f, ds: vec3f }

fn weights(c: StepCoefficients) -> Weights {
    let s = vec3f(RHO / LENGTH_0, RHO / LENGTH_1, RHO / LENGTH_2);
    return Weights(c.even.xyz, c.direct.xyz, c.even.xyz * s, c.direct.xyz * s);
}

// What the layer's nine cells around a column (rows a, c, b) send to it, and to the cells below
// and above it. With offset o a neighbour sends A - (rho/|o|) o.B, in direction -o.
fn sent(k: StepCoefficients, w: Weights, a: Row, c: Row, b: Row) -> Sent {
    let es = b.e + a.e;     // the four at corners
    let cs = b.c + a.c;
    let os = b.o + a.o;     // weighted by the offset along x, y, both
    let ed = b.e - a.e;
    let cd = b.c - a.c;
    let od = b.o - a.o;
    let four = c.e + cs;    // the four beside
    let side = c.o.y + cd.z;
    let corner = os.y + ed.z;
    let across_x = es.y + od.z;
    let across_y = od.y + es.z;
    let here = vec4f(
        w.e.x * four.x - w.es.x * side + w.e.y * es.x - w.es.y * corner + k.even.w * c.c.x,
        w.ds.x * c.e.y - w.d.x * c.o.x + w.ds.y * across_x - w.d.y * os.x + k.direct.w * c.c.y,
        w.ds.x * cs.z - w.d.x * cd.x + w.ds.y * across_y - w.d.y * ed.x + k.direct.w * c.c.z,
        k.direct.w * c.c.w);
    // To other layers: halves that do and do not change sign with the side.
    let even = w.e.x * c.c.x + w.e.y * four.x - w.es.y * side + w.e.z * es.x - w.es.z * corner;
    let odd = w.es.x * c.c.w + w.es.y * four.w + w.es.z * es.w;
    let along = w.d.x * c.c.x + w.d.y * four.x - w.ds.y * side + w.d.z * es.x - w.ds.z * corner;
    let still = w.ds.x * c.c.w + w.ds.y * four.w + w.ds.z * es.w;
    let px = w.ds.y * c.e.y - w.d.y * c.o.x + w.ds.z * across_x - w.d.z * os.x;
    let py = w.ds.y * cs.z - w.d.y * cd.x + w.ds.z * across_y - w.d.z * ed.x;
    let qx = w.ds.y * c.o.w + w.ds.z * os.w;
    let qy = w.ds.y * cd.w + w.ds.z * ed.w;
    return Sent(vec4f(even - odd, px + qx, py + qy, still - along), here,
        vec4f(even + odd, px - qx, py - qy, still + along));
}
