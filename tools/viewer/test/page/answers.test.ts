// SPDX-License-Identifier: GPL-3.0-or-later
//
// Answers of the page about the terrain of a stream, against the program.
import assert from 'node:assert/strict';
import { cpSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import type { Page } from 'playwright-core';
import { host } from '../../../decoder/test/host.mjs';
import { made } from '../../../decoder/test/support';
import {
  appears, askAlong, colours, compareRows, complete, counted, fast, located, onPage, phone, programRows, rested, savedCsv, site, text,
  told, until,
} from './browser';

/** Clicks the terrain, whose mesh is off by 5 m at most. */
async function clickTells(page: Page): Promise<void> {
  const { width, height } = page.viewportSize()!;
  await page.mouse.click(width * 0.6, height * 0.55);
  await appears(page, '#answer');
  const answer = await told(page);
  assert.ok(Math.abs(located(answer) - Number(answer.height)) <= Number(answer.deviation) + 1e-9, 'the interval holds the full height');
  const certified = Number((await text(page, '#certified')).replace(/[^0-9.]/g, ''));
  assert.ok(certified <= 5 && certified > 0);
  assert.match(await text(page, '#answer-note'), /certainly between [\d.]+ m and [\d.]+ m/);
  assert.ok(await colours(page) > 400);
}

const slide = (page: Page, value: number): Promise<void> => page.locator('#error').evaluate((e, v) => {
  (e as HTMLInputElement).value = String(v);
  e.dispatchEvent(new Event('input', { bubbles: true }));
}, value);

test('a click tells the height that locate tells, on a phone', () => onPage(`${fast.url}#error=5`, async (page) => {
  await complete(page);
  await clickTells(page);
}, { screen: phone }));

test('answers', (t) => onPage(`${fast.url}#error=5`, async (page) => {
  await complete(page);

  await t.test('a click tells the height that locate tells, on a wide screen', () => clickTells(page));

  await t.test('at full detail a click is exact', async () => {
    await page.keyboard.press('Escape');
    await slide(page, 100);
    await until(page, () => document.getElementById('certified')!.textContent === 'Exact');
    await rested(page);
    await page.mouse.click(640, 380);
    await until(page, () => document.getElementById('answer-note')!.textContent!.startsWith('exact'));
    const answer = await told(page);
    assert.ok(Math.abs(located(answer) - Number(answer.height)) < 1e-5);
  });

  await t.test('a profile is drawn and saved, a line of sight is judged', async () => {
    await askAlong(page, 'p', [520, 330], [760, 420]);
    const { head, rows } = await savedCsv(page);
    assert.equal(head, 'distance_m,x,y,height,height_min,height_max');
    assert.ok(rows.length > 19);
    const [, x, y, height] = rows[4];
    assert.ok(Math.abs(located({ x: String(x), y: String(y) }) - height) < 1e-3);
    await page.keyboard.press('Escape');
    await askAlong(page, 's', [520, 330], [760, 420], () => page.fill('input[name=frequency]', '0.45'));
    assert.match(await text(page, '#answer-note'), /Fresnel/);
    await page.keyboard.press('Escape');
  });

  await t.test('detail goes and comes again with the slider', async () => {
    await slide(page, 30);
    await until(page, () => !document.getElementById('certified')!.textContent!.includes('Exact'));
    await rested(page);
    assert.ok(await counted(page, '#fact-vertices') < 20000);
    await slide(page, 100);
    await until(page, () => document.getElementById('certified')!.textContent === 'Exact');
    assert.equal(await counted(page, '#fact-vertices'), 257 * 257);
  });
}));

test('what answers questions comes with the first of them, once, and again where it did not come', async () => {
  let fetched = 0;
  const server = await host(site, { answer: (_, response, path) => {
    if (!path.endsWith('/questions.wasm') || ++fetched > 1) return false;
    response.writeHead(404).end('not here');
    return true;
  } });
  await onPage(`${server.url}#error=5`, async (page) => {
    await complete(page);
    assert.equal(fetched, 0, 'nothing is asked yet');
    await page.mouse.click(640, 380);
    await until(page, () => /questions\.wasm/.test(document.getElementById('answer-note')!.textContent!));
    assert.ok(await page.isHidden('#trouble'), 'the terrain stays as it is');
    for (const x of [640, 600]) {
      await page.mouse.click(x, 380);
      await until(page, () => document.getElementById('answer')!.dataset.height !== undefined);
      await page.keyboard.press('Escape');
      await page.evaluate(() => { delete document.getElementById('answer')!.dataset.height; });
    }
    assert.equal(fetched, 2);
  }, { mayComplain: true });
  await server.close();
});

for (const name of ['degrees', 'feet', 'voids'] as const) {
  test(`of a stream lengths and rows are the program's: ${name}`, async () => {
    const { store: path, stream } = made(name);
    cpSync(stream, join(site, `${name}.ptins`));
    await onPage(`${fast.url}?stream=${name}.ptins`, async (page) => {
      await complete(page);
      await askAlong(page, 'p', [520, 300], [800, 430]);
      const { rows } = await savedCsv(page);
      compareRows(rows, programRows(path, rows), name === 'degrees' ? 1e-4 : 0);
      assert.match(await text(page, '#answer-note'), /Heights exact/);
    });
  });
}
