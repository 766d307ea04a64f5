// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where things are: on the grid (whole numbers, exact), on the map (the file's CRS), and in the scene: metres around the
// middle of the terrain, so that 32 bits of a GPU are enough anywhere on Earth. The scene is for pictures: it has one scale for
// the whole terrain. Lengths that the page tells come from the engine.
import type { Facts, LonLatNodes, MapPosition, Units, Window } from 'ptin-decoder';
import { boundsOf, onMap } from 'ptin-decoder/values';
import { type Earth, scaleAt } from './earth';
import { coordinates } from './format';

export class Frame {
  /** The middle of the terrain, on the map. */
  readonly middleX: number;
  readonly middleY: number;
  /** Metres in the scene for a unit of the map, and of a height. */
  readonly scaleX: number;
  readonly scaleY: number;
  readonly scaleZ: number;
  /** The unit of heights that nobody told is what it is taken for. */
  readonly units: Units;
  /** The height that lies at z = 0. */
  readonly baseHeight: number;
  readonly isDegrees: boolean;

  /** @param lonLat  Degrees over a terrain that has none itself, for people. */
  constructor(readonly facts: Facts, units: Units, readonly earth: Earth, private readonly lonLat: LonLatNodes | null = null) {
    this.units = units.height === 'unknown' && earth.metresPerHeight !== 1 ? { ...units, height: units.horizontal } : units;
    const f = facts;
    ({ x: this.middleX, y: this.middleY } = onMap(f, (f.minX + f.maxX) / 2, (f.minY + f.maxY) / 2));
    this.isDegrees = earth.isDegrees;
    // The scale of its middle parallel.
    const [x, y] = scaleAt(earth, this.middleY);
    this.scaleX = Math.max(x, 0.01 * y);
    this.scaleY = y;
    this.scaleZ = earth.metresPerHeight;
    this.baseHeight = f.minHeight <= f.maxHeight ? f.minHeight : 0;
  }

  /** The whole terrain on the map. */
  get bounds(): Window { return boundsOf(this.facts); }

  /** Extents of the terrain in the scene. */
  get width(): number { return (this.facts.maxX - this.facts.minX) * this.facts.stepX * this.scaleX; }
  get depth(): number { return (this.facts.maxY - this.facts.minY) * this.facts.stepY * this.scaleY; }
  get relief(): number { return Math.max(0, this.facts.maxHeight - this.facts.minHeight) * this.scaleZ; }

  /** A place for people: in the terrain's CRS, and in degrees where they are told. */
  where({ x, y }: MapPosition): string {
    const place = coordinates(x, y, this.isDegrees);
    const { lonLat } = this;
    const degrees = lonLat === null ? null : this.lonLatAt({ x, y });
    if (lonLat === null || degrees === null) return place;
    const [lon, lat] = degrees;
    const places = Math.min(5, Math.floor(-Math.log10(2 * lonLat.within)));
    return `${place}\n${coordinates(lon - 360 * Math.round(lon / 360), lat, true, places)}`;
  }

  /** Longitude, beyond 180 too, and latitude of a place on the map; null where nobody tells them. */
  lonLatAt({ x, y }: MapPosition): [lon: number, lat: number] | null {
    if (this.isDegrees) return [x, y];
    const { lonLat, bounds: [west, south, east, north] } = this;
    if (lonLat === null || !(east > west && north > south)) return null;
    const across = sharesOfNodes((x - west) / (east - west)), up = sharesOfNodes((y - south) / (north - south));
    let lon = 0, lat = 0;
    lonLat.nodes.forEach((node, i) => {
      const share = across[i % 4] * up[i >> 2];
      lon += share * node[0];
      lat += share * node[1];
    });
    return [lon, lat];
  }

  /** By how much they may be off, degrees. */
  get lonLatWithin(): number { return this.lonLat?.within ?? 0; }

  sceneX(mapX: number): number { return (mapX - this.middleX) * this.scaleX; }
  sceneY(mapY: number): number { return (mapY - this.middleY) * this.scaleY; }
  sceneZ(height: number): number { return (height - this.baseHeight) * this.scaleZ; }
  mapX(sceneX: number): number { return this.middleX + sceneX / this.scaleX; }
  mapY(sceneY: number): number { return this.middleY + sceneY / this.scaleY; }
  heightAt(sceneZ: number): number { return this.baseHeight + sceneZ / this.scaleZ; }
}

/** The weight of each of four nodes at a share of the way from the first to the last. */
function sharesOfNodes(at: number): number[] {
  const t = 3 * at;
  return [(1 - t) * (t - 2) * (t - 3) / 6, t * (t - 2) * (t - 3) / 2, t * (1 - t) * (t - 3) / 2, t * (t - 1) * (t - 2) / 6];
}
