// SPDX-License-Identifier: GPL-3.0-or-later
//
// The page in a browser: it opens, refines, answers, and says what is wrong.
import assert from 'node:assert/strict';
import { type ChildProcess, spawn } from 'node:child_process';
import { cpSync, mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { Browser, BrowserContextOptions, Page, chromium } from 'playwright-core';
import { host } from './host.mjs';
import { assets, file, hill, made, program, ptin, terrain } from './support';

const site = file('site');
let browser: Browser;
let store = '';
let fast: Awaited<ReturnType<typeof host>>;
let portioned: Awaited<ReturnType<typeof host>>;

before(async () => {
  const made = terrain('mountains_257');
  store = made.store;
  ptin('viewer', '-o', site, '--stream', made.stream);
  cpSync(assets, site, { recursive: true, force: true, filter: (from) => !from.endsWith('index.html') });
  fast = await host(site);
  portioned = await host(site, { portions: 3 });
  browser = await chromium.launch({
    executablePath: process.env.CHROMIUM, args: ['--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--no-sandbox'],
  });
});
after(async () => {
  await browser?.close();
  await fast?.close();
  await portioned?.close();
});

// A processor draws here, each vertex of each picture: where detail is not the subject a page opens at an error (`#error=5`).
const wide = { viewport: { width: 1100, height: 720 } };
const phone = { viewport: { width: 360, height: 740 }, hasTouch: true, isMobile: true, deviceScaleFactor: 2 };

/** An empty page. What is waited for may take long: a processor draws, and shares itself with other tests. */
async function emptyPage(options: BrowserContextOptions = wide): Promise<Page> {
  const context = await browser.newContext(options);
  context.setDefaultTimeout(240000);
  return context.newPage();
}

/** A page, with what it complained of. */
async function opened(address: string, options: BrowserContextOptions = wide): Promise<{ page: Page; faults: string[] }> {
  const page = await emptyPage(options);
  const faults: string[] = [];
  page.on('console', (message) => { if (['error', 'warning'].includes(message.type())) faults.push(message.text()); });
  page.on('pageerror', (error) => { faults.push(error.message); });
  await page.goto(address);
  return { page, faults: faults };
}

async function complete(page: Page): Promise<void> {
  await page.waitForFunction(() => document.querySelector('#progress')!.classList.contains('done'));
  await rested(page);
}

/** Waits until the picture is drawn and nothing more is asked for. */
async function rested(page: Page): Promise<number> {
  return page.evaluate(async () => {
    const relief = (window as unknown as { ptinViewer: { relief: { pictures: number } } }).ptinViewer.relief;
    for (let before = -1; before !== relief.pictures;) {
      before = relief.pictures;
      await new Promise((resolve) => { setTimeout(resolve, 700); });
    }
    return relief.pictures;
  });
}

/** The address of the page once its view rests. It is written some time after the last key. */
async function lastLink(page: Page): Promise<string> {
  for (let before = '';;) {
    await rested(page);
    const link = page.url();
    if (link === before) return link;
    before = link;
  }
}

/** How many colours the middle of the picture has. */
async function colours(page: Page): Promise<number> {
  const { width, height } = page.viewportSize()!;
  const clip = { x: width * 0.4, y: height * 0.4, width: width * 0.3, height: height * 0.25 };
  const png = (await page.screenshot({ clip })).toString('base64');
  return page.evaluate(async (data) => {
    const picture = await createImageBitmap(await (await fetch(`data:image/png;base64,${data}`)).blob());
    const canvas = new OffscreenCanvas(picture.width, picture.height);
    const context = canvas.getContext('2d')!;
    context.drawImage(picture, 0, 0);
    const { data: pixels } = context.getImageData(0, 0, picture.width, picture.height);
    return new Set(new Uint32Array(pixels.buffer)).size;
  }, png);
}

const text = (page: Page, selector: string): Promise<string> => page.locator(selector).innerText();
const digits = (told: string): number => Number(told.replace(/[^0-9]/g, ''));

test('the page shows the terrain while it arrives, and then rests', async () => {
  const { page, faults } = await opened(portioned.url);
  // The host waits after each portion, so that nothing here depends on which of them is faster, the page or its data.
  let vertices = 0;
  for (let portion = 1; portion < 3; ++portion) {
    await page.waitForFunction(([before, share]) =>
      Number(document.querySelector('#fact-vertices')!.textContent!.replace(/[^0-9]/g, '')) > before &&
      Number(document.querySelector('#progress')!.getAttribute('aria-valuenow')) >= share, [vertices, 33 * portion]);
    await rested(page);
    vertices = digits(await text(page, '#fact-vertices'));
    assert.ok(Number(await page.getAttribute('#progress', 'aria-valuenow')) <= 33 * portion + 1, 'no more than what has come');
    assert.match(await text(page, '#certified-what'), /still refining/);
    portioned.more();
  }
  await complete(page);
  assert.ok(vertices < 257 * 257, `${vertices} were shown before the end`);
  assert.equal(digits(await text(page, '#fact-vertices')), 257 * 257);
  assert.equal(await text(page, '#certified'), 'Exact');
  assert.ok(await colours(page) > 500, 'the picture is not blank');
  const pictures = await rested(page);
  await page.waitForTimeout(500);
  assert.equal(await rested(page), pictures, 'nothing is drawn while nothing changes');
  assert.deepEqual(faults, []);
  await page.context().close();
});

for (const [name, options] of [['a wide screen', wide], ['a phone', phone]] as const) {
  test(`a click tells the height that locate tells, on ${name}`, async () => {
    const { page, faults } = await opened(`${fast.url}#error=5`, options);
    await complete(page);
    const { width, height } = page.viewportSize()!;
    await page.mouse.click(width * 0.6, height * 0.55);
    await page.waitForSelector('#answer:not([hidden])');
    const told = await page.evaluate(() => ({ ...document.getElementById('answer')!.dataset })) as Record<string, string>;
    const at = (...more: string[]): number =>
      JSON.parse(ptin('locate', store, told.x, told.y, '--json', ...more)).points[0].height as number;
    assert.ok(Math.abs(at() - Number(told.height)) <= Number(told.deviation) + 1e-9, 'the interval holds the full height');
    const certified = Number((await text(page, '#certified')).replace(/[^0-9.]/g, ''));
    assert.ok(certified <= 5 && certified > 0);
    assert.match(await text(page, '#answer-note'), /certainly between [\d.]+ m and [\d.]+ m/);
    assert.ok(await colours(page) > 400);
    assert.deepEqual(faults, []);
    await page.context().close();
  });
}

test('at full detail a click is exact', async () => {
  const { page } = await opened(fast.url);
  await complete(page);
  await page.mouse.click(640, 380);
  await page.waitForSelector('#answer:not([hidden])');
  const told = await page.evaluate(() => ({ ...document.getElementById('answer')!.dataset })) as Record<string, string>;
  const point = JSON.parse(ptin('locate', store, told.x, told.y, '--json')).points[0] as { height: number };
  assert.ok(Math.abs(point.height - Number(told.height)) < 1e-5);
  assert.match(await text(page, '#answer-note'), /^exact/);
  await page.context().close();
});

test('what answers questions comes with the first of them, once, and again where it did not come', async () => {
  let fetched = 0;
  const server = await host(site, { answer: (_, response, path) => {
    if (!path.endsWith('/questions.wasm') || ++fetched > 1) return false;
    response.writeHead(404).end('not here');
    return true;
  } });
  const { page } = await opened(`${server.url}#error=5`);
  await complete(page);
  assert.equal(fetched, 0, 'nothing is asked yet');
  await page.mouse.click(640, 380);
  await page.waitForFunction(() => /questions\.wasm/.test(document.getElementById('toast')!.textContent!));
  assert.ok(await page.isHidden('#trouble'), 'the terrain stays as it is');
  for (const x of [640, 600]) {
    await page.mouse.click(x, 380);
    await page.waitForFunction(() => document.getElementById('answer')!.dataset.height !== undefined);
    await page.keyboard.press('Escape');
    await page.evaluate(() => { delete document.getElementById('answer')!.dataset.height; });
  }
  assert.equal(fetched, 2);
  await page.context().close();
  await server.close();
});

test('triangles, isolines and colours change the picture', async () => {
  const { page, faults } = await opened(`${fast.url}#error=20`);
  await complete(page);
  let before = await page.screenshot();
  for (const key of ['w', 'i', '2', '3', '1']) {
    await page.keyboard.press(key);
    await rested(page);
    const now = await page.screenshot();
    assert.ok(!now.equals(before), `${key} changes the picture`);
    before = now;
  }
  assert.ok(await page.isChecked('#wireframe'));
  assert.match(page.url(), /wireframe=1/);
  assert.match(page.url(), /interval=\d/);
  assert.deepEqual(faults, []);
  await page.context().close();
});

test('a profile is drawn and saved, a line of sight is judged', async () => {
  const { page, faults } = await opened(fast.url);
  await complete(page);
  await page.keyboard.press('p');
  await page.mouse.click(520, 330);
  await page.waitForTimeout(200);
  await page.mouse.click(760, 420);
  await page.waitForSelector('#plot .surface');
  const [download] = await Promise.all([page.waitForEvent('download'), page.click('#csv')]);
  const csv = readFileSync((await download.path())!, 'utf8').trim().split('\n');
  assert.equal(csv[0], 'distance_m,x,y,height,height_min,height_max');
  assert.ok(csv.length > 20);
  const [, x, y, height] = csv[5].split(',').map(Number);
  const point = JSON.parse(ptin('locate', store, String(x), String(y), '--json')).points[0] as { height: number };
  assert.ok(Math.abs(point.height - height) < 1e-3);
  await page.keyboard.press('Escape');
  await page.keyboard.press('s');
  await page.mouse.click(520, 330);
  await page.waitForTimeout(200);
  await page.fill('input[name=frequency]', '0.45');
  await page.mouse.click(760, 420);
  await page.waitForFunction(() => /Visible|Hidden/.test(document.getElementById('answer-text')!.textContent!));
  assert.match(await text(page, '#answer-note'), /Fresnel/);
  assert.deepEqual(faults, []);
  await page.context().close();
});

test('detail goes and comes again with the slider', async () => {
  const { page } = await opened(fast.url);
  await complete(page);
  const slide = (value: number): Promise<void> => page.locator('#error').evaluate((e, v) => {
    (e as HTMLInputElement).value = String(v);
    e.dispatchEvent(new Event('input', { bubbles: true }));
  }, value);
  await slide(30);
  await page.waitForFunction(() => !document.getElementById('certified')!.textContent!.includes('Exact'));
  await rested(page);
  assert.ok(digits(await text(page, '#fact-vertices')) < 20000);
  await slide(100);
  await page.waitForFunction(() => document.getElementById('certified')!.textContent === 'Exact');
  assert.equal(digits(await text(page, '#fact-vertices')), 257 * 257);
  await page.context().close();
});

test('a link brings the same view', async () => {
  const { page } = await opened(fast.url);
  await complete(page);
  for (const key of ['ArrowUp', 'ArrowLeft', '+', '+', '.']) await page.keyboard.press(key);
  const link = await lastLink(page);
  assert.match(link, /#at=/);
  const again = await opened(link);
  await complete(again.page);
  const numbers = (url: string): number[] => new URLSearchParams(new URL(url).hash.slice(1)).get('at')!.split(',').map(Number);
  const [first, second] = [numbers(link), numbers(await lastLink(again.page))];
  first.forEach((n, i) => { assert.ok(Math.abs(n - second[i]) <= 2e-3 * Math.abs(n), `${first} ${second}`); });
  await page.context().close();
  await again.page.context().close();
});

test('what is wrong is said in a sentence', async () => {
  const whole = readFileSync(file('mountains_257.ptins'));
  const bad = new Uint8Array(whole);
  bad[40000] ^= 1;
  mkdirSync(site, { recursive: true });
  writeFileSync(join(site, 'damaged.ptins'), bad);
  // The first frame behind T0, which comes with T0 in one piece.
  const early = new Uint8Array(whole);
  early[3000] ^= 1;
  writeFileSync(join(site, 'early.ptins'), early);
  writeFileSync(join(site, 'cut.ptins'), whole.subarray(0, 60000));
  writeFileSync(join(site, 'short.ptins'), whole.subarray(0, 700));
  writeFileSync(join(site, 'store.ptin'), readFileSync(store));
  const said = async (stream: string): Promise<string> => {
    const { page } = await opened(`${fast.url}?stream=${encodeURIComponent(stream)}`);
    await page.waitForSelector('#trouble:not([hidden])');
    const told = await text(page, '#trouble');
    await page.context().close();
    return told;
  };
  assert.match(await said('none.ptins'), /no such terrain[^]*none\.ptins/);
  assert.match(await said('viewer.js'), /not a stream/);
  assert.match(await said('store.ptin'), /not a stream[^]*store/);
  assert.match(await said('damaged.ptins'), /damaged[^]*frame \d+ at byte \d+/);
  assert.match(await said('short.ptins'), /too early/);
  assert.match(await said('http://127.0.0.1:9/x.ptins'), /cannot be reached/);
  const { page } = await opened(`${fast.url}?stream=cut.ptins`);
  await complete(page);
  assert.match(await text(page, '#certified-what'), /did not arrive/);
  assert.ok(digits(await text(page, '#fact-vertices')) > 10000);
  await page.context().close();
  for (const stream of ['damaged.ptins', 'early.ptins']) {
    const damaged = await opened(`${fast.url}?stream=${stream}`);
    await damaged.page.waitForSelector('#trouble:not([hidden])');
    assert.match(await text(damaged.page, '#certified-what'), /certified[^]*damaged/, stream);
    assert.doesNotMatch(await text(damaged.page, '#certified-what'), /refining/);
    assert.ok(digits(await text(damaged.page, '#fact-vertices')) > 0, 'what came before the damage is shown');
    await damaged.page.context().close();
  }
});

test('nothing is wider than a phone, and axe finds no serious fault', async () => {
  for (const options of [phone, wide, { ...wide, colorScheme: 'dark' as const, reducedMotion: 'reduce' as const }]) {
    const { page, faults } = await opened(`${fast.url}#error=5`, options);
    await complete(page);
    await page.keyboard.press('p');
    assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth));
    const over = await page.evaluate(() => [...document.querySelectorAll('button, input, label')].filter((e) => {
      const box = e.getBoundingClientRect();
      return box.width > 1 && box.height > 1 && (box.left < -1 || box.right > innerWidth + 1);
    }).map((e) => e.outerHTML.slice(0, 80)));
    assert.deepEqual(over, []);
    await page.addScriptTag({ path: process.env.PTIN_AXE });
    const found = await page.evaluate(async () => {
      const { axe } = window as unknown as {
        axe: { run(): Promise<{ violations: Array<{ id: string; impact: string; nodes: Array<{ html: string }> }> }> };
      };
      return (await axe.run()).violations.filter((v) => ['serious', 'critical'].includes(v.impact))
        .map((v) => `${v.id}: ${v.nodes.map((n) => n.html.slice(0, 120)).join(' | ')}`);
    });
    assert.deepEqual(found, []);
    assert.deepEqual(faults, []);
    await page.context().close();
  }
});

test('a terrain of 800 km fills the picture as a small one does', async () => {
  const heights = Array.from({ length: 40 }, (_, row) => Array.from({ length: 40 }, (_, c) => 500 + 300 * Math.sin(c / 4) * Math.cos(row / 5)));
  writeFileSync(file('wide.asc'), ['ncols 40', 'nrows 40', 'xllcorner 0', 'yllcorner 0', 'cellsize 20000',
    ...heights.map((row) => row.map((h) => h.toFixed(2)).join(' '))].join('\n') + '\n');
  ptin('build', file('wide.asc'), '--a-srs', 'EPSG:3413', '-q', '-o', file('wide.ptin'));
  ptin('stream', file('wide.ptin'), '-o', join(site, 'wide.ptins'));
  const { page, faults } = await opened(`${fast.url}?stream=wide.ptins`);
  await complete(page);
  const away = await page.evaluate(() => {
    const viewer = (window as unknown as { ptinViewer: { relief: { camera: { position: { length(): number } } } } }).ptinViewer;
    return viewer.relief.camera.position.length();
  });
  assert.ok(away < 3e6, `${away} m`);
  assert.deepEqual(faults, []);
  await page.context().close();
});

test('without a stream the page asks for one', async () => {
  const bare = file('bare');
  ptin('viewer', '-o', bare);
  cpSync(assets, bare, { recursive: true, force: true });
  const server = await host(bare);
  const { page, faults } = await opened(server.url);
  await page.waitForSelector('#welcome:not([hidden])');
  assert.ok(await page.isHidden('#scale'));
  await page.setInputFiles('#welcome input[type=file]', file('mountains_257.ptins'));
  await complete(page);
  assert.equal(await text(page, '#title'), 'mountains_257');
  assert.equal(digits(await text(page, '#fact-vertices')), 257 * 257);
  assert.deepEqual(faults, []);
  await page.context().close();
  await server.close();
});

/** A service of terrains, and its address. */
async function serving(terrains: string[], port = 0): Promise<{ service: ChildProcess; address: string }> {
  const service = spawn(program, ['serve', ...terrains, '--listen', `127.0.0.1:${port}`], { stdio: ['ignore', 'pipe', 'ignore'] });
  const address = await new Promise<string>((resolve, reject) => {
    let said = '';
    service.on('error', reject);
    service.stdout!.on('data', (bytes: Buffer) => {
      said += bytes.toString();
      const found = /http:\/\/[\d.:]+\//.exec(said);
      if (found !== null) resolve(found[0]);
    });
  });
  return { service, address };
}

/** Ends a service, and waits for its end. */
async function ended(service: ChildProcess): Promise<void> {
  if (service.exitCode !== null) return;
  const over = new Promise((resolve) => { service.on('exit', resolve); });
  service.kill();
  await over;
}

test('opens a terrain of a service from the page that lists them', async () => {
  const { service, address } = await serving([`hills=${store}`]);
  try {
    const { page, faults } = await opened(address);
    await page.locator('a', { hasText: 'hills' }).click();
    await complete(page);
    assert.ok(await colours(page) > 20);
    assert.deepEqual(faults, []);
    await page.context().close();
  } finally {
    await ended(service);
  }
});

type Told = Record<string, string>;
const told = (page: Page): Promise<Told> => page.evaluate(() => ({ ...document.getElementById('answer')!.dataset })) as Promise<Told>;

/** A line between two points of the picture, as CSV. */
async function profile(page: Page, a: [number, number], b: [number, number]): Promise<number[][]> {
  await page.keyboard.press('p');
  await page.mouse.click(...a);
  await page.waitForTimeout(200);
  await page.mouse.click(...b);
  await page.waitForSelector('#plot .surface');
  const [saved] = await Promise.all([page.waitForEvent('download'), page.click('#csv')]);
  const lines = readFileSync((await saved.path())!, 'utf8').trim().split('\n');
  return lines.slice(1).map((l) => l.split(',').map((v) => (v === '' ? NaN : Number(v))));
}

/** Rows of the page's CSV against those of the program: distance, x, y, height. */
function compareRows(rows: number[][], wanted: number[][], slack: number): void {
  const known = (all: number[][]): number[][] => all.filter((r) => !Number.isNaN(r[3]));
  const [here, there] = [known(rows), known(wanted)];
  assert.equal(here.length, there.length);
  here.forEach((r, i) => {
    assert.ok(Math.abs(r[0] - there[i][0]) <= slack, `${r} for ${there[i]}`);
    assert.deepEqual(r.slice(1, 4), there[i].slice(1, 4));
  });
}

function programRows(path: string, rows: number[][]): number[][] {
  const [first, last] = [rows[0], rows[rows.length - 1]];
  const line = `LINESTRING(${first[1]} ${first[2]}, ${last[1]} ${last[2]})`;
  ptin('profile', path, '--line', line, '-o', file('wanted.csv'), '--overwrite');
  return readFileSync(file('wanted.csv'), 'utf8').trim().split('\n').slice(1).map((l) => l.split(',').slice(0, 4).map((v) => (v === '' ? NaN : Number(v))));
}

for (const name of ['degrees', 'feet', 'voids'] as const) {
  test(`served: lengths, rows and lines of sight are the program's: ${name}`, async () => {
    const path = made(name).store;
    const { service, address } = await serving([`t=${path}`]);
    try {
      const { page, faults } = await opened(`${address}viewer/index.html?collection=t`);
      await complete(page);
      const rows = await profile(page, [520, 300], [800, 430]);
      const wanted = programRows(path, rows);
      compareRows(rows, wanted, 0);
      const length = wanted[wanted.length - 1][0];
      assert.equal(Number((await told(page)).metres), length);
      assert.match(await text(page, '#answer-note'), /exact, of the full terrain/);
      await page.keyboard.press('s');
      await page.mouse.click(520, 300);
      await page.waitForTimeout(200);
      await page.mouse.click(800, 430);
      await page.waitForFunction(() => /Visible|Hidden/.test(document.getElementById('answer-text')!.textContent!));
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
      assert.deepEqual(faults, []);
      await page.context().close();
    } finally {
      await ended(service);
    }
  });

  test(`of a stream lengths and rows are the program's: ${name}`, async () => {
    const { store: path, stream } = made(name);
    cpSync(stream, join(site, `${name}.ptins`));
    const { page, faults } = await opened(`${fast.url}?stream=${name}.ptins`);
    await complete(page);
    const rows = await profile(page, [520, 300], [800, 430]);
    compareRows(rows, programRows(path, rows), name === 'degrees' ? 1e-4 : 0);
    assert.match(await text(page, '#answer-note'), /Heights exact/);
    assert.deepEqual(faults, []);
    await page.context().close();
  });
}

test('what is certified holds for all that is in sight, wherever the camera looks', async () => {
  const path = made('degrees').store;
  const { service, address } = await serving([`t=${path}`]);
  try {
    for (const hash of ['', '#at=88.4,27.4,900,60000,30,76', '#at=87,26,900,25000,200,20', '#at=90,29,900,9000,340,80']) {
      const { page } = await opened(`${address}viewer/index.html?collection=t${hash}`);
      await complete(page);
      await page.waitForTimeout(500);
      await complete(page);
      const drawn = await page.evaluate(() => {
        type Numbers = ArrayLike<number>;
        const { ptinViewer: v } = window as unknown as { ptinViewer: {
          status: { certificate: { error: number } }; frame: { middleX: number; middleY: number; scaleX: number; scaleY: number; baseHeight: number; scaleZ: number };
          relief: { geometry: { attributes: { position: { array: Numbers } }; index: { array: Numbers } };
            camera: { projectionMatrix: { clone(): { multiply(m: unknown): { elements: number[] } } }; matrixWorldInverse: unknown } };
        } };
        const { middleX, middleY, scaleX, scaleY, baseHeight, scaleZ } = v.frame;
        return {
          certified: v.status.certificate.error, frame: { middleX, middleY, scaleX, scaleY, baseHeight, scaleZ },
          positions: Array.from(v.relief.geometry.attributes.position.array), corners: Array.from(v.relief.geometry.index.array),
          seen: v.relief.camera.projectionMatrix.clone().multiply(v.relief.camera.matrixWorldInverse).elements,
        };
      });
      const { samples, worst } = worstInSight(drawn);
      assert.ok(samples > 20, `${samples} samples in sight of ${hash}`);
      assert.ok(worst <= drawn.certified + 0.06, `${worst} in sight, ${drawn.certified} certified: ${hash}`);
      assert.match(await text(page, '#certified'), /Exact|\u00b1[\d.\u202f]+ m/);
      await page.context().close();
    }
  } finally {
    await ended(service);
  }
});

interface Drawn {
  frame: { middleX: number; middleY: number; scaleX: number; scaleY: number; baseHeight: number; scaleZ: number };
  positions: number[];
  corners: number[];
  seen: number[];
}

/** The largest error of the drawn mesh at the samples of made('degrees') that are in the picture, whatever hides them. */
function worstInSight({ frame: f, positions: p, corners, seen: e }: Drawn): { samples: number; worst: number } {
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
        const x = (west + q * step - f.middleX) * f.scaleX, y = (north - r * step - f.middleY) * f.scaleY, z = (h - f.baseHeight) * f.scaleZ;
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

test('the camera stays above the ground', async () => {
  const { page } = await opened(`${fast.url}#error=20`);
  await complete(page);
  await page.mouse.move(640, 380);
  const above = (): Promise<number> => page.evaluate(() => {
    const { relief } = (window as unknown as { ptinViewer: { relief: {
      camera: { position: { x: number; y: number; z: number } }; groundAt(x: number, y: number): number | null;
    } } }).ptinViewer;
    const { x, y, z } = relief.camera.position;
    return z - (relief.groundAt(x, y) ?? 0);
  });
  for (let i = 0; i < 40; ++i) await page.mouse.wheel(0, -240);
  await rested(page);
  for (let i = 0; i < 20; ++i) {
    await page.keyboard.press('PageDown');
    await page.keyboard.press('ArrowUp');
  }
  await rested(page);
  assert.ok(await above() > 0);
  await page.mouse.down({ button: 'right' });
  await page.mouse.move(640, 100, { steps: 5 });
  await page.mouse.up({ button: 'right' });
  await rested(page);
  assert.ok(await above() > 0);
  await page.context().close();
});

test('from a folder the page says that it needs a host', async () => {
  const page = await emptyPage();
  await page.goto(`file://${site}/index.html`);
  await page.waitForSelector('#trouble:not([hidden])');
  assert.match(await text(page, '#trouble'), /needs a web server[^]*http\.server/);
  assert.doesNotMatch(await text(page, '#subtitle'), /Loading/);
  await page.context().close();
});

test('keys tilt, leave no ring, and the pointer costs nothing while it moves', async () => {
  const { page } = await opened(`${fast.url}#error=5`);
  await complete(page);
  const tilt = (): Promise<number> => page.evaluate(() =>
    (window as unknown as { ptinViewer: { view: { current(exaggeration: number): { tilt: number } } } }).ptinViewer.view.current(1).tilt);
  await page.mouse.click(640, 380);
  await page.keyboard.press('PageDown');
  const low = await tilt();
  await page.keyboard.press('PageUp');
  assert.ok(Math.abs(low - await tilt() - 5) < 0.1);
  assert.equal(await page.evaluate(() => getComputedStyle(document.getElementById('relief')!).boxShadow), 'none');
  assert.notEqual(await text(page, '#scale'), '');
  await page.evaluate(() => {
    const w = window as unknown as { picks: number; ptinViewer: { relief: { pick(x: number, y: number): unknown } } };
    const { relief } = w.ptinViewer;
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
  await page.waitForFunction(() => document.getElementById('place')!.textContent !== '');
  assert.equal(await page.evaluate(() => (window as unknown as { picks: number }).picks), 1);
  await page.context().close();
});

test('after a service was away the page goes on by itself', async () => {
  const first = await serving([`hills=${store}`]);
  const port = Number(new URL(first.address).port);
  const { page } = await opened(`${first.address}viewer/index.html?collection=hills`);
  await complete(page);
  await ended(first.service);
  await page.mouse.move(640, 380);
  for (let i = 0; i < 6; ++i) await page.mouse.wheel(0, -240);
  await page.waitForSelector('#trouble:not([hidden])');
  assert.match(await text(page, '#certified-what'), /does not answer/);
  const again = await serving([`hills=${store}`], port);
  try {
    await page.waitForSelector('#trouble[hidden]', { state: 'attached' });
    await complete(page);
    await page.mouse.click(640, 380);
    await page.waitForSelector('#answer:not([hidden])');
    await page.context().close();
  } finally {
    await ended(again.service);
  }
});
