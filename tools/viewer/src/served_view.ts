// SPDX-License-Identifier: GPL-3.0-or-later
//
// A terrain of a service, as fine as the camera needs it where it looks. Each answer is a stream that goes on from those before
// it, so only what is missing travels. Detail that is no longer looked at goes away when there is too much of it: then the view
// is fetched anew into a second decoder, which takes the place of the first once it has caught up.
import {
  type BaseMap, type Certified, certifiedAt, type Collection, DecodeError, type Decoder, type LonLatNodes, mostServings, Problem, Received, type Wanted, widened, type Window,
} from 'ptin-decoder';
import { rounded } from './format';
import type { Frame } from './frame';
import type { Answer, Progress, Question } from './messages';
import { measuredInPlan } from './plan';
import { type Service, costOf, millisecondsOf } from './service';
import type { TerrainView, ViewEvents } from './terrain_view';
import { VertexBudget } from './vertex_budget';

const firstBytes = 64 * 1024;
const laterBytes = 256 * 1024;
const leastBytes = 32 * 1024;
/** The share of the time that the service computes which an answer should take; what it may then differ is left. */
const shareOfTime = 0.15;
/** Times finer than what is there that one answer may be, and least, so that there is an end. */
const mostFiner = 5, leastFiner = 1.4;
/** Milliseconds before a service that failed is asked again. */
const firstWait = 1000, longestWait = 20000;
/** Parts are about as fine as one another, measured by what is wanted of each, up to this factor. */
const mostUneven = 4;

export class ServedView implements TerrainView {
  private shown: Received;
  /** The receiver of what is asked for now; after a start anew not `shown` yet. */
  private received: Received;
  private wanted: Wanted[] = [];
  private leastError = 0;
  /** Errors are this many times those of the camera, where the vertices would be too many. */
  private coarser = 1;
  /** The parts that were wanted since the receiver began; null: what it holds is not, or not so finely, looked at any more. */
  private lookedAt: Wanted[] | null;
  private readonly budget: VertexBudget;
  private wake: (() => void) | null = null;
  /** Bytes of the next answer: less where the service has not the memory for more. */
  private mostBytes = laterBytes;
  /** The last answer was more than may be held. */
  private hadNoRoom = false;
  /** The service has not the memory for all that is wanted. */
  private isTooMuch = false;
  private bytes = 0;
  private cost: string | undefined;
  /** Milliseconds that the last answer took the service; null: it does not tell. */
  private lastTook: number | null = null;
  private isLoading = true;
  /** Why nothing comes at the moment. */
  private waitsFor: string | undefined;
  private failures = 0;

  constructor(
    private readonly service: Service, private readonly collection: Collection, private readonly module: WebAssembly.Module,
    mostVertices: number, private readonly events: ViewEvents,
  ) {
    this.shown = this.received = new Received(module);
    this.budget = new VertexBudget(mostVertices, collection.limits?.held_vertices ?? Infinity);
    this.lookedAt = [{ window: collection.bounds, error: Infinity }];
  }

  get name(): string { return this.collection.title; }
  get attribution(): string { return this.collection.attribution ?? ''; }
  get baseMap(): BaseMap | null { return this.collection.baseMap ?? null; }
  get lonLat(): LonLatNodes | null { return this.collection.lonLat ?? null; }
  get decoder(): Decoder { return this.shown.decoder; }
  get certified(): Certified { return this.shown.certified; }
  get progress(): Progress {
    const heldBy = this.isTooMuch ? 'service' : this.coarser > 1 ? this.budget.heldBy : undefined;
    return {
      bytes: this.bytes, bytesInAll: 0, heldBy, waitsFor: this.waitsFor, cost: this.cost,
      state: heldBy !== undefined ? 'held' : this.isLoading ? 'loading' : 'complete',
    };
  }

  setLimit(error: number): void {
    if (error === this.leastError) return;
    this.leastError = error;
    this.startAnew();
    this.wake?.();
  }

  setView(wanted: Wanted[]): void {
    // A window that sticks out by the last bit of a number would never be covered.
    this.wanted = wanted.map((w) => ({ window: widened(w.window, this.collection.bounds, 0), error: w.error }));
    if (this.lookedAt?.some((held) => !this.isLookedAt(held)) ?? false) {
      this.lookedAt = null;
      // What another view had to make do with says nothing of this one.
      this.coarser = 1;
    }
    const { lookedAt } = this;
    // A part that is about one of those adds nothing.
    const isNew = (w: Wanted): boolean => !lookedAt!.some((held) => shareOf(w.window, [held.window]) >= 0.5 && held.error <= 2 * w.error);
    lookedAt?.push(...this.wanted.filter(isNew));
    this.isTooMuch = false;
    this.mostBytes = laterBytes;
    this.budget.recover();
    if (!this.isLean) this.coarser = Math.max(1, this.coarser * 0.8);
    this.wake?.();
  }

  async run(): Promise<void> {
    // All of the terrain, coarsely: so that something is known of each place, of those beside the parts, too.
    const first: Wanted = { window: this.collection.bounds, error: Math.max(this.relief / 50, 1e-6) };
    for (;;) {
      if (!this.received.decoder.hasMesh) {
        this.hadNoRoom = false;
        await this.bring(first, firstBytes);
        const isTooFine = this.isTooMuch || this.hadNoRoom;
        if (!this.received.decoder.hasMesh && isTooFine && first.error < this.relief) first.error *= 2;
        continue;
      }
      if (this.nextWanted() !== undefined && this.budget.isFull(verticesOf(this.received)) && this.makesDo()) continue;
      const next = this.nextWanted();
      if (next !== undefined) {
        this.isLoading = true;
        await this.bring(next, this.budget.bytesBeside(verticesOf(this.received), this.mostBytes));
        continue;
      }
      this.shown = this.received;
      this.isLoading = false;
      this.events.settled();
      await new Promise<void>((resolve) => { this.wake = resolve; });
      this.wake = null;
    }
  }

  async answer(question: Question, frame: Frame): Promise<Answer> {
    try {
      return await this.service.answer(question, frame);
    } catch (error) {
      // A service that has no /volume leaves the plan.
      if (question.kind === 'area' && error instanceof Problem && error.status === 404) return measuredInPlan(question, frame);
      throw error;
    }
  }

  /** A part that is held is in sight for the most part, and not far finer than it is wanted there. */
  private isLookedAt({ window, error }: Wanted): boolean {
    const there = this.wanted.filter((w) => shareOf(window, [w.window]) >= 0.5);
    return there.length > 0 && error * mostUneven >= Math.min(...there.map((w) => w.error));
  }

  /** All that is held is looked at, about. */
  private get isLean(): boolean { return this.lookedAt !== null; }

  /** The parts, as coarse as they have to be. */
  private get parts(): Wanted[] {
    return this.wanted.map((w) => ({ window: w.window, error: Math.max(w.error * this.coarser, this.leastError) }));
  }

  /** The first part that is open, at its next step: part after part takes half as many answers as all in turns. */
  private nextWanted(): Wanted | undefined {
    return this.parts.map((w) => this.rung(w)).find((w) => !this.received.covers(w));
  }

  /** The error of a part; null: nothing is known of it. */
  private errorThere([west, south, east, north]: Window): number | null {
    const there = certifiedAt(this.received.certified, [{ x: west, y: south }, { x: east, y: north }]);
    // Before all borders of voids are there no error is finite: that of nothing is the relief.
    return there && Math.min(there.error, this.relief);
  }

  /**
   * The next step of a part on the way to what is wanted. The service makes all of the mesh that a receiver has for each answer, and
   * takes the longer the finer it is: so that it need never refuse, one answer is not much finer than what is there.
   */
  private rung(wanted: Wanted): Wanted {
    const { computing } = this.collection.limits ?? {};
    if (this.lastTook === null || computing === undefined || this.received.covers(wanted)) return wanted;
    const finer = Math.max(leastFiner, Math.min(mostFiner, shareOfTime * computing / Math.max(1, this.lastTook)));
    return { window: wanted.window, error: Math.max(wanted.error, (this.errorThere(wanted.window) ?? 0) / finer) };
  }

  private startAnew(): void {
    this.received = new Received(this.module);
    this.lookedAt = [...this.wanted];
  }

  /**
   * There is no room for more. What is not looked at goes; where all is looked at, and all parts are about as fine as one another,
   * they stay as they are. False where nothing can be done.
   */
  private makesDo(): boolean {
    const times = this.parts.map(({ window, error }) => Math.max(1, (this.errorThere(window) ?? this.relief) / error));
    const most = Math.max(...times);
    // Borders of voids come before anything is certified: they come as far as there is room. Where all is as fine as wanted, coarser
    // parts would free nothing.
    if (most === 1 || this.received.certified.every((part) => part.error === Infinity)) return false;
    if (this.isLean && most <= mostUneven * Math.min(...times)) {
      // Rounding shall not leave a part open.
      this.coarser *= most * (1 + 1e-9);
      return true;
    }
    if (this.isLean) this.coarser *= 1.5;
    this.startAnew();
    return true;
  }

  /**
   * Too much is held with what was asked last: without what is not looked at any more, or coarser when there is nothing else. What
   * came stays where nothing can be: the borders of voids come first, at every error, and nothing is certified before.
   */
  private makeRoom(held: Received, { window, error }: Wanted): void {
    const isUncertified = held.certified.every((part) => part.error === Infinity);
    if (isUncertified || (this.isLean && error >= this.relief)) {
      this.isTooMuch = true;
      held.giveUp({ window: this.collection.bounds, error: 0 });
      return;
    }
    this.hadNoRoom = true;
    const looked = this.wanted.find((w) => w.window === window)?.error ?? error;
    if (this.isLean) this.coarser = 1.5 * Math.max(this.coarser, error / looked);
    this.startAnew();
  }

  private get relief(): number {
    const [low, high] = this.collection.heights;
    return high - low;
  }

  /** Asks for a part, once. A failure waits before the next attempt; what came before stays. Throws where the terrain is another one. */
  private async bring(wanted: Wanted, mostBytes: number): Promise<void> {
    const to = this.received;
    if (to.have.length >= mostServings) {
      this.startAnew();
      return;
    }
    try {
      // A quarter larger, and somewhat finer, so that a small move asks for nothing.
      const window = widened(wanted.window, this.collection.bounds, 1 / 8);
      await this.receive(to, { window, error: rounded(0.8 * wanted.error, 2) }, mostBytes);
      if (this.failures > 0) this.events.mended();
      this.failures = 0;
      this.waitsFor = undefined;
    } catch (error) {
      // The page's frame is of the terrain that there was.
      if (error instanceof Problem && [400, 409].includes(error.status) && await this.isReplaced().catch(() => false)) {
        throw new Problem('The terrain was replaced', 'The service has another one under this name now; reload the page.', error.status);
      }
      if (this.mends(error, wanted, to)) return;
      if (error instanceof DecodeError) this.startAnew();
      await this.waitAfter(error);
    }
    if (verticesOf(to) > this.budget.most) this.makeRoom(to, wanted);
  }

  /** Whether the service has a terrain of other bounds or heights now. */
  private async isReplaced(): Promise<boolean> {
    const { bounds, heights } = await this.service.collection();
    return String([bounds, heights]) !== String([this.collection.bounds, this.collection.heights]);
  }

  /** A service that is busy is waited for as it asks; of one that cannot be reached people are told. */
  private async waitAfter(error: unknown): Promise<void> {
    const isBusy = error instanceof Problem && (error.status === 503 || error.status === 429);
    const wait = Math.min(longestWait, firstWait * 2 ** this.failures);
    this.waitsFor = isBusy ? 'the service is busy' : 'the service does not answer';
    if (!isBusy || this.failures > 3) this.events.failed(error);
    ++this.failures;
    this.events.grown();
    await new Promise<void>((resolve) => { setTimeout(resolve, isBusy ? Math.max(wait, 1000 * error.retryAfter) : wait); });
  }

  /** Makes less of what the service refused, so that the next attempt may succeed. */
  private mends(error: unknown, wanted: Wanted, to: Received): boolean {
    if (!(error instanceof Problem)) return false;
    if (error.status === 409) {
      this.startAnew();
    } else if (error.status === 503 && error.limit === 'computing') {
      this.lastTook = this.collection.limits?.computing ?? null;
      this.askForLess(wanted, to);
    } else if (error.status !== 413) {
      return false;
    } else if (error.limit === 'have' || error.limit === 'held_vertices') {
      this.makeRoom(to, wanted);
    } else if (error.limit === 'most_stream_bytes' && this.mostBytes > leastBytes) {
      this.mostBytes /= 2;
    } else {
      this.askForLess(wanted, to);
    }
    return true;
  }

  /**
   * The service has not the memory, or the time, for what was asked. Most of both goes into the mesh that is held already, so that
   * without what is not looked at any more there may be enough; from then on less is held. Else the part is wanted coarser.
   */
  private askForLess(wanted: Wanted, to: Received): void {
    this.isTooMuch = true;
    if (!this.isLean && to.decoder.hasMesh) {
      this.budget.lowerBelow(to.decoder.mesh.vertexCount);
      this.startAnew();
      return;
    }
    const coarser = { window: wanted.window, error: 2 * wanted.error };
    to.giveUp(wanted);
    if (!to.covers(coarser) && coarser.error < this.relief) this.wanted.push(coarser);
  }

  private async receive(to: Received, wanted: Wanted, mostBytes: number): Promise<void> {
    const response = await this.service.stream(to.asking(wanted, mostBytes));
    this.cost = costOf(response);
    this.lastTook = millisecondsOf(response);
    const before = to.bytes, held = verticesOf(to);
    let bytes = before;
    for await (const _ of to.take(wanted, response)) {
      // Frames come quicker than anybody looks.
      if (to.bytes === bytes) continue;
      this.bytes += to.bytes - bytes;
      ({ bytes } = to);
      if (to === this.shown) this.events.grown();
    }
    this.budget.note(verticesOf(to) - held, to.bytes - before);
  }
}

/** Vertices of a receiver. */
function verticesOf({ decoder }: Received): number {
  return decoder.hasMesh ? decoder.mesh.vertexCount : 0;
}

/** The largest share of a window that one of the others covers: those of a view lie in one another. */
function shareOf(window: Window, others: readonly Window[]): number {
  const area = ([west, south, east, north]: Window): number => Math.max(0, east - west) * Math.max(0, north - south);
  const common = (a: Window, b: Window): Window =>
    [Math.max(a[0], b[0]), Math.max(a[1], b[1]), Math.min(a[2], b[2]), Math.min(a[3], b[3])];
  return Math.max(0, ...others.map((other) => area(common(window, other)))) / area(window);
}
