// SPDX-License-Identifier: GPL-3.0-or-later
//
// Directions and places in the scene, and the camera's matrix: x to the east, y to the north, z up.

export type Triple = readonly [x: number, y: number, z: number];

export const sum = (a: Triple, b: Triple, times = 1): Triple => [a[0] + times * b[0], a[1] + times * b[1], a[2] + times * b[2]];
export const difference = (a: Triple, b: Triple): Triple => sum(a, b, -1);
export const dot = (a: Triple, b: Triple): number => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const lengthOf = (a: Triple): number => Math.hypot(...a);

/** Turned around an axis of length 1 by an angle, counter-clockwise as seen against the axis. */
export function turnedAround(v: Triple, axis: Triple, radians: number): Triple {
  const cosine = Math.cos(radians), sine = Math.sin(radians);
  const [x, y, z] = v, [a, b, c] = axis;
  const along = dot(v, axis) * (1 - cosine);
  return [
    x * cosine + (b * z - c * y) * sine + a * along, y * cosine + (c * x - a * z) * sine + b * along,
    z * cosine + (a * y - b * x) * sine + c * along,
  ];
}

/** A camera that stands upright: where it is, where it looks, what it sees. */
export class Camera {
  position: Triple = [0, 0, 1];
  /** Radians: clockwise from north, and from straight down. */
  heading = 0;
  tilt = 0;
  /** The picture, in pixels of the page. */
  width = 1;
  height = 1;
  near = 1;
  far = 1e6;

  get aspect(): number { return this.width / Math.max(1, this.height); }

  /** Half the picture's height at a distance of 1: of a tall picture more, whose width would show little. */
  get halfHeight(): number { return Math.tan(21 * Math.PI / 180) * Math.min(1.6, Math.max(1, 1 / this.aspect)); }

  get forward(): Triple {
    const sine = Math.sin(this.tilt);
    return [Math.sin(this.heading) * sine, Math.cos(this.heading) * sine, -Math.cos(this.tilt)];
  }
  get right(): Triple { return [Math.cos(this.heading), -Math.sin(this.heading), 0]; }
  get up(): Triple {
    const cosine = Math.cos(this.tilt);
    return [Math.sin(this.heading) * cosine, Math.cos(this.heading) * cosine, Math.sin(this.tilt)];
  }

  /** From a place of the scene to the picture, by columns: x and y from -1 to 1 after the division by w. */
  get matrix(): Float64Array {
    const { right, up, forward, position, halfHeight, near, far } = this;
    const wide = 1 / (halfHeight * this.aspect), high = 1 / halfHeight;
    const deep = (far + near) / (far - near), shift = -2 * far * near / (far - near);
    const m = new Float64Array(16);
    for (let i = 0; i < 3; ++i) m.set([wide * right[i], high * up[i], deep * forward[i], forward[i]], 4 * i);
    m.set([-wide * dot(right, position), -high * dot(up, position), shift - deep * dot(forward, position), -dot(forward, position)], 12);
    return m;
  }

  /** The direction, of length 1, of what is seen at a point of the picture: -1 to 1, to the right and up. */
  ray(x: number, y: number): Triple {
    const { halfHeight } = this;
    const way = sum(sum(this.forward, this.right, x * halfHeight * this.aspect), this.up, y * halfHeight);
    return sum([0, 0, 0], way, 1 / lengthOf(way));
  }

  /** Where a place is in the picture; null behind the camera. */
  project(place: Triple): { x: number; y: number } | null {
    const way = difference(place, this.position);
    const depth = dot(way, this.forward);
    if (depth <= this.near) return null;
    const { halfHeight } = this;
    return { x: dot(way, this.right) / (depth * halfHeight * this.aspect), y: dot(way, this.up) / (depth * halfHeight) };
  }

  /**
   * Whether a box, whose z is drawn so many times as high, may be in the picture as the camera stands now: it is not wholly beyond one
   * of its sides.
   */
  sight(exaggeration: number): (least: Triple, most: Triple) => boolean {
    const m = this.matrix;
    // Inside is where x a + y b + z c + d is not negative; of a box the corner counts for which this is most.
    const sides = [0, 1, 2].flatMap((axis) => [-1, 1].map((side) => {
      const [a, b, c, d] = [0, 1, 2, 3].map((i) => side * m[4 * i + axis] + m[4 * i + 3]);
      return { a, b, c: c * exaggeration, d };
    }));
    return (least, most) => sides.every(({ a, b, c, d }) =>
      Math.max(a * least[0], a * most[0]) + Math.max(b * least[1], b * most[1]) + Math.max(c * least[2], c * most[2]) + d >= 0);
  }
}
