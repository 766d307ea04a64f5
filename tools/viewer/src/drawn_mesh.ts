// SPDX-License-Identifier: GPL-3.0-or-later
//
// The mesh as the picture wants it: positions around the local origin, how each vertex is lit, corners of triangles by what they
// are, the plinth's walls, and where triangles lie.
import type { MeshView } from 'ptin-decoder';
import { heightOf, none, triangleWords, vertexWords } from 'ptin-decoder/values';
import type { Frame } from './frame';
import { type HeightCells, heightCellsOf } from './height_cells';
import type { Triple } from './space';
import { type Spread, SurfaceRaster } from './surface_raster';
import { extentOf, gridOf, type TriangleGrid } from './triangle_grid';
import { kindsOf, land, water } from './water';

/** The number of parts of a terrain's land along each side: those that are not in sight are not drawn, nearer ones first. */
export const tilesAcross = 8;

export interface DrawnMesh {
  /** Three a vertex, metres in the scene. */
  positions: Float32Array;
  /** Four a vertex, 32767 for 1: the normal of the land around it, smoothed, and whether it is on a ridge or in a hollow (-1). */
  normals: Int16Array;
  /** Three a triangle: of land, tile by tile, then of water, then of voids. */
  corners: Uint32Array;
  /** Where in `corners` each tile of land begins; then water, voids, and the end. */
  parts: Uint32Array;
  /** Four a tile of land: its least x and y, its greatest x and y. */
  tileExtents: Float32Array;
  /** Walls of the border: x, y, z and 1 at the foot for four vertices an edge. */
  walls: Float32Array;
  /** The way out of each of them: 32767 for 1. */
  wallNormals: Int16Array;
  grid: TriangleGrid;
  cells: HeightCells;
  /** Null without land. */
  spread: Spread | null;
  /** The extent of what is not void, in the scene: its least and its greatest x and y. */
  extent: { west: number; south: number; east: number; north: number };
  /** The highest vertex of what is not void; null without any. */
  summit: Triple | null;
}

/** Cost: linear. */
export function drawnMesh(mesh: MeshView, frame: Frame): DrawnMesh {
  const asDecoded = drawnPositions(mesh, frame);
  const kinds = kindsOf(mesh, frame.facts);
  const { corners, parts } = partedCorners(mesh, kinds, asDecoded, frame);
  const borders = drawnWalls(mesh, asDecoded);
  const positions = inOrderOfUse(corners, asDecoded);
  const landCorners = corners.subarray(0, parts[tilesAcross * tilesAcross]);
  const surface = corners.subarray(0, surfaceEnd(parts));
  const raster = new SurfaceRaster(positions, landCorners);
  return {
    positions, corners, parts, normals: drawnNormals(positions, landCorners.length > 0 ? landCorners : surface, raster.openness(positions)),
    tileExtents: tileExtentsOf(positions, corners, parts), ...borders, grid: gridOf(positions, surface),
    cells: heightCellsOf(positions, surface, corners.subarray(surface.length), frame.relief), spread: raster.spread,
    extent: extentOf(positions, surface), summit: summitOf(positions, surface),
  };
}

function summitOf(positions: Float32Array, corners: Uint32Array): Triple | null {
  let at = -1;
  for (const v of corners) if (at < 0 || positions[3 * v + 2] > positions[at + 2]) at = 3 * v;
  return at < 0 ? null : [positions[at], positions[at + 1], positions[at + 2]];
}

/** Where corners of land and water end. */
export function surfaceEnd(parts: Uint32Array): number {
  return parts[parts.length - 2];
}

export function buffersOf({ positions, normals, corners, parts, tileExtents, walls, wallNormals, grid, cells }: DrawnMesh): ArrayBuffer[] {
  const all = [positions, normals, corners, parts, tileExtents, walls, wallNormals, grid.starts, grid.triangles, cells.lows, cells.highs];
  return all.map((a) => a.buffer as ArrayBuffer);
}

function tileExtentsOf(positions: Float32Array, corners: Uint32Array, parts: Uint32Array): Float32Array {
  const extents = new Float32Array(4 * tilesAcross * tilesAcross);
  for (let tile = 0; tile < tilesAcross * tilesAcross; ++tile) {
    const { west, south, east, north } = extentOf(positions, corners.subarray(parts[tile], parts[tile + 1]));
    extents.set([west, south, east, north], 4 * tile);
  }
  return extents;
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
    positions[to + 2] = mesh.hasHeight[v] !== 0 ? frame.sceneZ(heightOf(facts, vertices[from + 2])) : NaN;
  }
  levelVoids(mesh, positions);
  return positions;
}

/** Gives vertices in voids the mean height of those beside them that have one, from the rims inwards. */
function levelVoids({ triangles, triangleCount, classes }: MeshView, positions: Float32Array): void {
  let open: number[] = [];
  for (let t = 0; t < triangleCount; ++t) if (classes[t] !== 0) open.push(triangleWords * t);
  for (let before = -1; open.length !== before;) {
    before = open.length;
    open = open.filter((at) => {
      const z = [0, 1, 2].map((k) => positions[3 * triangles[at + k] + 2]);
      const known = z.filter((h) => !Number.isNaN(h));
      if (known.length === 0) return true;
      const mean = known.reduce((a, b) => a + b) / known.length;
      z.forEach((h, k) => { if (Number.isNaN(h)) positions[3 * triangles[at + k] + 2] = mean; });
      return false;
    });
  }
  for (let at = 2; at < positions.length; at += 3) if (Number.isNaN(positions[at])) positions[at] = 0;
}

/** Squares of a tile along each side, a power of two: what they hold is drawn along a Hilbert curve. */
const squaresAcross = 64;

/** Corners by what the triangles are, tile by tile; in a tile neighbours follow each other, which share what is computed of corners. */
function partedCorners(
  { triangles, triangleCount }: MeshView, kinds: Uint8Array, positions: Float32Array, frame: Frame,
): { corners: Uint32Array; parts: Uint32Array } {
  const squares = squaresAcross * squaresAcross, across = tilesAcross * squaresAcross, tiles = tilesAcross * tilesAcross;
  const squareOf = new Uint32Array(triangleCount);
  const starts = new Uint32Array((tiles + 2) * squares + 1);
  const square = (v: number, of: number): number => Math.max(0, Math.min(across - 1, Math.floor((v / Math.max(of, 1e-6) + 0.5) * across)));
  for (let t = 0; t < triangleCount; ++t) {
    const v = 3 * triangles[triangleWords * t];
    const x = square(positions[v], frame.width), y = square(positions[v + 1], frame.depth);
    const part = kinds[t] === land ? Math.floor(y / squaresAcross) * tilesAcross + Math.floor(x / squaresAcross)
      : kinds[t] === water ? tiles : tiles + 1;
    squareOf[t] = part * squares + alongCurve(x % squaresAcross, y % squaresAcross);
    starts[squareOf[t] + 1] += 3;
  }
  for (let s = 1; s < starts.length; ++s) starts[s] += starts[s - 1];
  const parts = Uint32Array.from({ length: tiles + 3 }, (_, part) => starts[part * squares]);
  const corners = new Uint32Array(3 * triangleCount);
  for (let t = 0, from = 0; t < triangleCount; ++t, from += triangleWords) {
    const to = starts[squareOf[t]];
    for (let k = 0; k < 3; ++k) corners[to + k] = triangles[from + k];
    starts[squareOf[t]] += 3;
  }
  return { corners, parts };
}

/** How far along a Hilbert curve a square of a tile is. */
function alongCurve(x: number, y: number): number {
  let along = 0;
  for (let side = squaresAcross / 2; side > 0; side /= 2) {
    const right = (x & side) > 0 ? 1 : 0, up = (y & side) > 0 ? 1 : 0;
    along += side * side * ((3 * right) ^ up);
    if (up === 1) continue;
    if (right === 1) [x, y] = [squaresAcross - 1 - x, squaresAcross - 1 - y];
    [x, y] = [y, x];
  }
  return along;
}

/** Numbers vertices as the corners come to them, so that those of neighbours lie together; returns their positions in that order. */
function inOrderOfUse(corners: Uint32Array, positions: Float32Array): Float32Array {
  const numbers = new Uint32Array(positions.length / 3).fill(none);
  const ordered = new Float32Array(positions.length);
  let next = 0;
  for (let i = 0; i < corners.length; ++i) {
    const from = corners[i];
    if (numbers[from] === none) {
      for (let k = 0; k < 3; ++k) ordered[3 * next + k] = positions[3 * from + k];
      numbers[from] = next++;
    }
    corners[i] = numbers[from];
  }
  return ordered.slice(0, 3 * next);
}

/** Where a vertex has no land, up. */
function drawnNormals(positions: Float32Array, corners: Uint32Array, open: Float32Array): Int16Array {
  const own = new Float32Array(positions.length);
  for (let i = 0; i < corners.length; i += 3) addNormal(positions, own, 3 * corners[i], 3 * corners[i + 1], 3 * corners[i + 2]);
  const sums = smoothed(own, positions, corners);
  const normals = new Int16Array(positions.length / 3 * 4);
  for (let v = 0; v < open.length; ++v) {
    const x = sums[3 * v], y = sums[3 * v + 1], z = sums[3 * v + 2];
    const length = Math.hypot(x, y, z);
    const times = length > 0 ? 32767 / length : 0;
    normals[4 * v] = Math.round(x * times);
    normals[4 * v + 1] = Math.round(y * times);
    normals[4 * v + 2] = length > 0 ? Math.round(z * times) : 32767;
    normals[4 * v + 3] = Math.round(32767 * open[v]);
  }
  return normals;
}

/**
 * Sums around each vertex the directions of `own`, which become of length 1: a peak of one vertex, or a sliver, is no dark spot then.
 * Large triangles count more, by their roots: across a plain they are as level as it is, whatever the slopes at its rim.
 */
function smoothed(own: Float32Array, p: Float32Array, corners: Uint32Array): Float32Array {
  for (let at = 0; at < own.length; at += 3) {
    const times = 1 / (Math.hypot(own[at], own[at + 1], own[at + 2]) || 1);
    for (let k = 0; k < 3; ++k) own[at + k] *= times;
  }
  const sums = new Float32Array(own.length);
  for (let i = 0; i < corners.length; i += 3) {
    const a = 3 * corners[i], b = 3 * corners[i + 1], c = 3 * corners[i + 2];
    const area = (p[b] - p[a]) * (p[c + 1] - p[a + 1]) - (p[b + 1] - p[a + 1]) * (p[c] - p[a]);
    const size = Math.sqrt(Math.max(area, 0));
    for (let k = 0; k < 3; ++k) {
      const all = (own[a + k] + own[b + k] + own[c + k]) * size;
      sums[a + k] += all;
      sums[b + k] += all;
      sums[c + k] += all;
    }
  }
  return sums;
}

/** Adds a triangle's normal to those of its corners, by its angle there: long slivers do not outweigh what is beside them. */
function addNormal(p: Float32Array, sums: Float32Array, a: number, b: number, c: number): void {
  const ux = p[b] - p[a], uy = p[b + 1] - p[a + 1], uz = p[b + 2] - p[a + 2];
  const vx = p[c] - p[a], vy = p[c + 1] - p[a + 1], vz = p[c + 2] - p[a + 2];
  const wx = p[c] - p[b], wy = p[c + 1] - p[b + 1], wz = p[c + 2] - p[b + 2];
  const x = uy * vz - uz * vy, y = uz * vx - ux * vz, z = ux * vy - uy * vx;
  const area = Math.sqrt(x * x + y * y + z * z);
  if (!(area > 0)) return;
  const first = Math.atan2(area, ux * vx + uy * vy + uz * vz), second = Math.atan2(area, -ux * wx - uy * wy - uz * wz);
  for (let k = 0; k < 3; ++k) {
    const at = k === 0 ? a : k === 1 ? b : c;
    const angle = (k === 0 ? first : k === 1 ? second : Math.PI - first - second) / area;
    sums[at] += angle * x;
    sums[at + 1] += angle * y;
    sums[at + 2] += angle * z;
  }
}

/** Walls along every edge that has a triangle on one side alone. */
function drawnWalls({ triangles, triangleCount }: MeshView, positions: Float32Array): { walls: Float32Array; wallNormals: Int16Array } {
  const edges: number[] = [];
  for (let t = 0, at = 0; t < triangleCount; ++t, at += triangleWords) {
    for (let k = 0; k < 3; ++k) {
      if (triangles[at + 3 + k] === none) edges.push(triangles[at + (k + 1) % 3], triangles[at + (k + 2) % 3]);
    }
  }
  const walls = new Float32Array(8 * edges.length), wallNormals = new Int16Array(4 * edges.length);
  for (let e = 0; e < edges.length; e += 2) {
    const [a, b] = [3 * edges[e], 3 * edges[e + 1]];
    const east = positions[b] - positions[a], north = positions[b + 1] - positions[a + 1];
    const times = 32767 / (Math.hypot(east, north) || 1);
    for (const [i, v, foot] of [[0, a, 0], [1, b, 0], [2, a, 1], [3, b, 1]] as const) {
      walls.set([positions[v], positions[v + 1], positions[v + 2], foot], 8 * e + 4 * i);
      wallNormals.set([Math.round(north * times), Math.round(-east * times)], 4 * e + 2 * i);
    }
  }
  return { walls, wallNormals };
}

/** Every edge of some triangles once, as two vertices. Cost: linear. */
export function edgesOf(corners: Uint32Array, vertexCount: number): Uint32Array {
  const least = (i: number): [low: number, high: number] => {
    const a = corners[i], b = corners[i % 3 === 2 ? i - 2 : i + 1];
    return a < b ? [a, b] : [b, a];
  };
  const starts = new Uint32Array(vertexCount + 1);
  for (let i = 0; i < corners.length; ++i) ++starts[least(i)[0] + 1];
  for (let v = 0; v < vertexCount; ++v) starts[v + 1] += starts[v];
  const ends = starts.slice(), others = new Uint32Array(corners.length), edges = new Uint32Array(2 * corners.length);
  let count = 0;
  for (let i = 0; i < corners.length; ++i) {
    const [low, high] = least(i);
    const known = others.subarray(starts[low], ends[low]);
    if (known.includes(high)) continue;
    others[ends[low]++] = high;
    edges[count++] = low;
    edges[count++] = high;
  }
  return edges.slice(0, count);
}
