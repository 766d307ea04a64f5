// SPDX-License-Identifier: GPL-3.0-or-later
//
// The package as somebody else installs it: what is in it, its types in a strict program, and what README.md shows, run in Node.
import assert from 'node:assert/strict';
import { execFile, execFileSync } from 'node:child_process';
import { copyFileSync, cpSync, mkdirSync, readFileSync, readdirSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { promisify } from 'node:util';
import { host } from './host.mjs';
import { file, ptin, served, terrain } from './support';

const here = process.env.PTIN_PACKAGE ?? '';
const run = promisify(execFile);

/** Everything that a client reads of a step, and that it may be null; from CommonJS, too. */
const program = `
import { type Certainty, type Certificate, type Decoder, DecodeError, type Step, openBytes } from 'ptin-decoder';
import { createReadStream } from 'node:fs';
const terrain = await openBytes(createReadStream(process.argv[2]!));
const step: Step<Float64Array> = await terrain.refined({ error: 5, positions: 'map' });
const certified: Certainty | null = step.certified;
const ofStream: Certificate | null = (terrain.decoder satisfies Decoder).certificate;
export const unsafe = (): number[] => [
  // @ts-expect-error  Null where nothing is known.
  step.certified.error,
  // @ts-expect-error  So is what is certified elsewhere.
  terrain.certifiedIn([0, 0, 1, 1]).error,
  // @ts-expect-error  And what a stream certifies, before its first mesh.
  terrain.decoder.certificate.error,
];
const refused = await openBytes(new Uint8Array(80)).catch((error: unknown) => error instanceof DecodeError && error.code);
console.log(JSON.stringify({ error: certified?.error, ofStream, refused, triangles: step.indices.length / 3 }));
`;
const commonJs = `
import('ptin-decoder').then(async ({ openBytes }) => {
  const terrain = await openBytes(require('node:fs').readFileSync(process.argv[2]));
  console.log((await terrain.refined({ error: 5 })).state);
});
`;

/** Copies what is packed elsewhere, so that nothing of the tree can help, and packs it. */
function packed(): Array<{ filename: string; files: Array<{ path: string }> }> {
  const copy = file('tree/tools/decoder');
  for (const name of ['build', 'package.json', 'README.md', 'tsconfig.json', 'src']) cpSync(join(here, name), join(copy, name), { recursive: true });
  cpSync(join(here, '../../LICENSE'), file('tree/LICENSE'));
  mkdirSync(file('tree/tools/viewer/assets'), { recursive: true });
  cpSync(join(process.env.PTIN_VIEWER_ASSETS ?? '', 'decoder.wasm'), file('tree/tools/viewer/assets/decoder.wasm'));
  mkdirSync(join(copy, 'node_modules/.bin'), { recursive: true });
  writeFileSync(join(copy, 'node_modules/.bin/tsc'), `#!/bin/sh\nexec ${here}/node_modules/.bin/tsc "$@" --typeRoots ${here}/node_modules/@types\n`, { mode: 0o755 });
  return JSON.parse(execFileSync('npm', ['pack', '--json', '--silent', '--pack-destination', file('.')], { cwd: copy, encoding: 'utf8' })) as
    ReturnType<typeof packed>;
}

test('installed from its tarball it has types, and does what README.md shows', async () => {
  const [{ filename, files }] = packed();
  const sources = readdirSync(join(here, 'src')).map((name) => name.replace(/\.ts$/, ''));
  assert.deepEqual(files.map((f) => f.path).sort(), [
    'LICENSE', 'README.md', 'package.json', 'dist/decoder.wasm', ...sources.flatMap((s) => [`dist/${s}.d.ts`, `dist/${s}.js`, `src/${s}.ts`]),
  ].sort());
  const site = file('site/node_modules/ptin-decoder');
  mkdirSync(site, { recursive: true });
  execFileSync('tar', ['-xzf', file(filename), '-C', site, '--strip-components=1']);
  writeFileSync(file('site/consumer.mts'), program);
  writeFileSync(file('site/common.cjs'), commonJs);
  const { store, stream } = terrain('mountains_257', '--error', '1');
  const web = await host(file('site'));
  copyFileSync(stream, file('site/dem.ptins'));
  try {
    await served(`dem=${store}`, async (service) => {
      const blocks = readFileSync(join(here, 'README.md'), 'utf8').split('```js\n').slice(1).map((block) => block.split('```')[0]);
      assert.equal(blocks.length, 2);
      const shown = blocks.map((block, i) => {
        const path = file(`site/block${i}.mts`);
        writeFileSync(path, block.replace('http://127.0.0.1:8080/', service).replace('https://example.org/', web.url));
        return path;
      });
      // By the strictest rules, and nothing is left out: the package's own declarations are looked at, too.
      const types = ['--typeRoots', join(here, 'node_modules/@types'), '--types', 'node'];
      const rules = ['--strict', '--skipDefaultLibCheck', '--noUncheckedIndexedAccess', '--exactOptionalPropertyTypes'];
      const tsc = [...rules, '--target', 'es2022', '--module', 'nodenext', '--lib', 'es2022,dom,dom.iterable', '--outDir', file('site'), ...types];
      execFileSync(join(here, 'node_modules/.bin/tsc'), [...tsc, file('site/consumer.mts'), ...shown], { cwd: file('site'), stdio: ['ignore', 'inherit', 'inherit'] });
      const said = async (name: string): Promise<string> => (await run('node', [file(`site/${name}`), stream])).stdout;
      const [consumer, common, ofService, ofFile] = await Promise.all(['consumer.mjs', 'common.cjs', 'block0.mjs', 'block1.mjs'].map(said));
      const told = JSON.parse(consumer) as { error: number; ofStream: { error: number }; refused: string; triangles: number };
      assert.ok(told.error <= 5 && told.ofStream.error === told.error && told.triangles > 1000);
      assert.equal(told.refused, 'invalid_argument');
      assert.equal(common, 'reached\n');
      assert.match(ofService, /^\d+ vertices, \d+ triangles, within [\d.]+ refining\n[^]*triangles, within [\d.]+ reached\n$/);
      const read = /^(\d+) bytes, then (\d+) for \{\s+error: [1-5]/.exec(ofFile);
      assert.ok(read !== null && Number(read[1]) <= Number(read[2]), ofFile);
    });
  } finally {
    await web.close();
  }
});

test('the version is the program\'s', () => {
  const { version } = JSON.parse(readFileSync(join(here, 'package.json'), 'utf8')) as { version: string };
  assert.equal(version, /ptin (\d+\.\d+\.\d+)/.exec(ptin('--version'))?.[1]);
});
