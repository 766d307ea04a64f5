// SPDX-License-Identifier: GPL-3.0-or-later
//
// A terrain of `ptin serve`, refined where it is wanted.
import type { Certified } from './certified.js';
import type { Decoder } from './decoder.js';
import { Received, type Wanted } from './received.js';

export interface RefineOptions {
  /** Most bytes of one answer; the service has a limit of its own (most_stream_bytes). Default 262144. */
  mostBytes?: number;
  signal?: AbortSignal;
  /** Called whenever bytes came: the mesh may have changed. */
  grown?: (decoder: Decoder) => void;
}

/** The service refused: its status, its sentence, and the limit that a question went beyond. */
export class ServiceError extends Error {
  constructor(readonly status: number, message: string, readonly limit = '') {
    super(message);
    this.name = 'ServiceError';
  }
}

export class ServedTerrain {
  private readonly received: Received;

  /** @param address  Of the collection: http://host/collections/ID */
  constructor(module: WebAssembly.Module, private readonly address: string | URL) {
    this.received = new Received(module);
  }

  /** The mesh of all that came so far. */
  get decoder(): Decoder { return this.received.decoder; }
  /** What is certified where. */
  get certified(): Certified { return this.received.certified; }

  /**
   * Asks for what lacks of `wanted`, in as many answers as it takes; the same again asks for nothing.
   * @throws ServiceError  of 409: the file was replaced, begin with a new ServedTerrain; of 413: more than the service holds
   * @throws DecodeError   damage; begin anew
   */
  async refine(wanted: Wanted, { mostBytes = 262144, signal, grown }: RefineOptions = {}): Promise<void> {
    while (!this.received.covers(wanted)) {
      const splits = this.splitsServed;
      const response = await fetch(`${String(this.address).replace(/\/$/, '')}/stream`, {
        method: 'POST', headers: { 'Content-Type': 'application/json' }, signal,
        body: JSON.stringify(this.received.asking(wanted, mostBytes)),
      });
      if (!response.ok) throw await serviceErrorOf(response);
      await this.received.take(wanted, response, () => { grown?.(this.decoder); });
      if (!this.received.covers(wanted) && this.splitsServed === splits) {
        throw new ServiceError(response.status, 'the service sends no more, though not all of what is wanted has come');
      }
    }
  }

  private get splitsServed(): number {
    return this.received.have.reduce((sum, serving) => sum + serving.splits, 0);
  }
}

async function serviceErrorOf(response: Response): Promise<ServiceError> {
  const told = await response.json().catch(() => null) as { detail?: string; limit?: string } | null;
  return new ServiceError(response.status, told?.detail ?? `the service answered ${response.status}`, told?.limit);
}
