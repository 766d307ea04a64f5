// SPDX-License-Identifier: GPL-3.0-or-later
//
// The Worker: receives, decodes, answers questions about the mesh that is there, and hands the page meshes to draw.
import type { MapPosition } from './answers';
import { type Certified, certifiedAt } from './certified';
import type { Decoder } from './decoder';
import { drawnMesh, surfaceEdges } from './drawn_mesh';
import { type Told, earthOf, toldBy } from './earth';
import { Problem } from './fetching';
import { Frame, unitsOf } from './frame';
import type { Answer, Certainty, FromWorker, Question, Source, Status, ToWorker, Wanted } from './messages';
import { DecodeError } from './module';
import { type Asked, Questions } from './questions';
import { StaticStream, openStream } from './static_stream';
import { Service } from './service';
import { ServedView } from './served_view';

const say = (message: FromWorker, transfer: Transferable[] = []): void =>
  (self as unknown as { postMessage(m: FromWorker, t: Transferable[]): void }).postMessage(message, transfer);

/** Lets messages of the page in between two pieces of work. */
const breath = (): Promise<void> => new Promise((resolve) => { setTimeout(resolve, 0); });

/** A failure as the page tells it. */
function tell(error: unknown, final: boolean): void {
  if (error instanceof Problem) {
    say({ kind: 'error', title: error.title, message: error.message, final });
    return;
  }
  if (!(error instanceof DecodeError)) {
    say({ kind: 'error', title: 'The viewer failed', message: String((error as Error)?.message ?? error), final });
    return;
  }
  const titles: Partial<Record<DecodeError['code'], string>> = {
    corruption: 'The stream is damaged', invalid_argument: 'This is not a stream',
    unsupported_version: 'The stream is newer than this viewer', resource_exhausted: 'There is no memory left',
  };
  const title = titles[error.code] ?? 'The stream cannot be decoded';
  say({ kind: 'error', title, message: error.message, final });
}

/** Everything about the terrain that is open. */
class Session {
  private frame: Frame | null = null;
  private told: Told = toldBy(null);
  /** The certificates of the mesh that was handed over last. */
  private drawnCertified: Certified = { parts: [], otherwise: { error: Infinity, deviation: Infinity } };
  private readonly still: StaticStream;
  private served: ServedView | null = null;
  private bytesInAll = 0;
  private arrived = false;
  /** All that arrived is applied, and nothing more comes. */
  private settled = false;
  private cut = false;
  private failed = false;
  private error = 0;
  private drawnVertices = -1;
  private drawnNumbering = -1;
  private drawnOf: Decoder | null = null;
  private lastDrawn = 0;
  private drawingTook = 0;
  private edgesWanted = false;
  private wake: (() => void) | null = null;

  constructor(
    private readonly module: WebAssembly.Module, private readonly source: Source, private readonly mostVertices: number,
    private readonly folder: string,
  ) {
    this.still = new StaticStream(module, { error: 0, mostVertices });
  }

  async run(opening: Promise<Awaited<ReturnType<typeof openStream>>> | null): Promise<void> {
    if (this.source.kind === 'collection') {
      await this.runServed(new Service(this.source.service, this.source.id));
      return;
    }
    const url = this.source.url;
    const { reader, bytesInAll } = await (opening ?? openStream(url));
    this.bytesInAll = bytesInAll;
    const receiving = this.receive(reader);
    await this.follow();
    await receiving;
  }

  setLimit(error: number): void {
    this.error = error;
    this.served?.setLimit(error);
    if (!this.failed) this.still.setError(error);
    this.wake?.();
  }

  setView(wanted: Wanted[]): void {
    this.served?.setView(wanted);
  }

  sendEdges(wanted: boolean): void {
    this.edgesWanted = wanted;
    if (!wanted || !this.current.hasMesh) return;
    const edges = surfaceEdges(this.current.mesh);
    say({ kind: 'edges', edges }, [edges.buffer]);
  }

  async ask(ticket: number, question: Question): Promise<void> {
    try {
      if (!this.current.hasMesh || this.frame === null) {
        throw new Problem('Nothing is there yet', 'Wait until the first triangles have arrived.');
      }
      const answer = await (this.served === null ? this.answer(question, this.frame) : this.served.answer(question, this.frame));
      say({ kind: 'answer', ticket, answer });
    } catch (error) {
      say({ kind: 'refused', ticket, message: (error as Error).message });
    }
  }

  /** The decoder whose mesh is shown. */
  private get current(): Decoder {
    return this.served?.decoder ?? this.still.decoder;
  }

  private async runServed(service: Service): Promise<void> {
    const collection = await service.collection();
    this.served = new ServedView(service, collection, this.module, this.mostVertices, {
      grown: () => { this.introduce(collection.title); this.draw(false); },
      settled: () => { this.introduce(collection.title); this.draw(true); },
      failed: (error, final) => { tell(error, final); },
      mended: () => { say({ kind: 'mended' }); },
    });
    this.served.setLimit(this.error);
    await this.served.run();
  }

  /** Reads what the host sends, unless what is there is enough: then it waits, and so does the host. */
  private async receive(reader: ReadableStreamDefaultReader<Uint8Array>): Promise<void> {
    try {
      for (;;) {
        while (this.still.heldBy !== null && !this.failed) {
          await new Promise<void>((resolve) => { setTimeout(resolve, 100); });
        }
        const { done, value } = await reader.read();
        if (done || this.failed) break;
        this.still.kept.add(value);
        this.wake?.();
      }
    } catch {
      this.cut = true;
    }
    this.arrived = true;
    this.wake?.();
    if (this.failed) await reader.cancel().catch(() => undefined);
  }

  /** Applies what arrives, for as long as the page is open. */
  private async follow(): Promise<void> {
    for (;;) {
      let more = false;
      try {
        more = this.still.apply(40);
      } catch (error) {
        // What came whole before the damage is shown, though the damage was met before anything was.
        this.failed = true;
        this.introduce(nameOf(this.source));
        this.draw(true);
        tell(error, true);
        return;
      }
      this.introduce(nameOf(this.source));
      const settled = this.settled = this.arrived && !more;
      this.draw(!more && (settled || this.still.heldBy !== null));
      if (settled && !this.still.decoder.hasMesh) {
        throw new Problem('The stream ends too early', 'Its first part, without which nothing can be shown, is not whole.');
      }
      if (more) {
        await breath();
      } else {
        await new Promise<void>((resolve) => { this.wake = resolve; });
        this.wake = null;
      }
    }
  }

  /** Tells the page what terrain it is, once. */
  private introduce(name: string): void {
    if (this.frame !== null || !this.current.hasMesh) return;
    const decoder = this.current;
    const { facts } = decoder;
    let metadata: unknown = null;
    try {
      metadata = JSON.parse(decoder.metadata);
    } catch { /* Text that is no JSON tells nothing. */ }
    const units = unitsOf(metadata);
    this.told = toldBy(metadata);
    decoder.describe(this.told.ground);
    const earth = earthOf(decoder, this.told, units);
    this.frame = new Frame(facts, units, earth);
    say({ kind: 'terrain', facts, units, earth, metadata, name });
  }

  /** The certificates of the mesh that is there. */
  private get certified(): Certified {
    if (this.served !== null) return this.served.certified;
    const decoder = this.current;
    const { window, levels } = this.told.request;
    // A stream for isolines is certified along these alone.
    const isKnown = this.frame !== null && levels === undefined;
    const parts = isKnown ? [{ window: window ?? this.frame!.bounds, ...decoder.certificate }] : [];
    return { parts, otherwise: decoder.certificateByRelief };
  }

  private status(): Status {
    const d = this.current;
    const { vertexCount, triangleCount } = d.hasMesh ? d.mesh : { vertexCount: 0, triangleCount: 0 };
    const held = this.served === null ? this.still.heldBy : this.served.heldBy;
    const loading = this.served === null ? !this.settled : this.served.isLoading;
    const isCut = !loading && this.served === null && (!d.isComplete || this.cut);
    return {
      vertices: vertexCount, triangles: triangleCount, splits: d.splits, splitsInAll: d.splitsInAll,
      bytes: this.served?.bytes ?? this.still.kept.bytes, bytesInAll: this.bytesInAll, certified: this.drawnCertified,
      waitsFor: this.served?.waitsFor,
      state: this.failed ? 'damaged' : d.isComplete && this.served === null ? 'complete'
        : held !== null ? 'held' : loading ? 'loading' : isCut ? 'cut' : 'complete',
      heldBy: held ?? undefined, isServed: this.served !== null, requests: this.served?.requests ?? 1, cost: this.served?.cost,
    };
  }

  /** Hands out the mesh. Unless `now`, not more often than drawing it is worth. */
  private draw(now: boolean): void {
    const d = this.current;
    if (!d.hasMesh || this.frame === null) return;
    const { mesh } = d;
    const due = performance.now() - this.lastDrawn > Math.max(60, 4 * this.drawingTook);
    const changed = this.drawnVertices !== mesh.vertexCount || this.drawnNumbering !== d.numbering ||
      this.drawnOf !== d;
    if (!changed) this.drawnCertified = this.certified;
    if (!changed || !(now || due)) {
      say({ kind: 'status', status: this.status() });
      return;
    }
    const begin = performance.now();
    const drawn = drawnMesh(mesh, this.frame);
    this.drawnVertices = mesh.vertexCount;
    this.drawnNumbering = d.numbering;
    this.drawnOf = d;
    this.drawnCertified = this.certified;
    say({ kind: 'mesh', mesh: drawn, status: this.status() },
      [drawn.positions.buffer, drawn.normals.buffer, drawn.corners.buffer]);
    if (this.edgesWanted) this.sendEdges(true);
    this.lastDrawn = performance.now();
    this.drawingTook = this.lastDrawn - begin;
  }

  private questions: Promise<Questions> | null = null;

  /** The module of questions, which comes when something is asked; one that could not be had is asked for again. */
  private fetchQuestions(): Promise<Questions> {
    const coming = this.questions ??= moduleAt(this.folder, 'questions.wasm').then((module) => new Questions(module));
    coming.catch(() => { this.questions = null; });
    return coming;
  }

  /** What is asked at places of the mesh that is there. */
  private askedAt(places: readonly MapPosition[]): Asked & { certainty: Certainty } {
    const decoder = this.current;
    decoder.describe(this.told.ground);
    const { error, window, levels, splits } = this.told.request;
    const isAll = error === undefined && window === undefined && levels === undefined && splits === undefined;
    const certificate = certifiedAt(this.certified, places);
    const isCertified = certificate.deviation < decoder.certificateByRelief.deviation;
    return {
      decoder, ground: this.told.ground, freeOfVoids: this.told.freeOfVoids, isWhole: isAll && decoder.isComplete,
      certificate: isCertified ? certificate : null,
      certainty: { ...certificate, of: 'mesh', isExact: isCertified && certificate.deviation === 0 },
    };
  }

  /** Answers from the mesh that is there, within its certificate: all numbers are the engine's. */
  private async answer(question: Question, frame: Frame): Promise<Answer> {
    if (question.kind === 'viewshed') {
      throw new Problem('Nobody can be asked', 'A viewshed needs a service; this terrain comes from a file.');
    }
    const questions = await this.fetchQuestions();
    // The mesh may have grown while the module came: the question is of the mesh of now.
    const { certainty, ...asked } = this.askedAt(question.kind === 'height' ? [question.at] : [question.from, question.to]);
    if (question.kind === 'height') {
      return { kind: 'height', at: question.at, located: questions.locate(asked, question.at), certainty };
    }
    const { from, to } = question;
    this.checkLine(asked.decoder, frame, from, to);
    const profile = { ...questions.profile(asked, from, to), lengths: frame.earth.lengths };
    if (question.kind === 'profile') return { kind: 'profile', from, to, profile, certainty };
    const { request } = question;
    const sight = questions.sight(
      asked, from, request.observerHeight / frame.scaleZ, to, request.targetHeight / frame.scaleZ, request.frequency);
    return { kind: 'sight', from, to, request, sight, profile, certainty };
  }

  /** Refuses lines of which the engine cannot tell the length. */
  private checkLine(decoder: Decoder, frame: Frame, from: MapPosition, to: MapPosition): void {
    const least = 2 ** -20;
    if (Math.abs(frame.gridX(from.x) - frame.gridX(to.x)) < least && Math.abs(frame.gridY(from.y) - frame.gridY(to.y)) < least) {
      throw new Problem('No line', 'Both ends are at one place.');
    }
    if (this.told.ground === null && frame.isDegrees) {
      throw new Problem('No lengths', 'Lengths are not known: this stream was written by a program that did not tell its ellipsoid.');
    }
    if (!Number.isFinite(decoder.metresBetween(from, to))) {
      throw new Problem('No length', 'The length of a line around the Earth is not known here. Take a shorter one.');
    }
  }
}

function nameOf(source: Source): string {
  if (source.kind === 'collection') return source.id;
  const last = source.name ?? decodeURIComponent(source.url.split(/[?#]/)[0].split('/').pop() ?? '');
  return last.replace(/\.(ptins|pts)$/, '') || 'Terrain';
}

/** A module of the viewer, which lies beside the page. */
async function moduleAt(folder: string, name: string): Promise<WebAssembly.Module> {
  const fetched = await fetch(new URL(name, folder)).catch(() => null);
  if (fetched === null) {
    throw new Problem('The viewer cannot be reached', `A part of it (${name}) did not come: the connection to the host broke, or there is none.`);
  }
  if (!fetched.ok) throw new Problem('The viewer is not whole', `A part of it (${name}) does not lie beside it.`);
  return WebAssembly.compile(await fetched.arrayBuffer());
}

let session: Promise<Session> | null = null;

async function open(message: Extract<ToWorker, { kind: 'open' }>): Promise<Session> {
  // The stream is asked for while the decoder still comes.
  const opening = message.source.kind === 'stream' ? openStream(message.source.url) : null;
  opening?.catch(() => undefined);
  const module = await moduleAt(message.folder, 'decoder.wasm');
  const made = new Session(module, message.source, message.mostVertices, message.folder);
  made.run(opening).catch((error: unknown) => { tell(error, true); });
  return made;
}

self.onmessage = (event: MessageEvent<ToWorker>): void => {
  const message = event.data;
  if (message.kind === 'open') {
    session = open(message);
    session.catch((error: unknown) => { tell(error, true); });
    return;
  }
  session?.then((s) => {
    if (message.kind === 'limit') s.setLimit(message.error);
    if (message.kind === 'view') s.setView(message.wanted);
    if (message.kind === 'edges') s.sendEdges(message.wanted);
    if (message.kind === 'ask') void s.ask(message.ticket, message.question);
  }).catch(() => undefined);
};
