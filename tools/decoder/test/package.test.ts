// SPDX-License-Identifier: GPL-3.0-or-later
//
// The package as somebody else installs it: what is in it, its types in a strict program, and its decoder in Node.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { cpSync, mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { file, ptin, terrain } from './support';

const here = process.env.PTIN_PACKAGE ?? '';
const sources = ['certified', 'decode_stream', 'decoder', 'engine', 'index', 'load', 'map_window', 'mesh', 'metadata', 'module', 'received',
  'served_terrain', 'surface'];

const program = `
import { type Certificate, type Decoder, decodeStream, loadDecoder, surfaceOf } from 'ptin-decoder';
import { readFile } from 'node:fs/promises';
const module: WebAssembly.Module = await loadDecoder();
let finest: Decoder | null = null;
for await (const step of decodeStream(module, await readFile(process.argv[2]), { error: 5 })) finest = step;
if (finest === null) throw new Error('nothing came');
const { error }: Certificate = finest.certificate;
const indices: Uint32Array = surfaceOf(finest).indices;
console.log(JSON.stringify({ error, triangles: indices.length / 3 }));
`;

/** Copies what is packed elsewhere, so that nothing of the tree can help, and packs it. */
function packed(): Array<{ filename: string; files: Array<{ path: string }> }> {
  const copy = file('tree/tools/decoder');
  for (const name of ['build', 'package.json', 'README.md', 'tsconfig.json', 'src']) cpSync(join(here, name), join(copy, name), { recursive: true });
  cpSync(join(here, '../../LICENSE'), file('tree/LICENSE'));
  mkdirSync(file('tree/tools/viewer/assets'), { recursive: true });
  cpSync(join(process.env.PTIN_VIEWER_ASSETS ?? '', 'decoder.wasm'), file('tree/tools/viewer/assets/decoder.wasm'));
  mkdirSync(join(copy, 'node_modules/.bin'), { recursive: true });
  writeFileSync(join(copy, 'node_modules/.bin/tsc'), `#!/bin/sh\nexec ${here}/node_modules/.bin/tsc "$@"\n`, { mode: 0o755 });
  return JSON.parse(execFileSync('npm', ['pack', '--json', '--silent', '--pack-destination', file('.')], { cwd: copy, encoding: 'utf8' })) as
    ReturnType<typeof packed>;
}

test('installed from its tarball it has types and decodes', () => {
  const [{ filename, files }] = packed();
  assert.deepEqual(files.map((f) => f.path).sort(), [
    'LICENSE', 'README.md', 'package.json', 'dist/decoder.wasm', ...sources.flatMap((s) => [`dist/${s}.d.ts`, `dist/${s}.js`, `src/${s}.ts`]),
  ].sort());
  const site = file('site/node_modules/ptin-decoder');
  mkdirSync(site, { recursive: true });
  execFileSync('tar', ['-xzf', file(filename), '-C', site, '--strip-components=1']);
  const consumer = file('site/consumer.mts');
  writeFileSync(consumer, program);
  // What README.md shows is a strict program, too.
  const shown = readFileSync(join(here, 'README.md'), 'utf8').split('```js\n').slice(1).map((block, i) => {
    const path = file(`site/block${i}.mts`);
    writeFileSync(path, block.split('```')[0]);
    return path;
  });
  assert.ok(shown.length >= 2);
  const types = ['--typeRoots', join(here, 'node_modules/@types'), '--types', 'node'];
  const tsc = ['--strict', '--target', 'es2022', '--module', 'nodenext', '--lib', 'es2022,dom,dom.iterable', '--outDir', file('site'), ...types, consumer, ...shown];
  execFileSync(join(here, 'node_modules/.bin/tsc'), tsc, { encoding: 'utf8', cwd: file('site'), stdio: ['ignore', 'inherit', 'inherit'] });
  const { stream } = terrain('mountains_257', '--error', '0.5');
  const told = JSON.parse(execFileSync('node', [file('site/consumer.mjs'), stream], { encoding: 'utf8' })) as { error: number; triangles: number };
  assert.ok(told.error <= 5 && told.triangles > 1000);
});

test('the version is the program\'s', () => {
  const { version } = JSON.parse(readFileSync(join(here, 'package.json'), 'utf8')) as { version: string };
  assert.equal(version, /ptin (\d+\.\d+\.\d+)/.exec(ptin('--version'))?.[1]);
});
