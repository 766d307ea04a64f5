// SPDX-License-Identifier: GPL-3.0-or-later
//
// A terrain that is decoded in a Worker: a page sends { terrain: its address, and what refine() takes }, and gets each step.
//   const worker = new Worker(new URL('worker.js', import.meta.url), { type: 'module' });
import { openServed } from 'ptin-decoder';

onmessage = async ({ data: { terrain: address, ...options } }) => {
  try {
    const terrain = await openServed(address);
    for await (const step of terrain.refine(options)) {
      // Nobody else has the arrays, so they move and are not copied.
      postMessage(step, [step.positions.buffer, step.indices.buffer]);
    }
  } catch ({ message }) {
    postMessage({ state: 'failed', message });
  }
};
