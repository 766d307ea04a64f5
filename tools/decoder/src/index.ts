// SPDX-License-Identifier: GPL-3.0-or-later
//
// Progressive TINs in JavaScript: streams of `ptin stream` and `ptin serve` to meshes with a certified error.
export { loadDecoder } from './load.js';
export { decodeStream, type StreamOptions, type StreamSource } from './decode_stream.js';
export { ServedTerrain, ServiceError, type RefineOptions } from './served_terrain.js';
export { Received, type Serving, type StreamBody, type Wanted } from './received.js';
export { type Certificate, Decoder, type Facts, boundsOf, heightOf, onMap } from './decoder.js';
export { type Certified, type CertifiedPart, certifiedAt, certifiedOf, certifiedWithin } from './certified.js';
export { type Surface, surfaceAround, surfaceCorners, surfaceOf } from './surface.js';
export { type StreamRequest, type Told, type Units, toldBy } from './metadata.js';
export { type MapPosition, type Window, holds, widened, windowAround } from './map_window.js';
export { DecodeError, type ErrorCode, type GroundFacts } from './module.js';
export { type MeshView, none, triangleWords, vertexWords } from './mesh.js';
