// SPDX-License-Identifier: GPL-3.0-or-later
//
// The mesh as the GPU wants it: positions and normals around the local origin, corners of the surface's triangles. Void
// triangles are left out, so voids stay open.
import { heightOf, type MeshView, none, surfaceCorners, triangleWords, vertexWords } from 'ptin-decoder';
import type { Frame } from './frame';

export interface DrawnMesh {
  /** Three a vertex, metres in the scene. */
  positions: Float32Array;
  /** Four a vertex, the last without a meaning: of the mean plane around it, weighted by area, 32767 for 1. */
  normals: Int16Array;
  /** Three a surface triangle. */
  corners: Uint32Array;
}

/** Cost: linear. */
export function drawnMesh(mesh: MeshView, frame: Frame): DrawnMesh {
  const positions = drawnPositions(mesh, frame);
  const corners = surfaceCorners(mesh);
  return { positions, corners, normals: drawnNormals(positions, corners) };
}

function drawnPositions(mesh: MeshView, frame: Frame): Float32Array {
  const { vertices, vertexCount } = mesh;
  const { facts } = frame;
  const positions = new Float32Array(3 * vertexCount);
  const stepX = facts.stepX * frame.scaleX;
  const stepY = facts.stepY * frame.scaleY;
  const middleX = (facts.minX + facts.maxX) / 2;
  const middleY = (facts.minY + facts.maxY) / 2;
  for (let v = 0, from = 0, to = 0; v < vertexCount; ++v, from += vertexWords, to += 3) {
    positions[to] = (vertices[from] - middleX) * stepX;
    positions[to + 1] = (vertices[from + 1] - middleY) * stepY;
    positions[to + 2] = mesh.hasHeight[v] !== 0 ? frame.sceneZ(heightOf(facts, vertices[from + 2])) : 0;
  }
  return positions;
}

function drawnNormals(positions: Float32Array, corners: Uint32Array): Int16Array {
  const sums = new Float32Array(positions.length);
  for (let i = 0; i < corners.length; i += 3) {
    const a = 3 * corners[i], b = 3 * corners[i + 1], c = 3 * corners[i + 2];
    const ux = positions[b] - positions[a], uy = positions[b + 1] - positions[a + 1];
    const uz = positions[b + 2] - positions[a + 2];
    const vx = positions[c] - positions[a], vy = positions[c + 1] - positions[a + 1];
    const vz = positions[c + 2] - positions[a + 2];
    const x = uy * vz - uz * vy, y = uz * vx - ux * vz, z = ux * vy - uy * vx;
    for (const at of [a, b, c]) {
      sums[at] += x;
      sums[at + 1] += y;
      sums[at + 2] += z;
    }
  }
  const normals = new Int16Array(positions.length / 3 * 4);
  for (let from = 0, to = 0; from < sums.length; from += 3, to += 4) {
    const length = Math.hypot(sums[from], sums[from + 1], sums[from + 2]) || 1;
    normals[to] = Math.round(32767 * sums[from] / length);
    normals[to + 1] = Math.round(32767 * sums[from + 1] / length);
    normals[to + 2] = Math.round(32767 * sums[from + 2] / length);
  }
  return normals;
}

/** Every edge of the surface once, as two vertices. Cost: linear. */
export function surfaceEdges(mesh: MeshView): Uint32Array {
  const { triangles, classes, triangleCount } = mesh;
  const edges = new Uint32Array(6 * triangleCount);
  let count = 0;
  for (let t = 0, at = 0; t < triangleCount; ++t, at += triangleWords) {
    if (classes[t] !== 0) continue;
    for (let i = 0; i < 3; ++i) {
      const across = triangles[at + 3 + i];
      if (across !== none && across < t && classes[across] === 0) continue;
      edges[count++] = triangles[at + (i + 1) % 3];
      edges[count++] = triangles[at + (i + 2) % 3];
    }
  }
  return edges.slice(0, count);
}
