// SPDX-License-Identifier: GPL-3.0-or-later
//
// The part that all examples share: a terrain of `ptin serve` that refines step by step, and a line that tells of it.
// The page's address names it: page.html?with=three&terrain=http://127.0.0.1:8080/collections/dem (serve with --cors '*').
import { ServedTerrain, boundsOf, loadDecoder, toldBy } from 'ptin-decoder';

/**
 * Refines the whole terrain down to an error in the height's unit, and calls `draw` with each mesh. The service sends the first
 * mesh for any error; each further answer brings what the mesh lacks for half of it.
 */
export async function refineTerrain(leastError, draw) {
  const told = document.getElementById('told');
  try {
    const address = new URLSearchParams(location.search).get('terrain');
    const { terrain: { bounds, heights } } = await (await fetch(address, { headers: { Accept: 'application/json' } })).json();
    const terrain = new ServedTerrain(await loadDecoder(), address);
    for (let error = (heights[1] - heights[0]) / 10; ; error = Math.max(error / 2, leastError)) {
      await terrain.refine({ window: bounds, error });
      const { decoder } = terrain;
      const unit = toldBy(decoder.metadata).units.height;
      draw(decoder);
      told.textContent = `${decoder.mesh.triangleCount} triangles, at every sample within ${decoder.certificate.error} ` +
        (unit === 'unknown' ? '(unit not known)' : unit);
      if (error === leastError) break;
    }
    told.dataset.state = 'complete';
  } catch (error) {
    told.textContent = `The terrain did not come: ${error.message}`;
    told.dataset.state = 'failed';
  }
}

/** The middle of a terrain on its map, at its least height. */
export function middleOf({ facts }) {
  const [west, south, east, north] = boundsOf(facts);
  return [(west + east) / 2, (south + north) / 2, facts.minHeight];
}
