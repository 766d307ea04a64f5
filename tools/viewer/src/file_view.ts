// SPDX-License-Identifier: GPL-3.0-or-later
//
// A terrain whose stream comes from a file: all of it, as far as the error and the number of vertices go. Questions are answered
// from the mesh that is there, within its certificate: all numbers are the engine's.
import {
  type BaseMap, type Certified, certifiedAt, certifiedOf, type Decoder, type HostedBytes, type MapPosition, Problem, type Told, toldBy, type Wanted,
} from 'ptin-decoder';
import { moduleAt } from './fetching';
import type { Frame } from './frame';
import type { Answer, Certainty, Progress, Question } from './messages';
import { measuredInPlan } from './plan';
import { type Asked, Questions } from './questions';
import { cornersOf, joined } from './stations';
import { StaticStream } from './static_stream';
import type { TerrainView, ViewEvents } from './terrain_view';

export class FileView implements TerrainView {
  /** The stream itself tells whom to name. */
  readonly attribution = '';
  readonly lonLat = null;
  private readonly still: StaticStream;
  private bytesInAll = 0;
  /** Nothing more comes. */
  private arrived = false;
  /** All that arrived is applied, too. */
  private isSettled = false;
  private hasFailed = false;
  private wake: (() => void) | null = null;
  private metadata: Told | null = null;
  private questions: Promise<Questions> | null = null;

  /** @param folder  The address below which the viewer's files lie. */
  constructor(
    readonly name: string, private readonly opening: Promise<HostedBytes>, module: WebAssembly.Module,
    private readonly folder: string, mostVertices: number, private readonly events: ViewEvents,
  ) {
    this.still = new StaticStream(module, { error: 0, mostVertices });
  }

  get baseMap(): BaseMap | null { return this.told.baseMap; }

  get decoder(): Decoder { return this.still.decoder; }

  get certified(): Certified { return certifiedOf(this.decoder, this.told.request); }

  get progress(): Progress {
    const { heldBy } = this.still;
    return {
      bytes: this.still.kept.bytes, bytesInAll: this.bytesInAll, heldBy: heldBy ?? undefined,
      state: this.hasFailed ? 'damaged' : this.decoder.isComplete ? 'complete'
        : heldBy !== null ? 'held' : this.isSettled ? 'cut' : 'loading',
    };
  }

  async run(): Promise<void> {
    const host = await this.opening;
    this.bytesInAll = host.bytesInAll;
    void this.receive(host);
    await this.follow();
  }

  setLimit(error: number): void {
    if (!this.hasFailed) this.still.setError(error);
    this.wake?.();
  }

  /** A file has one stream, wherever the camera looks. */
  setView(_wanted: Wanted[]): void {}

  async answer(question: Question, frame: Frame): Promise<Answer> {
    if (question.kind === 'area') return measuredInPlan(question, frame);
    if (question.kind === 'viewshed') {
      throw new Problem('Nobody can be asked', 'A viewshed needs a service; this terrain comes from a file.');
    }
    const questions = await this.fetchQuestions();
    // The mesh may have grown while the module came: the question is of the mesh of now.
    const corners = question.kind === 'height' ? [question.at] : cornersOf(question);
    const { certainty, ...asked } = this.askedAt(corners);
    if (question.kind === 'height') return { ...question, located: questions.locate(asked, question.at), certainty };
    if (asked.ground === null && frame.isDegrees) {
      throw new Problem('No lengths', 'Lengths are not known: this stream was written by a program that did not tell its ellipsoid.');
    }
    const { from, to } = question;
    if (question.kind === 'profile' && question.isLonLat === true && !frame.isDegrees) {
      throw new Problem('No degrees', 'This terrain has no degrees, and without a service nobody turns them into its map units.');
    }
    const profile = { ...joined(corners.slice(1).map((b, i) => questions.profile(asked, corners[i], b))), lengths: frame.earth.lengths };
    if (question.kind === 'profile') return { ...question, profile, certainty };
    const { observerHeight, targetHeight, frequency } = question.request;
    const sight = questions.sight(asked, from, observerHeight / frame.scaleZ, to, targetHeight / frame.scaleZ, frequency);
    return { ...question, sight, profile, certainty };
  }

  /** Facts that the metadata tell, once they are there. */
  private get told(): Told {
    return this.metadata ??= toldBy(this.decoder.metadata);
  }

  /** Reads what the host sends, unless what is there is enough: then it waits, and so does the host. */
  private async receive(host: HostedBytes): Promise<void> {
    try {
      for (;;) {
        while (this.still.heldBy !== null && !this.hasFailed) {
          await new Promise<void>((resolve) => { setTimeout(resolve, 100); });
        }
        const value = await host.next();
        if (value === null || this.hasFailed) break;
        this.still.kept.add(value);
        this.wake?.();
      }
    } catch (error) {
      // The part that came stays.
      this.events.failed(error);
    }
    this.arrived = true;
    this.wake?.();
    host.rest();
  }

  /** Applies what arrives. */
  private async follow(): Promise<void> {
    for (;;) {
      let more = false;
      try {
        more = this.still.apply(40);
      } catch (error) {
        // The part that came whole before the damage is shown, though the damage was met before anything was.
        this.hasFailed = true;
        this.events.settled();
        throw error;
      }
      this.isSettled = this.arrived && !more;
      if (this.isSettled || (!more && this.still.heldBy !== null)) this.events.settled();
      else this.events.grown();
      if (this.isSettled && !this.decoder.hasMesh) {
        throw new Problem('The stream ends too early', 'Its first part, without which nothing can be shown, is not whole.');
      }
      // Messages of the page come in between two pieces of work.
      await new Promise<void>((resolve) => {
        if (more) setTimeout(resolve, 0);
        else this.wake = resolve;
      });
      this.wake = null;
    }
  }

  /** The module of questions, which comes when something is asked; one that could not be had is asked for again. */
  private fetchQuestions(): Promise<Questions> {
    const coming = this.questions ??= moduleAt(this.folder, 'questions.wasm').then((module) => new Questions(module));
    coming.catch(() => { this.questions = null; });
    return coming;
  }

  /** A question at places of the mesh that is there. */
  private askedAt(places: readonly MapPosition[]): Asked & { certainty: Certainty } {
    const { decoder } = this;
    const { ground, freeOfVoids, request: { error, window, levels, splits } } = this.told;
    const isAll = error === undefined && window === undefined && levels === undefined && splits === undefined;
    const certificate = certifiedAt(this.certified, places);
    const { error: most, deviation } = certificate ?? { error: null, deviation: null };
    return {
      decoder, ground, freeOfVoids, isWhole: isAll && decoder.isComplete, certificate,
      certainty: { error: most, deviation, of: 'mesh', isExact: deviation === 0 },
    };
  }
}
