// SPDX-License-Identifier: GPL-3.0-or-later
//
// The part that all examples share: a terrain of `ptin serve` that refines step by step, and a line that tells of it.
// The page's address names it: page.html?with=three&terrain=http://127.0.0.1:8080/collections/dem (serve with --cors '*').
import { openServed } from 'ptin-decoder';

/** Refines the whole terrain down to an error of 2 in the height's unit, and calls `draw` with each mesh. */
export async function refineTerrain(draw, options = {}) {
  const told = document.getElementById('told');
  try {
    const terrain = await openServed(new URLSearchParams(location.search).get('terrain'));
    for await (const step of terrain.refine({ error: 2, maxVertices: 1e6, ...options })) {
      draw(step, terrain);
      const { certified, indices } = step;
      told.textContent = `${indices.length / 3} triangles, ` + (certified === null ? 'nothing certified'
        : `at every sample within ${certified.error} ${certified.unit ?? '(unit not known)'}`);
    }
    told.dataset.state = 'complete';
  } catch (error) {
    told.textContent = `The terrain did not come: ${error.message}`;
    told.dataset.state = 'failed';
  }
}
