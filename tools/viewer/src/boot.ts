// SPDX-License-Identifier: GPL-3.0-or-later
//
// The script before the page's module: finds out what to open, has the Worker ask for it while the module still comes, and says what
// goes wrong without the module. Where a first picture lies in the page, the module comes first and begins the Worker.
import type { Boot, Source } from './messages';

const query = new URLSearchParams(location.search);

/** The source that the address names, or the page itself. */
function sourceOf(): Source | null {
  const collection = query.get('collection');
  const stream = query.get('stream') || document.querySelector<HTMLMetaElement>('meta[name=ptin-stream]')!.content;
  if (collection) return { kind: 'collection', service: query.get('service') || location.origin, id: collection };
  return stream ? { kind: 'stream', url: new URL(stream, location.href).href } : null;
}

/** Says what went wrong. `aside`: there is a terrain, which stays in sight. */
function trouble(title: string, message: string, aside = false): void {
  const say = (): void => {
    const box = document.getElementById('trouble')!;
    box.querySelector('h2')!.textContent = title;
    box.querySelector('p')!.textContent = message;
    box.classList.toggle('aside', aside);
    box.hidden = false;
    document.getElementById('progress')!.classList.add('done');
    if (!aside) document.getElementById('subtitle')!.textContent = 'Nothing is shown';
  };
  if (document.readyState === 'loading') document.addEventListener('DOMContentLoaded', say);
  else say();
}

/** The trouble where a script cannot be run. */
const missing = 'or shared.js does not lie beside the page, or this browser is too old for them.';

function begun(boot: Boot): Worker {
  const worker = new Worker('worker.js', { type: 'module' });
  worker.onmessage = (event) => { boot.early.push(event.data); };
  worker.onerror = () => {
    boot.early.push({ kind: 'error', title: 'The viewer is not whole', message: `worker.js ${missing}` });
  };
  return worker;
}

function start(): void {
  const boot: Boot = {
    source: sourceOf(), early: [], trouble, worker: null,
    begin: () => boot.worker ??= begun(boot),
    open: (source) => {
      const isSmall = matchMedia('(max-width: 700px), (pointer: coarse)').matches;
      const mostVertices = Number(query.get('vertices')) || (isSmall ? 400000 : 2500000);
      boot.begin().postMessage({ kind: 'open', source, folder: new URL('.', location.href).href, mostVertices });
    },
  };
  window.ptinBoot = boot;
  if (location.protocol === 'file:') {
    trouble('The page needs a web server', 'Browsers do not let a page in a folder read the files beside it. In that folder: ' +
      'python3 -m http.server, then open http://localhost:8000.');
    return;
  }
  const noModule = (): void => {
    trouble('The viewer is not whole', `viewer.js ${missing}`);
  };
  document.getElementById('module')!.addEventListener('error', noModule);
  if (!('noModule' in HTMLScriptElement.prototype)) noModule();
  // A first picture is drawn only by a page that opens what it was made for.
  boot.hasPicture = document.getElementById('first-mesh') !== null && query.get('stream') === null;
  if (boot.source !== null && !boot.hasPicture) boot.open(boot.source);
}

start();
