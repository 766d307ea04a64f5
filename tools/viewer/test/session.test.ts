// SPDX-License-Identifier: GPL-3.0-or-later
//
// Messages of the Worker about a terrain that comes in pieces.
import { Decoder } from 'ptin-decoder';
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';
import type { FromWorker } from '../src/messages';
import { Session } from '../src/session';
import type { TerrainView, ViewEvents } from '../src/terrain_view';
import { decoderModule, terrain } from '../../decoder/test/support';

test('a mesh that comes too soon after another is handed out later, though the host sends nothing more', async () => {
  const bytes = readFileSync(terrain('mountains_257').stream);
  const decoder = new Decoder(decoderModule());
  let events: ViewEvents | undefined;
  const view = {
    decoder, certified: [], name: 'm', attribution: '', lonLat: null, baseMap: null,
    progress: { bytes: 0, bytesInAll: 0, state: 'loading' }, run: () => Promise.resolve(),
  } as unknown as TerrainView;
  const told: FromWorker[] = [];
  const lastMesh = (): number => told.reduce((last, m) => (m.kind === 'mesh' ? m.status.vertices : last), 0);
  await new Promise<void>((resolve) => {
    new Session((message) => {
      told.push(message);
      if (lastMesh() === 257 * 257) resolve();
    }, (given) => { events = given; return view; });
    decoder.feed(bytes.subarray(0, bytes.length / 2));
    events!.grown();
    assert.deepEqual(told.map((m) => m.kind), ['terrain', 'mesh']);
    decoder.feed(bytes.subarray(bytes.length / 2));
    view.progress.state = 'complete';
    events!.grown();
    assert.equal((told[told.length - 1] as Extract<FromWorker, { kind: 'status' }>).status.state, 'loading', 'its last mesh is not told yet');
  });
  assert.equal((told[told.length - 1] as Extract<FromWorker, { kind: 'mesh' }>).status.state, 'complete');
  const meshes = told.filter((m) => m.kind === 'mesh').length;
  events!.grown();
  assert.equal(told.filter((m) => m.kind === 'mesh').length, meshes, 'no mesh comes twice');
});
