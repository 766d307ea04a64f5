// SPDX-License-Identifier: GPL-3.0-or-later
import type { IncomingMessage, ServerResponse } from 'node:http';
import type { Browser } from 'playwright-core';

export interface HostOptions {
  portions?: number;
  answer?: (request: IncomingMessage, response: ServerResponse, path: string) => boolean;
}
export function launched(): Promise<Browser>;
export function host(folder: string, options?: HostOptions): Promise<{ url: string; more(): void; close(): Promise<void> }>;
