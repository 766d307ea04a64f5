// SPDX-License-Identifier: GPL-3.0-or-later
//
// The Worker: opens a terrain, hands the page meshes to draw, and passes its questions on.
import { type Certified, DecodeError, type Decoder, HostedBytes, mapCrsOf, Problem, toldBy } from 'ptin-decoder';
import { buffersOf, drawnMesh } from './drawn_mesh';
import { earthOf } from './earth';
import { moduleAt } from './fetching';
import { FileView } from './file_view';
import { Frame } from './frame';
import type { FromWorker, Question, Source, Status, ToWorker } from './messages';
import { Service } from './service';
import { ServedView } from './served_view';
import type { TerrainView, ViewEvents } from './terrain_view';

const say = (message: FromWorker, transfer: Transferable[] = []): void =>
  (self as unknown as { postMessage(m: FromWorker, t: Transferable[]): void }).postMessage(message, transfer);

/** A failure as the page tells it. */
function tell(error: unknown): void {
  if (error instanceof Problem) {
    say({ kind: 'error', title: error.title, message: error.message });
    return;
  }
  if (!(error instanceof DecodeError)) {
    say({ kind: 'error', title: 'The viewer failed', message: String((error as Error)?.message ?? error) });
    return;
  }
  const titles: Partial<Record<DecodeError['code'], string>> = {
    corruption: 'The stream is damaged', invalid_argument: 'This is not a stream',
    unsupported_version: 'The stream is newer than this viewer', resource_exhausted: 'There is no memory left',
  };
  say({ kind: 'error', title: titles[error.code] ?? 'The stream cannot be decoded', message: error.message });
}

/** The terrain that is open, and what the page has of it. */
class Session {
  readonly view: TerrainView;
  private frame: Frame | null = null;
  /** The certificates of the mesh that was handed over last. */
  private drawnCertified: Certified = [];
  private drawn: { decoder: Decoder; vertices: number; numbering: number } | null = null;
  private lastDrawn = 0;
  private drawingTook = 0;

  constructor(open: (events: ViewEvents) => TerrainView) {
    this.view = open({
      grown: () => { this.draw(false); }, settled: () => { this.draw(true); }, failed: tell, mended: () => { say({ kind: 'mended' }); },
    });
    this.view.run().catch(tell);
  }

  async ask(ticket: number, question: Question): Promise<void> {
    try {
      if (this.frame === null) throw new Problem('Nothing is there yet', 'Wait until the first triangles have arrived.');
      say({ kind: 'answer', ticket, answer: await this.view.answer(question, this.frame) });
    } catch (error) {
      say({ kind: 'refused', ticket, message: (error as Error).message });
    }
  }

  /** Tells the page what terrain it is, once; null until there is a mesh. */
  private introduce(): Frame | null {
    const { decoder } = this.view;
    if (this.frame !== null || !decoder.hasMesh) return this.frame;
    const { facts } = decoder;
    const told = toldBy(decoder.metadata);
    decoder.describe(told.ground);
    const earth = earthOf(decoder, told);
    this.frame = new Frame(facts, told.units, earth);
    const { name, attribution, lonLat, baseMap } = this.view;
    const crs = /"([^"]*)"/.exec(mapCrsOf(told.crs ?? ''))?.[1] ?? '';
    const about = { attribution: told.attribution || attribution, crs, lonLat, baseMap };
    say({ kind: 'terrain', facts, units: told.units, earth, name: told.title || name, about });
    return this.frame;
  }

  private get status(): Status {
    const { decoder, progress } = this.view;
    const { vertexCount, triangleCount } = decoder.mesh;
    return {
      vertices: vertexCount, triangles: triangleCount, splits: decoder.splits, splitsInAll: decoder.splitsInAll,
      certified: this.drawnCertified, ...progress,
    };
  }

  /** Hands out the mesh. Unless `now`, not more often than drawing it is worth. */
  private draw(now: boolean): void {
    const frame = this.introduce();
    if (frame === null) return;
    const { decoder, certified } = this.view;
    const { mesh, numbering } = decoder;
    const due = performance.now() - this.lastDrawn > Math.max(60, 4 * this.drawingTook);
    const { drawn } = this;
    const changed = drawn === null || drawn.decoder !== decoder || drawn.vertices !== mesh.vertexCount || drawn.numbering !== numbering;
    if (!changed) this.drawnCertified = certified;
    if (!changed || !(now || due)) {
      say({ kind: 'status', status: this.status });
      return;
    }
    const begin = performance.now();
    const made = drawnMesh(mesh, frame);
    this.drawn = { decoder, vertices: mesh.vertexCount, numbering };
    this.drawnCertified = certified;
    say({ kind: 'mesh', mesh: made, status: this.status }, buffersOf(made));
    this.lastDrawn = performance.now();
    this.drawingTook = this.lastDrawn - begin;
  }
}

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
    return new Session((events) => new FileView(nameOf(source), opening, module, folder, mostVertices, events));
  }
  const service = new Service(source.service, source.id);
  const [module, collection] = await Promise.all([moduleAt(folder, 'decoder.wasm'), service.collection()]);
  return new Session((events) => new ServedView(service, collection, module, mostVertices, events));
}

self.onmessage = (event: MessageEvent<ToWorker>): void => {
  const message = event.data;
  if (message.kind === 'open') {
    session = open(message);
    session.catch(tell);
    return;
  }
  session?.then((s) => {
    if (message.kind === 'limit') s.view.setLimit(message.error);
    if (message.kind === 'view') s.view.setView(message.wanted);
    if (message.kind === 'ask') void s.ask(message.ticket, message.question);
  }).catch(() => undefined);
};
