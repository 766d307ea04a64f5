// SPDX-License-Identifier: GPL-3.0-or-later
//
// How fast streams are decoded and shown, how large the page is, and what a service sends until there is a picture.
// With a browser: when the first picture is there, also at 1 Mbit/s and 80 ms, and how long a picture takes while the camera flies.
// usage: node measure.mjs STREAM...    CHROMIUM=path measures the page in a browser, too, with pictures by software
//        CHROMIUM=path node measure.mjs http://127.0.0.1:8080/collections/ID...    a terrain of a service, in a browser
import { execFileSync } from 'node:child_process';
import { cpSync, mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { connect, createServer } from 'node:net';
import { tmpdir } from 'node:os';
import { basename, dirname, join } from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';
import { gzipSync } from 'node:zlib';
import { host, launched } from '../../decoder/test/host.mjs';

const here = dirname(fileURLToPath(import.meta.url));
const assets = join(here, '..', 'assets');
const scratch = mkdtempSync(join(tmpdir(), 'ptin-measure-'));
const median = (values) => [...values].sort((a, b) => a - b)[Math.floor(values.length / 2)];
const repeats = 5;
const marks = ['ptin-first-picture', 'ptin-settled'];
const isService = (given) => /^http:\/\//.test(given);

let packed = 0;
for (const name of ['index.html', 'viewer.css', 'boot.js', 'viewer.js', 'shared.js', 'worker.js', 'decoder.wasm', 'base_map.js', 'questions.wasm']) {
  const bytes = readFileSync(join(assets, name));
  const small = gzipSync(bytes, { level: 9 }).length;
  if (name !== 'questions.wasm' && name !== 'base_map.js') packed += small;
  console.log(`${name}: ${bytes.length} bytes, ${small} packed`);
}
console.log(`the page until something is asked: ${packed} bytes packed`);

const decoderPath = join(scratch, 'decoder.mjs');
execFileSync(join(here, '..', 'node_modules', '.bin', 'esbuild'),
  [join(here, '..', '..', 'decoder', 'src', 'decoder.ts'), '--bundle', '--format=esm', '--log-level=warning', `--outfile=${decoderPath}`]);
const { Decoder } = await import(pathToFileURL(decoderPath).href);
const module = new WebAssembly.Module(readFileSync(join(assets, 'decoder.wasm')));

for (const address of process.argv.slice(2).filter(isService)) await ofService(new URL(address));

for (const stream of process.argv.slice(2).filter((given) => !isService(given))) {
  const bytes = readFileSync(stream);
  const rates = [];
  let splits = 0;
  for (let i = 0; i < repeats; ++i) {
    const decoder = new Decoder(module);
    // Time of the processor: what else the machine does counts little.
    const begin = process.cpuUsage();
    decoder.feed(bytes);
    splits = decoder.splits;
    const { user, system } = process.cpuUsage(begin);
    rates.push(splits / (user + system) * 1e6);
  }
  console.log(`${basename(stream)}: ${bytes.length} bytes, ${splits} splits; Node ${process.version}: ${Math.round(median(rates))} splits a processor second`);
  if (process.env.CHROMIUM) await inBrowser(stream, splits);
}
rmSync(scratch, { recursive: true });

/** Milliseconds from the address being asked for to the first picture, and to the first time that nothing is awaited. */
async function shownAfter(page, address) {
  await page.goto(address);
  await page.waitForFunction((names) => names.every((name) => performance.getEntriesByName(name).length !== 0), marks, { timeout: 120000 });
  return page.evaluate((names) => names.map((name) => performance.getEntriesByName(name)[0].startTime), marks);
}

/** The page over a slow line: 1 Mbit/s, 80 ms. */
async function slowly(page) {
  const line = await page.context().newCDPSession(page);
  await line.send('Network.enable');
  await line.send('Network.emulateNetworkConditions', { offline: false, latency: 80, downloadThroughput: 125000, uploadThroughput: 125000 });
}

/** Milliseconds from the address being asked for to the first picture, over a slow line. */
async function firstSlowly(browser, address) {
  const times = [];
  for (let i = 0; i < repeats; ++i) {
    const context = await browser.newContext({ viewport: { width: 1280, height: 800 } });
    const page = await context.newPage();
    await slowly(page);
    await page.goto(address);
    await page.waitForFunction((name) => performance.getEntriesByName(name).length !== 0, marks[0], { timeout: 120000 });
    times.push(await page.evaluate((name) => performance.getEntriesByName(name)[0].startTime, marks[0]));
    await context.close();
  }
  return times;
}

/**
 * The cost of pictures while the camera goes round, in some rounds: milliseconds from one to the next in the middle round and in the
 * quickest, and of a processor, which other work on the machine changes little.
 */
async function flying(browser, page) {
  const session = await browser.newBrowserCDPSession();
  const used = async () => (await session.send('SystemInfo.getProcessInfo')).processInfo.reduce((sum, p) => sum + p.cpuTime, 0);
  // The pace at which pictures become smaller is found first.
  await goRound(page, 30);
  const rounds = [], before = await used();
  for (let i = 0; i < repeats; ++i) rounds.push(await goRound(page, 40));
  const cost = (await used() - before) / (repeats * 40) * 1000;
  const medians = rounds.map((times) => median(times));
  const { triangles, width } = await page.evaluate(() => {
    const { drawn, canvas } = window.ptinViewer.relief;
    return { triangles: drawn.corners.length / 3, width: canvas.width };
  });
  return { median: median(medians), best: Math.min(...medians), cost, triangles, width };
}

function goRound(page, pictures) {
  return page.evaluate(async (count) => {
    const next = () => new Promise((resolve) => { requestAnimationFrame(resolve); });
    const times = [];
    for (let i = 0, before = await next(); i < count; ++i) {
      window.ptinViewer.view.turn(1);
      const now = await next();
      times.push(now - before);
      before = now;
    }
    return times;
  }, pictures);
}

function flown({ median, best, cost, triangles, width }) {
  return `flying over ${triangles} triangles: ${median.toFixed(1)} ms a picture, ${best.toFixed(1)} in the best of ${repeats} rounds, ` +
    `${cost.toFixed(1)} ms of a processor; ${width} pixels across`;
}

/** Passes on what goes between a browser and a service, and keeps when how many bytes came from the service. */
async function tapped(target) {
  const pieces = [];
  const sockets = new Set();
  const server = createServer((near) => {
    const far = connect(Number(target.port || 80), target.hostname);
    for (const [socket, other] of [[near, far], [far, near]]) {
      sockets.add(socket);
      socket.setNoDelay();
      socket.on('error', () => { other.destroy(); });
      socket.on('close', () => { sockets.delete(socket); other.destroy(); });
    }
    far.on('data', (bytes) => { pieces.push([performance.timeOrigin + performance.now(), bytes.length]); });
    near.pipe(far);
    far.pipe(near);
  });
  await new Promise((resolve) => { server.listen(0, '127.0.0.1', resolve); });
  return {
    url: `http://127.0.0.1:${server.address().port}/`,
    begin: () => { pieces.length = 0; },
    bytesUntil: (time) => pieces.reduce((sum, [at, bytes]) => sum + (at <= time ? bytes : 0), 0),
    close: () => { server.close(); for (const socket of sockets) socket.destroy(); },
  };
}

/** All that a browser without any cache gets of a service: the page, the terrain's facts, the stream, and heads. */
async function ofService(address) {
  if (!process.env.CHROMIUM) throw new Error('a service is measured in a browser: name it by CHROMIUM=path');
  const id = decodeURIComponent(/\/collections\/([^/]+)$/.exec(address.pathname)?.[1] ?? '');
  if (id === '') throw new Error(`${address} is no address of a collection`);
  const tap = await tapped(address);
  const browser = await launched();
  const runs = [];
  for (let i = 0; i < repeats; ++i) {
    const context = await browser.newContext({ viewport: { width: 1280, height: 800 } });
    const page = await context.newPage();
    tap.begin();
    const [first] = await shownAfter(page, `${tap.url}viewer/index.html?collection=${encodeURIComponent(id)}`);
    const begin = await page.evaluate(() => performance.timeOrigin);
    runs.push({ time: first, bytes: tap.bytesUntil(begin + first) });
    await context.close();
  }
  const times = runs.map((run) => run.time);
  console.log(`${address}, Chromium ${browser.version()}: first picture after ${median(runs.map((run) => run.bytes))} bytes and ` +
    `${Math.round(median(times))} ms, the quickest of ${repeats} after ${Math.round(Math.min(...times))} ms`);
  const slow = await firstSlowly(browser, `${address.origin}/viewer/index.html?collection=${encodeURIComponent(id)}`);
  console.log(`  at 1 Mbit/s and 80 ms: first picture after ${Math.round(median(slow))} ms, the slowest of ${repeats} after ${Math.round(Math.max(...slow))} ms`);
  await browser.close();
  tap.close();
}

/** The decoder alone in a page, then the whole page from its address to the first and the last picture. */
async function inBrowser(stream, splits) {
  const site = join(scratch, 'site');
  cpSync(assets, site, { recursive: true });
  cpSync(stream, join(site, 'dem.ptins'));
  cpSync(decoderPath, join(site, 'decoder.js'));
  const server = await host(site);
  const browser = await launched();
  const alone = await browser.newPage();
  await alone.goto(`${server.url}decoder.js`);
  const rate = await alone.evaluate(async (repeats) => {
    const { Decoder } = await import('/decoder.js');
    const module = await WebAssembly.compile(await (await fetch('/decoder.wasm')).arrayBuffer());
    const bytes = new Uint8Array(await (await fetch('/dem.ptins')).arrayBuffer());
    const rates = [];
    for (let i = 0; i < repeats; ++i) {
      const decoder = new Decoder(module);
      const begin = performance.now();
      decoder.feed(bytes);
      rates.push(decoder.splits / (performance.now() - begin) * 1000);
    }
    return rates.sort((a, b) => a - b)[Math.floor(repeats / 2)];
  }, repeats);
  await alone.close();
  const times = [];
  for (let i = 0; i < repeats; ++i) {
    const context = await browser.newContext({ viewport: { width: 1280, height: 800 } });
    const page = await context.newPage();
    times.push(await shownAfter(page, `${server.url}?stream=dem.ptins`));
    await context.close();
  }
  console.log(`  Chromium ${browser.version()}: ${Math.round(rate)} splits/s; first picture after ` +
    `${Math.round(median(times.map((t) => t[0])))} ms, all ${splits} splits after ${Math.round(median(times.map((t) => t[1])))} ms`);
  const page = await browser.newPage({ viewport: { width: 1280, height: 800 } });
  await shownAfter(page, `${server.url}?stream=dem.ptins`);
  console.log(`  ${flown(await flying(browser, page))}`);
  await browser.close();
  await server.close();
}
