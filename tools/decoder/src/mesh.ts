// SPDX-License-Identifier: GPL-3.0-or-later
//
// A mesh as both modules hold it in memory (wasm/module.cc): arrays of numbers, positions on a grid.
import type { ModuleExports } from './module.js';

/** Words of a vertex: x, y on the grid, bits of the height, a triangle. */
export const vertexWords = 4;
/** Words of a triangle: its corners, counter-clockwise, then across from each its neighbour, or `none`. */
export const triangleWords = 6;
export const none = 0xffffffff;

export interface MeshExports extends ModuleExports {
  vertexCount(): number;
  vertices(): number;
  hasHeight(): number;
  triangleCount(): number;
  triangles(): number;
  classes(): number;
  storeFacts(): number;
  storeFactsBytes(): number;
}

/** The mesh where it lies in the memory of an instance: valid until the instance takes more. */
export interface MeshView {
  vertexCount: number;
  triangleCount: number;
  /** `vertexWords` a vertex; positions are signed. */
  vertices: Int32Array;
  hasHeight: Uint8Array;
  /** `triangleWords` a triangle. */
  triangles: Uint32Array;
  /** 1: void. */
  classes: Uint8Array;
  /** The engine's facts of the terrain (storage/store_facts.h), which nobody reads here. */
  facts: Uint8Array;
}

export function meshIn(wasm: MeshExports): MeshView {
  const { buffer } = wasm.memory;
  const vertexCount = wasm.vertexCount(), triangleCount = wasm.triangleCount();
  return {
    vertexCount, triangleCount,
    vertices: new Int32Array(buffer, wasm.vertices(), vertexCount * vertexWords),
    hasHeight: new Uint8Array(buffer, wasm.hasHeight(), vertexCount),
    triangles: new Uint32Array(buffer, wasm.triangles(), triangleCount * triangleWords),
    classes: new Uint8Array(buffer, wasm.classes(), triangleCount),
    facts: new Uint8Array(buffer, wasm.storeFacts(), wasm.storeFactsBytes()),
  };
}
