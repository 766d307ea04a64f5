// SPDX-License-Identifier: GPL-3.0-or-later
//
// Messages of the page and its Worker.
import type { BaseMap, Certified, Facts, LonLatNodes, MapPosition, Units, Wanted, Window } from 'ptin-decoder';
import type { Located, Profile, Sight, SightRequest } from './answers';
import type { DrawnMesh } from './drawn_mesh';
import type { Earth } from './earth';

/** Where the terrain comes from. */
export type Source =
  /** `name`: what to call it, where its address does not tell. */
  | { kind: 'stream'; url: string; name?: string }
  | { kind: 'collection'; service: string; id: string };

export type ToWorker =
  /** `folder`: the address below which the viewer's files lie. */
  | { kind: 'open'; source: Source; folder: string; mostVertices: number }
  /** The certified error at which to stop; 0: all there is. */
  | { kind: 'limit'; error: number }
  /** The parts that the camera looks at, the coarsest first. Static streams ignore it. */
  | { kind: 'view'; wanted: Wanted[] }
  | { kind: 'ask'; ticket: number; question: Question };

export type Question =
  | { kind: 'height'; at: MapPosition }
  /** `via`: corners of the line between its ends. `isLonLat`: degrees of WGS 84, whatever the terrain's CRS. */
  | { kind: 'profile'; from: MapPosition; to: MapPosition; via?: MapPosition[]; isLonLat?: boolean }
  /** A polygon, and the height from which volumes are told. */
  | { kind: 'area'; ring: MapPosition[]; against: number }
  | { kind: 'sight'; from: MapPosition; to: MapPosition; request: SightRequest }
  /** Heights above ground and the radius in metres. */
  | { kind: 'viewshed'; at: MapPosition; observerHeight: number; targetHeight: number; radius: number };

/** Volumes of a polygon as the service tells them, in its unit's cubes: what the TIN has, and what the source has at least and at most. */
export interface Volume {
  volume: number;
  low: number;
  high: number;
}

export interface Measured {
  /** In squares of `unit`: with a surface, and void. */
  surface: number;
  empty: number;
  /** Null where nobody can be asked. */
  cut: Volume | null;
  fill: Volume | null;
  unit: string;
}

export interface Viewshed {
  /** A picture of what is seen. */
  picture: Blob;
  window: Window;
}

/**
 * The certainty of heights of the mesh that is shown, or of the full terrain: as a Certificate, with null for what is not known.
 * `isExact`: they are the source's.
 */
export interface Certainty {
  error: number | null;
  deviation: number | null;
  of: 'mesh' | 'terrain';
  isExact: boolean;
}

export type QuestionOf<K extends Question['kind']> = Extract<Question, { kind: K }>;

/** The question, and what is answered. */
export type Answer =
  | QuestionOf<'height'> & { located: Located; certainty: Certainty; cost?: string }
  | QuestionOf<'profile'> & { profile: Profile; certainty: Certainty }
  | QuestionOf<'area'> & { measured: Measured; certainty: Certainty }
  | QuestionOf<'sight'> & { sight: Sight; profile: Profile; certainty: Certainty }
  | QuestionOf<'viewshed'> & { viewshed: Viewshed };

/** How far loading is. */
export interface Progress {
  /** Received, and to come as far as the host says; 0 when it does not. */
  bytes: number;
  bytesInAll: number;
  /** `held`: there is more, which the error, the number of vertices or the service keeps away. */
  state: 'loading' | 'complete' | 'held' | 'cut' | 'damaged';
  /** Why nothing comes at the moment, though more is asked for. */
  waitsFor?: string;
  /** Why it is held. */
  heldBy?: 'error' | 'vertices' | 'service';
  /** The cost of the last answer to the service. */
  cost?: string;
}

export interface Status extends Progress {
  vertices: number;
  triangles: number;
  splits: number;
  splitsInAll: number;
  /** The mesh is none of the terrain's but heights of some places, joined: nothing of it is certified. */
  isPreview?: boolean;
  /** The certificates of the mesh that was handed over last. */
  certified: Certified;
}

/** Facts that a terrain tells of itself; empty: nothing. */
export interface About {
  attribution: string;
  /** The name of the CRS of its positions. */
  crs: string;
  /** Null: not told. */
  lonLat: LonLatNodes | null;
  /** Null: none. */
  baseMap: BaseMap | null;
}

export type FromWorker =
  | { kind: 'terrain'; facts: Facts; units: Units; earth: Earth; name: string; about: About }
  | { kind: 'mesh'; mesh: DrawnMesh; status: Status }
  | { kind: 'status'; status: Status }
  | { kind: 'answer'; ticket: number; answer: Answer }
  | { kind: 'refused'; ticket: number; message: string }
  /** The trouble that was told before is over. */
  | { kind: 'mended' }
  /** The trouble, as a sentence. */
  | { kind: 'error'; title: string; message: string };

/** The things that boot left for the page's module, before which it runs. */
export interface Boot {
  source: Source | null;
  worker: Worker | null;
  early: FromWorker[];
  /** A first picture of the source lies in the page. */
  hasPicture?: boolean;
  /** The Worker, begun where it is not yet. */
  begin(): Worker;
  /** Has the Worker open a terrain. */
  open(source: Source): void;
  /** Says what went wrong. `aside`: there is a terrain, which stays in sight. */
  trouble(title: string, message: string, aside?: boolean): void;
}

declare global {
  interface Window {
    ptinBoot: Boot;
  }
}
