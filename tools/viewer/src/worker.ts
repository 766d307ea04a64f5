// SPDX-License-Identifier: GPL-3.0-or-later
//
// The Worker: opens a terrain, hands the page meshes to draw, and passes its questions on.
import { HostedBytes } from 'ptin-decoder';
import { moduleAt } from './fetching';
import { FileView } from './file_view';
import type { Source, ToWorker } from './messages';
import { Service } from './service';
import { ServedView } from './served_view';
import { type Say, Session, troubleOf } from './session';

const say: Say = (message, transfer = []) => {
  (self as unknown as { postMessage(m: unknown, t: Transferable[]): void }).postMessage(message, transfer);
};

function nameOf(source: Extract<Source, { kind: 'stream' }>): string {
  const last = source.name ?? decodeURIComponent(source.url.split(/[?#]/)[0].split('/').pop() ?? '');
  return last.replace(/\.(ptins|pts)$/, '') || 'Terrain';
}

let session: Promise<Session> | null = null;

async function open({ source, folder, mostVertices }: Extract<ToWorker, { kind: 'open' }>): Promise<Session> {
  // The terrain is asked for while the decoder still comes.
  if (source.kind === 'stream') {
    const opening = new HostedBytes(source.url).open();
    opening.catch(() => undefined);
    const module = await moduleAt(folder, 'decoder.wasm');
    return new Session(say, (events) => new FileView(nameOf(source), opening, module, folder, mostVertices, events));
  }
  const service = new Service(source.service, source.id);
  const [module, collection] = await Promise.all([moduleAt(folder, 'decoder.wasm'), service.collection()]);
  return new Session(say, (events) => new ServedView(service, collection, module, mostVertices, events));
}

self.onmessage = (event: MessageEvent<ToWorker>): void => {
  const message = event.data;
  if (message.kind === 'open') {
    session = open(message);
    session.catch((error: unknown) => { say(troubleOf(error)); });
    return;
  }
  session?.then((s) => {
    if (message.kind === 'limit') s.view.setLimit(message.error);
    if (message.kind === 'view') s.view.setView(message.wanted);
    if (message.kind === 'ask') void s.ask(message.ticket, message.question);
  }).catch(() => undefined);
};
