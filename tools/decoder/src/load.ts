// SPDX-License-Identifier: GPL-3.0-or-later

/**
 * The engine's stream reader, compiled; to be kept and shared by all decoders, also with Workers.
 *
 * @param from  Its bytes, or the answer or address that has them. Without one, the file beside this one: read in Node, fetched by
 *              pages, where bundlers copy it (`new URL('decoder.wasm', import.meta.url)`).
 * @throws TypeError               it could not be fetched
 * @throws WebAssembly.CompileError  it is something else
 */
export async function loadDecoder(from?: string | URL | Response | BufferSource): Promise<WebAssembly.Module> {
  const source = from ?? new URL('decoder.wasm', import.meta.url);
  if (source instanceof ArrayBuffer || ArrayBuffer.isView(source)) return WebAssembly.compile(source);
  if (source instanceof URL && source.protocol === 'file:') {
    // Bundlers for pages leave out what they do not know by name.
    const files = 'node:fs/promises';
    const { readFile } = await import(/* @vite-ignore */ files) as { readFile(url: URL): Promise<Uint8Array<ArrayBuffer>> };
    return WebAssembly.compile(await readFile(source));
  }
  const response = source instanceof Response ? source : await fetch(source);
  if (!response.ok) throw new TypeError(`${response.url || 'the host of the decoder'} answered ${response.status}`);
  return WebAssembly.compile(await response.arrayBuffer());
}
