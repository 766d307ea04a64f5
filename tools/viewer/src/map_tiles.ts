// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which tiles of a base map a picture wants: finer where it is near, a bounded number of them.
import { type TileGrid, type Pair } from './tile_grid';

/** A tile by its level above the grid's, and its column and row there; it lies below the grid's four. */
export interface Tile {
  up: number;
  column: number;
  row: number;
}

/** How the camera sees tiles. */
export interface TileSight {
  /** Whether a rectangle of the scene may be in the picture. */
  mayMeet(west: number, south: number, east: number, north: number): boolean;
  /** Pixels of the picture that a metre has where the rectangle is nearest. */
  sharpness(west: number, south: number, east: number, north: number): number;
}

/** Pixels of the picture that a pixel of a tile may be large. */
const mostPixels = 1.4;
/** The finest that most maps have. */
const finestLevel = 19;

interface Seen extends Tile {
  /** Pixels of the picture for one of the tile. */
  pixels: number;
}

export const nameOf = ({ up, column, row }: Tile): string => `${up}/${column}/${row}`;

/**
 * The tiles, each behind the one that holds it.
 * @param side    Pixels of a tile.
 * @param most    So many at most.
 * @param finest  No level beyond it.
 */
export function wantedTiles(grid: TileGrid, sight: TileSight, side: number, most: number, finest: number): Tile[] {
  const last = Math.min(finestLevel, finest, grid.finest);
  const seenAt = (up: number, column: number, row: number): Seen | null => {
    const size = 2 ** -up;
    const clamp = (v: number, axis: 0 | 1): number => Math.max(grid.least[axis], Math.min(grid.most[axis], v));
    const ends: Pair[] = [[clamp(column * size, 0), clamp(row * size, 1)], [clamp((column + 1) * size, 0), clamp((row + 1) * size, 1)]];
    const level = grid.level + up, worldRow = grid.row * 2 ** up + row;
    if (!(ends[1][0] > ends[0][0] && ends[1][1] > ends[0][1]) || worldRow < 0 || worldRow >= 2 ** level) return null;
    const corners = [0, 1, 2, 3].map((k) => grid.placeOf([ends[k & 1][0], ends[k >> 1][1]]));
    const xs = corners.map(([x]) => x), ys = corners.map(([, y]) => y);
    const box = [Math.min(...xs), Math.min(...ys), Math.max(...xs), Math.max(...ys)] as const;
    if (!sight.mayMeet(...box)) return null;
    const metres = (box[2] - box[0]) / ((ends[1][0] - ends[0][0]) / size) / side;
    return { up, column, row, pixels: metres * sight.sharpness(...box) };
  };
  const kept: Tile[] = [];
  const open: Seen[] = [];
  const add = (up: number, column: number, row: number): void => {
    for (const [i, j] of [[0, 0], [1, 0], [0, 1], [1, 1]]) {
      const found = seenAt(up, column + i, row + j);
      if (found === null) continue;
      kept.push({ up, column: found.column, row: found.row });
      open.push(found);
    }
  };
  add(0, 0, 0);
  while (open.length !== 0 && kept.length + 4 <= most) {
    const next = open.reduce((a, b) => (b.pixels > a.pixels ? b : a));
    if (next.pixels <= mostPixels) break;
    open.splice(open.indexOf(next), 1);
    if (grid.level + next.up < last) add(next.up + 1, 2 * next.column, 2 * next.row);
  }
  return kept;
}

/** Entries of a row of the tree: a card takes 2048 at least, and a few tiles deep down in parts of their own need more than that. */
export const treeRow = 256;

/**
 * The tree that the shader goes down, in whole rows: for each tile the layer of its picture plus one, or 0, and where its four parts
 * begin, or 0. The first four entries are the grid's.
 */
export function treeOf(layers: ReadonlyMap<string, number>): Uint16Array {
  const nodes: Array<[layer: number, parts: number]> = [[0, 0], [0, 0], [0, 0], [0, 0]];
  const entryOf = ({ up, column, row }: Tile): number => {
    const place = (column & 1) + 2 * (row & 1);
    if (up === 0) return place;
    const above = nodes[entryOf({ up: up - 1, column: column >> 1, row: row >> 1 })];
    if (above[1] === 0) {
      above[1] = nodes.length;
      nodes.push([0, 0], [0, 0], [0, 0], [0, 0]);
    }
    return above[1] + place;
  };
  for (const [name, layer] of layers) {
    const [up, column, row] = name.split('/').map(Number);
    nodes[entryOf({ up, column, row })][0] = layer + 1;
  }
  const tree = new Uint16Array(2 * treeRow * Math.ceil(nodes.length / treeRow));
  tree.set(nodes.flat());
  return tree;
}
