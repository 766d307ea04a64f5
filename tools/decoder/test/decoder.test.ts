// SPDX-License-Identifier: GPL-3.0-or-later
//
// The decoder in WebAssembly against the program: the same mesh, bit for bit, however the bytes were cut.
import { DecodeError, Decoder } from '../src/index';
import assert from 'node:assert/strict';
import { readFileSync, writeFileSync } from 'node:fs';
import { test } from 'node:test';
import { decoded, decoderModule, file, ptin, terrain, trianglesOf, trianglesOfPly } from './support';

const module = decoderModule();

for (const name of ['mountains_257', 'coast_257']) {
  test(`a whole stream is the mesh that unstream writes: ${name}`, () => {
    const { stream } = terrain(name, '--error', '0.5');
    const answer = JSON.parse(ptin('unstream', stream, '-o', file('whole.ply'), '--overwrite', '--json')) as Record<string, number>;
    assert.equal(new Decoder(module).certificate, null);
    const decoder = decoded(module, readFileSync(stream), 4096);
    assert.ok(decoder.isComplete);
    assert.equal(decoder.mesh.vertexCount, answer.vertices);
    assert.equal(decoder.mesh.triangleCount, answer.triangles);
    assert.equal(decoder.certificate?.error, answer.certified_error);
    assert.equal(decoder.certificate?.deviation, answer.certified_deviation);
    assert.deepEqual(trianglesOf(decoder.mesh, decoder.facts), trianglesOfPly(file('whole.ply')));
  });
}

test('cut anywhere it is what unstream makes of the same bytes', () => {
  const bytes = readFileSync(terrain('mountains_257', '--error', '4').stream);
  const cuts = process.env.PTIN_ALL_CASES === undefined ? 10 : 100;
  const least = bytes.length / (cuts + 1);
  let meshes = 0;
  for (let i = 1; i <= cuts; ++i) {
    const cut = bytes.subarray(0, Math.floor(i * least));
    const decoder = decoded(module, cut, 1 + (i * 37) % 5000);
    if (!decoder.hasMesh) continue;
    ++meshes;
    writeFileSync(file('cut.ptins'), cut);
    const answer = JSON.parse(ptin('unstream', file('cut.ptins'), '-o', file('cut.ply'), '--overwrite', '--json')) as
      Record<string, number>;
    assert.equal(decoder.splits, answer.splits);
    assert.equal(decoder.certificate?.error, answer.certified_error);
    assert.deepEqual(trianglesOf(decoder.mesh, decoder.facts), trianglesOfPly(file('cut.ply')), `cut behind ${cut.length} bytes`);
  }
  assert.ok(meshes > 0.8 * cuts, `${meshes} of ${cuts} cuts have a mesh`);
});

test('a stream that goes on from another is followed', () => {
  const { store, stream } = terrain('mountains_257', '--error', '20');
  ptin('stream', store, '--error', '5', '--have-error', '20', '-o', file('more.ptins'), '--overwrite');
  const decoder = decoded(module, readFileSync(stream));
  const first = decoder.numbering;
  decoder.feed(readFileSync(file('more.ptins')));
  assert.notEqual(decoder.numbering, first);
  ptin('unstream', stream, file('more.ptins'), '-o', file('both.ply'), '--overwrite');
  assert.deepEqual(trianglesOf(decoder.mesh, decoder.facts), trianglesOfPly(file('both.ply')));
});

test('damage anywhere is refused by a sentence, and what came before stays', () => {
  const bytes = readFileSync(terrain('mountains_257', '--error', '20').stream);
  for (let i = 0; i < 200; ++i) {
    const damaged = new Uint8Array(bytes);
    const at = Math.floor((i + 0.5) * bytes.length / 200);
    damaged[at] ^= 1 << (i % 8);
    const decoder = new Decoder(module);
    assert.throws(() => { decoder.feed(damaged); }, (error: unknown) => {
      assert.ok(error instanceof DecodeError);
      assert.match(error.code, /corruption|unsupported_version/);
      assert.match(error.message, /stream/);
      return true;
    });
    if (decoder.hasMesh) assert.ok(decoder.mesh.vertexCount >= 4);
    assert.throws(() => { decoder.feed(damaged); }, DecodeError, 'nothing more can be fed');
  }
});

test('a store is told apart from a stream, and something else from both', () => {
  const { store } = terrain('mountains_257', '--error', '20');
  assert.throws(() => { decoded(module, readFileSync(store)); }, { code: 'invalid_argument', message: /a store, not a stream/ });
  assert.throws(() => { decoded(module, new TextEncoder().encode('<!doctype html><p>no')); }, { code: 'invalid_argument' });
});
