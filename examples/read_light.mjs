// The solved light in JavaScript, without a library: what an engine would do with it.
//
//     airlight export-lattice builtin:cornell -o light -t lpv -D resolution=24
//     node examples/read_light.mjs light 0.5 0.01 -0.5   0 1 0
//
// You should see the indirect irradiance, W m^-2 in red, green and blue, on a surface at that
// point (metres) with that normal. It reads header.json and three arrays, and looks the light up as
// an engine's shader would: trilinear between cells, half a cell before the surface. That is the
// first order; airlight's own lookup (LightField.irradiance) also keeps light from leaking through
// walls.

import { existsSync, readFileSync, realpathSync } from "node:fs";
import { join } from "node:path";
import { pathToFileURL } from "node:url";

/** A .npy file of 32-bit floats in C order: { shape, data }. */
export function readNpy(path) {
  const file = readFileSync(path);
  if (file.toString("latin1", 1, 6) !== "NUMPY") throw new Error(`${path}: not an .npy file`);
  const long = file[6] > 1;
  const size = long ? file.readUInt32LE(8) : file.readUInt16LE(8);
  const begin = (long ? 12 : 10) + size;
  const head = file.toString("latin1", long ? 12 : 10, begin);
  if (!head.includes("'<f4'") || !head.includes("'fortran_order': False")) {
    throw new Error(`${path}: not float32 in C order`);
  }
  const shape = head.match(/'shape': \(([^)]*)\)/)[1].split(",").filter((n) => n.trim()).map(Number);
  // A copy: the numbers need not lie at a multiple of four bytes in the file.
  const bytes = file.subarray(begin);
  return { shape, data: new Float32Array(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length)) };
}

/** The lattices of a folder that `airlight export-lattice` wrote, the finest first. */
export function readLattices(folder) {
  const header = JSON.parse(readFileSync(join(folder, "header.json"), "utf8"));
  if (header.format !== "airlight light field") throw new Error(`${folder}: no light field`);
  return header.lattices.map((about, k) => ({
    ...about,
    surfaces: readNpy(join(folder, `lattice${k}_surfaces.npy`)), // (z, y, x, rgb, 4)
  }));
}

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];

/** How much of a lattice's light counts at a point (its own axes): 1 inside, 0 at its border. */
function weight(lattice, p) {
  const [low, lowWidth, high, highWidth] = lattice.fade_m;
  let least = 1;
  for (let k = 0; k < 3; k++) {
    least = Math.min(least, (p[k] - low[k]) / lowWidth[k], (high[k] - p[k]) / highWidth[k]);
  }
  return Math.max(least, 0);
}

/** Irradiance [r, g, b], W m^-2, of one lattice at a point with a normal, both in its own axes. */
function latticeIrradiance(lattice, p, n) {
  const [X, Y, Z] = lattice.count_xyz;
  const { data } = lattice.surfaces;
  const size = [X, Y, Z];
  const low = [0, 0, 0];
  const t = [0, 0, 0];
  for (let k = 0; k < 3; k++) {
    // Cell centres lie at whole numbers; half a cell before the surface there is no wall.
    const at = (p[k] + 0.5 * lattice.cell_m * n[k] - lattice.origin_m[k]) / lattice.cell_m - 0.5;
    const inside = Math.min(Math.max(at, 0), size[k] - 1);
    low[k] = Math.min(Math.floor(inside), Math.max(size[k] - 2, 0));
    t[k] = inside - low[k];
  }
  const total = [0, 0, 0];
  for (let corner = 0; corner < 8; corner++) {
    const step = [corner & 1, (corner >> 1) & 1, corner >> 2];
    const [x, y, z] = step.map((s, k) => Math.min(low[k] + s, size[k] - 1));
    const share = step.reduce((w, s, k) => w * (s ? t[k] : 1 - t[k]), 1);
    for (let c = 0; c < 3; c++) {
      // Real spherical harmonics Y00, Y1-1 (y), Y10 (z), Y11 (x) of the way the light travels.
      const i = (((z * Y + y) * X + x) * 3 + c) * 4;
      const a = 0.282095 * data[i];
      const b = [0.488603 * data[i + 3], 0.488603 * data[i + 1], 0.488603 * data[i + 2]];
      total[c] += share * Math.PI * Math.max(a - (2 / 3) * dot(b, n), 0);
    }
  }
  return total;
}

/** Irradiance [r, g, b], W m^-2, at a point of the world, metres, on a surface with a normal. */
export function irradiance(lattices, point, normal) {
  const total = [0, 0, 0];
  let left = 1;
  for (const lattice of lattices) {
    const p = lattice.axes_xyz.map((axis) => dot(axis, point));
    const n = lattice.axes_xyz.map((axis) => dot(axis, normal));
    const share = left * weight(lattice, p);
    latticeIrradiance(lattice, p, n).forEach((e, c) => (total[c] += share * e));
    left -= share;
  }
  return total;
}

/** What the command line asks for; throws where that is not a folder, a point and a normal. */
function asked([folder, ...numbers]) {
  const at = numbers.map(Number);
  if (at.length !== 6 || !at.every(Number.isFinite)) {
    throw new Error("usage: node read_light.mjs FOLDER X Y Z NX NY NZ");
  }
  if (!existsSync(join(folder, "header.json"))) {
    throw new Error(`${folder}: no folder of airlight export-lattice (its -o names a folder, not an .npz)`);
  }
  return [readLattices(folder), at.slice(0, 3), at.slice(3, 6)];
}

// As a program; other modules import the functions above.
if (process.argv[1] && import.meta.url === pathToFileURL(realpathSync(process.argv[1])).href) {
  try {
    console.log(irradiance(...asked(process.argv.slice(2))).join(" "));
  } catch (error) {
    console.error(error.message);
    process.exitCode = 2;
  }
}
