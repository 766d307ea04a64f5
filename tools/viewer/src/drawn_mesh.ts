// SPDX-License-Identifier: GPL-3.0-or-later
//
// The mesh as the GPU wants it: positions and normals around the local origin, corners of the surface's triangles. Void
// triangles are left out, so voids stay open.
import { heightOf, type MeshView, none, normalsOf, surfaceCorners, triangleWords, vertexWords } from 'ptin-decoder';
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

/** Unit normals as the card takes them: 16 bits a number, four numbers a vertex. */
function drawnNormals(positions: Float32Array, corners: Uint32Array): Int16Array {
  const units = normalsOf(positions, corners);
  const normals = new Int16Array(positions.length / 3 * 4);
  for (let from = 0, to = 0; from < units.length; from += 3, to += 4) {
    for (let i = 0; i < 3; ++i) normals[to + i] = Math.round(32767 * units[from + i]);
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
