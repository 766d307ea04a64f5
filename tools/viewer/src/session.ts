// SPDX-License-Identifier: GPL-3.0-or-later
//
// Messages of the Worker to the page about one terrain: what it is, meshes to draw as they come, answers, troubles.
import { type Certified, DecodeError, type Decoder, mapCrsOf, Problem, toldBy } from 'ptin-decoder';
import { buffersOf, drawnMesh } from './drawn_mesh';
import { earthOf } from './earth';
import { Frame } from './frame';
import type { FromWorker, Question, Status } from './messages';
import type { TerrainView, ViewEvents } from './terrain_view';

/** Passes a message to the page; buffers of the second go there with it. */
export type Say = (message: FromWorker, transfer?: Transferable[]) => void;

/** A failure as the page tells it. */
export function troubleOf(error: unknown): Extract<FromWorker, { kind: 'error' }> {
  if (error instanceof Problem) return { kind: 'error', title: error.title, message: error.message };
  if (!(error instanceof DecodeError)) {
    return { kind: 'error', title: 'The viewer failed', message: String((error as Error)?.message ?? error) };
  }
  const titles: Partial<Record<DecodeError['code'], string>> = {
    corruption: 'The stream is damaged', invalid_argument: 'This is not a stream',
    unsupported_version: 'The stream is newer than this viewer', resource_exhausted: 'There is no memory left',
  };
  return { kind: 'error', title: titles[error.code] ?? 'The stream cannot be decoded', message: error.message };
}

/** The terrain that is open, and what the page has of it. */
export class Session {
  readonly view: TerrainView;
  private frame: Frame | null = null;
  /** The certificates of the mesh that was handed over last. */
  private drawnCertified: Certified = [];
  private drawn: { decoder: Decoder; vertices: number; numbering: number } | null = null;
  private lastDrawn = 0;
  private drawingTook = 0;
  private later: ReturnType<typeof setTimeout> | undefined;

  constructor(private readonly say: Say, open: (events: ViewEvents) => TerrainView) {
    const failed = (error: unknown): void => { say(troubleOf(error)); };
    this.view = open({
      grown: () => { this.draw(false); }, settled: () => { this.draw(true); }, failed, mended: () => { say({ kind: 'mended' }); },
    });
    this.view.run().catch(failed);
  }

  async ask(ticket: number, question: Question): Promise<void> {
    try {
      if (this.frame === null) throw new Problem('Nothing is there yet', 'Wait until the first triangles have arrived.');
      this.say({ kind: 'answer', ticket, answer: await this.view.answer(question, this.frame) });
    } catch (error) {
      this.say({ kind: 'refused', ticket, message: (error as Error).message });
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
    this.say({ kind: 'terrain', facts, units: told.units, earth, name: told.title || name, about });
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

  /** Hands out the mesh: at once if `now`, else as soon as it is due, so that it comes not more often than drawing it is worth. */
  private draw(now: boolean): void {
    const frame = this.introduce();
    if (frame === null) return;
    const { decoder, certified } = this.view;
    const { mesh, numbering } = decoder;
    const wait = this.lastDrawn + Math.max(60, 4 * this.drawingTook) - performance.now();
    const { drawn } = this;
    const changed = drawn === null || drawn.decoder !== decoder || drawn.vertices !== mesh.vertexCount || drawn.numbering !== numbering;
    if (!changed) this.drawnCertified = certified;
    if (!changed || (!now && wait > 0)) {
      // An end is told with the mesh that it is the end of: until then the certificates are those of the mesh before.
      const { status } = this;
      this.say({ kind: 'status', status: changed ? { ...status, state: 'loading' } : status });
      // The host may send nothing for long after this.
      if (changed) this.later ??= setTimeout(() => { this.draw(true); }, wait);
      return;
    }
    clearTimeout(this.later);
    this.later = undefined;
    const begin = performance.now();
    const made = drawnMesh(mesh, frame);
    this.drawn = { decoder, vertices: mesh.vertexCount, numbering };
    this.drawnCertified = certified;
    this.say({ kind: 'mesh', mesh: made, status: this.status }, buffersOf(made));
    this.lastDrawn = performance.now();
    this.drawingTook = this.lastDrawn - begin;
  }
}
