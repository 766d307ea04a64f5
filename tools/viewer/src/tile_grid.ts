// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where the tiles of Web Mercator lie in the scene. Places are told in columns and rows of the level at which two by two tiles hold the
// terrain, counted from the upper left one of these.
import type { Frame } from './frame';

const radians = Math.PI / 180;
/** Where Web Mercator ends. */
export const mostLatitude = 85.05;
/** The coarsest tiles are none finer: of the finest maps. */
const finestRoot = 18;
/** From values at -1, -1/3, 1/3 and 1 the factors of 1, s, s^2 and s^3. */
const factorsOf = [[-1, 9, 9, -1], [1, -27, 27, -1], [9, -9, -9, 9], [-9, 27, -27, 9]].map((row) => row.map((n) => n / 16));

export type Pair = readonly [number, number];

/** Metres of a pixel of a tile of 256 at level 0, at the equator. */
const coarsestPixel = 2 * Math.PI * 6378137 / 256;

/** A place of Web Mercator, 0 to 1 from the upper left of the world. */
function mercator([lon, lat]: Pair): Pair {
  const sine = Math.sin(lat * radians);
  return [lon / 360 + 0.5, 0.5 - Math.atanh(sine) / (2 * Math.PI)];
}

export class TileGrid {
  readonly level: number;
  /** The upper left tile; columns go on beyond those that there are, around the Earth. */
  readonly column: number;
  readonly row: number;
  /** The terrain's extent. */
  readonly least: Pair;
  readonly most: Pair;
  /** Finer tiles would show more than the places of the terrain are good for. */
  readonly finest: number;

  private constructor(private readonly frame: Frame) {
    const places: Pair[] = [];
    for (let i = 0; i <= 8; ++i) {
      for (let j = 0; j <= 8; ++j) {
        const [lon, lat] = this.degrees((i / 8 - 0.5) * frame.width, (j / 8 - 0.5) * frame.depth);
        places.push(mercator([lon, Math.max(-mostLatitude, Math.min(mostLatitude, lat))]));
      }
    }
    const end = (axis: 0 | 1, of: (...all: number[]) => number): number => of(...places.map((p) => p[axis]));
    const least: Pair = [end(0, Math.min), end(1, Math.min)], most: Pair = [end(0, Math.max), end(1, Math.max)];
    const span = Math.max(most[0] - least[0], most[1] - least[1]);
    this.level = Math.max(0, Math.min(finestRoot, Math.floor(-Math.log2(span))));
    this.column = Math.floor(least[0] * 2 ** this.level);
    this.row = Math.floor(least[1] * 2 ** this.level);
    [this.least, this.most] = [this.fromWorld(least), this.fromWorld(most)];
    this.finest = frame.lonLatWithin > 0 ? Math.floor(Math.log2(coarsestPixel / (111195 * frame.lonLatWithin))) : Infinity;
  }

  /** Null where the terrain has no place on Earth, or none that Web Mercator has. */
  static of(frame: Frame): TileGrid | null {
    const [, south, , north] = frame.bounds;
    const corners = [south, north].map((y) => frame.lonLatAt({ x: frame.middleX, y }));
    if (!corners.some((c) => c !== null && Math.abs(c[1]) < mostLatitude) || !(frame.width > 0 && frame.depth > 0)) return null;
    return new TileGrid(frame);
  }

  private degrees(x: number, y: number): Pair {
    const { frame } = this;
    return frame.lonLatAt({ x: frame.mapX(x), y: frame.mapY(y) })!;
  }

  private fromWorld([across, down]: Pair): Pair {
    const times = 2 ** this.level;
    return [across * times - this.column, down * times - this.row];
  }

  /** Column and row of a place of the scene. */
  at(x: number, y: number): Pair { return this.fromWorld(mercator(this.degrees(x, y))); }

  /** The place of the scene at a column and row, in the terrain or beside it: by steps of Newton's. */
  placeOf([across, down]: Pair): Pair {
    const { frame, least, most } = this;
    const step = 1e-3;
    let x = ((across - least[0]) / (most[0] - least[0]) - 0.5) * frame.width, y = (0.5 - (down - least[1]) / (most[1] - least[1])) * frame.depth;
    for (let times = 0; times < 4; ++times) {
      const here = this.at(x, y), east = this.at(x + step * frame.width, y), north = this.at(x, y + step * frame.depth);
      const a = east[0] - here[0], b = north[0] - here[0], c = east[1] - here[1], d = north[1] - here[1];
      const [du, dv, det] = [across - here[0], down - here[1], a * d - b * c];
      if (det === 0) break;
      x += step * frame.width * (du * d - dv * b) / det;
      y += step * frame.depth * (dv * a - du * c) / det;
    }
    return [x, y];
  }

  /**
   * Numbers by which the shader finds columns and rows (map_shader): degrees as a polynomial, in radians beside those of the middle, since
   * 32 bits hold no degrees; Mercator's ordinate beside the middle's, too.
   */
  get uniforms(): Record<string, readonly number[]> {
    const { frame } = this;
    const middle = this.degrees(0, 0);
    const at = [-1, -1 / 3, 1 / 3, 1];
    const nodes = at.map((t) => at.map((s) => this.degrees(s * frame.width / 2, t * frame.depth / 2)));
    const factors = (axis: 0 | 1): number[] => factorsOf.flatMap((up) => factorsOf.map((across) => {
      let sum = 0;
      up.forEach((u, j) => { across.forEach((a, i) => { sum += u * a * (nodes[j][i][axis] - middle[axis]); }); });
      return sum * radians;
    }));
    const latitude = middle[1] * radians;
    const [across, down] = this.at(0, 0);
    return {
      lonOf: factors(0), latOf: factors(1), mapMiddle: [across, down, frame.width / 2, frame.depth / 2],
      mapTurn: [2 ** this.level / (2 * Math.PI), latitude, Math.sin(latitude)],
    };
  }
}
