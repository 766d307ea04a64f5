// SPDX-License-Identifier: GPL-3.0-or-later
//
// The surface of a mesh as drawing libraries take it: positions, and the corners of its triangles. Voids are left open.
import { type Decoder, heightOf, onMap } from './decoder.js';
import { type MeshView, triangleWords, vertexWords } from './mesh.js';

/** Copies: they stay as they are when the decoder is fed again. */
export interface Surface<Positions extends Float32Array | Float64Array = Float64Array> {
  /** Three a vertex: x, y in units of the map, the height in its own. A vertex in a void has the height NaN, and no triangle. */
  positions: Positions;
  /** Three a triangle, counter-clockwise seen from above. */
  indices: Uint32Array;
}

/** The surface on the map, exact. Cost: linear. */
export function surfaceOf(decoder: Decoder): Surface {
  const positions = new Float64Array(3 * decoder.mesh.vertexCount);
  placeVertices(decoder, [0, 0, 0], positions);
  return { positions, indices: surfaceCorners(decoder.mesh) };
}

/**
 * The surface around an origin on the map, rounded to 32 bits as graphics cards take them: near the origin that is less than a
 * millimetre, which map positions themselves are not. Cost: linear.
 */
export function surfaceAround(decoder: Decoder, origin: readonly [x: number, y: number, height: number]): Surface<Float32Array> {
  const positions = new Float32Array(3 * decoder.mesh.vertexCount);
  placeVertices(decoder, origin, positions);
  return { positions, indices: surfaceCorners(decoder.mesh) };
}

function placeVertices(decoder: Decoder, [x0, y0, height0]: readonly [number, number, number], to: Float32Array | Float64Array): void {
  const { mesh, facts } = decoder;
  for (let v = 0, from = 0, i = 0; v < mesh.vertexCount; ++v, from += vertexWords) {
    const { x, y } = onMap(facts, mesh.vertices[from], mesh.vertices[from + 1]);
    to[i++] = x - x0;
    to[i++] = y - y0;
    to[i++] = mesh.hasHeight[v] !== 0 ? heightOf(facts, mesh.vertices[from + 2]) - height0 : NaN;
  }
}

/** The corners of the triangles that are no void, three each. */
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
