// SPDX-License-Identifier: GPL-3.0-or-later
//
// Takes comments and blanks out of the shaders in a bundle, which the bundler leaves as they are.
// usage: node shorter_shaders.mjs FILE
import { readFileSync, writeFileSync } from 'node:fs';

const isShader = (text) => /\b(uniform|void main|gl_Position)\b/.test(text);
const shorter = (text) => text.replace(/ *\/\/[^\n`]*/g, '').replace(/\n\s*/g, '\n')
  .replace(/ *([=+\-*/,;(){}<>?:|&]) */g, '$1').replace(/([;{},(])\n/g, '$1');

// "a - -b" would become another shader.
const checked = (text) => {
  if (/--|\+\+/.test(text)) throw new Error(`two signs of a shader meet without blanks; write brackets: ${/.*(--|\+\+).*/.exec(text)[0]}`);
  return text;
};

const [file] = process.argv.slice(2);
writeFileSync(file, readFileSync(file, 'utf8').replace(/`[^`]*`/g, (text) => (isShader(text) ? checked(shorter(text)) : text)));
