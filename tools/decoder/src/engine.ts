// SPDX-License-Identifier: GPL-3.0-or-later
//
// Parts for further modules of the engine (the viewer's questions), beside what index.ts has for everybody.
export { type MeshExports, meshIn } from './mesh.js';
export { decodeErrorOf, describeGround, instanceOf, numbersAt } from './module.js';
