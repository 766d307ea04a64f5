// SPDX-License-Identifier: GPL-3.0-or-later
//
// The page: ties the Worker, the relief, the camera and the controls together. Nothing runs while nothing changes.
import type { BaseMap as ToldMap, Certificate, Problem } from 'ptin-decoder';
import { certifiedAt, certifiedWithin, holds } from 'ptin-decoder/values';
import type { BaseMap } from './base_map';
import { Compass } from './compass';
import { type DrawnMesh, drawnMesh, surfaceEnd } from './drawn_mesh';
import { scaleAt } from './earth';
import { type FirstMesh, firstMeshOf } from './first_mesh';
import { bytes, metres, roundBelow, rounded } from './format';
import { Frame } from './frame';
import { Gestures } from './gestures';
import { Inquiry } from './inquiry';
import { lineInFile } from './lines_in_file';
import type { Boot, FromWorker, Status, ToWorker } from './messages';
import { colour, part, speak, toast } from './page';
import { Overlay } from './overlay';
import { Panel } from './panel';
import { Peaks } from './peaks';
import { askedInHash, askedToHash, type Settings, fromHash, toHash } from './permalink';
import { savePicture } from './picture_export';
import { type Place, Relief } from './relief';
import { Service } from './service';
import { difference, lengthOf } from './space';
import { TileGrid } from './tile_grid';
import { usualExaggeration, View } from './view';

/** Vertices of a mesh whose heights are spread as the terrain's are. */
const enoughToTell = 200;
/** Pixels by which a picture of a service's terrain may be off. */
const tolerance = 0.6;

class Viewer {
  private readonly relief: Relief;
  private readonly view: View;
  private readonly panel: Panel;
  private readonly inquiry: Inquiry;
  private readonly overlay: Overlay;
  private readonly compass: Compass;
  private worker: Worker | null;
  /** For the Worker, until it is begun. */
  private readonly unsent: ToWorker[] = [];
  /** The vertices of the picture that lay in the page; a mesh that has come only so far is not shown. */
  private firstVertices = 0;
  private frame: Frame | null = null;
  /** The status, with what is certified of all that is in sight. */
  private status: (Status & { certificate: Certificate | null }) | null = null;
  private readonly isServed: boolean;
  private linkTimer = 0;
  private viewTimer = 0;
  private spokenState = '';
  /** A trouble is shown that may mend by itself. */
  private isTroubled = false;
  private placeTimer = 0;
  private mapTimer = 0;
  /** A base map that may be shown, and the one that is. */
  private offered: { told: ToldMap; grid: TileGrid } | null = null;
  private baseMap: BaseMap | null = null;
  private isMapped = false;
  /** With which the page was opened. */
  private readonly linkPose = fromHash(location.hash).pose;
  /** The question of the link, until it is asked: the address soon tells of the page as it is. */
  private linkAsked = askedInHash(location.hash);
  /** The Worker has opened the terrain. */
  private isOpen = false;
  /** The first sight is chosen. */
  private isSighted = false;

  constructor(private readonly boot: Boot) {
    const canvas = part<HTMLCanvasElement>('relief');
    this.worker = boot.worker;
    this.isServed = boot.source?.kind === 'collection';
    this.relief = new Relief(canvas);
    this.view = new View(this.relief.camera, this.relief);
    new Gestures(canvas, this.view);
    this.compass = new Compass(() => { this.view.turnNorth(); });
    this.panel = new Panel(fromHash(location.hash).settings, (key) => { this.apply(key); });
    this.inquiry = this.madeInquiry();
    this.overlay = this.madeOverlay();
    part('viewshed-tool').hidden = !this.isServed;
    for (const key of Object.keys(this.panel.settings) as Array<keyof Settings>) this.apply(key);
    this.relief.beforeDrawing = () => this.beforeDrawing();
    this.view.changed = () => { this.moved(); };
    this.followPage(canvas);
    this.followPointer(canvas);
    addEventListener('keydown', (event) => { this.key(event); });
    if (boot.hasPicture === true) this.showFirst();
    else this.listen();
  }

  private listen(): void {
    const { boot } = this;
    this.worker = boot.begin();
    this.worker.onmessage = (event: MessageEvent<FromWorker>) => { this.take(event.data); };
    for (const message of boot.early.splice(0)) this.take(message);
    for (const message of this.unsent.splice(0)) this.worker.postMessage(message);
  }

  /** Draws the picture that lies in the page; only then the Worker begins, so that what this needs comes first. */
  private showFirst(): void {
    let first: FirstMesh | null = null;
    try {
      first = firstMeshOf(part('first-mesh').textContent ?? '');
    } catch (error) {
      // The stream brings the same, later.
      console.warn(`the first picture: ${(error as Error).message}`);
    }
    if (first !== null) this.drawFirst(first);
    requestAnimationFrame(() => { setTimeout(() => {
      if (this.boot.source !== null) this.boot.open(this.boot.source);
      this.listen();
    }); });
  }

  private drawFirst({ isPreview, frame, mesh, certified }: FirstMesh): void {
    const { vertexCount: vertices, triangleCount: triangles } = mesh;
    this.frame = frame;
    this.relief.setFrame(frame);
    this.view.setFrame(frame);
    // Its unit and its relief; what it is called comes later.
    this.panel.setFrame(frame, document.title, part('subtitle').textContent ?? '', '');
    this.poseOfLink();
    this.take({
      kind: 'mesh', mesh: drawnMesh(mesh, frame),
      status: { vertices, triangles, isPreview, splits: 0, splitsInAll: 0, certified, bytes: 0, bytesInAll: 0, state: 'loading' },
    });
    this.firstVertices = vertices;
    this.moved();
  }

  private madeInquiry(): Inquiry {
    return new Inquiry({
      relief: this.relief, frame: () => this.frame, send: (m) => { this.send(m); }, project: ({ x, y, z }) => this.view.project(x, y, z),
      pan: (right, ahead) => { this.view.pan(right, ahead); this.moved(); }, zoom: (factor) => { this.view.zoom(factor); this.moved(); },
      changed: () => { this.keepLink(); },
    });
  }

  private madeOverlay(): Overlay {
    const { source } = this.boot;
    const service = source?.kind === 'collection' ? new Service(source.service, source.id) : null;
    return new Overlay({
      canvas: this.relief.canvas, frame: () => this.frame, project: ({ x, y, z }) => this.view.project(x, y, z),
      pick: (x, y) => this.relief.pick(x, y), depth: (place) => this.depth(place),
      window: () => this.view.wanted(this.relief.canvas.clientHeight, tolerance)[0]?.window ?? null,
      interval: () => this.panel.settings.interval,
    }, service === null ? null : new Peaks((window) => service.highest(window)));
  }

  private depth({ x, y, z }: Place): number {
    return lengthOf(difference(this.relief.camera.position, [x, y, z * this.view.exaggeration]));
  }

  private send(message: ToWorker): void {
    if (this.worker === null) this.unsent.push(message);
    else this.worker.postMessage(message);
  }

  private take(message: FromWorker): void {
    switch (message.kind) {
      case 'terrain': this.introduce(message); break;
      case 'mesh':
        if (this.keepsFirst(message.status)) break;
        this.firstVertices = 0;
        this.relief.setMesh(message.mesh);
        this.overlay.setMesh({ ...message.mesh, corners: message.mesh.corners.subarray(0, surfaceEnd(message.mesh.parts)) });
        this.panel.setColours(this.relief.colouredHeights);
        this.firstSight(message.mesh, message.status);
        if (this.status === null) requestAnimationFrame(() => { performance.mark('ptin-first-picture'); });
        this.show(message.status);
        break;
      case 'status': if (this.firstVertices === 0) this.show(message.status); break;
      case 'answer':
      case 'refused': this.inquiry.take(message); break;
      case 'mended':
        if (this.isTroubled) part('trouble').hidden = true;
        this.isTroubled = false;
        break;
      case 'error':
        this.boot.trouble(message.title, message.message, this.frame !== null);
        this.isTroubled = true;
        break;
    }
  }

  /** Whether the picture that lay in the page tells more than what came: a preview does until something is certified. */
  private keepsFirst({ vertices, state, certified }: Status): boolean {
    if (state !== 'loading') return false;
    return this.status?.isPreview === true ? !certified.some((part) => part.error < Infinity) : vertices < this.firstVertices;
  }

  private introduce(message: Extract<FromWorker, { kind: 'terrain' }>): void {
    const { facts, units, earth, about } = message;
    const frame = this.frame = new Frame(facts, units, earth, about.lonLat);
    this.relief.setFrame(frame);
    const size = earth.size === null ? 'size not known' : `${metres(earth.size[0])} \u00d7 ${metres(earth.size[1])}`;
    const unknown = units.height !== 'unknown' ? ''
      : ` \u00b7 unit of heights unknown, taken for ${earth.metresPerHeight === 1 ? 'metres' : 'that of the map'}`;
    part('scale').hidden = earth.lengths.metres === null;
    this.panel.setFrame(frame, message.name, `${size}${about.crs === '' ? '' : ` \u00b7 ${about.crs}`}${unknown}`, about.attribution);
    if (this.firstVertices > 0) {
      this.view.replaceFrame(frame);
    } else {
      this.view.setFrame(frame);
      this.poseOfLink();
    }
    if (about.baseMap !== null) this.offer(about.baseMap, frame);
    this.moved();
    this.isOpen = true;
    this.followLink();
  }

  private offer(told: ToldMap, frame: Frame): void {
    const grid = TileGrid.of(frame);
    this.offered = grid === null ? null : { told, grid };
    this.panel.offerMap(grid !== null ? ''
      : frame.lonLatAt({ x: frame.middleX, y: frame.middleY }) === null ? 'No map: nobody tells where on Earth this terrain is.'
      : 'No map: Web Mercator ends at 85 degrees of latitude.');
  }

  /** Shows the base map or takes it away; only while it is shown its host is asked. */
  private async showMap(isShown: boolean): Promise<void> {
    const { offered } = this;
    if (!isShown || offered === null) {
      this.baseMap?.close();
      if (this.isMapped) this.panel.showMap('', '');
      this.baseMap = null;
      this.isMapped = false;
      return;
    }
    if (this.isMapped) return;
    this.isMapped = true;
    const credit = offered.told.attribution || new URL(offered.told.tiles).host;
    const failed = (what: string): void => {
      this.panel.showMap(credit, what);
      toast(what);
    };
    this.panel.showMap(credit, '');
    try {
      const made = await import('./base_map');
      if (!this.isMapped || this.baseMap !== null) return;
      this.baseMap = new made.BaseMap(this.relief.gl, offered.grid, offered.told, { drawn: (drawn) => { this.relief.baseMap = drawn; }, failed });
      this.relief.draw();
    } catch {
      failed('base_map.js cannot be had');
    }
  }

  /** Some time after a picture: what tiles it lacks. */
  private followMap(): void {
    if (this.baseMap === null || this.mapTimer !== 0) return;
    this.mapTimer = window.setTimeout(() => {
      this.mapTimer = 0;
      const { relief, view, frame } = this;
      if (frame === null) return;
      const top = frame.relief * view.exaggeration, pixels = relief.canvas.clientHeight * Math.min(devicePixelRatio, 2);
      this.baseMap?.follow({
        mayMeet: (west, south, east, north) => relief.camera.mayMeet([west, south, 0], [east, north, top]),
        sharpness: (west, south, east, north) => {
          const [cameraX, cameraY] = relief.camera.position;
          const x = Math.max(west, Math.min(east, cameraX)), y = Math.max(south, Math.min(north, cameraY));
          return 1 / view.metresPerPixel(Math.max(view.leastDistance, this.depth({ x, y, z: relief.groundAt(x, y) ?? 0 })), pixels);
        },
      });
    }, 150);
  }

  private poseOfLink(): void {
    if (this.linkPose !== null) this.view.pose(this.linkPose);
  }

  /** Once enough is there to tell the relief: shows it high enough, and has it fill the picture, unless the link says otherwise. */
  private firstSight({ spread, extent }: DrawnMesh, { vertices, state }: Status): void {
    const { frame } = this;
    if (this.isSighted || frame === null || spread === null || (vertices < enoughToTell && state === 'loading')) return;
    this.isSighted = true;
    if (this.panel.settings.exaggeration === 0) this.panel.set('exaggeration', usualExaggeration(frame, spread));
    this.view.fillWith(extent, spread.low + 0.3 * (spread.high - spread.low));
    this.poseOfLink();
    this.moved();
    this.followLink();
  }

  /** Asks what the link asks, once the terrain can answer and the camera stands. */
  private followLink(): void {
    const { linkAsked } = this;
    if (linkAsked === null || !this.isSighted || !this.isOpen) return;
    this.linkAsked = null;
    this.inquiry.follow(linkAsked);
  }

  private show(status: Status): void {
    this.status = { ...status, certificate: this.inSight(status) };
    this.showCertificate();
    const what = part('certified-what').textContent ?? '';
    if (status.isPreview === true) {
      speak(what);
    } else if (status.state !== this.spokenState && status.state !== 'loading') {
      performance.mark('ptin-settled');
      speak(`${part('certified').textContent}, ${what}, ${bytes(status.bytes)} received`);
    }
    this.spokenState = status.state;
  }

  /** The certificate of all that is in sight; null where nothing is known. */
  private inSight({ certified }: Status): Certificate | null {
    const { frame } = this;
    return frame === null ? null : certifiedWithin(certified, frame.bounds, this.view.seenWindows(frame));
  }

  private showCertificate(): void {
    const { status, frame } = this;
    if (status === null || frame === null) return;
    const { certificate, certified } = status;
    const most = certificate?.error ?? -1;
    const isEverywhere = certified.some((part) => holds(part.window, frame.bounds) && part.error <= most);
    this.panel.showStatus(status, certificate, isEverywhere);
  }

  /** Carries a setting out. */
  private apply(key: keyof Settings): void {
    const s = this.panel.settings;
    if (key === 'shading') {
      this.relief.shading = s.shading;
      void this.showMap(s.shading === 'map');
    }
    if (key === 'azimuth' || key === 'altitude') this.relief.sun = s;
    if (key === 'interval') this.relief.isolines = s.interval;
    if (key === 'error') this.send({ kind: 'limit', error: s.error });
    if (key === 'wireframe') this.relief.wireframe = s.wireframe;
    if (key === 'exaggeration') this.relief.verticalScale = this.view.exaggeration = s.exaggeration || 1;
    this.keepLink();
  }

  private beforeDrawing(): boolean {
    const moves = this.view.update();
    const { distance, current } = this.view;
    this.relief.hazeFrom = 1.1 * distance;
    if (current !== null) this.compass.show(current.heading, current.tilt);
    this.showScale(distance);
    this.overlay.drawn();
    this.followMap();
    if (this.status !== null) {
      const before = this.status.certificate;
      const now = this.status.certificate = this.inSight(this.status);
      if (now?.error !== before?.error || now?.deviation !== before?.deviation) this.showCertificate();
    }
    return moves;
  }

  /** The camera moved. */
  private moved(): void {
    this.relief.moves();
    this.keepLink();
    if (!this.isServed) return;
    clearTimeout(this.viewTimer);
    this.viewTimer = window.setTimeout(() => {
      const wanted = this.view.wanted(this.relief.canvas.clientHeight, tolerance);
      this.send({ kind: 'view', wanted });
    }, 150);
  }

  private keepLink(): void {
    clearTimeout(this.linkTimer);
    this.linkTimer = window.setTimeout(() => {
      if (this.frame === null) return;
      history.replaceState(null, '', this.address);
    }, 250);
  }

  /** The address of what is shown. */
  private get address(): string {
    return `${location.pathname}${location.search}#${toHash(this.view.current, this.panel.settings)}${askedToHash(this.inquiry.link)}`;
  }

  /** How long a line across the picture is where the camera looks: over ground, which the picture stretches away from its middle. */
  private showScale(distance: number): void {
    const { frame, view } = this;
    if (frame === null || frame.earth.lengths.metres === null) return;
    const { canvas } = this.relief;
    const [x, y] = scaleAt(frame.earth, frame.mapY(view.lookedAt[1]));
    const [east, north] = view.across;
    const stretch = Math.hypot(east * x / frame.scaleX, north * y / frame.scaleY);
    const metre = 1 / (stretch * view.metresPerPixel(distance, canvas.clientHeight));
    const length = roundBelow(Math.min(130, canvas.clientWidth / 4) / metre);
    const scale = part('scale');
    scale.querySelector('i')!.style.width = `${length * metre}px`;
    scale.querySelector('span')!.textContent = length >= 1000 ? `${rounded(length / 1000, 1)} km` : `${rounded(length, 1)} m`;
  }

  private followPage(canvas: HTMLCanvasElement): void {
    const resize = (): void => { this.relief.resize(canvas.clientWidth, canvas.clientHeight); };
    new ResizeObserver(resize).observe(canvas);
    resize();
    const dark = matchMedia('(prefers-color-scheme: dark)');
    const recolour = (): void => { this.relief.setAir(colour('haze'), colour('sky-top'), colour('ground-low')); };
    dark.addEventListener('change', recolour);
    recolour();
    this.followCard(canvas);
    addEventListener('hashchange', () => {
      const { pose, settings } = fromHash(location.hash);
      const { panel } = this;
      // An exaggeration that no link names stays as it was found.
      for (const key of Object.keys(settings) as Array<keyof Settings>) {
        if (settings[key] !== panel.settings[key] && (key !== 'exaggeration' || settings[key] > 0)) panel.set(key, settings[key]);
      }
      if (pose !== null) this.view.pose(pose);
      this.moved();
    });
    part('home').addEventListener('click', () => { this.home(); });
    part('link').addEventListener('click', () => { void this.copyLink(); });
    part('picture').addEventListener('click', () => { this.savePicture(); });
    part<HTMLAnchorElement>('whole').addEventListener('focus', () => { this.linkWhole(); });
    part<HTMLAnchorElement>('whole').addEventListener('pointerenter', () => { this.linkWhole(); });
    this.linkWhole();
    addEventListener('dragover', (event) => { event.preventDefault(); });
    addEventListener('drop', (event) => {
      event.preventDefault();
      const file = event.dataTransfer?.files[0];
      if (file !== undefined) void this.profileOf(file);
    });
    part('help').addEventListener('click', () => { part<HTMLDialogElement>('keys').showModal(); });
    part('trouble-close').addEventListener('click', () => { part('trouble').hidden = true; });
  }

  /** A card may lose all that it has, and come back: after sleep, or when many pages want it. */
  private followCard(canvas: HTMLCanvasElement): void {
    canvas.addEventListener('webglcontextlost', (event) => {
      event.preventDefault();
      void this.showMap(false);
      this.boot.trouble('The picture is lost', 'The graphics card gave up on it. It comes back when the card does; otherwise reload the page.', true);
    });
    canvas.addEventListener('webglcontextrestored', () => {
      part('trouble').hidden = true;
      this.relief.restore();
      void this.showMap(this.panel.settings.shading === 'map');
    });
    const followPixels = (): void => {
      matchMedia(`(resolution: ${devicePixelRatio}dppx)`).addEventListener('change', () => {
        this.relief.draw();
        followPixels();
      }, { once: true });
    };
    followPixels();
  }

  private followPointer(canvas: HTMLCanvasElement): void {
    let pressed: { x: number; y: number } | null = null;
    canvas.addEventListener('pointerdown', (e) => {
      pressed = e.isPrimary && e.button === 0 ? { x: e.clientX, y: e.clientY } : null;
      canvas.classList.remove('ringed');
    });
    canvas.addEventListener('pointerup', (e) => {
      const isClick = pressed !== null && Math.hypot(e.clientX - pressed.x, e.clientY - pressed.y) < 5;
      pressed = null;
      part('crosshair').hidden = true;
      if (isClick) this.inquiry.click(this.relief.pick(e.clientX, e.clientY));
    });
    // A place is told where the pointer rests: numbers that run are not read.
    canvas.addEventListener('pointermove', (e) => {
      clearTimeout(this.placeTimer);
      part('crosshair').hidden = true;
      if (e.pointerType === 'touch' || e.buttons !== 0) return;
      this.placeTimer = window.setTimeout(() => { this.tellPlace(e.clientX, e.clientY); }, 160);
    });
    canvas.addEventListener('pointerleave', () => {
      clearTimeout(this.placeTimer);
      this.panel.showPlace(null);
    });
    // A ring shows whom the keys belong to, when one came here by them; shortcuts work without it.
    canvas.addEventListener('focus', () => { canvas.classList.toggle('ringed', canvas.matches(':focus-visible')); });
    canvas.addEventListener('blur', () => { canvas.classList.remove('ringed'); });
  }

  private tellPlace(x: number, y: number): void {
    if (this.frame === null || this.status === null) return;
    const { frame, status } = this;
    const place = this.relief.pick(x, y);
    if (place === null) {
      this.panel.showPlace({ where: '', height: null, slack: null });
      return;
    }
    const at = { x: frame.mapX(place.x), y: frame.mapY(place.y) };
    const certificate = certifiedAt(status.certified, [at]);
    this.panel.showPlace({
      where: frame.where(at), height: frame.heightAt(place.z), slack: certificate?.deviation ?? null,
    });
  }

  /** Puts the cross-hair of the keys into the middle, and tells what is there. */
  private aim(): void {
    part('crosshair').hidden = false;
    clearTimeout(this.placeTimer);
    const { clientWidth, clientHeight } = this.relief.canvas;
    this.placeTimer = window.setTimeout(() => { this.tellPlace(clientWidth / 2, clientHeight / 2); }, 160);
  }

  /** In a frame: the link to the same view with its card. */
  private linkWhole(): void {
    const query = new URLSearchParams(location.search);
    query.delete('embed');
    part<HTMLAnchorElement>('whole').href = `${location.pathname}?${query}${location.hash}`;
  }

  private savePicture(): void {
    const { canvas } = this.relief;
    this.relief.draw();
    const { labels } = this.overlay;
    requestAnimationFrame(() => {
      const scale = part('scale');
      savePicture(canvas, {
        title: part('title').textContent ?? '', attribution: part('attribution').textContent ?? '', labels,
        scale: scale.hidden ? null : { width: scale.querySelector('i')!.clientWidth, text: scale.querySelector('span')!.textContent ?? '' },
      });
    });
    toast('The picture is saved');
  }

  private async profileOf(file: File): Promise<void> {
    try {
      const { line, isLonLat } = lineInFile(file.name, await file.text());
      this.inquiry.profileAlong(line, isLonLat);
    } catch (error) {
      toast((error as Problem).message);
    }
  }

  private home(): void {
    this.view.flyHome();
  }

  private async copyLink(): Promise<void> {
    try {
      await navigator.clipboard.writeText(location.origin + this.address);
      toast('The link to this view is copied');
    } catch {
      toast('The browser does not let pages copy; the address line has the link');
    }
  }

  private key(event: KeyboardEvent): void {
    const target = event.target as HTMLElement;
    if (event.ctrlKey || event.metaKey || event.altKey || part<HTMLDialogElement>('keys').open) return;
    if (target.matches('input[type=number], input[type=text]') && event.key !== 'Escape') return;
    if (/^(Arrow|Page)/.test(event.key) && target.matches('input')) return;
    if (event.key === 'Enter' && target !== this.relief.canvas) return;
    const action = this.actions[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    if (action === undefined) return;
    event.preventDefault();
    action();
    if (/^(Arrow|Enter|Page|Back)|^[-+=,.]$/.test(event.key)) this.aim();
    if (!['?', 'Enter', 'Escape', 'Backspace'].includes(event.key)) this.moved();
  }

  private readonly actions: Record<string, () => void> = {
    ArrowLeft: () => { this.view.pan(-1, 0); },
    ArrowRight: () => { this.view.pan(1, 0); },
    ArrowUp: () => { this.view.pan(0, 1); },
    ArrowDown: () => { this.view.pan(0, -1); },
    '+': () => { this.view.zoom(0.8); },
    '=': () => { this.view.zoom(0.8); },
    '-': () => { this.view.zoom(1.25); },
    PageUp: () => { this.view.tilt(-5); },
    PageDown: () => { this.view.tilt(5); },
    ',': () => { this.view.turn(-10); },
    '.': () => { this.view.turn(10); },
    r: () => { this.home(); },
    n: () => { this.view.turnNorth(); },
    w: () => { this.panel.set('wireframe', !this.panel.settings.wireframe); },
    i: () => { this.panel.set('interval', this.panel.settings.interval > 0 ? 0 : this.panel.usualInterval); },
    1: () => { this.panel.set('shading', 'height'); },
    2: () => { this.panel.set('shading', 'slope'); },
    3: () => { this.panel.set('shading', 'shade'); },
    4: () => { if (this.offered !== null) this.panel.set('shading', 'map'); },
    h: () => { this.inquiry.choose('height'); },
    p: () => { this.inquiry.choose('profile'); },
    s: () => { this.inquiry.choose('sight'); },
    v: () => { if (this.isServed) this.inquiry.choose('viewshed'); },
    a: () => { this.inquiry.choose('area'); },
    e: () => { this.savePicture(); },
    Backspace: () => { this.inquiry.back(); },
    l: () => { void this.copyLink(); },
    '?': () => { part<HTMLDialogElement>('keys').showModal(); },
    Enter: () => {
      const { clientWidth, clientHeight } = this.relief.canvas;
      this.inquiry.click(this.relief.pick(clientWidth / 2, clientHeight / 2));
    },
    Escape: () => { this.inquiry.close(); },
  };
}

/** Where no terrain was named. */
function welcome(boot: Boot): void {
  const box = part('welcome');
  box.hidden = false;
  part('card').hidden = part('tools').hidden = true;
  const form = box.querySelector('form')!;
  form.addEventListener('submit', (event) => {
    event.preventDefault();
    const stream = String(new FormData(form).get('stream')).trim();
    if (stream !== '') location.search = `?${new URLSearchParams({ stream })}`;
  });
  let isOpen = false;
  const openFile = (file: File | undefined): void => {
    if (file === undefined || isOpen) return;
    isOpen = true;
    box.hidden = true;
    part('card').hidden = part('tools').hidden = false;
    boot.source = { kind: 'stream', url: URL.createObjectURL(file), name: file.name };
    boot.open(boot.source);
    start(boot);
  };
  box.querySelector<HTMLInputElement>('input[type=file]')!.addEventListener('change', (event) => {
    openFile((event.target as HTMLInputElement).files?.[0]);
  });
  addEventListener('dragover', (event) => { event.preventDefault(); });
  addEventListener('drop', (event) => {
    event.preventDefault();
    openFile(event.dataTransfer?.files[0]);
  });
}

function start(boot: Boot): void {
  try {
    (window as unknown as { ptinViewer: Viewer }).ptinViewer = new Viewer(boot);
  } catch (error) {
    boot.trouble('The picture cannot be drawn', `The viewer needs WebGL 2, which this browser does not give. (${(error as Error).message})`, false);
  }
}

if (new URLSearchParams(location.search).has('embed')) document.body.classList.add('embed');
const boot = window.ptinBoot;
if (location.protocol === 'file:') {
  // The page itself has told it (index.html).
} else if (boot.source === null) {
  welcome(boot);
} else {
  start(boot);
}
