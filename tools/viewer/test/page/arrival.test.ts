// SPDX-License-Identifier: GPL-3.0-or-later
//
// The page while a terrain arrives, what it says where none comes, and where it is opened from.
import assert from 'node:assert/strict';
import { existsSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import type { Page } from 'playwright-core';
import { host } from '../../../decoder/test/host.mjs';
import { file, gridded, ptin } from '../../../decoder/test/support';
import { appears, colours, complete, counted, fast, layOut, onPage, portioned, rested, site, store, text, until } from './browser';

test('the page shows the terrain while it arrives, and then rests', () => onPage(portioned.url, async (page) => {
  // The host waits after each portion, so that nothing here depends on which of them is faster, the page or its data.
  let vertices = 0;
  for (let portion = 1; portion < 3; ++portion) {
    await until(page, ([before, share]) =>
      Number(document.querySelector('#fact-vertices')!.textContent!.replace(/[^0-9]/g, '')) > before &&
      Number(document.querySelector('#progress')!.getAttribute('aria-valuenow')) >= share, [vertices, 33 * portion]);
    await rested(page);
    vertices = await counted(page, '#fact-vertices');
    assert.ok(Number(await page.getAttribute('#progress', 'aria-valuenow')) <= 33 * portion + 1, 'no more than what has come');
    assert.match(await text(page, '#certified-what'), /still refining/);
    portioned.more();
  }
  await complete(page);
  assert.ok(vertices < 257 * 257, `${vertices} were shown before the end`);
  assert.equal(await counted(page, '#fact-vertices'), 257 * 257);
  assert.equal(await text(page, '#certified'), 'Exact');
  assert.ok(await colours(page) > 500, 'the picture is not blank');
  const pictures = await rested(page);
  await page.waitForTimeout(500);
  assert.equal(await rested(page), pictures, 'nothing is drawn while nothing changes');
}));

test('what is wrong is said in a sentence', async () => {
  const whole = readFileSync(file('mountains_257.ptins'));
  const bad = new Uint8Array(whole);
  bad[40000] ^= 1;
  writeFileSync(join(site, 'damaged.ptins'), bad);
  // The first frame behind T0, which comes with T0 in one piece.
  const early = new Uint8Array(whole);
  early[3000] ^= 1;
  writeFileSync(join(site, 'early.ptins'), early);
  writeFileSync(join(site, 'cut.ptins'), whole.subarray(0, 60000));
  writeFileSync(join(site, 'short.ptins'), whole.subarray(0, 700));
  writeFileSync(join(site, 'store.ptin'), readFileSync(store));
  const said = (stream: string, words: RegExp, isShown = false): Promise<void> =>
    onPage(`${fast.url}?stream=${encodeURIComponent(stream)}`, async (page) => {
      await appears(page, '#trouble');
      assert.match(await text(page, '#trouble'), words);
      if (!isShown) return;
      assert.match(await text(page, '#certified-what'), /certified[^]*damaged/, stream);
      assert.doesNotMatch(await text(page, '#certified-what'), /refining/);
      assert.ok(await counted(page, '#fact-vertices') > 0, 'what came before the damage is shown');
    }, { mayComplain: true });
  await said('none.ptins', /no such terrain[^]*none\.ptins/);
  await said('viewer.js', /not a stream/);
  await said('store.ptin', /not a stream[^]*store/);
  await said('damaged.ptins', /damaged[^]*frame \d+ at byte \d+/, true);
  await said('early.ptins', /damaged/, true);
  await said('short.ptins', /too early/);
  await said('http://127.0.0.1:9/x.ptins', /cannot be reached/);
  await onPage(`${fast.url}?stream=cut.ptins`, async (page) => {
    await complete(page);
    assert.match(await text(page, '#certified-what'), /did not arrive/);
    assert.ok(await counted(page, '#fact-vertices') > 10000);
  });
});

test('a stream for isolines, of whose mesh nothing is known, certifies nothing', async () => {
  ptin('stream', store, '--level', '1000', '--error', '5', '-o', join(site, 'isolines.ptins'));
  await onPage(`${fast.url}?stream=isolines.ptins`, async (page) => {
    await complete(page);
    assert.equal(await text(page, '#certified'), '\u2013');
    assert.match(await text(page, '#certified-what'), /^not certified/);
  });
});

test('without a stream the page asks for one', async () => {
  layOut(file('bare'));
  const server = await host(file('bare'));
  await onPage(server.url, async (page) => {
    await appears(page, '#welcome');
    assert.ok(await page.isHidden('#scale'));
    await page.setInputFiles('#welcome input[type=file]', file('mountains_257.ptins'));
    await complete(page);
    assert.equal(await text(page, '#title'), 'mountains_257');
    assert.equal(await counted(page, '#fact-vertices'), 257 * 257);
  });
  await server.close();
});

test('from a folder the page says that it needs a host', () => onPage(`file://${site}/index.html`, async (page) => {
  await appears(page, '#trouble');
  assert.match(await text(page, '#trouble'), /needs a web server[^]*http\.server/);
  assert.doesNotMatch(await text(page, '#subtitle'), /Loading/);
}, { mayComplain: true }));

interface Held {
  page: Page;
  /** Lets the decoder come. */
  release(): void;
  /** Lets the next portion of the stream come. */
  more(): void;
}

/** A page of a site whose decoder waits until it is released, once its first picture is there. */
async function heldBack(folder: string, use: (held: Held) => Promise<void>, { portions = 1, query = '' } = {}): Promise<void> {
  let release: () => void = () => undefined;
  const held = new Promise<void>((resolve) => { release = resolve; });
  let asked = 0;
  const server = await host(folder, { portions, answer: (_, response, path) => {
    if (!path.endsWith('/decoder.wasm') || asked++ > 0) return false;
    void held.then(() => {
      response.writeHead(200, { 'Content-Type': 'application/wasm' }).end(readFileSync(join(folder, 'decoder.wasm')));
    });
    return true;
  } });
  try {
    await onPage(server.url + query, async (page) => {
      await until(page, () => performance.getEntriesByName('ptin-first-picture').length > 0);
      await rested(page);
      await use({ page, release, more: server.more });
    });
  } finally {
    release();
    await server.close();
  }
}

test('a first picture lies in the page: it is there before the decoder is asked for', () => heldBack(site, async ({ page, release }) => {
  assert.ok(await counted(page, '#fact-vertices') < 5000);
  assert.match(await text(page, '#certified'), /^\u00b1[\d.\u202f]+/, 'with its certificate');
  assert.match(await text(page, '#legend-high'), /^1\d{3} m$/, 'and its legend');
  assert.ok(await colours(page) > 200, 'the picture is not blank');
  const before = await page.evaluate(() => window.ptinViewer.view.current);
  release();
  await complete(page);
  assert.equal(await text(page, '#certified'), 'Exact');
  const after = await page.evaluate(() => window.ptinViewer.view.current);
  assert.ok(Math.abs(after.distance - before.distance) < 1e-6 * before.distance, 'the camera stays');
}));

/** The words that a picture has when it is saved. */
async function wordsSaved(page: Page): Promise<string> {
  await page.evaluate(() => {
    const words: string[] = [];
    const { fillText } = CanvasRenderingContext2D.prototype;
    CanvasRenderingContext2D.prototype.fillText = function (this: CanvasRenderingContext2D, word: string, x: number, y: number): void {
      words.push(word);
      fillText.call(this, word, x, y);
    };
    Object.assign(window, { words });
  });
  await Promise.all([page.waitForEvent('download'), page.keyboard.press('e')]);
  return page.evaluate(() => (window as unknown as { words: string[] }).words.join('\n'));
}

/** The words for a preview wherever the page says something of the terrain. */
async function isCalledPreview(page: Page): Promise<void> {
  assert.equal(await counted(page, '#fact-vertices'), 33 * 33);
  assert.equal(await text(page, '#certified'), '\u2013');
  for (const part of ['#certified-what', '#credit']) assert.match(await text(page, part), /preview, not certified/, part);
}

// The borders of all these voids come first, until when no error is finite.
const size = 330;
const heightOfHoles = (column: number, row: number): number => 400 + 200 * Math.sin(column / 28) * Math.cos(row / 22);
function holes(): string {
  const folder = file('preview');
  if (existsSync(folder)) return folder;
  const heights = Array.from({ length: size }, (_, row) => Array.from({ length: size }, (_, c) =>
    (row % 3 === 1 && c % 3 === 1 && c < 245 ? '-9999' : heightOfHoles(c, row).toFixed(2))));
  const { stream } = gridded('holes', 'EPSG:32632', [400000, 5000000], 10, heights, '--error', '20');
  layOut(folder, '--stream', stream);
  return folder;
}

test('of a terrain that certifies nothing for long a preview lies in the page, and certifies nothing', () => heldBack(holes(), async ({ page, release, more }) => {
  await isCalledPreview(page);
  assert.match(await text(page, '#spoken'), /preview, not certified/);
  assert.ok(await colours(page) > 200, 'the picture is not blank');
  for (const [column, row] of [[260, 50], [277, 133], [320, 301]] as const) {
    const there = await page.evaluate(([x, y]) => {
      const { frame, relief } = window.ptinViewer;
      return frame.heightAt(relief.groundAt(frame.sceneX(x), frame.sceneY(y)) ?? NaN);
    }, [400005 + 10 * column, 5000005 + 10 * (size - 1 - row)]);
    assert.ok(Math.abs(there - heightOfHoles(column, row)) < 60, `${there} for ${heightOfHoles(column, row)}`);
  }
  assert.match(await wordsSaved(page), /preview, not certified/);
  await page.mouse.move(880, 600);
  await until(page, () => /^about \d+[02468] m/.test(document.getElementById('place')!.textContent!));
  // The stream has more vertices than the preview now, and still nothing certified.
  release();
  await until(page, () => document.title !== 'Terrain');
  await page.mouse.click(880, 600);
  await appears(page, '#answer');
  assert.match(await text(page, '#answer-text') + await text(page, '#answer-note'), /certainly between/);
  await isCalledPreview(page);
  for (let i = 0; i < 8; ++i) more();
  await complete(page);
  assert.match(await text(page, '#certified'), /^\u00b1[\d.\u202f]+/, 'then the terrain takes its place');
  assert.ok(await counted(page, '#fact-vertices') > 6000);
  for (const part of ['#certified-what', '#spoken', '#credit']) assert.doesNotMatch(await page.locator(part).textContent() ?? '', /preview/);
  assert.doesNotMatch(await wordsSaved(page), /preview/);
}, { portions: 8 }));

test('in a frame, where there is no card, a preview is called so, too', () => heldBack(holes(), async ({ page, release }) => {
  assert.match(await text(page, '#credit'), /preview, not certified/);
  release();
  await complete(page);
  assert.doesNotMatch(await text(page, '#credit'), /preview/);
}, { query: '?embed=1' }));
