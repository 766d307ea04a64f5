// SPDX-License-Identifier: GPL-3.0-or-later
//
// Holds records that were read of LAZ files against what two decoders by others read: laz-perf, and laz-rs as @loaders.gl/las
// has it.
// usage: node oracles.mjs FILE.laz...    FILE.laz.bin holds the first 20 bytes of each record
// Exit status 1 and a line a file and decoder where something differs.
import fs from 'node:fs';
import {createLazPerf} from 'laz-perf';
import init, {WasmLasZipDecompressor} from './node_modules/@loaders.gl/las/dist/libs/laz-rs-wasm/laz_rs_wasm.js';

const kRecordBytes = 20;
const wasm = 'node_modules/@loaders.gl/las/dist/libs/laz-rs-wasm/laz_rs_wasm_bg.wasm';
await init({module_or_path: fs.readFileSync(new URL(wasm, import.meta.url))});
const perf = await createLazPerf();

/** All records of `laz`, of `step` bytes each, one after the other. */
function byLazPerf(laz, count, step) {
  const from = perf._malloc(laz.length);
  perf.HEAPU8.set(laz, from);
  const reader = new perf.LASZip();
  reader.open(from, laz.length);
  const record = perf._malloc(step);
  const all = Buffer.alloc(count * step);
  for (let i = 0; i < count; ++i) {
    reader.getPoint(record);
    all.set(perf.HEAPU8.subarray(record, record + step), i * step);
  }
  reader.delete();
  perf._free(from);
  perf._free(record);
  return all;
}

function byLazRs(laz, count, step) {
  const all = new Uint8Array(count * step);
  new WasmLasZipDecompressor(new Uint8Array(laz)).decompress_many(all);
  return Buffer.from(all.buffer);
}

/** The number of the first record that differs, or -1. Of formats 6 to 10 intensity is not read. */
function firstDifference(all, ours, format, step) {
  const parts = format < 6 ? [[0, 20]] : [[0, 12], [14, 17]];
  for (let i = 0; i * kRecordBytes < ours.length; ++i) {
    for (const [begin, end] of parts) {
      const at = i * kRecordBytes;
      if (all.compare(ours, at + begin, at + end, i * step + begin, i * step + end) !== 0) return i;
    }
  }
  return -1;
}

let differs = false;
for (const file of process.argv.slice(2)) {
  const laz = fs.readFileSync(file), ours = fs.readFileSync(`${file}.bin`);
  const format = laz[104] & 0x7f, step = laz.readUInt16LE(105);
  const count = ours.length / kRecordBytes;
  // laz-rs does not read chunks of varying sizes this way.
  const decoders = {'laz-perf': byLazPerf, ...(file.includes('varies') ? {} : {'laz-rs': byLazRs})};
  for (const [name, decode] of Object.entries(decoders)) {
    const first = firstDifference(decode(laz, count, step), ours, format, step);
    if (first >= 0) {
      console.log(`${file}: ${name} reads another record ${first}`);
      differs = true;
    }
  }
}
process.exit(differs ? 1 : 0);
