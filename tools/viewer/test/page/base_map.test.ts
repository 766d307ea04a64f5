// SPDX-License-Identifier: GPL-3.0-or-later
//
// A base map over the terrain: nobody is asked unasked, and each tile lies where a library of projections has it.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { createServer, type ServerResponse } from 'node:http';
import type { AddressInfo } from 'node:net';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';
import type { BrowserContextOptions, Page } from 'playwright-core';
import { host } from '../../../decoder/test/host.mjs';
import { file, gridded, hill, made, ptin, served } from '../../../decoder/test/support';
import { complete, lastLink, layOut, onPage, rested, store, text } from './browser';

const screen: BrowserContextOptions = { viewport: { width: 560, height: 400 }, reducedMotion: 'reduce' };

/** Red, green and blue of a tile: another one than those of its neighbours and of the tiles around it at other levels. */
const colourOf = (z: number, x: number, y: number): readonly number[] => [30 + 30 * ((x + z) % 4), 30 + 30 * ((y + 2 * z) % 4), 75];

/** A picture of one colour, as BMP. */
function painted(side: number, [red, green, blue]: readonly number[]): Buffer {
  const bytes = Buffer.alloc(54 + 3 * side * side, Buffer.from([blue, green, red]));
  bytes.fill(0, 0, 54).write('BM');
  bytes.writeUInt32LE(bytes.length, 2);
  [54, 40, side, side].forEach((n, i) => { bytes.writeUInt32LE(n, 10 + 4 * i); });
  bytes.writeUInt32LE(1 | 24 << 16, 26);
  return bytes;
}

interface Tiles {
  /** With {z}/{x}/{y} behind it. */
  url: string;
  /** Each tile that was asked for, and those that were given. */
  asked: string[];
  given: Set<string>;
}

/** A host of coloured tiles. `answer`: may answer a request itself, by returning true. */
async function withTiles(
  use: (tiles: Tiles) => Promise<void>, side = 256, answer: (response: ServerResponse, z: number) => boolean = () => false,
): Promise<void> {
  const asked: string[] = [], given = new Set<string>();
  const server = createServer((request, response) => {
    const found = /(\d+)\/(\d+)\/(\d+)/.exec(request.url ?? '');
    assert.ok(found !== null);
    const [z, x, y] = found.slice(1).map(Number);
    asked.push(found[0]);
    if (answer(response, z)) return;
    given.add(found[0]);
    response.writeHead(200, { 'Content-Type': 'image/bmp', 'Access-Control-Allow-Origin': '*' }).end(painted(side, colourOf(z, x, y)));
  });
  await new Promise<void>((resolve) => { server.listen(0, '127.0.0.1', resolve); });
  try {
    await use({ url: `http://127.0.0.1:${(server.address() as AddressInfo).port}`, asked, given });
  } finally {
    server.closeAllConnections();
    await new Promise((resolve) => { server.close(resolve); });
  }
}

interface Mapped {
  baseMap: {
    map: { loading: Map<string, unknown>; layers: Map<string, number>; isOver: boolean; grid: { level: number; column: number; row: number } } | null;
    timer: number;
  };
}

/** Waits until all tiles that the picture wants are drawn, or the map is given up. */
async function mapped(page: Page): Promise<void> {
  for (let times = 0; times < 3;) {
    await rested(page);
    const isStill = await page.evaluate(() => {
      const { map, timer } = (window.ptinViewer as unknown as Mapped).baseMap;
      return timer === 0 && map !== null && (map.isOver || (map.loading.size === 0 && map.layers.size > 0));
    });
    times = isStill ? times + 1 : 0;
  }
}

interface Point {
  x: number;
  y: number;
  mapX: number;
  mapY: number;
  /** Red, green, blue there. */
  colour: number[];
}

/** The ground at points all over the picture, and what colour it has there. */
async function groundPoints(page: Page): Promise<Point[]> {
  const places = await page.evaluate(() => {
    // Parts that lie over the picture are not looked at.
    for (const part of document.querySelectorAll<SVGElement | HTMLElement>('main, #labels, #crosshair, footer, #compass, #toast')) part.style.display = 'none';
    const { frame, relief } = window.ptinViewer;
    const found: Array<{ x: number; y: number; mapX: number; mapY: number }> = [];
    for (let x = 20.5; x < innerWidth; x += 41) {
      for (let y = 20.5; y < innerHeight; y += 37) {
        const place = relief.pick(x, y) as { x: number; y: number } | null;
        // At the terrain's end a pixel is half of the sky.
        const isInside = [[-3, -3], [3, -3], [-3, 3], [3, 3]].every(([i, j]) => relief.pick(x + i, y + j) !== null);
        if (place !== null && isInside) found.push({ x, y, mapX: frame.mapX(place.x), mapY: frame.mapY(place.y) });
      }
    }
    return found;
  });
  await rested(page);
  const png = (await page.screenshot()).toString('base64');
  const colours = await page.evaluate(async ([data, points]) => {
    const picture = await createImageBitmap(new Blob([Uint8Array.from(atob(data), (c) => c.charCodeAt(0))], { type: 'image/png' }));
    const context = new OffscreenCanvas(picture.width, picture.height).getContext('2d', { willReadFrequently: true })!;
    context.drawImage(picture, 0, 0);
    return points.map(({ x, y }) => [...context.getImageData(Math.floor(x), Math.floor(y), 1, 1).data].slice(0, 3));
  }, [png, places] as const);
  return places.map((place, i) => ({ ...place, colour: colours[i] }));
}

/** Web Mercator of places, 0 to 1 from the upper left of the world, by PROJ. */
function mercatorOf(points: readonly Point[], crs: string): Array<[number, number]> {
  const half = 20037508.342789244;
  const input = points.map((p) => `${p.mapX} ${p.mapY}`).join('\n');
  const output = execFileSync('gdaltransform', ['-s_srs', crs, '-t_srs', 'EPSG:3857', '-output_xy'], { input, encoding: 'utf8' });
  return output.trim().split('\n').map((line) => {
    const [x, y] = line.split(' ').map(Number);
    return [(x + half) / (2 * half), (half - y) / (2 * half)];
  });
}

/** The air at the horizon, as the style sheet has it. */
const haze = [0xe3, 0xea, 0xee];

/** Whether a colour is that of a tile in some light, behind a little air. */
function isLit(colour: readonly number[], tile: readonly number[]): boolean {
  const dot = (a: readonly number[], b: readonly number[]): number => a.reduce((sum, n, i) => sum + n * b[i], 0);
  // The least squares.
  const [tt, th, hh, ct, ch] = [dot(tile, tile), dot(tile, haze), dot(haze, haze), dot(colour, tile), dot(colour, haze)];
  const light = (ct * hh - ch * th) / (tt * hh - th * th), air = (ch * tt - ct * th) / (tt * hh - th * th);
  const off = Math.max(...colour.map((c, i) => Math.abs(c - light * tile[i] - air * haze[i])));
  return light > 0.3 && air > -0.02 && air < 0.06 && off < 4;
}

/** Holds the picture to the tiles that the page has: one that was given may have come when it was not wanted any more. */
async function compare(page: Page, crs: string): Promise<void> {
  const given = new Set(await page.evaluate(() => {
    const { layers, grid } = (window.ptinViewer as unknown as Mapped).baseMap.map!;
    return [...layers.keys()].map((name) => {
      const [up, column, row] = name.split('/').map(Number);
      return `${grid.level + up}/${grid.column * 2 ** up + column}/${grid.row * 2 ** up + row}`;
    });
  }));
  const points = await groundPoints(page);
  assert.ok(points.length > 60, `${points.length} points`);
  const levels = [...new Set([...given].map((name) => Number(name.split('/')[0])))].sort((a, b) => b - a);
  let clear = 0;
  mercatorOf(points, crs).forEach(([u, v], i) => {
    const level = levels.find((z) => given.has(`${z}/${Math.floor(u * 2 ** z)}/${Math.floor(v * 2 ** z)}`));
    assert.ok(level !== undefined);
    const at = [u * 2 ** level, v * 2 ** level];
    // Beside a seam the pixel may be the neighbour's: a hundredth of a tile is two or three of its pixels.
    if (at.some((n) => Math.abs(n - Math.round(n)) < 0.01)) return;
    ++clear;
    const tile = colourOf(level, Math.floor(at[0]), Math.floor(at[1]));
    assert.ok(isLit(points[i].colour, tile), `${points[i].colour} at ${points[i].x} ${points[i].y}, where ${level}/${at} is ${tile}`);
  });
  assert.ok(clear > 0.8 * points.length);
}

const hasProj = ((): boolean => {
  try {
    execFileSync('gdaltransform', ['--version']);
    return true;
  } catch {
    return false;
  }
})();

for (const { name, crs, at, side, template } of [
  { name: 'degrees', crs: 'EPSG:4326', at: '88.3,27.4,600,700000,20,0', side: 256, template: '{z}/{x}/{y}' },
  { name: 'projected', crs: 'EPSG:32611', at: '', side: 512, template: 'wmts?TILE={TileMatrix}/{TileCol}/{TileRow}' },
]) {
  test(`tiles lie where they belong, and come when they are wanted: ${name}`, { skip: hasProj ? false : 'there is no gdaltransform' }, () => withTiles(async (tiles) => {
    const path = name === 'degrees' ? made('degrees').store : store;
    await served(`t=${path}`, (address) => onPage(`${address}viewer/index.html?collection=t#shading=map&exaggeration=1${at === '' ? '' : `&at=${at}`}`, async (page) => {
      await complete(page);
      if (at === '') for (let i = 0; i < 18; ++i) await page.keyboard.press('PageUp');
      await rested(page);
      assert.deepEqual(tiles.asked, [], 'a link turns no map on');
      assert.equal(await page.isVisible('#attribution:has-text("Map")'), false);
      await page.keyboard.press('4');
      await mapped(page);
      assert.ok(tiles.asked.length > 4);
      assert.equal(new Set(tiles.asked).size, tiles.asked.length, 'no tile twice');
      assert.match(await text(page, '#attribution'), /Map: Who made it/);
      assert.doesNotMatch(await lastLink(page), /shading/);
      const [saved] = await Promise.all([page.waitForEvent('download'), page.keyboard.press('e')]);
      assert.ok(readFileSync((await saved.path())!).length > 1000, 'a picture with tiles may be saved');
      await compare(page, crs);
      const before = tiles.asked.length;
      for (let i = 0; i < 12; ++i) await page.keyboard.press('+');
      await mapped(page);
      assert.ok(tiles.asked.length > before, 'nearer ground has finer tiles');
      await compare(page, crs);
      const layers = await page.evaluate(() => (window.ptinViewer as unknown as Mapped).baseMap.map!.layers.size);
      assert.ok(layers <= (32 << 20) / (4 * side * side), `${layers} tiles on the card`);
      await page.keyboard.press('1');
      const end = tiles.asked.length;
      for (let i = 0; i < 6; ++i) await page.keyboard.press('-');
      await rested(page);
      await page.waitForTimeout(300);
      assert.equal(tiles.asked.length, end, 'turned off it asks nobody');
    }, { screen }), 0, '--base-map', `${tiles.url}/${template}`, '--base-map-attribution', 'Who made it');
  }, side));
}

test('a stream on any host brings the map that its file names', () => withTiles(async (tiles) => {
  const rows = Array.from({ length: 40 }, (_, r) => Array.from({ length: 40 }, (_, c) => hill(r, c).toFixed(1)));
  gridded('mapped', 'EPSG:4326', [7, 46], 0.001, rows);
  const [named, stream, folder] = [file('named.ptin'), file('named.ptins'), file('named')];
  ptin('build', file('mapped.asc'), '--a-srs', 'EPSG:4326', '--base-map', `${tiles.url}/{z}/{x}/{y}.png`, '-q', '-o', named);
  ptin('stream', named, '-o', stream);
  layOut(folder, '--stream', stream);
  const web = await host(folder);
  try {
    await onPage(web.url, async (page) => {
      await complete(page);
      assert.deepEqual(tiles.asked, []);
      await page.keyboard.press('4');
      await mapped(page);
      assert.ok(tiles.asked.length > 0);
      assert.match(await text(page, '#attribution'), /Map: 127\.0\.0\.1/);
    }, { screen });
  } finally {
    await web.close();
  }
}));

test('what a map lacks is told once, and the terrain stays', () => {
  type Fault = 'none' | 'not for others' | 'not beyond 12';
  let fault = 'none' as Fault;
  return withTiles(async (tiles) => {
    const rows = Array.from({ length: 40 }, (_, r) => Array.from({ length: 40 }, (_, c) => hill(r, c).toFixed(1)));
    const placeless = gridded('placeless', 'LOCAL_CS["site",UNIT["metre",1]]', [0, 0], 10, rows).store;
    await served(`hills=${store}`, async (address) => {
      await onPage(`${address}viewer/index.html?collection=hills`, async (page) => {
        const note = (): Promise<string | null> => page.locator('#map-note').textContent();
        /** Turns the map on anew. */
        const turnOn = async (now: Fault): Promise<string[]> => {
          fault = now;
          tiles.asked.length = 0;
          await page.keyboard.press('3');
          await page.keyboard.press('4');
          await mapped(page);
          return tiles.asked;
        };
        await complete(page);
        const inVain = await turnOn('none');
        assert.match((await note())!, /cannot be had: status 404/);
        assert.ok(inVain.length > 0 && inVain.length <= 10, `${inVain.length} requests`);
        await turnOn('not for others');
        assert.match((await note())!, /CORS/);
        const asked = await turnOn('not beyond 12');
        for (let i = 0; i < 8; ++i) await page.keyboard.press('+');
        await mapped(page);
        assert.match((await note())!, /Some tiles of .* are missing/);
        const missing = asked.filter((name) => !tiles.given.has(name));
        assert.ok(missing.length >= 4 && missing.length <= 12, `${missing.length} requests in vain`);
        await page.mouse.click(640, 380);
        await page.waitForSelector('#answer:not([hidden])');
      }, { mayComplain: true });
      tiles.asked.length = 0;
      await onPage(`${address}viewer/index.html?collection=here`, async (page) => {
        await complete(page);
        assert.equal(await page.locator('input[value=map]').isDisabled(), true);
        assert.match((await page.locator('#map-note').textContent())!, /nobody tells where on Earth/);
        await page.keyboard.press('4');
        await page.waitForTimeout(300);
        assert.deepEqual(tiles.asked, []);
      });
    }, 0, `here=${placeless}`, '--base-map', `${tiles.url}/{z}/{x}/{y}.png`);
  }, 256, (response, z) => {
    if (fault === 'not beyond 12' && z <= 12) return false;
    if (fault === 'not for others') response.writeHead(200, { 'Content-Type': 'image/bmp' }).end(painted(256, [1, 2, 3]));
    else response.writeHead(404, { 'Access-Control-Allow-Origin': '*' }).end();
    return true;
  });
});
