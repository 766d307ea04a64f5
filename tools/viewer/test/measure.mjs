// SPDX-License-Identifier: GPL-3.0-or-later
//
// How fast streams are decoded and shown, and how large the page is.
// usage: node measure.mjs STREAM...    CHROMIUM=path measures the page in a browser, too, with pictures by software
import { execFileSync } from 'node:child_process';
import { cpSync, mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { basename, dirname, join } from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';
import { gzipSync } from 'node:zlib';
import { host } from './host.mjs';

const here = dirname(fileURLToPath(import.meta.url));
const assets = join(here, '..', 'assets');
const scratch = mkdtempSync(join(tmpdir(), 'ptin-measure-'));
const median = (values) => [...values].sort((a, b) => a - b)[Math.floor(values.length / 2)];
const repeats = 5;

let packed = 0;
for (const name of ['index.html', 'viewer.js', 'worker.js', 'decoder.wasm']) {
  const bytes = readFileSync(join(assets, name));
  const small = gzipSync(bytes, { level: 9 }).length;
  packed += small;
  console.log(`${name}: ${bytes.length} bytes, ${small} packed`);
}
console.log(`the page: ${packed} bytes packed`);

const decoderPath = join(scratch, 'decoder.mjs');
execFileSync(join(here, '..', 'node_modules', '.bin', 'esbuild'),
  [join(here, '..', 'src', 'decoder.ts'), '--bundle', '--format=esm', '--log-level=warning', `--outfile=${decoderPath}`]);
const { Decoder } = await import(pathToFileURL(decoderPath).href);
const module = new WebAssembly.Module(readFileSync(join(assets, 'decoder.wasm')));

for (const stream of process.argv.slice(2)) {
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

/** The decoder alone in a page, then the whole page from its address to the first and the last picture. */
async function inBrowser(stream, splits) {
  const { chromium } = await import('playwright-core');
  const site = join(scratch, 'site');
  cpSync(assets, site, { recursive: true });
  cpSync(stream, join(site, 'dem.ptins'));
  cpSync(decoderPath, join(site, 'decoder.js'));
  const server = await host(site);
  const browser = await chromium.launch({
    executablePath: process.env.CHROMIUM, args: ['--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--no-sandbox'],
  });
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
    await page.goto(`${server.url}?stream=dem.ptins`);
    await page.waitForFunction(() => performance.getEntriesByName('ptin-settled').length !== 0, null, { timeout: 120000 });
    times.push(await page.evaluate(() => ['ptin-first-picture', 'ptin-settled'].map((n) => performance.getEntriesByName(n)[0].startTime)));
    await context.close();
  }
  console.log(`  Chromium ${browser.version()}: ${Math.round(rate)} splits/s; first picture after ` +
    `${Math.round(median(times.map((t) => t[0])))} ms, all ${splits} splits after ${Math.round(median(times.map((t) => t[1])))} ms`);
  await browser.close();
  await server.close();
}
