// SPDX-License-Identifier: GPL-3.0-or-later
//
// Delatin (greedy insertion) over a raw float32 grid. Prints one line of JSON for each result.
//   node delatin.mjs counts GRID WIDTH HEIGHT ERROR...    one mesh, refined from the largest error to the smallest: the
//                                                         vertices at each, and the largest error at a pixel, measured
//                                                         here a second time from the triangles alone
//   node delatin.mjs time GRID WIDTH HEIGHT ERROR RUNS    a fresh mesh each run; seconds on the clock and of the processor
//                                                         (all threads, so with garbage collection), reading left out
import {readFileSync} from 'node:fs';
import Delatin from 'delatin';

const [mode, path, ...numbers] = process.argv.slice(2);
const [width, height, ...rest] = numbers.map(Number);
const bytes = readFileSync(path);
const grid = new Float32Array(bytes.buffer, bytes.byteOffset, bytes.byteLength / 4);
if (grid.length !== width * height) throw new Error(`${path}: ${grid.length} values, not ${width} x ${height}`);

// The largest vertical distance between a pixel and the triangle over it, in doubles.
function worstError(mesh) {
    let worst = 0;
    const {coords, triangles} = mesh;
    for (let t = 0; t < triangles.length; t += 3) {
        const [ax, ay, bx, by, cx, cy] = [0, 1, 2].flatMap(i => [coords[2 * triangles[t + i]], coords[2 * triangles[t + i] + 1]]);
        const area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax);
        const [za, zb, zc] = [grid[ay * width + ax], grid[by * width + bx], grid[cy * width + cx]];
        for (let y = Math.min(ay, by, cy); y <= Math.max(ay, by, cy); y++) {
            for (let x = Math.min(ax, bx, cx); x <= Math.max(ax, bx, cx); x++) {
                const b = ((x - ax) * (cy - ay) - (y - ay) * (cx - ax)) / area;
                const c = ((bx - ax) * (y - ay) - (by - ay) * (x - ax)) / area;
                if (b < 0 || c < 0 || b + c > 1) continue;
                worst = Math.max(worst, Math.abs(za + b * (zb - za) + c * (zc - za) - grid[y * width + x]));
            }
        }
    }
    return worst;
}

if (mode === 'counts') {
    const mesh = new Delatin(grid, width, height);
    for (const error of rest.sort((a, b) => b - a)) {
        mesh.run(error);
        console.log(JSON.stringify({error, vertices: mesh.coords.length / 2, triangles: mesh.triangles.length / 3,
            reported: mesh.getMaxError(), measured: worstError(mesh)}));
    }
} else {
    const [error, runs] = rest;
    for (let i = 0; i < runs; i++) {
        const cpu = process.cpuUsage();
        const begin = performance.now();
        const mesh = new Delatin(grid, width, height);
        mesh.run(error);
        const wall = (performance.now() - begin) / 1000;
        const used = process.cpuUsage(cpu);
        console.log(JSON.stringify({error, wall, cpu: (used.user + used.system) / 1e6, vertices: mesh.coords.length / 2}));
    }
}
