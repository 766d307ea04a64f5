// SPDX-License-Identifier: GPL-3.0-or-later
//
// The base map that a terrain offers: shown and taken away as its user wants, and followed by the camera. The map's own file is
// fetched when it is first shown.
import type { BaseMap as Told } from 'ptin-decoder';
import type { BaseMap } from './base_map';
import type { Frame } from './frame';
import { toast } from './page';
import type { Panel } from './panel';
import type { Relief } from './relief';
import { TileGrid } from './tile_grid';
import type { View } from './view';

/** Milliseconds between a picture and a look at what tiles it lacks: while the camera moves, each picture wants others. */
const pause = 150;

export class OfferedMap {
  private offered: { told: Told; grid: TileGrid; frame: Frame } | null = null;
  private map: BaseMap | null = null;
  private isShown = false;
  private timer = 0;

  constructor(private readonly relief: Relief, private readonly view: View, private readonly panel: Panel) {}

  get isThere(): boolean { return this.offered !== null; }

  /** The map of a terrain, or why it can have none. */
  offer(told: Told, frame: Frame): void {
    const grid = TileGrid.of(frame);
    this.offered = grid === null ? null : { told, grid, frame };
    this.panel.offerMap(grid !== null ? ''
      : frame.lonLatAt({ x: frame.middleX, y: frame.middleY }) === null ? 'No map: nobody tells where on Earth this terrain is.'
      : 'No map: Web Mercator ends at 85 degrees of latitude.');
  }

  /** Shows the map or takes it away; only while it is shown its host is asked. */
  async show(isShown: boolean): Promise<void> {
    const { offered } = this;
    if (!isShown || offered === null) {
      this.map?.close();
      if (this.isShown) this.panel.showMap('', '');
      this.map = null;
      this.isShown = false;
      return;
    }
    if (this.isShown) return;
    this.isShown = true;
    const credit = offered.told.attribution || new URL(offered.told.tiles).host;
    const failed = (what: string): void => {
      this.panel.showMap(credit, what);
      toast(what);
    };
    this.panel.showMap(credit, '');
    try {
      const made = await import('./base_map');
      if (!this.isShown || this.map !== null) return;
      this.map = new made.BaseMap(this.relief.gl, offered.grid, offered.told, { drawn: (drawn) => { this.relief.baseMap = drawn; }, failed });
      this.relief.draw();
    } catch {
      failed('base_map.js cannot be had');
    }
  }

  /** Some time after a picture: what tiles it lacks. */
  follow(): void {
    if (this.map === null || this.timer !== 0) return;
    this.timer = window.setTimeout(() => {
      this.timer = 0;
      this.followNow();
    }, pause);
  }

  private followNow(): void {
    const { relief, view, offered } = this;
    if (offered === null) return;
    const top = offered.frame.relief, mayMeet = relief.camera.sight(view.exaggeration);
    const pixels = relief.canvas.clientHeight * Math.min(devicePixelRatio, 2);
    this.map?.follow({
      mayMeet: (west, south, east, north) => mayMeet([west, south, 0], [east, north, top]),
      sharpness: (west, south, east, north) => {
        const [cameraX, cameraY] = relief.camera.position;
        const x = Math.max(west, Math.min(east, cameraX)), y = Math.max(south, Math.min(north, cameraY));
        const distance = view.distanceTo({ x, y, z: relief.groundAt(x, y) ?? 0 });
        return 1 / view.metresPerPixel(Math.max(view.leastDistance, distance), pixels);
      },
    });
  }
}
