// SPDX-License-Identifier: GPL-3.0-or-later
//
// <ptin-terrain> in a page of another origin: a stream of a host that knows nothing of others, and a terrain of a service.
import assert from 'node:assert/strict';
import { copyFileSync, mkdirSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import type { Frame, Page } from 'playwright-core';
import { host } from '../../../decoder/test/host.mjs';
import { assets, file, served } from '../../../decoder/test/support';
import { colours, fast, onPage, store } from './browser';

/** A page of its own host, which has the element's file, too, that shows a terrain. */
async function onOtherPage(script: string, element: string, use: (page: Page, frame: Frame) => Promise<void>): Promise<void> {
  const folder = file('other');
  mkdirSync(folder, { recursive: true });
  copyFileSync(join(assets, 'ptin-terrain.js'), join(folder, 'ptin-terrain.js'));
  // A browser asks for an icon where a page names none.
  writeFileSync(join(folder, 'index.html'), `<!doctype html><title>Another page</title><link rel="icon" href="data:,">${script}
    <h1>Here is a terrain</h1>${element}`);
  const other = await host(folder);
  try {
    await onPage(other.url, async (page) => {
      const frame = await (await page.waitForSelector('ptin-terrain iframe')).contentFrame();
      await shown(frame!);
      await use(page, frame!);
    });
  } finally {
    await other.close();
  }
}

/** Waits until all of the terrain is there. */
async function shown(frame: Frame): Promise<void> {
  await frame.waitForFunction(() => document.querySelector('#progress.done') !== null && !window.ptinViewer.relief.pending, [], { polling: 40 });
}

const attribute = (page: Page, name: string, value: string): Promise<void> =>
  page.evaluate(([key, to]) => { document.querySelector('ptin-terrain')!.setAttribute(key, to); }, [name, value]);

test('an element of another page shows a stream, and follows its attributes', () => onOtherPage(
  `<script src="${fast.url}ptin-terrain.js"></script>`,
  `<ptin-terrain src="${fast.url}mountains_257.ptins" view="#error=20&shading=slope" title="Mountains" style="height: 600px"></ptin-terrain>`,
  async (page, frame) => {
    assert.equal(new URL(frame.url()).origin, new URL(fast.url).origin);
    assert.equal(await page.getAttribute('ptin-terrain iframe', 'title'), 'Mountains');
    const { height } = (await page.locator('ptin-terrain').boundingBox())!;
    assert.equal(height, 600);
    assert.ok(await colours(page) > 20, 'a picture');
    for (const part of ['#card', '#tools']) assert.ok(await frame.isHidden(part));
    assert.ok(await frame.isChecked('input[value=slope]'));
    const coarse = await frame.textContent('#fact-vertices');
    // Another view of the same terrain is no other document.
    await frame.evaluate(() => { document.body.dataset.same = 'yes'; });
    await attribute(page, 'view', 'error=5&shading=shade');
    await frame.waitForFunction(() => document.querySelector<HTMLInputElement>('input[value=shade]')!.checked);
    await frame.waitForFunction((before) => document.getElementById('fact-vertices')!.textContent !== before, coarse);
    assert.equal(await frame.evaluate(() => document.body.dataset.same), 'yes');
    // The link opens the terrain with its card, at the same view.
    const [opened] = await Promise.all([page.context().waitForEvent('page'), frame.click('#whole')]);
    await opened.waitForSelector('#card');
    const { searchParams, hash } = new URL(opened.url());
    assert.equal(searchParams.get('embed'), null);
    assert.match(hash, /shading=shade/);
    await opened.close();
    // Another terrain is.
    await attribute(page, 'src', `${fast.url}mountains_257.ptins?again`);
    await frame.waitForFunction(() => document.body?.dataset.same === undefined && /again/.test(location.search));
    await shown(frame);
  },
));

test('the wheel over a framed terrain moves the page that it is in, and with Ctrl the camera', () => onOtherPage(
  `<script src="${fast.url}ptin-terrain.js"></script>`,
  `<ptin-terrain src="${fast.url}mountains_257.ptins" style="height: 500px"></ptin-terrain><p style="height: 4000px">More.</p>`,
  async (page, frame) => {
    const distance = (): Promise<number> => frame.evaluate(() => window.ptinViewer.view.current.distance);
    const before = await distance();
    await page.mouse.move(400, 300);
    await page.mouse.wheel(0, 120);
    await page.waitForFunction(() => scrollY > 0);
    assert.equal(await distance(), before);
    assert.match((await frame.textContent('#toast'))!, /Ctrl/);
    assert.equal(await frame.evaluate(() => getComputedStyle(document.getElementById('relief')!).touchAction), 'pan-y');
    const top = await page.evaluate(() => scrollY);
    await page.keyboard.down('Control');
    await page.mouse.wheel(0, -240);
    await page.keyboard.up('Control');
    await frame.waitForFunction((was) => window.ptinViewer.view.current.distance < 0.95 * was, before);
    assert.equal(await page.evaluate(() => scrollY), top);
  },
));

test('an element whose script is the page\'s own, a module, shows a terrain of a service that names no other origin', () => served(`hills=${store}`, (address) => onOtherPage(
  '<script type="module" src="ptin-terrain.js"></script>',
  `<ptin-terrain src="${address}collections/hills" viewer="${address}viewer" view="error=20"></ptin-terrain>`,
  async (page, frame) => {
    assert.equal(await frame.title(), 'hills');
    assert.ok(await colours(page) > 20, 'a picture');
    // Gone and come again, as pages move their parts.
    await page.evaluate(() => { const element = document.querySelector('ptin-terrain')!; element.remove(); document.body.append(element); });
    const again = await (await page.waitForSelector('ptin-terrain iframe')).contentFrame();
    await shown(again!);
  },
)));
