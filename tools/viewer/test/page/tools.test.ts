// SPDX-License-Identifier: GPL-3.0-or-later
//
// Tools of several points, by keys alone, from links and from files, and the page within another one.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import type { Page } from 'playwright-core';
import { complete, fast, lastLink, onPage, rested, savedCsv, text, told, until } from './browser';

const noted = (page: Page, pattern: string): Promise<void> => page.waitForFunction(
  (p) => new RegExp(p).test(document.getElementById('answer-note')!.textContent!), pattern, { polling: 40 }) as unknown as Promise<void>;

test('keys alone place points, take one back, and a link asks the same again', async () => {
  let link = '';
  let length = 0;
  await onPage(`${fast.url}#error=20`, async (page) => {
    await complete(page);
    await page.locator('#relief').focus();
    for (const key of ['p', 'Enter', 'ArrowRight', 'Enter']) await page.keyboard.press(key);
    await page.waitForSelector('#plot .surface');
    assert.ok(await page.isVisible('#crosshair'));
    const two = Number((await told(page)).length);
    await page.keyboard.press('ArrowUp');
    await page.keyboard.press('Enter');
    await page.waitForFunction((l) => Number(document.getElementById('answer')!.dataset.length) > l * 1.01, two, { polling: 40 });
    length = Number((await told(page)).length);
    await page.keyboard.press('Backspace');
    await page.waitForFunction((l) => Math.abs(Number(document.getElementById('answer')!.dataset.length) / l - 1) < 1e-9, two, { polling: 40 });
    await page.keyboard.press('Enter');
    await page.waitForFunction((l) => Math.abs(Number(document.getElementById('answer')!.dataset.length) / l - 1) < 1e-9, length, { polling: 40 });
    link = await lastLink(page);
    assert.match(link, /ask=profile:/);
    await page.locator('#answer-close').focus();
    await page.keyboard.press('Escape');
    assert.ok(await page.isHidden('#answer'));
    assert.equal(await page.evaluate(() => document.activeElement!.id), 'relief', 'the keys go on');
    assert.doesNotMatch(await lastLink(page), /ask=/);
  });
  await onPage(link, async (page) => {
    await complete(page);
    await page.waitForSelector('#plot .surface');
    assert.ok(Math.abs(Number((await told(page)).length) / length - 1) < 1e-6);
    // Nothing that the answer speaks of lies below it.
    const over = await page.evaluate(() => {
      const box = document.getElementById('answer')!.getBoundingClientRect();
      const { inquiry } = window.ptinViewer as unknown as {
        inquiry: { spoken: object[]; ground: { project(p: object): { x: number; y: number } } };
      };
      return inquiry.spoken.map((p) => inquiry.ground.project(p))
        .filter((p) => p.x > box.left && p.x < box.right && p.y > box.top && p.y < box.bottom).length;
    });
    assert.equal(over, 0);
  });
});

test('areas, labelled contours, and lines of files', () => onPage(`${fast.url}#error=5&interval=20`, async (page) => {
  await complete(page);
  await until(page, () => document.querySelectorAll('#labels .contour').length > 2);
  const heights = await page.locator('#labels .contour').allTextContents();
  for (const h of heights) assert.equal(Number(h.replace(/[^0-9]/g, '')) % 100, 0, `${h} is of an index contour`);
  await page.keyboard.press('a');
  for (const at of [[560, 330], [760, 340], [700, 430]] as const) await page.mouse.click(at[0], at[1]);
  await noted(page, 'in plan');
  assert.ok(Number((await told(page)).surface) > 1e4);
  await page.keyboard.press('Escape');
  const drop = (name: string, content: string): Promise<void> => page.evaluate(([n, c]) => {
    const data = new DataTransfer();
    data.items.add(new File([c], n));
    dispatchEvent(new DragEvent('drop', { dataTransfer: data, cancelable: true }));
  }, [name, content] as const);
  const { x, y } = await page.evaluate(() => ({ x: window.ptinViewer.frame.middleX, y: window.ptinViewer.frame.middleY }));
  await drop('way.csv', `x,y\n${x},${y}\n${x + 600},${y}\n${x + 600},${y + 800}\n`);
  await page.waitForSelector('#plot .surface');
  const { rows } = await savedCsv(page);
  assert.ok(Math.abs(rows[rows.length - 1][0] - 1400) < 1e-6, 'along both legs');
  await drop('way.csv', 'nothing');
  await until(page, () => /holds no line/.test(document.getElementById('toast')!.textContent!));
  const [saved] = await Promise.all([page.waitForEvent('download'), page.keyboard.press('e')]);
  assert.match(saved.suggestedFilename(), /\.png$/);
}));

test('in a frame there is the terrain, and a link to its page', () => onPage(`${fast.url}?embed=1#error=20`, async (page) => {
  await complete(page);
  await rested(page);
  for (const part of ['#card', '#tools']) assert.ok(await page.isHidden(part));
  await page.locator('#whole').hover();
  assert.doesNotMatch(await page.getAttribute('#whole', 'href') ?? '', /embed/);
  assert.match(await text(page, '#credit'), /Open the terrain/);
}));
