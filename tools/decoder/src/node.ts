// SPDX-License-Identifier: GPL-3.0-or-later
//
// The package for Node, whose fetch() reads no files.
/// <reference types="node" />
import { readFile } from 'node:fs/promises';
import { files } from './load.js';

files.read = async (url) => new Uint8Array(await readFile(url));

export * from './index.js';
