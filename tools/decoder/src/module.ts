// SPDX-License-Identifier: GPL-3.0-or-later
//
// Instances of the engine's modules in WebAssembly (wasm/module.h), and what they refuse.

/** Why something was refused: the names of the engine's ErrorCode, in its order. */
export const errorCodes = [
  'invalid_argument', 'not_found', 'corruption', 'unsupported_version', 'io_error', 'resource_exhausted', 'cancelled',
  'internal',
] as const;
export type ErrorCode = (typeof errorCodes)[number];

/** The engine refused. Its instance cannot be fed or asked any further; what it holds stays readable. */
export class DecodeError extends Error {
  constructor(readonly code: ErrorCode, message: string) {
    super(message);
    this.name = 'DecodeError';
  }
}

/** The exports of every module. */
export interface ModuleExports {
  memory: WebAssembly.Memory;
  _initialize(): void;
  describeGround(
    geographic: number, semiMajor: number, inverseFlattening: number, radiansPerMapUnit: number, metresPerMapUnit: number,
    metresPerHeight: number): void;
}

/** A new instance, whose functions throw DecodeError. */
export function instanceOf<Exports extends ModuleExports>(module: WebAssembly.Module): Exports {
  const fail = (code: number, text: number, bytes: number): never => {
    const message = new TextDecoder().decode(new Uint8Array(wasm.memory.buffer, text, bytes));
    throw new DecodeError(errorCodes[code] ?? 'internal', message);
  };
  const wasm = new WebAssembly.Instance(module, { host: { fail } }).exports as unknown as Exports;
  wasm._initialize();
  return wasm;
}

/** The fault that a function threw, as the DecodeError that it is or stands for: memory that cannot grow traps. */
export function decodeErrorOf(error: unknown): DecodeError {
  return error instanceof DecodeError ? error
    : new DecodeError('resource_exhausted', 'the decoder came to its end: ' + String(error));
}

/** A copy of numbers that an instance holds. */
export function numbersAt(memory: WebAssembly.Memory, at: number, count: number): Float64Array {
  return new Float64Array(memory.buffer, at, count).slice();
}

/** As the engine's GroundFacts: what metadata of a stream hold under `ground`. */
export interface GroundFacts {
  geographic: boolean;
  semi_major: number;
  inverse_flattening: number;
  radians_per_map_unit: number;
  metres_per_map_unit: number;
  metres_per_height: number;
}

/** Tells an instance the ground; without any, lengths are map units. */
export function describeGround(wasm: ModuleExports, ground: GroundFacts | null): void {
  const g = ground;
  wasm.describeGround(
    g?.geographic === true ? 1 : 0, g?.semi_major ?? 6378137, g?.inverse_flattening ?? 0, g?.radians_per_map_unit ?? 0,
    g?.metres_per_map_unit ?? 1, g?.metres_per_height ?? 1);
}
