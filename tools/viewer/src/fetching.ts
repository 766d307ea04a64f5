// SPDX-License-Identifier: GPL-3.0-or-later
//
// Parts of the viewer that come when they are needed.
import { Problem } from 'ptin-decoder/values';

/** A module of the viewer, which lies beside the page. */
export async function moduleAt(folder: string, name: string): Promise<WebAssembly.Module> {
  const fetched = await fetch(new URL(name, folder)).catch(() => null);
  if (fetched === null) {
    throw new Problem('The viewer cannot be reached', `A part of it (${name}) did not come: the connection to the host broke, or there is none.`);
  }
  if (!fetched.ok) throw new Problem('The viewer is not whole', `A part of it (${name}) does not lie beside it.`);
  return WebAssembly.compile(await fetched.arrayBuffer());
}
