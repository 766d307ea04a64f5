// SPDX-License-Identifier: GPL-3.0-or-later
//
// Points, lines and bodies over the relief.
import { Program, Vertices } from './gl';
import { lineFragment, lineVertex, markFragment, ribbonVertex } from './shaders';

export interface Place {
  x: number;
  y: number;
  z: number;
}

/** The camera as all that is drawn has it: the uniforms of shaders.ts's `seenFrom`. */
export type Seen = { matrix: Float64Array; eye: readonly number[]; exaggeration: number };

interface Mark {
  vertices: Vertices;
  program: Program;
  mode: number;
  colour: readonly number[];
  /** Pixels of the page. */
  size: number;
  /** The share of the way to the eye by which it is moved there, so that the ground does not hide it. */
  lift: number;
  /** The ground hides it. */
  isHidden: boolean;
  order: number;
}

export class Marks {
  private all: Mark[] = [];
  /** How each of them was made, since a card may lose them. */
  private makers: Array<() => void> = [];
  private made: Record<'line' | 'point' | 'ribbon', Program> | null = null;

  constructor(private readonly gl: WebGL2RenderingContext) {}

  /** Made with the first mark, for which the first picture need not wait. */
  private get programs(): Record<'line' | 'point' | 'ribbon', Program> {
    const { gl } = this;
    return this.made ??= {
      line: new Program(gl, lineVertex, lineFragment), point: new Program(gl, lineVertex, markFragment),
      ribbon: new Program(gl, ribbonVertex, lineFragment),
    };
  }

  clear(): void {
    for (const vertices of new Set(this.all.map((mark) => mark.vertices))) vertices.free();
    this.all = [];
    this.makers = [];
  }

  /** Makes all anew on a card that lost them. */
  restore(): void {
    const { makers } = this;
    this.made = null;
    this.all = [];
    this.makers = [];
    for (const make of makers) make();
  }

  /** `colour`: as CSS has it; `size`: pixels of the page. */
  addPoint(place: Place, colour: string, size: number): void {
    const { gl } = this;
    this.makers.push(() => { this.addPoint(place, colour, size); });
    const vertices = new Vertices(gl, [{ at: 0, numbers: numbersOf([place]), size: 3 }], null);
    this.add({ vertices, program: this.programs.point, mode: gl.POINTS, colour: pageColour(colour, 1), size, lift: 0.005, isHidden: false, order: 3 });
  }

  /** A line through places, which is seen through the terrain, faintly. */
  addLine(places: readonly Place[], colour: string): void {
    const { gl } = this;
    this.makers.push(() => { this.addLine(places, colour); });
    const common = { vertices: ribbonOf(gl, places), program: this.programs.ribbon, mode: gl.TRIANGLES, size: 2.6 };
    this.add({ ...common, colour: pageColour(colour, 1), lift: 0.0015, isHidden: true, order: 2 });
    this.add({ ...common, colour: pageColour(colour, 0.3), lift: 0, isHidden: false, order: 1 });
  }

  /** A translucent surface of triangles. */
  addBody(places: readonly Place[], corners: readonly number[], colour: string): void {
    const { gl } = this;
    this.makers.push(() => { this.addBody(places, corners, colour); });
    const vertices = new Vertices(gl, [{ at: 0, numbers: numbersOf(places), size: 3 }], new Uint32Array(corners));
    this.add({ vertices, program: this.programs.line, mode: gl.TRIANGLES, colour: pageColour(colour, 0.22), size: 0, lift: 0, isHidden: true, order: 1 });
  }

  /** Edges of the mesh, as two vertices each. */
  drawEdges(edges: Vertices, seen: Seen): void {
    const { gl } = this;
    this.programs.line.use({ ...seen, colour: [0.05, 0.1, 0.16, 0.26], size: 0, lift: 0 });
    this.whileBlending(() => { edges.draw(gl.LINES); });
  }

  /** `picture`: pixels of the drawing; `ratio`: such pixels for one of the page. */
  draw(seen: Seen, picture: readonly [number, number], ratio: number): void {
    const { gl } = this;
    this.whileBlending(() => {
      for (const mark of this.all) {
        mark.program.use({ ...seen, colour: mark.colour, size: mark.size * ratio, lift: mark.lift, picture });
        if (!mark.isHidden) gl.disable(gl.DEPTH_TEST);
        mark.vertices.draw(mark.mode);
        gl.enable(gl.DEPTH_TEST);
      }
    });
  }

  private whileBlending(draw: () => void): void {
    const { gl } = this;
    gl.enable(gl.BLEND);
    gl.depthMask(false);
    draw();
    gl.depthMask(true);
    gl.disable(gl.BLEND);
  }

  private add(mark: Mark): void {
    this.all.push(mark);
    this.all.sort((a, b) => a.order - b.order);
  }
}

const swatch = typeof document === 'undefined' ? null : document.createElement('canvas').getContext('2d', { willReadFrequently: true });

/** A colour of CSS as four numbers up to 1. */
export function pageColour(colour: string, opacity = 1): [number, number, number, number] {
  if (swatch === null) return [0, 0, 0, opacity];
  swatch.fillStyle = colour;
  swatch.fillRect(0, 0, 1, 1);
  const [r, g, b] = swatch.getImageData(0, 0, 1, 1).data;
  return [r / 255, g / 255, b / 255, opacity];
}

function numbersOf(places: readonly Place[]): Float32Array {
  return Float32Array.from(places.flatMap((p) => [p.x, p.y, p.z]));
}

/** Each stretch of the line as two triangles. */
function ribbonOf(gl: WebGL2RenderingContext, places: readonly Place[]): Vertices {
  const here: number[] = [], other: number[] = [], turn: number[] = [], corners: number[] = [];
  for (let i = 1; i < places.length; ++i) {
    const a = places[i - 1], b = places[i], first = turn.length;
    for (const [p, q, side] of [[a, b, 1], [a, b, -1], [b, a, -1], [b, a, 1]] as const) {
      here.push(p.x, p.y, p.z);
      other.push(q.x, q.y, q.z);
      turn.push(side);
    }
    corners.push(first, first + 1, first + 2, first + 2, first + 1, first + 3);
  }
  return new Vertices(gl, [
    { at: 0, numbers: new Float32Array(here), size: 3 }, { at: 1, numbers: new Float32Array(other), size: 3 },
    { at: 2, numbers: new Float32Array(turn), size: 1 },
  ], new Uint32Array(corners));
}
