// SPDX-License-Identifier: GPL-3.0-or-later
//
// <ptin-terrain>: a terrain in any page, from this one file. It is the viewer in a frame, without its card.
//   <script src="https://host/viewer/ptin-terrain.js"></script>
//   <ptin-terrain src="https://host/collections/ID"></ptin-terrain>
// `src`: a terrain of a service, or a stream. `view`: what stands behind # in a link. `viewer`: the folder of index.html, where it is
// not that of this file.

/** The viewer's address for what the attributes say. */
export function addressOf(src: string, view: string, viewer: string, page: string): string {
  const url = new URL(src, page);
  const served = /^(.*)\/collections\/([^/]+)\/?$/.exec(url.href.split(/[?#]/)[0]);
  const query: Record<string, string> = served === null ? { stream: url.href } : { service: served[1], collection: decodeURIComponent(served[2]) };
  return `${new URL('index.html', viewer).href}?${new URLSearchParams({ ...query, embed: '1' })}${view === '' ? '' : `#${view.replace(/^#/, '')}`}`;
}

if (typeof HTMLElement !== 'undefined') {
  // A script of no module: one may be had from a host that says nothing of other origins. As a module it is found by its name.
  const script = document.currentScript ?? document.querySelector('script[src*="ptin-terrain"]');
  const here = (script as HTMLScriptElement | null)?.src ?? document.baseURI;
  customElements.define('ptin-terrain', class extends HTMLElement {
    static readonly observedAttributes = ['src', 'view', 'viewer'];
    private readonly shown = document.createElement('iframe');

    connectedCallback(): void {
      if (this.shown.parentNode !== null) return;
      const root = this.attachShadow({ mode: 'open' });
      const style = new CSSStyleSheet();
      style.replaceSync(':host { display: block; height: 24rem; } iframe { width: 100%; height: 100%; border: 0; display: block; }');
      root.adoptedStyleSheets = [style];
      this.shown.title = this.getAttribute('title') ?? 'Terrain';
      this.shown.allow = 'fullscreen; clipboard-write';
      root.append(this.shown);
      this.attributeChangedCallback();
    }

    attributeChangedCallback(): void {
      const src = this.getAttribute('src');
      if (src === null || !this.isConnected) return;
      const viewer = new URL(`${this.getAttribute('viewer') ?? '.'}/`, this.hasAttribute('viewer') ? document.baseURI : here);
      this.shown.src = addressOf(src, this.getAttribute('view') ?? '', viewer.href, document.baseURI);
    }
  });
}
