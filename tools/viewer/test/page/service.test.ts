// SPDX-License-Identifier: GPL-3.0-or-later
//
// The page with a service: its answers against the program, what is certified where the camera looks, a service that goes away.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { ended, hill, made, ptin, served } from '../../../decoder/test/support';
import {
  appears, askAlong, colours, compareRows, complete, faultsOfAxe, onPage, programRows, savedCsv, store, text, told, until,
} from './browser';

const names = ['degrees', 'feet', 'voids'] as const;

test('a service', (t) => served(`hills=${store}`, async (address) => {
  await t.test('a terrain is opened from the page that lists them', () => onPage(address, async (page) => {
    await until(page, () => [...document.images].every((image) => image.complete && image.naturalWidth > 0));
    assert.match(await text(page, 'article:has(a[href*=hills])'), /Heights\s+633 to 1576/);
    assert.equal(await page.locator('.map rect').count(), 4, 'their places on the map');
    await page.addScriptTag({ path: process.env.PTIN_AXE });
    assert.deepEqual(await faultsOfAxe(page), []);
    await page.locator('a.open', { hasText: 'hills' }).click();
    await complete(page);
    assert.ok(await colours(page) > 20);
    assert.ok(await page.locator('#map-choice').isHidden(), 'the service names no base map');
    // The terrain is projected: a place is told in its CRS and in degrees, which the service knows for the same.
    await page.mouse.click(640, 380);
    await appears(page, '#answer');
    const { x, y, height } = await told(page);
    const degrees = /([\d.]+)\u00b0 N\s+([\d.]+)\u00b0 W/.exec(await text(page, '#answer-note'));
    assert.ok(degrees !== null);
    const asked = async (place: string): Promise<number> => {
      const answer = await fetch(`${address}collections/hills/position?f=json&coords=POINT(${place}`);
      return (await answer.json() as { points: Array<{ height: number }> }).points[0].height;
    };
    assert.equal(await asked(`${x} ${y})&crs=native`), Number(height));
    assert.ok(Math.abs(await asked(`-${degrees[2]} ${degrees[1]})`) - Number(height)) < 2, 'half a metre aside at most');
  }));

  await t.test('where the pointer stays, the height is that of the full terrain', () =>
    onPage(`${address}viewer/index.html?collection=voids#error=20`, async (page) => {
      await complete(page);
      const place = (): Promise<string> => text(page, '#place');
      let before = '';
      await page.route(/\/position\?/, async (route) => {
        before = await place();
        await route.continue();
      });
      const [response] = await Promise.all([page.waitForResponse(/\/position\?/), page.mouse.move(640, 380)]);
      assert.match(before, / \u00b1 /, 'that of the picture until then');
      const answer = await response.json() as { exact: boolean; points: Array<{ height: number }> };
      assert.ok(answer.exact);
      await until(page, () => !document.querySelector('#place')!.textContent!.includes('\u00b1'));
      assert.ok(Math.abs(Number(/^[\d.]+/.exec(await place())![0]) - answer.points[0].height) < 0.006, await place());
    }));

  for (const name of names) {
    await t.test(`lengths, rows and lines of sight are the program's: ${name}`, async () => {
      const path = made(name).store;
      await onPage(`${address}viewer/index.html?collection=${name}`, async (page) => {
        await complete(page);
        await askAlong(page, 'p', [520, 300], [800, 430]);
        const { rows } = await savedCsv(page);
        const wanted = programRows(path, rows);
        compareRows(rows, wanted, 0);
        const length = wanted[wanted.length - 1][0];
        assert.equal(Number((await told(page)).metres), length);
        assert.match(await text(page, '#answer-note'), /exact, of the full terrain/);
        await askAlong(page, 's', [520, 300], [800, 430]);
        // Its own ends: another picture may have other places at the same pixels.
        const here = await told(page);
        const ends = [[here.fromX, here.fromY], [here.toX, here.toY]];
        const eye = name === 'feet' ? String(2 / (1200 / 3937)) : '2';
        const sight = JSON.parse(ptin('sight', path, ...ends[0], eye, ...ends[1], eye, '--json')) as
          { verdict: string; length: number; clearance: { min: number } };
        assert.equal(here.verdict, sight.verdict);
        assert.ok(Math.abs(Number(here.length) - sight.length) < 1e-6);
        assert.ok(Math.abs(Number(here.clearanceMin) - sight.clearance.min) < 1e-6);
        const along = programRows(path, ends.map(([x, y]) => [0, Number(x), Number(y)]));
        assert.ok(Math.abs(Number(here.metres) - along[along.length - 1][0]) < 1e-3);
      });
    });
  }

  await t.test('what is certified holds for all that is in sight, wherever the camera looks', () =>
    onPage(`${address}viewer/index.html?collection=degrees`, async (page) => {
      for (const hash of ['', '#at=88.4,27.4,900,60000,30,76', '#at=87,26,900,25000,200,20', '#at=90,29,900,9000,340,80']) {
        await complete(page);
        if (hash !== '') await page.evaluate((to) => { location.hash = to; }, hash);
        // The page asks for what a view lacks once it rests; what it says until then holds, too.
        await page.waitForTimeout(400);
        await complete(page);
        // As text: one by one numbers take longer on their way than all that is done with them.
        const drawn = JSON.parse(await page.evaluate(() => {
          const { frame, status, relief: { drawn, camera } } = window.ptinViewer;
          const { middleX, middleY, scaleX, scaleY, baseHeight, scaleZ } = frame;
          return JSON.stringify({
            certified: status.certificate.error, frame: { middleX, middleY, scaleX, scaleY, baseHeight, scaleZ },
            positions: Array.from(drawn.positions), corners: Array.from(drawn.corners.subarray(0, drawn.parts[drawn.parts.length - 2])),
            seen: Array.from(camera.matrix), factor: window.ptinViewer.view.exaggeration,
          });
        })) as Drawn & { certified: number };
        const { samples, worst } = worstInSight(drawn);
        assert.ok(samples > 20, `${samples} samples in sight of ${hash}`);
        assert.ok(worst <= drawn.certified + 0.06, `${worst} in sight, ${drawn.certified} certified: ${hash}`);
        assert.match(await text(page, '#certified'), /Exact|\u00b1[\d.\u202f]+ m/);
      }
    }));
}, 0, ...names.map((name) => `${name}=${made(name).store}`)));

interface Drawn {
  frame: { middleX: number; middleY: number; scaleX: number; scaleY: number; baseHeight: number; scaleZ: number };
  positions: number[];
  corners: number[];
  seen: number[];
  factor: number;
}

/** The largest error of the drawn mesh at the samples of made('degrees') that are in the picture, whatever hides them. */
function worstInSight({ frame: f, positions: p, corners, seen: e, factor }: Drawn): { samples: number; worst: number } {
  const mapX = (v: number): number => f.middleX + p[3 * v] / f.scaleX, mapY = (v: number): number => f.middleY + p[3 * v + 1] / f.scaleY;
  const step = 0.04, west = 86.02, north = 25 + 121 * step - step / 2;
  const done = new Set<number>();
  let samples = 0, worst = 0;
  for (let t = 0; t < corners.length; t += 3) {
    const [a, b, c] = corners.slice(t, t + 3);
    const xs = [a, b, c].map((v) => (mapX(v) - west) / step), ys = [a, b, c].map((v) => (north - mapY(v)) / step);
    const zs = [a, b, c].map((v) => f.baseHeight + p[3 * v + 2] / f.scaleZ);
    const area = (xs[1] - xs[0]) * (ys[2] - ys[0]) - (xs[2] - xs[0]) * (ys[1] - ys[0]);
    for (let r = Math.ceil(Math.min(...ys) - 1e-3); r <= Math.max(...ys) + 1e-3; ++r) {
      for (let q = Math.ceil(Math.min(...xs) - 1e-3); q <= Math.max(...xs) + 1e-3; ++q) {
        const u = ((q - xs[0]) * (ys[2] - ys[0]) - (xs[2] - xs[0]) * (r - ys[0])) / area;
        const v = ((xs[1] - xs[0]) * (r - ys[0]) - (q - xs[0]) * (ys[1] - ys[0])) / area;
        if (u < -1e-3 || v < -1e-3 || u + v > 1.001 || done.has(1000 * r + q)) continue;
        done.add(1000 * r + q);
        const h = zs[0] + u * (zs[1] - zs[0]) + v * (zs[2] - zs[0]);
        const x = (west + q * step - f.middleX) * f.scaleX, y = (north - r * step - f.middleY) * f.scaleY, z = factor * (h - f.baseHeight) * f.scaleZ;
        const w = e[3] * x + e[7] * y + e[11] * z + e[15];
        const across = (e[0] * x + e[4] * y + e[8] * z + e[12]) / w, up = (e[1] * x + e[5] * y + e[9] * z + e[13]) / w;
        if (w <= 0 || Math.abs(across) > 1 || Math.abs(up) > 1) continue;
        ++samples;
        worst = Math.max(worst, Math.abs(h - Number(hill(r, q).toFixed(1))));
      }
    }
  }
  return { samples, worst };
}

test('after a service was away the page goes on by itself', () => served(`hills=${store}`, async (address, service) => {
  await onPage(`${address}viewer/index.html?collection=hills`, async (page) => {
    await complete(page);
    await ended(service);
    await page.mouse.move(640, 380);
    for (let i = 0; i < 6; ++i) await page.mouse.wheel(0, -240);
    await appears(page, '#trouble');
    assert.match(await text(page, '#certified-what'), /does not answer/);
    await served(`hills=${store}`, async () => {
      await page.waitForSelector('#trouble[hidden]', { state: 'attached' });
      await complete(page);
      await page.mouse.click(640, 380);
      await appears(page, '#answer');
    }, Number(new URL(address).port));
  }, { mayComplain: true });
}));
