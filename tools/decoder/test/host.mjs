// SPDX-License-Identifier: GPL-3.0-or-later
//
// A web host of a folder for tests, without ranges, that can wait within a file; and a browser.
import { readFileSync } from 'node:fs';
import { createServer } from 'node:http';
import { extname, join, normalize } from 'node:path';

/** A browser that draws by software: the pictures of WebGL by that of graphics cards, the rest by its own, which is quicker. */
export async function launched() {
  const { chromium } = await import('playwright-core');
  return chromium.launch({
    executablePath: process.env.CHROMIUM,
    args: [
      '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--disable-gpu-compositing', '--disable-gpu-rasterization', '--no-sandbox',
    ],
  });
}

const types = { '.html': 'text/html; charset=utf-8', '.js': 'text/javascript', '.mjs': 'text/javascript', '.css': 'text/css', '.wasm': 'application/wasm' };

/**
 * Serves `folder` on a free port of the loopback.
 * `portions`: files whose name ends in .ptins arrive in so many equal portions; each but the first waits for a call of `more()`.
 * `answer`: may answer a request itself, by returning true.
 */
export async function host(folder, { portions = 1, answer = () => false } = {}) {
  const waiting = [];
  const send = (response, bytes, left) => {
    const size = Math.ceil(bytes.length / left);
    response.write(bytes.subarray(0, size));
    if (left === 1) response.end();
    else waiting.push(() => { send(response, bytes.subarray(size), left - 1); });
  };
  const server = createServer((request, response) => {
    const path = normalize(decodeURIComponent(new URL(request.url, 'http://localhost').pathname));
    if (answer(request, response, path)) return;
    const file = join(folder, path.endsWith('/') ? `${path}index.html` : path);
    let bytes;
    try {
      bytes = readFileSync(file);
    } catch {
      response.writeHead(404).end('not here');
      return;
    }
    response.writeHead(200, { 'Content-Type': types[extname(file)] ?? 'application/octet-stream', 'Content-Length': bytes.length });
    send(response, bytes, file.endsWith('.ptins') ? portions : 1);
  });
  await new Promise((resolve) => { server.listen(0, '127.0.0.1', resolve); });
  return {
    url: `http://127.0.0.1:${server.address().port}/`,
    more: () => { for (const sendNext of waiting.splice(0)) sendNext(); },
    close: () => new Promise((resolve) => {
      server.closeAllConnections?.();
      server.close(resolve);
    }),
  };
}
