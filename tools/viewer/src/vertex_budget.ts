// SPDX-License-Identifier: GPL-3.0-or-later
//
// How many vertices a view of a service may hold: as many as are drawn in time, and as many as the service can go on from.

/** The share of the vertices that the service goes on from which are held: what the next answer brings takes memory, too. */
const shareOfHeld = 0.9;
/** A frame has an eighth of the mesh's vertices, and one is always sent: beyond this share the next one would not fit. */
const shareOfFull = 8 / 9;
/** Splits of the next answer take at least so much of those of the last one: the finer the mesh, the fewer bytes. */
const shareOfBytes = 0.8;
/** The beginning of an answer weighs too much where it brings fewer splits. */
const leastSplits = 1000;
/** A mesh that the service refused was too large by no more than an answer, which is a fifth where it is largest. */
const shareAfterRefusal = 0.8;
/** The growth that is tried at each view after a refusal: a service that was busy may be so no more. */
const growthAfterRefusal = 1.1;

export class VertexBudget {
  private readonly told: number;
  private served: number;
  /** Bytes of a split of the last answer; none is smaller where nothing came. */
  private bytesOfSplit = 1;

  /** @param drawn   Vertices that the picture takes.  @param held  Those that the service goes on from, as it tells. */
  constructor(private readonly drawn: number, held: number) {
    this.served = this.told = shareOfHeld * held;
  }

  get most(): number { return Math.min(this.drawn, this.served); }
  /** Who does not take more. */
  get heldBy(): 'service' | 'vertices' { return this.served < this.drawn ? 'service' : 'vertices'; }

  isFull(vertices: number): boolean { return vertices > shareOfFull * this.most; }

  /** An answer brought so many in so many bytes. */
  note(splits: number, bytes: number): void {
    if (splits >= leastSplits) this.bytesOfSplit = bytes / splits;
  }

  /** Bytes of an answer that should stay within it, of at most so many. */
  bytesBeside(vertices: number, mostBytes: number): number {
    return Math.max(1, Math.min(mostBytes, Math.floor((this.most - vertices) * shareOfBytes * this.bytesOfSplit)));
  }

  /** The service had not the memory, or the time, to go on from so many. */
  lowerBelow(vertices: number): void {
    this.served = Math.min(this.served, shareAfterRefusal * vertices);
  }

  recover(): void {
    this.served = Math.min(this.told, growthAfterRefusal * this.served);
  }
}
