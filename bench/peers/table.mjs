// SPDX-License-Identifier: GPL-3.0-or-later
//
// Prints the tables of bench/peers/run from the lines of JSON that it collected.  usage: node table.mjs FOLDER
import {existsSync, readFileSync} from 'node:fs';

const folder = process.argv[2];
const lines = name => existsSync(`${folder}/${name}`) ?
    readFileSync(`${folder}/${name}`, 'utf8').trim().split('\n').filter(Boolean).map(line => JSON.parse(line)) : [];
const median = values => values.sort((a, b) => a - b)[Math.floor(values.length / 2)];
const row = cells => console.log(`| ${cells.join(' | ')} |`);

function printCounts() {
    row(['grid', 'error', 'ptin vertices', 'Delatin vertices', 'ratio', 'ptin worst sample', 'Delatin reports', 'measured']);
    row(Array(8).fill('---'));
    const theirs = lines('delatin_counts');
    for (const ours of lines('ptin_counts')) {
        const their = theirs.find(t => t.grid === ours.grid && t.error === ours.error);
        row([ours.grid, ours.error, ours.vertices, their.vertices, (ours.vertices / their.vertices).toFixed(3),
            ours.worst.toFixed(3), their.reported.toFixed(3), their.measured.toFixed(3)]);
    }
}

function printTimes() {
    row(['grid', 'pixels', 'runs', 'ptin cpu s', 'Delatin cpu s', 'ratio cpu', 'ptin clock s', 'Delatin clock s', 'ratio clock',
        'hmm clock s', 'ptin pixels/s cpu']);
    row(Array(11).fill('---'));
    const of = (name, grid, key) => median(lines(name).filter(l => l.grid === grid).map(l => l[key]));
    for (const {grid, pixels} of lines('grids').filter(g => lines('ptin_times').some(l => l.grid === g.grid))) {
        const cpu = [of('ptin_times', grid, 'cpu'), of('delatin_times', grid, 'cpu')];
        const wall = [of('ptin_times', grid, 'wall'), of('delatin_times', grid, 'wall')];
        const hmm = of('hmm_times', grid, 'wall');
        row([grid, pixels, lines('ptin_times').filter(l => l.grid === grid).length, ...cpu.map(s => s.toFixed(2)),
            (cpu[0] / cpu[1]).toFixed(2), ...wall.map(s => s.toFixed(2)), (wall[0] / wall[1]).toFixed(2),
            hmm === undefined ? '-' : hmm.toFixed(2), Math.round(pixels / cpu[0])]);
    }
}

printCounts();
console.log();
printTimes();
