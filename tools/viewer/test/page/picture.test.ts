// SPDX-License-Identifier: GPL-3.0-or-later
//
// The picture, the camera over it, and the page around it.
import assert from 'node:assert/strict';
import { cpSync, readFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import type { Page } from 'playwright-core';
import { gridded } from '../../../decoder/test/support';
import { appears, colours, complete, fast, faultsOfAxe, lastLink, onPage, phone, quick, rested, site, text, until } from './browser';

const tilt = (page: Page): Promise<number> => page.evaluate(() => window.ptinViewer.view.current.tilt);
const heading = (page: Page): Promise<number> => page.evaluate(() => window.ptinViewer.view.current.heading);
const seen = (page: Page, place: { x: number; y: number; z: number }): Promise<{ x: number; y: number }> =>
  page.evaluate(({ x, y, z }) => window.ptinViewer.view.project(x, y, z), place);
/** The camera above the ground below it. */
const above = (page: Page): Promise<number> => page.evaluate(() => {
  const { relief, view } = window.ptinViewer;
  const [x, y, z] = relief.camera.position;
  return z - (relief.groundAt(x, y) ?? 0) * view.exaggeration;
});
/** Presses a key, and waits until the picture, beside the card, is another one; returns it. */
async function changedBy(page: Page, key: string, before: Buffer): Promise<Buffer> {
  await page.keyboard.press(key);
  // Edges come from the Worker, some time later.
  for (const begin = Date.now(); Date.now() - begin < 60000;) {
    await rested(page);
    const now = await pictureOf(page);
    if (!now.equals(before)) return now;
  }
  throw new Error(`${key} changes nothing`);
}
const pictureOf = (page: Page): Promise<Buffer> => page.screenshot({ clip: { x: 400, y: 200, width: 560, height: 400 } });

test('the picture and the camera', (t) => onPage(`${fast.url}#error=20`, async (page) => {
  await complete(page);

  await t.test('while nothing moves nothing is drawn, and what is under the pointer is found without a picture', async () => {
    const pictures = await rested(page);
    for (let i = 0; i < 30; ++i) await page.mouse.move(500 + 5 * i, 380);
    await until(page, () => document.getElementById('place')!.textContent !== '');
    assert.equal(await rested(page), pictures);
  });

  await t.test('triangles, isolines and colours change the picture', async () => {
    let before = await pictureOf(page);
    for (const key of ['w', 'i', '2', '3', '1']) before = await changedBy(page, key, before);
    assert.ok(await page.isChecked('#wireframe'));
    const link = await lastLink(page);
    assert.match(link, /wireframe=1/);
    assert.match(link, /interval=\d/);
    for (const key of ['w', 'i']) before = await changedBy(page, key, before);
  });

  await t.test('the ground under the wheel stays there, and the camera above it', async () => {
    const place = await page.evaluate(() => window.ptinViewer.relief.pick(640, 420) as { x: number; y: number; z: number });
    const before = await seen(page, place);
    assert.ok(Math.hypot(before.x - 640, before.y - 420) < 1, 'projected where it was picked');
    await page.mouse.move(640, 420);
    for (let i = 0; i < 5; ++i) await page.mouse.wheel(0, -240);
    await rested(page);
    const after = await seen(page, place);
    assert.ok(Math.hypot(after.x - 640, after.y - 420) < 12, `${after.x} ${after.y}`);
  });

  await t.test('the compass shows north, and turns there', async () => {
    await page.keyboard.press('r');
    for (let i = 0; i < 4; ++i) await page.keyboard.press('.');
    assert.ok(Math.abs(await heading(page) - 305) < 0.5);
    await page.click('#compass');
    await rested(page);
    const north = await heading(page);
    assert.ok(Math.min(north, 360 - north) < 0.5, `${north}`);
    await page.keyboard.press('r');
  });

  await t.test('keys tilt, leave no ring, and the pointer costs nothing while it moves', async () => {
    await page.mouse.click(640, 380);
    await appears(page, '#answer');
    await page.keyboard.press('PageDown');
    const low = await tilt(page);
    await page.keyboard.press('PageUp');
    assert.ok(Math.abs(low - await tilt(page) - 5) < 0.1);
    assert.equal(await page.evaluate(() => getComputedStyle(document.getElementById('relief')!).boxShadow), 'none');
    assert.notEqual(await text(page, '#scale'), '');
    await page.evaluate(() => {
      const w = window as unknown as { picks: number };
      const { relief } = window.ptinViewer;
      const pick = relief.pick.bind(relief);
      w.picks = 0;
      document.getElementById('place')!.textContent = '';
      relief.pick = (x, y) => { ++w.picks; return pick(x, y); };
      // A pointer moves without a rest.
      for (let i = 0; i < 15; ++i) {
        const move = { clientX: 500 + 10 * i, clientY: 380, pointerType: 'mouse', bubbles: true };
        document.getElementById('relief')!.dispatchEvent(new PointerEvent('pointermove', move));
      }
    });
    await until(page, () => document.getElementById('place')!.textContent !== '');
    assert.equal(await page.evaluate(() => (window as unknown as { picks: number }).picks), 1);
    await page.keyboard.press('Escape');
  });

  await t.test('a link brings the same view', async () => {
    const numbers = (url: string): number[] => new URLSearchParams(new URL(url).hash.slice(1)).get('at')!.split(',').map(Number);
    for (const key of ['ArrowUp', 'ArrowLeft', '+', '+', '.']) await page.keyboard.press(key);
    const link = await lastLink(page);
    assert.match(link, /#at=/);
    await page.goto('about:blank');
    await page.goto(link);
    await complete(page);
    const [first, second] = [numbers(link), numbers(await lastLink(page))];
    first.forEach((n, i) => { assert.ok(Math.abs(n - second[i]) <= 2e-3 * Math.abs(n), `${first} ${second}`); });
  });

  await t.test('the camera stays above the ground', async () => {
    await page.emulateMedia({ reducedMotion: 'no-preference' });
    await page.keyboard.press('r');
    await rested(page);
    await page.mouse.move(640, 380);
    for (let i = 0; i < 40; ++i) await page.mouse.wheel(0, -240);
    await rested(page);
    for (let i = 0; i < 20; ++i) {
      await page.keyboard.press('PageDown');
      await page.keyboard.press('ArrowUp');
    }
    await rested(page);
    assert.ok(await above(page) > 0);
    await page.mouse.down({ button: 'right' });
    await page.mouse.move(640, 100, { steps: 5 });
    await page.mouse.up({ button: 'right' });
    await rested(page);
    assert.ok(await above(page) > 0);
    await page.emulateMedia({ reducedMotion: null });
  });
}));

test('a link that wants the impossible shows the terrain, and a card that loses its picture gets it back', () =>
  onPage(`${fast.url}#error=20&interval=0.000001&at=1e300,-1e300,1e300,1e300,30,40`, async (page) => {
    await complete(page);
    const { x, y, distance } = await page.evaluate(() => window.ptinViewer.view.current);
    assert.ok([x, y, distance].every((n) => Math.abs(n) < 1e7), `${x} ${y} ${distance}`);
    for (let i = 0; i < 60; ++i) await page.keyboard.press('ArrowLeft');
    await page.evaluate(() => { location.hash = 'at=380000,3803000,1000,9000,0,30'; });
    await rested(page);
    await page.mouse.click(640, 380);
    await appears(page, '#answer');
    await rested(page);
    const before = await colours(page);
    const card = await page.evaluateHandle(() => {
      const lost = document.querySelector<HTMLCanvasElement>('#relief')!.getContext('webgl2')!.getExtension('WEBGL_lose_context')!;
      lost.loseContext();
      return lost;
    });
    await appears(page, '#trouble');
    await card.evaluate((lost) => { lost.restoreContext(); });
    await page.waitForSelector('#trouble[hidden]', { state: 'attached' });
    await rested(page);
    assert.ok(before > 50 && await colours(page) > 0.8 * before, 'the terrain is drawn again');
    assert.equal(await page.evaluate(() => (window.ptinViewer.relief as unknown as { marks: { all: object[] } }).marks.all.length), 4, 'and the mark, with its triangle');
  }, { mayComplain: true }));

test('nothing is wider than a phone, and axe finds no fault', async () => {
  for (const screen of [phone, quick]) {
    await onPage(`${fast.url}#error=20`, async (page) => {
      await complete(page);
      await page.keyboard.press('p');
      assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth));
      const over = await page.evaluate(() => [...document.querySelectorAll('button, input, label')].filter((e) => {
        const box = e.getBoundingClientRect();
        return box.width > 1 && box.height > 1 && (box.left < -1 || box.right > innerWidth + 1);
      }).map((e) => e.outerHTML.slice(0, 80)));
      assert.deepEqual(over, []);
      if (screen === quick) {
        // Somebody's letters are twice as large.
        const cut = await page.evaluate(() => {
          document.documentElement.style.fontSize = '28px';
          const cut = [...document.querySelectorAll<HTMLElement>('#tools label span')].filter((e) =>
            e.getBoundingClientRect().right > document.getElementById('tools')!.getBoundingClientRect().right).map((e) => e.innerText);
          document.documentElement.style.fontSize = '';
          return cut;
        });
        assert.deepEqual(cut, []);
      }
      // As the page's policy lets no script of another place in.
      await page.evaluate(readFileSync(process.env.PTIN_AXE!, 'utf8'));
      assert.deepEqual(await faultsOfAxe(page), []);
      // Dark, it is the same document in other colours.
      await page.emulateMedia({ colorScheme: 'dark' });
      assert.deepEqual(await faultsOfAxe(page, ['color-contrast']), []);
      await page.emulateMedia({ colorScheme: null });
    }, { screen });
  }
});

test('a terrain of 800 km fills the picture as a small one does', async () => {
  const heights = Array.from({ length: 40 }, (_, row) =>
    Array.from({ length: 40 }, (_, c) => (500 + 300 * Math.sin(c / 4) * Math.cos(row / 5)).toFixed(2)));
  cpSync(gridded('wide', 'EPSG:3413', [0, 0], 20000, heights).stream, join(site, 'wide.ptins'));
  await onPage(`${fast.url}?stream=wide.ptins`, async (page) => {
    await complete(page);
    const away = await page.evaluate(() => Math.hypot(...window.ptinViewer.relief.camera.position));
    assert.ok(away < 3e6, `${away} m`);
  });
});
