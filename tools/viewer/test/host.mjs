// SPDX-License-Identifier: GPL-3.0-or-later
//
// A web host of a folder for tests, without ranges, that can be slow; and a browser.
import { createReadStream, statSync } from 'node:fs';
import { createServer } from 'node:http';
import { extname, join, normalize } from 'node:path';

/** A browser that draws by software. */
export async function launched() {
  const { chromium } = await import('playwright-core');
  return chromium.launch({
    executablePath: process.env.CHROMIUM, args: ['--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--no-sandbox'],
  });
}

const types = { '.html': 'text/html; charset=utf-8', '.js': 'text/javascript', '.wasm': 'application/wasm' };

/**
 * Serves `folder` on a free port of the loopback. `bytesPerSecond`: of files whose name ends in .ptins; 0: as fast as it goes.
 * `answer`: may answer a request itself, by returning true.
 */
export async function host(folder, { bytesPerSecond = 0, answer = () => false } = {}) {
  const server = createServer((request, response) => {
    const path = normalize(decodeURIComponent(new URL(request.url, 'http://localhost').pathname));
    if (answer(request, response, path)) return;
    const file = join(folder, path.endsWith('/') ? `${path}index.html` : path);
    let bytes;
    try {
      bytes = statSync(file).size;
    } catch {
      response.writeHead(404).end('not here');
      return;
    }
    response.writeHead(200, { 'Content-Type': types[extname(file)] ?? 'application/octet-stream', 'Content-Length': bytes });
    const slow = bytesPerSecond > 0 && file.endsWith('.ptins');
    const stream = createReadStream(file, slow ? { highWaterMark: Math.ceil(bytesPerSecond / 20) } : {});
    if (slow) {
      stream.on('data', () => { stream.pause(); setTimeout(() => stream.resume(), 50); });
    }
    stream.pipe(response);
  });
  await new Promise((resolve) => { server.listen(0, '127.0.0.1', resolve); });
  return { url: `http://127.0.0.1:${server.address().port}/`, close: () => new Promise((resolve) => {
    server.closeAllConnections?.();
    server.close(resolve);
  }) };
}
