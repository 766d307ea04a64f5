// SPDX-License-Identifier: GPL-3.0-or-later
//
// A terrain that comes from a host, finer the longer it comes: from a file (file_view) or from a service (served_view).
import type { BaseMap, Certified, Decoder, LonLatNodes, Wanted } from 'ptin-decoder';
import type { Frame } from './frame';
import type { Answer, Progress, Question } from './messages';

export interface TerrainView {
  readonly name: string;
  /** The attribution; empty: nobody told. */
  readonly attribution: string;
  /** Null where places are told in the CRS alone. */
  readonly lonLat: LonLatNodes | null;
  /** That may be laid over the terrain; null: none. */
  readonly baseMap: BaseMap | null;
  /** The decoder whose mesh is shown. */
  readonly decoder: Decoder;
  /** The certificates of the mesh of `decoder`. */
  readonly certified: Certified;
  readonly progress: Progress;
  /** Receives for as long as the page is open. Throws where nothing more will come. */
  run(): Promise<void>;
  /** The certified error at which to stop; 0: all there is. */
  setLimit(error: number): void;
  /** The parts that the camera looks at, the coarsest first. */
  setView(wanted: Wanted[]): void;
  answer(question: Question, frame: Frame): Promise<Answer>;
}

export interface ViewEvents {
  /** There is more to see. */
  grown(): void;
  /** All that is wanted for now is there. */
  settled(): void;
  /** Something failed that may mend by itself. */
  failed(error: unknown): void;
  /** It did. */
  mended(): void;
}
