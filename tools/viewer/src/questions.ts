// SPDX-License-Identifier: GPL-3.0-or-later
//
// The engine's questions of a mesh that was received (decoder/questions.cc), in a WebAssembly instance of their own: it answers
// about a copy of the decoder's mesh, which is made anew when the decoder's has changed.
import type { Certificate, Decoder, GroundFacts, MapPosition } from 'ptin-decoder';
import { decodeErrorOf, describeGround, instanceOf, type MeshExports, meshIn, numbersAt } from 'ptin-decoder/engine';
import { stationsOf } from './stations';
import type { Located, PointState, Profile, Sight, SightPoint } from './answers';

/** The thing asked: the mesh that a decoder holds, and what is known of it. */
export interface Asked {
  decoder: Decoder;
  /** Null: not known; lengths are map units. */
  ground: GroundFacts | null;
  freeOfVoids: boolean;
  /** The certificate at the places that are asked; null: no more than the least and the greatest height of the terrain. */
  certificate: Certificate | null;
  /** No record of the file is missing there. Without a certificate nobody knows. */
  isWhole: boolean;
}

interface Exports extends MeshExports {
  makeRoom(vertices: number, triangles: number): void;
  describe(freeOfVoids: number, error: number, deviation: number, isWhole: number): void;
  locate(x: number, y: number): number;
  profile(ax: number, ay: number, bx: number, by: number): number;
  sight(ax: number, ay: number, heightA: number, bx: number, by: number, heightB: number, hertz: number): number;
}

const states: readonly PointState[] = ['surface', 'void', 'outside'];
const verdicts: ReadonlyArray<Sight['verdict']> = ['visible', 'hidden', 'unsure', 'undefined'];
const orNull = (value: number): number | null => (Number.isNaN(value) ? null : value);

/** Each question throws DecodeError where the engine refuses, and may be followed by others. */
export class Questions {
  private wasm: Exports | null = null;
  /** The version of the mesh that was copied. */
  private copied = 0;

  constructor(private readonly module: WebAssembly.Module) {}

  /** The mesh at a place. */
  locate(asked: Asked, at: MapPosition): Located {
    return this.ask(asked, (wasm) => {
      const n = numbersAt(wasm.memory, wasm.locate(at.x, at.y), 13);
      const state = states[n[0]];
      const triangle = [4, 7, 10].map((i) => ({ x: n[i], y: n[i + 1], height: orNull(n[i + 2]) }));
      return {
        state, height: orNull(n[1]), least: orNull(n[2]), most: orNull(n[3]), triangle: state === 'outside' ? [] : triangle,
      };
    });
  }

  /** The heights along a line over the mesh. */
  profile(asked: Asked, a: MapPosition, b: MapPosition): Omit<Profile, 'lengths'> {
    return this.ask(asked, (wasm) => {
      const at = wasm.profile(a.x, a.y, b.x, b.y);
      const [count] = numbersAt(wasm.memory, at, 1);
      const n = numbersAt(wasm.memory, at + 8, 5 * count);
      const points = Array.from({ length: count }, (_, i) => ({
        distance: n[5 * i], x: n[5 * i + 1], y: n[5 * i + 2], height: orNull(n[5 * i + 3]), state: states[n[5 * i + 4]],
      }));
      return { stations: stationsOf(points), length: points[count - 1].distance };
    });
  }

  /** A line of sight over the mesh: heights above ground, in the height's unit. */
  sight(asked: Asked, a: MapPosition, heightA: number, b: MapPosition, heightB: number, hertz: number): Sight {
    return this.ask(asked, (wasm) => {
      const n = numbersAt(wasm.memory, wasm.sight(a.x, a.y, heightA, b.x, b.y, heightB, hertz), 13);
      const point = (i: number): SightPoint => ({ x: n[i], y: n[i + 1], distance: n[i + 2], height: n[i + 3] });
      return {
        verdict: verdicts[n[0]], length: n[1],
        clearance: Number.isNaN(n[5]) ? null : { min: n[2], max: n[3], at: point(5) },
        fresnel: Number.isNaN(n[4]) ? null : { ratio: n[4], at: point(9) },
      };
    });
  }

  private ask<Answer>(asked: Asked, question: (wasm: Exports) => Answer): Answer {
    try {
      const wasm = this.wasm ??= instanceOf<Exports>(this.module);
      this.copy(wasm, asked.decoder);
      describeGround(wasm, asked.ground);
      const { error, deviation } = asked.certificate ?? { error: Infinity, deviation: Infinity };
      wasm.describe(asked.freeOfVoids ? 1 : 0, error, deviation, asked.certificate !== null && asked.isWhole ? 1 : 0);
      return question(wasm);
    } catch (error) {
      this.wasm = null;
      this.copied = 0;
      throw decodeErrorOf(error);
    }
  }

  /** Takes over the mesh as the decoder has it now. Cost: linear, when the decoder was fed since. */
  private copy(wasm: Exports, decoder: Decoder): void {
    if (this.copied === decoder.version) return;
    const { mesh } = decoder;
    wasm.makeRoom(mesh.vertexCount, mesh.triangleCount);
    const copy = meshIn(wasm);
    for (const part of ['vertices', 'hasHeight', 'triangles', 'classes', 'facts'] as const) copy[part].set(mesh[part]);
    this.copied = decoder.version;
  }
}
