// SPDX-License-Identifier: GPL-3.0-or-later
//
// Parts of index.ts that need no WebAssembly module, for scripts that show what another one decodes: the viewer's page.
export { certifiedAt, certifiedWithin } from './certified.js';
export { collectionAt, streamOf } from './collection.js';
export { boundsOf, factNames, heightOf, onMap } from './facts.js';
export { holds, widened, windowAround } from './map_window.js';
export { none, triangleWords, vertexWords } from './mesh.js';
export { toldBy } from './metadata.js';
export { Problem, opened } from './requests.js';
