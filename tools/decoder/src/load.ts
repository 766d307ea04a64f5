// SPDX-License-Identifier: GPL-3.0-or-later
//
// The engine's stream reader in WebAssembly, which lies beside this file.
import { Problem } from './requests.js';

type Bytes = ArrayBuffer | ArrayBufferView;
/** Bytes, the answer that has them, or their address. */
type Uncompiled = Bytes | Response | URL | string;
/** The module, compiled or not, or its address. */
export type ModuleSource = WebAssembly.Module | Uncompiled;

/** How files are read where fetch() reads none: node.ts. */
export const files: { read: ((url: URL) => Promise<Bytes>) | null } = { read: null };

let own: Promise<WebAssembly.Module> | null = null;

/**
 * The module, compiled; without a source the package's own, once. It may be shared by all decoders, also with Workers. Bundlers that
 * do not follow `new URL('./decoder.wasm', import.meta.url)` leave it behind: copy it beside the bundle, or say here where it is.
 * Throws Problem where it cannot be had.
 */
export function loadModule(source?: ModuleSource): Promise<WebAssembly.Module> {
  if (source !== undefined) return compiled(source);
  own ??= compiled(new URL('./decoder.wasm', import.meta.url)).catch((error: unknown) => {
    own = null;
    throw error;
  });
  return own;
}

async function compiled(source: ModuleSource): Promise<WebAssembly.Module> {
  if (source instanceof WebAssembly.Module) return source;
  const [bytes, place] = await bytesOf(source as Uncompiled);
  // Hosts of single pages answer with the page where there is no such file.
  if (!isModule(bytes)) {
    throw new Problem('The decoder is something else', `${place} is no WebAssembly. Give the place of decoder.wasm as { wasm: url }.`);
  }
  return WebAssembly.compile(bytes as BufferSource).catch((error: unknown) => {
    const policy = "Where a page has a Content-Security-Policy, it needs script-src 'wasm-unsafe-eval'.";
    throw new Problem('The decoder cannot be compiled', `${String(error)} ${policy}`);
  });
}

function isModule(bytes: Bytes): boolean {
  const view = ArrayBuffer.isView(bytes) ? new Uint8Array(bytes.buffer, bytes.byteOffset, bytes.byteLength) : new Uint8Array(bytes);
  return String.fromCharCode(...view.subarray(0, 4)) === '\0asm';
}

async function bytesOf(source: Uncompiled): Promise<[bytes: Bytes, place: string]> {
  if (source instanceof ArrayBuffer || ArrayBuffer.isView(source)) return [source, 'What was given'];
  const address = String(source);
  if (files.read !== null && address.startsWith('file:')) return [await files.read(new URL(address)), address];
  const response = source instanceof Response ? source : await fetch(source).catch(() => null);
  const place = response?.url || address;
  if (response === null || !response.ok) {
    throw new Problem(
      'The decoder cannot be reached', `There is no decoder.wasm at ${place}. Give its place as { wasm: url }.`, response?.status ?? 0);
  }
  return [await response.arrayBuffer(), place];
}
