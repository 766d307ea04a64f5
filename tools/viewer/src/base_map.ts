// SPDX-License-Identifier: GPL-3.0-or-later
//
// A map of somebody else over the terrain: asks for the tiles that the picture wants, a few at once, and keeps a bounded number of them
// on the card. This file is fetched when the user turns the map on; before that nobody is asked for anything.
import type { BaseMap as Told } from 'ptin-decoder';
import { mapText } from './map_shader';
import { nameOf, type Tile, type TileSight, treeOf, wantedTiles } from './map_tiles';
import type { DrawnMap } from './relief';
import type { TileGrid } from './tile_grid';
import { TileTextures } from './tile_textures';

/** Requests at once, as browsers have to a host. */
const atOnce = 6;
/** Milliseconds after which a tile is given up. */
const patience = 20000;
/** A map of which so many tiles fail and none arrives is given up; a level, likewise. */
const enoughFailed = 4;
/** Bytes of the tiles' pictures. */
const mostBytes = 32 << 20;

export interface MapEvents {
  /** There is another picture to draw. */
  drawn(map: DrawnMap | null): void;
  /** Something is wrong, which is told once. */
  failed(what: string): void;
}

/** The address of a tile. Columns go around the Earth. */
export function addressOfTile(template: string, grid: Pick<TileGrid, 'level' | 'column' | 'row'>, { up, column, row }: Tile): string {
  const z = grid.level + up, times = 2 ** up, around = 2 ** z;
  const x = (((grid.column * times + column) % around) + around) % around, y = grid.row * times + row;
  return template.replace(/\{(z|TileMatrix)\}/g, String(z)).replace(/\{(x|TileCol)\}/g, String(x)).replace(/\{(y|TileRow)\}/g, String(y));
}

export class BaseMap {
  private readonly host: string;
  private textures: TileTextures | null = null;
  /** Layers of the tiles on the card; those that were wanted last come last. */
  private readonly layers = new Map<string, number>();
  private readonly loading = new Map<string, AbortController>();
  private readonly failed = new Set<string>();
  /** Tiles of each level that failed and that arrived. */
  private readonly counts = new Map<number, [failed: number, arrived: number]>();
  private wanted: Tile[] = [];
  private finest = Infinity;
  private side = 256;
  private isOver = false;
  private hasTold = false;
  /** Why the last tile failed; empty: none did. */
  private why = '';

  constructor(
    private readonly gl: WebGL2RenderingContext, private readonly grid: TileGrid, private readonly told: Told, private readonly events: MapEvents,
  ) {
    this.host = new URL(told.tiles).host;
  }

  private get mostLayers(): number { return mostBytes / (4 * this.side * this.side); }

  /** Asks for what a picture lacks. */
  follow(sight: TileSight): void {
    if (this.isOver) return;
    this.wanted = wantedTiles(this.grid, sight, this.side, this.mostLayers, this.finest);
    const names = new Set(this.wanted.map(nameOf));
    for (const [name, request] of this.loading) if (!names.has(name)) request.abort();
    for (const name of names) {
      const layer = this.layers.get(name);
      if (layer === undefined) continue;
      this.layers.delete(name);
      this.layers.set(name, layer);
    }
    this.askOn();
  }

  /** Lets go of all. */
  close(): void {
    this.isOver = true;
    for (const request of this.loading.values()) request.abort();
    this.textures?.free();
    this.textures = null;
    this.events.drawn(null);
  }

  private askOn(): void {
    for (const tile of this.wanted) {
      if (this.isOver || this.loading.size >= atOnce) return;
      const name = nameOf(tile);
      if (!this.layers.has(name) && !this.loading.has(name) && !this.failed.has(name) && this.grid.level + tile.up <= this.finest) void this.load(tile);
    }
  }

  private async load(tile: Tile): Promise<void> {
    const name = nameOf(tile);
    const request = new AbortController();
    let isLate = false;
    const timer = setTimeout(() => { isLate = true; request.abort(); }, patience);
    this.loading.set(name, request);
    try {
      // A tile that its host does not give to other pages is none, so what is drawn with it may always be saved.
      const response = await fetch(addressOfTile(this.told.tiles, this.grid, tile), { mode: 'cors', credentials: 'omit', signal: request.signal });
      if (!response.ok) throw new Error(`status ${response.status}`);
      const picture = await createImageBitmap(await response.blob(), { premultiplyAlpha: 'none', colorSpaceConversion: 'none' });
      if (!this.isOver && !request.signal.aborted) this.take(tile, picture);
      picture.close();
    } catch (error) {
      // Whoever has no need of a tile any more has ended its request.
      if (!this.isOver && (!request.signal.aborted || isLate)) {
        this.fail(tile, isLate ? `no answer in ${patience / 1000} s` : error instanceof TypeError ? 'not reachable, or not for other pages (CORS)' : (error as Error).message);
      }
    } finally {
      clearTimeout(timer);
      this.loading.delete(name);
    }
    this.askOn();
  }

  private take(tile: Tile, picture: ImageBitmap): void {
    const { width, height } = picture;
    if (width !== height || (width !== 256 && width !== 512)) throw new Error(`tiles of ${width} by ${height} pixels instead of 256 or 512`);
    if (this.textures === null) {
      this.side = width;
      this.textures = new TileTextures(this.gl, width, this.mostLayers);
    }
    if (width !== this.side) throw new Error('tiles of several sizes');
    this.count(tile)[1]++;
    this.textures.put(this.freeLayer(tile), picture);
    this.textures.setTree(treeOf(this.layers));
    this.tellMissing();
    this.events.drawn({ uniforms: this.grid.uniforms, shader: mapText, samplers: TileTextures.samplers });
  }

  /** A layer for a tile: one that is free, or that of the tile which was not wanted for longest. */
  private freeLayer(tile: Tile): number {
    let layer = this.layers.size;
    if (layer >= this.mostLayers) {
      const [oldest] = this.layers.keys();
      layer = this.layers.get(oldest)!;
      this.layers.delete(oldest);
    }
    this.layers.set(nameOf(tile), layer);
    return layer;
  }

  private count({ up }: Tile): [failed: number, arrived: number] {
    let count = this.counts.get(up);
    if (count === undefined) this.counts.set(up, count = [0, 0]);
    return count;
  }

  private fail(tile: Tile, why: string): void {
    this.failed.add(nameOf(tile));
    const count = this.count(tile);
    count[0]++;
    const isBarren = count[0] >= enoughFailed && count[1] === 0;
    const hasCoarsest = this.wanted.some((t) => t.up === 0 && !this.failed.has(nameOf(t)));
    if (this.layers.size === 0 && !hasCoarsest && this.failed.size >= Math.min(enoughFailed, this.wanted.length)) {
      this.isOver = true;
      this.events.failed(`The map of ${this.host} cannot be had: ${why}`);
      return;
    }
    // The map ends above this level.
    if (isBarren) this.finest = Math.min(this.finest, this.grid.level + tile.up - 1);
    this.why = why;
    this.tellMissing();
  }

  /** Tells once that some tiles failed, when there are others. */
  private tellMissing(): void {
    if (this.hasTold || this.why === '' || this.layers.size === 0) return;
    this.hasTold = true;
    this.events.failed(`Some tiles of ${this.host} are missing, coarser ones stand for them: ${this.why}`);
  }
}
