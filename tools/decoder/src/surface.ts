// SPDX-License-Identifier: GPL-3.0-or-later
//
// A mesh as graphics want it: positions, normals, corners of the surface's triangles. Void triangles are left out, so voids stay
// open.
import { type Facts, heightOf } from './facts.js';
import { type MeshView, triangleWords, vertexWords } from './mesh.js';

/** A frame around a place of the terrain, in which 32 bits are enough: local = (map - origin) * scale. */
export interface LocalFrame {
  /** x and y on the map, and the height, of local (0, 0, 0). */
  origin: readonly [x: number, y: number, height: number];
  /** Local units for one unit of the map along x, one along y, and one of height. */
  scale: readonly [x: number, y: number, height: number];
}

/** Writes three numbers a vertex. A vertex without a height, which no triangle of the surface has, gets the terrain's least one. */
function place<Numbers extends Float32Array | Float64Array>(
  to: Numbers, mesh: MeshView, facts: Facts, { origin, scale }: LocalFrame,
): Numbers {
  const { vertices, vertexCount, hasHeight } = mesh;
  const least = facts.minHeight <= facts.maxHeight ? facts.minHeight : 0;
  const east = facts.originX - origin[0], north = facts.originY - origin[1];
  for (let v = 0, from = 0, at = 0; v < vertexCount; ++v, from += vertexWords, at += 3) {
    to[at] = (east + facts.stepX * vertices[from]) * scale[0];
    to[at + 1] = (north + facts.stepY * vertices[from + 1]) * scale[1];
    to[at + 2] = ((hasHeight[v] !== 0 ? heightOf(facts, vertices[from + 2]) : least) - origin[2]) * scale[2];
  }
  return to;
}

/** Positions in a local frame, three numbers a vertex. Cost: linear. */
export function localPositions(mesh: MeshView, facts: Facts, frame: LocalFrame): Float32Array {
  return place(new Float32Array(3 * mesh.vertexCount), mesh, facts, frame);
}

/** Positions in the CRS of the terrain's file, three numbers a vertex. Cost: linear. */
export function mapPositions(mesh: MeshView, facts: Facts): Float64Array {
  return place(new Float64Array(3 * mesh.vertexCount), mesh, facts, { origin: [0, 0, 0], scale: [1, 1, 1] });
}

/** Corners of the surface's triangles, three a triangle, counter-clockwise seen from above. Cost: linear. */
export function surfaceCorners(mesh: MeshView): Uint32Array {
  const { triangles, classes, triangleCount } = mesh;
  let surface = 0;
  for (let t = 0; t < triangleCount; ++t) surface += classes[t] === 0 ? 1 : 0;
  const corners = new Uint32Array(3 * surface);
  for (let t = 0, from = 0, to = 0; t < triangleCount; ++t, from += triangleWords) {
    if (classes[t] !== 0) continue;
    corners[to++] = triangles[from];
    corners[to++] = triangles[from + 1];
    corners[to++] = triangles[from + 2];
  }
  return corners;
}

/**
 * Unit normals, three numbers a vertex: of the mean plane around it, weighted by area; 0, 0, 0 where no triangle is. Positions
 * have one unit in all directions, as those of a local frame. Cost: linear.
 */
export function normalsOf(positions: Float32Array, corners: Uint32Array): Float32Array {
  const normals = new Float32Array(positions.length);
  for (let i = 0; i < corners.length; i += 3) {
    const a = 3 * corners[i], b = 3 * corners[i + 1], c = 3 * corners[i + 2];
    const ux = positions[b] - positions[a], uy = positions[b + 1] - positions[a + 1];
    const uz = positions[b + 2] - positions[a + 2];
    const vx = positions[c] - positions[a], vy = positions[c + 1] - positions[a + 1];
    const vz = positions[c + 2] - positions[a + 2];
    const x = uy * vz - uz * vy, y = uz * vx - ux * vz, z = ux * vy - uy * vx;
    for (const at of [a, b, c]) {
      normals[at] += x;
      normals[at + 1] += y;
      normals[at + 2] += z;
    }
  }
  for (let at = 0; at < normals.length; at += 3) {
    const length = Math.hypot(normals[at], normals[at + 1], normals[at + 2]) || 1;
    for (let i = at; i < at + 3; ++i) normals[i] /= length;
  }
  return normals;
}
