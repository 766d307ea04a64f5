// SPDX-License-Identifier: GPL-3.0-or-later
//
// Progressive TINs in JavaScript: terrains of `ptin stream` and `ptin serve` that become finer while they arrive, and the parts that
// they are made of, for what keeps cameras and budgets of its own, as the viewer does.
import { type Bytes, GivenBytes, HostedBytes } from './byte_source.js';
import { type ModuleSource, loadModule } from './load.js';
import { until } from './requests.js';
import { ServedTerrain } from './served_terrain.js';
import { StreamTerrain } from './stream_terrain.js';

export interface OpenOptions {
  /** Ends the opening, with the signal's reason. */
  signal?: AbortSignal;
  /** The decoder, where it does not lie beside the package's code: decoder.wasm by its address or bytes, or compiled. */
  wasm?: ModuleSource;
}

/**
 * Opens a terrain of `ptin serve`, and receives a first mesh of it. Another host must answer with Access-Control-Allow-Origin
 * (`ptin serve --cors`). Throws as Terrain.refine() does.
 * @param url  Of the terrain: `http://127.0.0.1:8080/collections/ID`
 */
export async function openServed(url: string | URL, { signal, wasm }: OpenOptions = {}): Promise<ServedTerrain> {
  return ServedTerrain.open(await until(loadModule(wasm), signal), String(url).replace(/\/$/, ''), signal);
}

/**
 * Opens a stream that `ptin stream` wrote, on any web host, and receives its first mesh. The file is read as far as refine() needs
 * it, by ranges of bytes where the host knows them; of several streams in it the first. Throws as Terrain.refine() does.
 */
export async function openFile(url: string | URL, { signal, wasm }: OpenOptions = {}): Promise<StreamTerrain> {
  const source = new HostedBytes(String(url));
  const opening = source.open(signal);
  opening.catch(() => undefined);
  const module = await until(loadModule(wasm), signal);
  return StreamTerrain.open(module, await opening, signal);
}

/** Opens a stream that `ptin stream` wrote: bytes at hand, or as they come; of several the first. Throws as Terrain.refine() does. */
export async function openBytes(bytes: Bytes, { signal, wasm }: OpenOptions = {}): Promise<StreamTerrain> {
  return StreamTerrain.open(await until(loadModule(wasm), signal), new GivenBytes(bytes), signal);
}

export { type ByteSource, type Bytes, GivenBytes, HostedBytes } from './byte_source.js';
export { type Certified, type CertifiedPart, certifiedAt, certifiedOf, certifiedWithin } from './certified.js';
export { type Collection, type LonLatNodes, type StreamBody, collectionAt, streamOf } from './collection.js';
export { Decoder } from './decoder.js';
export { type Certificate, type Facts, boundsOf, heightOf, onMap } from './facts.js';
export { type ModuleSource, loadModule } from './load.js';
export { type MapPosition, type Window, holds, widened, windowAround } from './map_window.js';
export { type MeshView, none, triangleWords, vertexWords } from './mesh.js';
export { type BaseMap, type StreamRequest, type Told, type Units, mapCrsOf, toldBy } from './metadata.js';
export { DecodeError, type ErrorCode, type GroundFacts } from './module.js';
export { Received, type Serving, type Wanted, mostServings } from './received.js';
export { Problem, opened } from './requests.js';
export { ServedTerrain } from './served_terrain.js';
export { StreamTerrain } from './stream_terrain.js';
export { type LocalFrame, localPositions, mapPositions, normalsOf, surfaceCorners } from './surface.js';
export {
  type Certainty, type Frame, type Mesh, type MeshOptions, type RefineOptions, type State, type Step, Terrain,
} from './terrain.js';
