// SPDX-License-Identifier: GPL-3.0-or-later
//
// Each example in a browser, with a service of mountains: it refines to the end, complains of nothing, and shows relief.
import assert from 'node:assert/strict';
import { cpSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { build } from 'esbuild';
import type { Browser, Page } from 'playwright-core';
import { host, launched } from '../host.mjs';
import { assets, file, served, terrain } from '../support';

const here = process.env.PTIN_PACKAGE ?? '';
const examples = ['three', 'maplibre', 'deck'] as const;
type Seen = { state: string; certified: { error: number } | null; triangles: number };
const site = file('examples');
const { store } = terrain('mountains_257');
let browser: Browser;

before(async () => {
  await build({
    entryPoints: [...examples, 'worker'].map((name) => join(here, 'examples', `${name}.js`)), outdir: site, bundle: true, format: 'esm', logLevel: 'warning',
    conditions: ['ptin-source'], alias: { 'ptin-decoder': join(here, 'src/index.ts') }, nodePaths: [join(here, 'node_modules')],
  });
  cpSync(join(here, 'examples/page.html'), join(site, 'page.html'));
  cpSync(join(assets, 'decoder.wasm'), join(site, 'decoder.wasm'));
  const maplibre = join(here, 'node_modules/maplibre-gl/dist');
  for (const name of ['maplibre-gl-worker.mjs', 'maplibre-gl-shared.mjs']) cpSync(join(maplibre, name), join(site, name));
  browser = await launched();
});
after(() => browser?.close());

/** How many colours the middle of the picture has, of 32 a channel. */
async function coloursOf(page: Page): Promise<number> {
  const picture = await page.screenshot({ clip: { x: 150, y: 100, width: 300, height: 200 } });
  return page.evaluate(async (url) => {
    const image = await createImageBitmap(await (await fetch(url)).blob());
    const context = new OffscreenCanvas(image.width, image.height).getContext('2d')!;
    context.drawImage(image, 0, 0);
    const { data } = context.getImageData(0, 0, image.width, image.height);
    const seen = new Set<number>();
    for (let i = 0; i < data.length; i += 4) seen.add((data[i] >> 3 << 10) | (data[i + 1] >> 3 << 5) | data[i + 2] >> 3);
    return seen.size;
  }, `data:image/png;base64,${picture.toString('base64')}`);
}

for (const name of examples) {
  test(`${name} shows the terrain`, () => served(`dem=${store}`, async (address) => {
    const pages = await host(site);
    const page = await browser.newPage({ viewport: { width: 600, height: 400 } });
    const faults: string[] = [];
    page.on('pageerror', (e) => { faults.push(e.message); });
    page.on('console', (m) => { if (m.type() === 'error') faults.push(m.text()); });
    try {
      await page.goto(`${pages.url}page.html?with=${name}&terrain=${address}collections/dem`);
      const told = page.locator('#told[data-state]');
      await told.waitFor({ timeout: 120000 }).catch(() => assert.fail(`nothing came: ${faults.join('; ')}`));
      assert.equal(await told.getAttribute('data-state'), 'complete', await told.innerText());
      const error = Number(/every sample within ([\d.]+) /.exec(await told.innerText())?.[1]);
      assert.ok(error > 0 && error <= 2, String(error));
      let colours = 0;
      for (let waited = 0; waited < 40 && colours < 15; ++waited) {
        await page.waitForTimeout(250);
        colours = await coloursOf(page);
      }
      if (process.env.PTIN_PICTURES !== undefined) await page.screenshot({ path: join(process.env.PTIN_PICTURES, `${name}.jpg`), type: 'jpeg', quality: 85 });
      assert.ok(colours >= 15, `${colours} colours`);
      assert.deepEqual(faults, []);
    } finally {
      await page.close();
      await pages.close();
    }
  }, 0, '--cors', '*'));
}

test('a Worker hands steps over', () => served(`dem=${store}`, async (address) => {
  const pages = await host(site);
  const page = await browser.newPage();
  try {
    await page.goto(`${pages.url}page.html`);
    const seen = await page.evaluate((terrain) => new Promise<Seen[]>((resolve, reject) => {
      const worker = new Worker('worker.js', { type: 'module' }), steps: Seen[] = [];
      worker.onerror = ({ message }) => { reject(new Error(message)); };
      worker.onmessage = ({ data: { state, certified, indices, message } }) => {
        steps.push({ state: message ?? state, certified, triangles: (indices?.length ?? 0) / 3 });
        if (state !== 'refining') resolve(steps);
      };
      worker.postMessage({ terrain, error: 5 });
    }), `${address}collections/dem`);
    const last = seen[seen.length - 1];
    assert.equal(last.state, 'reached');
    assert.ok(last.certified!.error <= 5 && last.triangles > 1000 && seen.length > 1, JSON.stringify(last));
  } finally {
    await page.close();
    await pages.close();
  }
}, 0, '--cors', '*'));
