// SPDX-License-Identifier: GPL-3.0-or-later
//
// Helpers that the tests of the page share: a browser, hosts of the page with a terrain, and what one does on a page.
import type { Certificate } from 'ptin-decoder';
import assert from 'node:assert/strict';
import { cpSync, readFileSync } from 'node:fs';
import { after, before } from 'node:test';
import type { Browser, BrowserContextOptions, Page } from 'playwright-core';
import type { DrawnMesh } from '../../src/drawn_mesh';
import type { Frame } from '../../src/frame';
import type { Camera } from '../../src/space';
import type { Pose } from '../../src/view';
import { host, launched } from '../../../decoder/test/host.mjs';
import { assets, file, ptin, terrain } from '../../../decoder/test/support';

declare global {
  interface Window {
    /** The parts of the page. */
    ptinViewer: {
      frame: Frame;
      status: { certificate: Certificate };
      /** The address of what is shown. */
      address: string;
      relief: {
        pictures: number; camera: Camera; drawn: DrawnMesh; pending: boolean; sharpness: number;
        groundAt(x: number, y: number): number | null; pick(x: number, y: number): unknown;
      };
      view: { current: Pose; exaggeration: number; flight: object | null; project(x: number, y: number, z: number): { x: number; y: number; visible: boolean } };
    };
  }
}

type Host = Awaited<ReturnType<typeof host>>;

/** The folder of a page with mountains, which `fast` gives out at once, `portioned` in three portions. */
export const site = file('site');
export let store = '';
export let fast: Host;
export let portioned: Host;
let browser: Browser;
let kept: Page | null = null;
let faults: string[] = [];

before(async () => {
  const mountains = terrain('mountains_257');
  store = mountains.store;
  layOut(site, '--stream', mountains.stream);
  fast = await host(site);
  portioned = await host(site, { portions: 3 });
  browser = await launched();
});
after(async () => {
  await browser?.close();
  await fast?.close();
  await portioned?.close();
});

/** Writes the page into a folder, with the assets of today. */
export function layOut(folder: string, ...options: string[]): void {
  ptin('viewer', '-o', folder, ...options);
  cpSync(assets, folder, { recursive: true, force: true, filter: (from) => options.length === 0 || !from.endsWith('index.html') });
}

// A processor draws here, each vertex and each pixel of each picture. So a page is as a screen shows it where that is the subject;
// else it has few and rough pixels and stands still at once, and where detail is not the subject it opens at an error (`#error=5`).
export const wide: BrowserContextOptions = { viewport: { width: 1100, height: 720 } };
export const phone: BrowserContextOptions = { viewport: { width: 360, height: 740 }, hasTouch: true, isMobile: true, deviceScaleFactor: 2 };
export const quick: BrowserContextOptions = { ...wide, deviceScaleFactor: 0.25, reducedMotion: 'reduce' };

export interface OnPage {
  screen?: BrowserContextOptions;
  /** Requests fail on purpose, of which the browser complains. */
  mayComplain?: boolean;
}

/**
 * Does something on a page at an address; there is nothing of which the browser complained. Pages on a `quick` screen are one page,
 * with one document after the other: a process that has begun, and compiled the page's code.
 */
export async function onPage(
  address: string, use: (page: Page) => Promise<void>, { screen = quick, mayComplain = false }: OnPage = {},
): Promise<void> {
  const page = screen === quick ? kept ??= await newPage(quick) : await newPage(screen);
  const wasKept = page === kept;
  // A page is kept only where its test went well: one that no longer answers would stop all tests after it.
  if (wasKept) kept = null;
  faults = [];
  try {
    await page.goto(address);
    await within(10, use(page));
    if (!mayComplain) assert.deepEqual(faults, []);
    if (wasKept) {
      await within(1, page.goto('about:blank'));
      kept = page;
    }
  } finally {
    if (page !== kept) await closed(page);
  }
}

/** Closes a page, or the whole browser where that does not answer: its test has failed, and the next one goes on. */
async function closed(page: Page): Promise<void> {
  try {
    await within(1, page.context().close());
  } catch {
    kept = null;
    // Its end is not waited for, and whether it ends well says nothing of the page.
    browser.close().catch(() => undefined);
    browser = await launched();
  }
}

/** The outcome of something within some minutes; fails after them, since a page whose code never ends answers nothing. */
async function within<T>(minutes: number, done: Promise<T>): Promise<T> {
  let timer: NodeJS.Timeout;
  const late = new Promise<never>((_, reject) => {
    timer = setTimeout(() => { reject(new Error(`the page does not answer within ${minutes} min`)); }, 60000 * minutes);
  });
  return Promise.race([done, late]).finally(() => { clearTimeout(timer); });
}

/** Has the pictures of a document drawn without smooth edges, each of which costs four samples a pixel. */
function drawsRoughly(): void {
  const { getParameter } = WebGL2RenderingContext.prototype;
  WebGL2RenderingContext.prototype.getParameter = function (this: WebGL2RenderingContext, name: number): unknown {
    return name === WebGL2RenderingContext.MAX_SAMPLES ? 1 : getParameter.call(this, name);
  };
}

async function newPage(screen: BrowserContextOptions): Promise<Page> {
  const context = await browser.newContext(screen);
  // Waiting may take long: a processor draws, and shares itself with other tests.
  context.setDefaultTimeout(240000);
  if (screen !== wide && screen !== phone) await context.addInitScript(drawsRoughly);
  const page = await context.newPage();
  page.on('console', (message) => {
    // The driver's note that the browser takes pictures over from WebGL, as it does here for each.
    if (/GL Driver Message .*Performance.* GPU stall due to ReadPixels/.test(message.text())) return;
    if (['error', 'warning'].includes(message.type())) faults.push(message.text());
  });
  page.on('pageerror', (error) => { faults.push(error.message); });
  return page;
}

/** Waits until something holds on the page. A poll at each frame would keep the page at work. */
export async function until(page: Page, holds: (given: number[]) => boolean, given: number[] = []): Promise<void> {
  await page.waitForFunction(holds, given, { polling: 40 });
}

export async function complete(page: Page): Promise<void> {
  await until(page, () => document.querySelector('#progress')!.classList.contains('done'));
  await rested(page);
}

/** Waits until the picture is drawn whole and the camera stands. Returns the number of pictures. */
export async function rested(page: Page): Promise<number> {
  return page.evaluate(async () => {
    const { relief, view } = window.ptinViewer;
    // Twice in a row: a message of the Worker may lie between.
    for (let times = 0; times < 2;) {
      await new Promise((resolve) => { setTimeout(resolve, 40); });
      times = relief.pending || relief.sharpness < 1 || view.flight !== null ? 0 : times + 1;
    }
    return relief.pictures;
  });
}

/** The address of the page once its view rests. It is written some time after the last key. */
export async function lastLink(page: Page): Promise<string> {
  await rested(page);
  await until(page, () => location.href === location.origin + window.ptinViewer.address);
  return page.url();
}

/** How many colours the middle of the picture has. */
export async function colours(page: Page): Promise<number> {
  const { width, height } = page.viewportSize()!;
  const clip = { x: width * 0.4, y: height * 0.4, width: width * 0.3, height: height * 0.25 };
  const png = (await page.screenshot({ clip })).toString('base64');
  return page.evaluate(async (data) => {
    const bytes = Uint8Array.from(atob(data), (c) => c.charCodeAt(0));
    const picture = await createImageBitmap(new Blob([bytes], { type: 'image/png' }));
    const canvas = new OffscreenCanvas(picture.width, picture.height);
    const context = canvas.getContext('2d')!;
    context.drawImage(picture, 0, 0);
    const { data: pixels } = context.getImageData(0, 0, picture.width, picture.height);
    return new Set(new Uint32Array(pixels.buffer)).size;
  }, png);
}

export const text = (page: Page, selector: string): Promise<string> => page.locator(selector).innerText();
/** The whole number that a part of the page tells. */
export const counted = async (page: Page, selector: string): Promise<number> =>
  // Parts that are folded away are read, too.
  Number((await page.locator(selector).textContent() ?? '').replace(/[^0-9]/g, ''));
export const appears = (page: Page, selector: string): Promise<unknown> => page.waitForSelector(`${selector}:not([hidden])`);
/** The numbers of the answer as they came. */
export const told = (page: Page): Promise<Record<string, string>> =>
  page.evaluate(() => ({ ...document.getElementById('answer')!.dataset })) as Promise<Record<string, string>>;

/** The height that the program tells at the place of the answer. */
export function located(at: Record<string, string>): number {
  return (JSON.parse(ptin('locate', store, at.x, at.y, '--json')) as { points: Array<{ height: number }> }).points[0].height;
}

type Pixel = readonly [x: number, y: number];

/** Asks along a line between two points of the picture; `between` the clicks something else may be done. */
export async function askAlong(page: Page, key: 'p' | 's', a: Pixel, b: Pixel, between?: () => Promise<void>): Promise<void> {
  await page.keyboard.press(key);
  await page.mouse.click(...a);
  await between?.();
  await page.mouse.click(...b);
  if (key === 'p') await page.waitForSelector('#plot .surface');
  else await until(page, () => /Visible|Hidden/.test(document.getElementById('answer-text')!.textContent!));
}

/** The profile that is shown, as the page saves it: its head and its rows, without a number where there is no height. */
export async function savedCsv(page: Page): Promise<{ head: string; rows: number[][] }> {
  const [saved] = await Promise.all([page.waitForEvent('download'), page.click('#csv')]);
  return csvIn((await saved.path())!);
}

export function csvIn(path: string): { head: string; rows: number[][] } {
  const [head, ...lines] = readFileSync(path, 'utf8').trim().split('\n');
  return { head, rows: lines.map((line) => line.split(',').map((v) => (v === '' ? NaN : Number(v)))) };
}

/** The program's profile between the ends of rows, as rows. */
export function programRows(path: string, rows: number[][]): number[][] {
  const [first, last] = [rows[0], rows[rows.length - 1]];
  ptin('profile', path, '--line', `LINESTRING(${first[1]} ${first[2]}, ${last[1]} ${last[2]})`, '-o', file('wanted.csv'), '--overwrite');
  return csvIn(file('wanted.csv')).rows.map((row) => row.slice(0, 4));
}

/** Holds rows of the page's CSV to those of the program: distance, x, y, height. */
export function compareRows(rows: number[][], wanted: number[][], slack: number): void {
  const known = (all: number[][]): number[][] => all.filter((r) => !Number.isNaN(r[3]));
  const [here, there] = [known(rows), known(wanted)];
  assert.equal(here.length, there.length);
  here.forEach((r, i) => {
    assert.ok(Math.abs(r[0] - there[i][0]) <= slack, `${r} for ${there[i]}`);
    assert.deepEqual(r.slice(1, 4), there[i].slice(1, 4));
  });
}

/** Whatever axe finds on a page that has its script, by all of its rules or by those of some names. */
export function faultsOfAxe(page: Page, rules?: string[]): Promise<string[]> {
  return page.evaluate(async (runOnly) => {
    const { axe } = window as unknown as {
      axe: { run(options: object): Promise<{ violations: Array<{ id: string; nodes: Array<{ html: string }> }> }> };
    };
    return (await axe.run(runOnly === undefined ? {} : { runOnly })).violations.map((v) => `${v.id}: ${v.nodes.map((n) => n.html.slice(0, 120)).join(' | ')}`);
  }, rules);
}
