// SPDX-License-Identifier: GPL-3.0-or-later
//
// The page while a terrain arrives, what it says where none comes, and where it is opened from.
import assert from 'node:assert/strict';
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { host } from '../../../decoder/test/host.mjs';
import { file, ptin } from '../../../decoder/test/support';
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

test('a first picture lies in the page: it is there before the decoder is asked for', async () => {
  let release: () => void = () => undefined;
  const held = new Promise<void>((resolve) => { release = resolve; });
  let asked = 0;
  const server = await host(site, { answer: (_, response, path) => {
    if (!path.endsWith('/decoder.wasm') || asked++ > 0) return false;
    void held.then(() => {
      response.writeHead(200, { 'Content-Type': 'application/wasm' }).end(readFileSync(join(site, 'decoder.wasm')));
    });
    return true;
  } });
  await onPage(server.url, async (page) => {
    await until(page, () => performance.getEntriesByName('ptin-first-picture').length > 0);
    await rested(page);
    assert.ok(await counted(page, '#fact-vertices') < 5000);
    assert.match(await text(page, '#certified'), /^\u00b1[\d.\u202f]+/, 'with its certificate');
    assert.ok(await colours(page) > 200, 'the picture is not blank');
    const before = await page.evaluate(() => window.ptinViewer.view.current);
    release();
    await complete(page);
    assert.equal(await text(page, '#certified'), 'Exact');
    const after = await page.evaluate(() => window.ptinViewer.view.current);
    assert.ok(Math.abs(after.distance - before.distance) < 1e-6 * before.distance, 'the camera stays');
  });
  await server.close();
});
