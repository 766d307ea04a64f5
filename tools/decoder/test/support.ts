// SPDX-License-Identifier: GPL-3.0-or-later
//
// Helpers of several tests: the program, streams of small terrains, the decoder, meshes that the program wrote.
import { type ChildProcess, execFileSync, spawn } from 'node:child_process';
import { existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { Decoder, type Facts, type MeshView, heightOf, onMap, triangleWords, vertexWords } from '../src/index';

/** The program that was built, and the small terrains of tests/data. */
export const program = process.env.PTIN_PROGRAM ?? '';
export const data = process.env.PTIN_TEST_DATA ?? '';
export const assets = process.env.PTIN_VIEWER_ASSETS ?? '';

export const folder = mkdtempSync(join(tmpdir(), 'ptin-viewer-'));
process.on('exit', () => { rmSync(folder, { recursive: true, force: true }); });

export function file(name: string): string {
  return join(folder, name);
}

export function ptin(...parts: string[]): string {
  return execFileSync(program, parts, { encoding: 'utf8', maxBuffer: 1 << 28, stdio: ['ignore', 'pipe', 'ignore'] });
}

/** A terrain of tests/data, and its stream. */
export function terrain(name: string, ...options: string[]): { store: string; stream: string } {
  return built(join(data, `${name}.tif`), name, [], options);
}

/** The store of an input and its stream, each made once. */
function built(input: string, name: string, forBuild: string[], forStream: string[]): { store: string; stream: string } {
  const store = file(`${name}.ptin`), stream = file(`${[name, ...forStream].join(' ')}.ptins`);
  if (!existsSync(store)) ptin('build', input, ...forBuild, '-q', '-o', store);
  if (!existsSync(stream)) ptin('stream', store, ...forStream, '-o', stream);
  return { store, stream };
}

/** The store of a text grid of square cells, and its stream. */
export function gridded(
  name: string, crs: string, corner: readonly [number, number], cell: number, rows: string[][], ...options: string[]
): { store: string; stream: string } {
  const path = file(`${name}.asc`);
  writeFileSync(path, [`ncols ${rows[0].length}`, `nrows ${rows.length}`, `xllcorner ${corner[0]}`, `yllcorner ${corner[1]}`,
    `cellsize ${cell}`, 'NODATA_value -9999', ...rows.map((row) => row.join(' '))].join('\n') + '\n');
  return built(path, name, ['--a-srs', crs], options);
}

function moduleOf(name: string): WebAssembly.Module {
  return new WebAssembly.Module(readFileSync(join(assets, name)));
}
export const decoderModule = (): WebAssembly.Module => moduleOf('decoder.wasm');
export const questionsModule = (): WebAssembly.Module => moduleOf('questions.wasm');

/** A decoder that was fed `bytes`, in pieces of a size. */
export function decoded(module: WebAssembly.Module, bytes: Uint8Array, piece = bytes.length): Decoder {
  const decoder = new Decoder(module);
  for (let at = 0; at < bytes.length; at += piece) decoder.feed(bytes.subarray(at, at + piece));
  return decoder;
}

type Corner = readonly [number, number, number];

/** A triangle beginning with its least corner, as text: so that two meshes can be compared whatever their order. */
function told(corners: Corner[]): string {
  const names = corners.map((c) => c.join(' '));
  const first = names.indexOf([...names].sort()[0]);
  return [0, 1, 2].map((i) => names[(first + i) % 3]).join(', ');
}

/** The surface's triangles, corner by corner on the map, sorted. */
export function trianglesOf(mesh: MeshView, facts: Facts): string[] {
  const corner = (v: number): Corner => {
    const [gridX, gridY, height] = mesh.vertices.subarray(v * vertexWords);
    const { x, y } = onMap(facts, gridX, gridY);
    return [x, y, heightOf(facts, height)];
  };
  const all: string[] = [];
  for (let t = 0; t < mesh.triangleCount; ++t) {
    if (mesh.classes[t] === 0) all.push(told([0, 1, 2].map((i) => corner(mesh.triangles[t * triangleWords + i]))));
  }
  return all.sort();
}

export interface MapMesh {
  positions: Float64Array;
  indices: Uint32Array;
}

/** True when all numbers of two meshes are the same. */
export function isSameMesh(a: MapMesh, b: MapMesh): boolean {
  const bytesOf = ({ buffer }: MapMesh['positions' | 'indices']): Uint8Array => new Uint8Array(buffer);
  return Buffer.compare(bytesOf(a.positions), bytesOf(b.positions)) === 0 && Buffer.compare(bytesOf(a.indices), bytesOf(b.indices)) === 0;
}

/** The same of positions on the map and their indices. */
export function trianglesOfArrays({ positions, indices }: MapMesh): string[] {
  const corner = (v: number): Corner => [positions[3 * v], positions[3 * v + 1], positions[3 * v + 2]];
  return Array.from({ length: indices.length / 3 }, (_, t) => told([0, 1, 2].map((i) => corner(indices[3 * t + i])))).sort();
}

/** The same of a binary PLY that the program wrote: doubles, then a count and three indices a triangle. */
export function trianglesOfPly(path: string): string[] {
  const bytes = readFileSync(path);
  const mark = 'end_header\n';
  const header = bytes.subarray(0, bytes.indexOf(mark) + mark.length).toString('latin1');
  const countOf = (what: string): number => Number(new RegExp(`element ${what} (\\d+)`).exec(header)![1]);
  let at = header.length;
  const corners: Corner[] = [];
  for (let v = 0; v < countOf('vertex'); ++v, at += 24) {
    corners.push([bytes.readDoubleLE(at), bytes.readDoubleLE(at + 8), bytes.readDoubleLE(at + 16)]);
  }
  const all: string[] = [];
  for (let t = 0; t < countOf('face'); ++t, at += 13) {
    all.push(told([1, 5, 9].map((offset) => corners[bytes.readUInt32LE(at + offset)])));
  }
  return all.sort();
}

/** Metres of the hills of made(). */
export function hill(row: number, column: number): number {
  return 600 + 500 * Math.sin(row / 9) * Math.cos(column / 11) + 60 * Math.sin(row * 1.7 + column * 2.3);
}

/** Hills on a small grid, and their stream: over degrees of five parallels; with heights in feet over metres; with voids. */
export function made(name: 'degrees' | 'feet' | 'voids', ...options: string[]): { store: string; stream: string } {
  const size = 121;
  const height = (row: number, column: number): string => {
    if (name === 'voids' && Math.hypot(row - 40, column - 70) < 18) return '-9999';
    return (name === 'feet' ? hill(row, column) / 0.3048 : hill(row, column)).toFixed(1);
  };
  const rows = Array.from({ length: size }, (_, r) => Array.from({ length: size }, (_, c) => height(r, c)));
  const crs = { degrees: 'EPSG:4326', feet: 'EPSG:32632+6360', voids: 'EPSG:32632' }[name];
  if (name === 'degrees') return gridded(name, crs, [86, 25], 0.04, rows, ...options);
  return gridded(name, crs, [400000, 5000000], 50, rows, ...options);
}

/** Does something with a service of a terrain, given its address, which is over then. */
export async function served(
  named: string, use: (address: string, service: ChildProcess) => Promise<void>, port = 0, ...options: string[]
): Promise<void> {
  const service = spawn(program, ['serve', named, '--listen', `127.0.0.1:${port}`, ...options], { stdio: ['ignore', 'pipe', 'ignore'] });
  try {
    await use(await addressOf(service), service);
  } finally {
    await ended(service);
  }
}

function addressOf(service: ChildProcess): Promise<string> {
  return new Promise((resolve, reject) => {
    let said = '';
    service.on('error', reject);
    service.stdout!.on('data', (bytes: Buffer) => {
      said += bytes.toString();
      const found = /http:\/\/[\d.:]+\//.exec(said);
      if (found !== null) resolve(found[0]);
    });
  });
}

/** Ends a service, and waits for its end. */
export async function ended(service: ChildProcess): Promise<void> {
  if (service.exitCode !== null || service.signalCode !== null) return;
  const over = new Promise((resolve) => { service.on('exit', resolve); });
  service.kill();
  await over;
}
