// SPDX-License-Identifier: GPL-3.0-or-later
//
// The page: ties the Worker, the relief, the camera and the controls together. Nothing runs while nothing changes.
import type { Certificate, Problem } from 'ptin-decoder';
import { certifiedWithin, holds } from 'ptin-decoder/values';
import { Compass } from './compass';
import { type DrawnMesh, drawnMesh, surfaceEnd } from './drawn_mesh';
import { scaleAt } from './earth';
import { type FirstMesh, firstMeshOf } from './first_mesh';
import { bytes, metres, roundBelow, rounded } from './format';
import { Frame } from './frame';
import { Gestures } from './gestures';
import { Inquiry } from './inquiry';
import { followKeys } from './keys';
import { lineInFile } from './lines_in_file';
import type { Boot, FromWorker, Status, ToWorker } from './messages';
import { colour, part, speak, toast } from './page';
import { OfferedMap } from './offered_map';
import { Overlay } from './overlay';
import { Panel } from './panel';
import { Peaks } from './peaks';
import { askedInHash, askedToHash, type Settings, fromHash, toHash } from './permalink';
import { savePicture } from './picture_export';
import { Pointing } from './pointing';
import { Relief } from './relief';
import { Service } from './service';
import { usualExaggeration, View } from './view';
import { welcome } from './welcome';

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
  private pointing: Pointing | null = null;
  private readonly baseMap: OfferedMap;
  private worker: Worker | null;
  /** For the Worker, until it is begun. */
  private readonly unsent: ToWorker[] = [];
  /** The vertices of the picture that lay in the page; a mesh that has come only so far is not shown. */
  private firstVertices = 0;
  private frame: Frame | null = null;
  /** The status, with what is certified of all that is in sight. */
  private status: (Status & { certificate: Certificate | null }) | null = null;
  private readonly isServed: boolean;
  /** Null where the terrain is a stream alone. */
  private readonly service: Service | null;
  private linkTimer = 0;
  private viewTimer = 0;
  /** The view that was asked for last counts how far the ground may be off. */
  private isSlackWanted = false;
  private isViewAsked = false;
  private spokenState = '';
  /** A trouble is shown that may mend by itself. */
  private isTroubled = false;
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
    const { source } = boot;
    this.service = source?.kind === 'collection' ? new Service(source.service, source.id) : null;
    this.isServed = this.service !== null;
    this.relief = new Relief(canvas);
    this.view = new View(this.relief.camera, this.relief);
    const isFramed = document.body.classList.contains('embed') && parent !== window;
    new Gestures(canvas, this.view, { isFramed, passedOn: () => { toast('Ctrl or ⌘ and the wheel come nearer'); } });
    this.compass = new Compass(() => { this.view.turnNorth(); });
    this.panel = new Panel(fromHash(location.hash).settings, (key) => { this.apply(key); });
    this.baseMap = new OfferedMap(this.relief, this.view, this.panel);
    this.inquiry = this.madeInquiry();
    this.overlay = this.madeOverlay();
    part('viewshed-tool').hidden = !this.isServed;
    for (const key of Object.keys(this.panel.settings) as Array<keyof Settings>) this.apply(key);
    this.relief.beforeDrawing = () => this.beforeDrawing();
    this.view.changed = () => { this.moved(); };
    this.followPage(canvas);
    this.followKeys(canvas);
    if (boot.hasPicture === true) this.showFirst();
    else this.listen();
  }

  private followKeys(canvas: HTMLCanvasElement): void {
    const { relief, view, panel, inquiry, isServed } = this;
    const pointing = new Pointing(relief, panel, inquiry, () => {
      const { frame, status } = this;
      return frame === null || status === null ? null : { frame, certified: status.certified };
    }, this.service);
    this.pointing = pointing;
    followKeys({
      canvas, view, panel, inquiry, pointing, isServed, isMapThere: () => this.baseMap.isThere,
      savePicture: () => { this.savePicture(); }, copyLink: () => { void this.copyLink(); }, moved: () => { this.moved(); },
    });
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
    const { service } = this;
    return new Overlay({
      canvas: this.relief.canvas, frame: () => this.frame, project: ({ x, y, z }) => this.view.project(x, y, z),
      pick: (x, y) => this.relief.pick(x, y), distance: (place) => this.view.distanceTo(place),
      // Far squares are large, so that what is within a quarter of the way would have few peaks.
      windows: () => this.view.wanted(this.relief.canvas.clientHeight, tolerance).filter((_, i) => i % 2 === 0 && i < 4).map((w) => w.window),
      interval: () => this.panel.settings.interval,
    }, service === null ? null : new Peaks((window) => service.highest(window)));
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
        this.panel.setColours(this.relief.colours);
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
    if (about.baseMap !== null) this.baseMap.offer(about.baseMap, frame);
    this.moved();
    this.isOpen = true;
    this.followLink();
  }

  private poseOfLink(): void {
    if (this.linkPose !== null) this.view.pose(this.linkPose);
  }

  /** Once enough is there to tell the relief: shows it high enough, and has it fill the picture, unless the link says otherwise. */
  private firstSight({ spread, extent, summit }: DrawnMesh, { vertices, state }: Status): void {
    const { frame } = this;
    if (this.isSighted || frame === null || spread === null || (vertices < enoughToTell && state === 'loading')) return;
    this.isSighted = true;
    if (this.panel.settings.exaggeration === 0) this.panel.set('exaggeration', usualExaggeration(frame, spread));
    this.view.fillWith(extent, spread.low + 0.3 * (spread.high - spread.low), summit);
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
    // The first view was asked for before anything was certified. Messages come quicker than it waits, so it is asked for once.
    if (!this.isSlackWanted && this.slack > 0) {
      this.isSlackWanted = true;
      this.wantView();
    }
    const what = part('certified-what').textContent ?? '';
    if (status.isPreview === true) {
      speak(what);
    } else if (status.state !== this.spokenState && status.state !== 'loading') {
      if (this.isViewAsked || !this.isServed) this.relief.keepColours();
      performance.mark('ptin-settled');
      speak(`${part('certified').textContent}, ${what}, ${bytes(status.bytes)} received`);
    }
    this.spokenState = status.state;
  }

  /** The certificate of all that is in sight; null where nothing is known. */
  private inSight({ certified }: Status): Certificate | null {
    const { frame } = this;
    return frame === null ? null : certifiedWithin(certified, frame.bounds, this.view.seenWindows(frame, certified));
  }

  /** By how much the ground of the picture may be off anywhere, in the scene; 0 where nothing is certified yet. */
  private get slack(): number {
    const { frame, status } = this;
    if (frame === null || status === null) return 0;
    const slack = (certifiedWithin(status.certified, frame.bounds)?.deviation ?? 0) * frame.scaleZ;
    return slack < frame.relief ? slack : 0;
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
      void this.baseMap.show(s.shading === 'map');
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
    this.baseMap.follow();
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
    this.pointing?.moved();
    this.keepLink();
    this.wantView();
  }

  /** Asks for what is in sight, once the camera rests. */
  private wantView(): void {
    if (!this.isServed) return;
    clearTimeout(this.viewTimer);
    this.viewTimer = window.setTimeout(() => {
      const { slack } = this;
      this.isSlackWanted = slack > 0;
      this.isViewAsked = true;
      this.send({ kind: 'view', wanted: this.view.wanted(this.relief.canvas.clientHeight, tolerance, slack) });
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
    part('home').addEventListener('click', () => { this.view.flyHome(); });
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
      void this.baseMap.show(false);
      this.boot.trouble('The picture is lost', 'The graphics card gave up on it. It comes back when the card does; otherwise reload the page.', true);
    });
    canvas.addEventListener('webglcontextrestored', () => {
      part('trouble').hidden = true;
      this.relief.restore();
      void this.baseMap.show(this.panel.settings.shading === 'map');
    });
    const followPixels = (): void => {
      matchMedia(`(resolution: ${devicePixelRatio}dppx)`).addEventListener('change', () => {
        this.relief.draw();
        followPixels();
      }, { once: true });
    };
    followPixels();
  }

  /** In a frame: the link to the same view with its card. */
  private linkWhole(): void {
    const query = new URLSearchParams(location.search);
    query.delete('embed');
    part<HTMLAnchorElement>('whole').href = `${location.pathname}?${query}${location.hash}`;
  }

  private savePicture(): void {
    const { canvas } = this.relief;
    this.relief.rests();
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

  private async copyLink(): Promise<void> {
    try {
      await navigator.clipboard.writeText(location.origin + this.address);
      toast('The link to this view is copied');
    } catch {
      toast('The browser does not let pages copy; the address line has the link');
    }
  }
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
  welcome(boot, () => { start(boot); });
} else {
  start(boot);
}
