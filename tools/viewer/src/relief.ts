// SPDX-License-Identifier: GPL-3.0-or-later
//
// The picture: sky, relief, plinth, edges, and the marks on it. Drawn only when something changed; rougher while it moves, where
// the card is slow.
import type { Window } from 'ptin-decoder';
import { type DrawnMesh, edgesOf, surfaceEnd, tilesAcross } from './drawn_mesh';
import { type Place, type Seen, Marks, pageColour } from './marks';
import type { Frame } from './frame';
import { drapeUnit, Program, rampUnit, slopeUnit, Smooth, texture, Vertices } from './gl';
import { someBox } from './height_cells';
import { heightStops, rampPixels, slopeStops, type Stop, stopsUpTo } from './ramps';
import { groundFragment, groundVertex, skyFragment, skyVertex, wallFragment, wallVertex } from './shaders';
import { Camera, lengthOf, sum, type Triple } from './space';
import type { Spread } from './surface_raster';
import { Ground } from './triangle_grid';

export type Shading = 'height' | 'slope' | 'shade' | 'map';
export type { Place } from './marks';

/** Where the light comes from, in degrees: clockwise from the top of the picture, and above the horizon. */
export interface Sun {
  azimuth: number;
  altitude: number;
}

/** A base map whose tiles are on the card, and where they lie (tile_grid). */
export interface DrawnMap {
  uniforms: Record<string, readonly number[]>;
  /** The text that draws it (map_shader), and the texture units of its samplers. */
  shader: string;
  samplers: Record<string, number>;
}

const radians = Math.PI / 180;
/** Milliseconds: where a picture takes longer, there are fewer pixels while the camera moves, and all of them once it rests. */
const slowPicture = 28, restAfter = 180;
/** The least share of the pixels along a side, while it moves. */
const roughest = 0.35;

const waterColour = [0.50, 0.69, 0.81], voidColour = [0.894, 0.894, 0.902], stoneColour = [0.66, 0.63, 0.59];

export class Relief {
  readonly camera = new Camera();
  /** The mesh that is drawn now. */
  drawn: DrawnMesh | null = null;
  /** Called before each picture, for what follows the camera. Returns true when another picture is due. */
  beforeDrawing: (() => boolean) | null = null;
  pictures = 0;
  readonly gl: WebGL2RenderingContext;
  private plain!: Program;
  /** Made when it is needed: compiling takes as long as some pictures. */
  private detailed: Program | null = null;
  private mapped: Program | null = null;
  private map: DrawnMap | null = null;
  private wall!: Program;
  private sky!: Program;
  private skyVertices!: Vertices;
  private readonly marks: Marks;
  private smooth!: Smooth;
  private ground: Vertices | null = null;
  private walls: Vertices | null = null;
  private edges: Vertices | null = null;
  private under: Ground | null = null;
  private frame: Frame | null = null;
  private intervalHeight = 0;
  private shadingNumber = 0;
  private exaggeration = 1;
  private edgesShown = false;
  private sunNow: Sun = { azimuth: 315, altitude: 42 };
  private drape: WebGLTexture | null = null;
  private drapePicture: ImageBitmap | null = null;
  private drapeWindow: readonly number[] = [0, 0, 0, 0];
  private air = { haze: [1, 1, 1], zenith: [1, 1, 1], below: [1, 1, 1], hazeDistance: 1 };
  private ramp: readonly [number, number] = [0, 1];
  private stops = heightStops;
  private rampTexture: WebGLTexture | null = null;
  private areColoursKept = false;
  private pending = false;
  /** The share of a side's pixels; less than 1 while the camera moves and the card is slow. */
  private sharpness = 1;
  private movingSharpness = 1;
  private restTimer = 0;
  private size: readonly [width: number, height: number] = [1, 1];

  constructor(readonly canvas: HTMLCanvasElement) {
    const gl = canvas.getContext('webgl2', { antialias: false, powerPreference: 'high-performance' });
    if (gl === null) throw new Error('no WebGL 2');
    this.gl = gl;
    this.marks = new Marks(gl);
    this.prepare();
  }

  /** Makes what is there before any terrain. */
  private prepare(): void {
    const { gl } = this;
    this.plain = new Program(gl, groundVertex, groundFragment(false));
    this.wall = new Program(gl, wallVertex, wallFragment);
    this.sky = new Program(gl, skyVertex, skyFragment);
    this.skyVertices = new Vertices(gl, [{ at: 0, numbers: new Float32Array([-1, -1, 3, -1, -1, 3]), size: 2 }], null);
    this.smooth = new Smooth(gl);
    this.rampTexture = texture(gl, rampUnit, rampPixels(this.stops));
    texture(gl, slopeUnit, rampPixels(slopeStops));
    texture(gl, drapeUnit, new Uint8Array(4));
    this.plain.sampler('ramp', rampUnit);
    gl.enable(gl.DEPTH_TEST);
    gl.depthFunc(gl.LEQUAL);
    gl.blendFuncSeparate(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA, gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    gl.polygonOffset(1, 1);
  }

  /** Has all on the card again that it lost, but for a base map. */
  restore(): void {
    this.detailed = this.mapped = this.ground = this.walls = this.edges = this.map = this.awaited = null;
    this.prepare();
    this.marks.restore();
    if (this.drape !== null) this.drape = texture(this.gl, drapeUnit, this.drapePicture!);
    if (this.drawn !== null) this.setMesh(this.drawn);
    this.draw();
  }

  setFrame(frame: Frame): void {
    this.frame = frame;
    this.ramp = [0, Math.max(frame.relief, 1e-3)];
    this.draw();
  }

  setMesh(mesh: DrawnMesh): void {
    const { gl } = this;
    for (const old of [this.ground, this.walls, this.edges]) old?.free();
    this.drawn = mesh;
    this.ground = new Vertices(gl, [
      { at: 0, numbers: mesh.positions, size: 3 }, { at: 1, numbers: mesh.normals, size: 4 },
    ], mesh.corners);
    this.walls = new Vertices(gl, [
      { at: 0, numbers: mesh.walls, size: 4 }, { at: 1, numbers: mesh.wallNormals, size: 2 },
    ], quads(mesh.walls.length / 16));
    this.edges = null;
    this.under = new Ground(mesh.positions, mesh.corners, mesh.grid);
    if (mesh.spread !== null && this.frame !== null && !this.areColoursKept) this.colourBy(mesh.spread, this.frame);
    this.draw();
  }

  private colourBy({ low, high }: Spread, frame: Frame): void {
    this.ramp = [low, Math.max(high, low + 1e-3)];
    this.stops = stopsUpTo(coloursFor(frame.heightAt(high) * frame.scaleZ), heightStops);
    this.gl.deleteTexture(this.rampTexture);
    this.rampTexture = texture(this.gl, rampUnit, rampPixels(this.stops));
  }

  /** A height has the colour that it has now from here on, however much finer the mesh becomes. */
  keepColours(): void {
    this.areColoursKept = this.drawn !== null && this.drawn.spread !== null;
  }

  /** The colours, and the heights at both ends of them; null before there is a frame. */
  get colours(): { stops: readonly Stop[]; heights: readonly [low: number, high: number] } | null {
    const { frame, ramp, stops } = this;
    return frame === null ? null : { stops, heights: [frame.heightAt(ramp[0]), frame.heightAt(ramp[1])] };
  }

  /** z of the picture's ground at a place of the scene, without exaggeration; null where there is none. */
  groundAt(x: number, y: number): number | null {
    return this.under?.at(x, y) ?? null;
  }

  /** The share of `way` from a place at which the ground is met, both without exaggeration; null where it is not. */
  meets(from: Triple, way: Triple): number | null {
    return this.under?.meets(from, way) ?? null;
  }

  /** Whether `test` holds for one of the boxes that hold the ground of an extent of the scene, where its z may be off by `slack`. */
  someBox(extent: Window, slack: number, test: (least: Triple, most: Triple) => boolean): boolean {
    return this.drawn !== null && someBox(this.drawn.cells, extent, slack, test);
  }

  set wireframe(on: boolean) {
    this.edgesShown = on;
    this.draw();
  }

  set shading(shading: Shading) {
    this.shadingNumber = { height: 0, slope: 1, shade: 2, map: 2 }[shading];
    this.draw();
  }

  set verticalScale(factor: number) {
    this.exaggeration = factor;
    this.draw();
  }

  set sun(sun: Sun) {
    this.sunNow = { azimuth: sun.azimuth, altitude: sun.altitude };
    this.draw();
  }

  /** Heights between isolines, in the height's unit; 0: none. */
  set isolines(interval: number) {
    this.intervalHeight = interval;
    this.draw();
  }

  /** Colours of CSS: of the air at the horizon, of the sky above, and of what is below. */
  setAir(haze: string, zenith: string, below: string): void {
    const [h, z, b] = [haze, zenith, below].map((colour) => pageColour(colour).slice(0, 3));
    this.air = { ...this.air, haze: h, zenith: z, below: b };
    this.draw();
  }

  /** Lays a picture over the terrain; null: none. Its window is on the map. */
  setDrape(picture: ImageBitmap | null, window: readonly number[]): void {
    this.gl.deleteTexture(this.drape);
    this.drape = null;
    this.drapePicture = picture;
    this.drapeWindow = [0, 0, 0, 0];
    if (picture !== null && this.frame !== null) {
      const { frame } = this;
      this.drape = texture(this.gl, drapeUnit, picture);
      const x = frame.sceneX(window[0]), top = frame.sceneY(window[3]);
      this.drapeWindow = [x, top, frame.sceneX(window[2]) - x, frame.sceneY(window[1]) - top];
    }
    this.draw();
  }

  /** Shows a base map instead of colours; null: none. */
  set baseMap(map: DrawnMap | null) {
    this.map = map;
    this.draw();
  }

  /** Pixels of the page. */
  resize(width: number, height: number): void {
    this.size = [width, height];
    Object.assign(this.camera, { width, height });
    this.draw();
  }

  /** Distance from which on the air is seen. */
  set hazeFrom(distance: number) {
    this.air.hazeDistance = distance;
  }

  /** The camera moves: pictures may be rougher until it rests. */
  moves(): void {
    this.sharpness = this.movingSharpness;
    this.restLater();
    this.draw();
  }

  private restLater(): void {
    clearTimeout(this.restTimer);
    this.restTimer = window.setTimeout(() => { this.rests(); }, restAfter);
  }

  /** Draws as sharp as can be. */
  rests(): void {
    if (this.sharpness === 1) return;
    this.sharpness = 1;
    this.draw();
  }

  /** Asks for a picture; however often it is asked, there is one a frame of the screen. */
  draw(): void {
    if (this.pending) return;
    this.pending = true;
    requestAnimationFrame(() => {
      this.pending = false;
      const again = this.beforeDrawing?.() ?? false;
      this.drawNow();
      if (again) this.moves();
    });
  }

  /** The place of the terrain under a point of the canvas, in CSS pixels; null where there is none. Nothing is drawn for it. */
  pick(x: number, y: number): Place | null {
    const { camera, exaggeration } = this;
    const { clientWidth, clientHeight } = this.canvas;
    const ray = camera.ray(2 * x / clientWidth - 1, 1 - 2 * y / clientHeight);
    const from: Triple = [camera.position[0], camera.position[1], camera.position[2] / exaggeration];
    const way: Triple = [ray[0], ray[1], ray[2] / exaggeration];
    const share = this.meets(from, way);
    if (share === null) return null;
    const [px, py, z] = sum(from, way, share);
    return { x: px, y: py, z };
  }

  clearMarks(): void {
    this.marks.clear();
    this.draw();
  }

  addMark(place: Place, colour: string, size = 13): void {
    this.marks.addPoint(place, colour, size);
    this.draw();
  }

  addLine(places: readonly Place[], colour: string): void {
    this.marks.addLine(places, colour);
    this.draw();
  }

  addBody(places: readonly Place[], corners: readonly number[], colour: string): void {
    this.marks.addBody(places, corners, colour);
    this.draw();
  }

  /** The picture as it is, as PNG. */
  async saved(): Promise<Blob> {
    this.sharpness = 1;
    this.drawNow();
    return new Promise((resolve, reject) => {
      this.canvas.toBlob((blob) => { if (blob === null) reject(new Error('the picture is empty')); else resolve(blob); }, 'image/png');
    });
  }

  private drawNow(): void {
    const { gl, camera } = this;
    const begin = performance.now();
    const ratio = this.fit();
    if (this.sharpness === 1) this.smooth.begin(this.canvas.width, this.canvas.height);
    gl.viewport(0, 0, this.canvas.width, this.canvas.height);
    gl.clear(gl.DEPTH_BUFFER_BIT);
    const seen: Seen = { matrix: camera.matrix, eye: camera.position, exaggeration: this.exaggeration };
    this.drawGround(seen, ratio);
    this.drawWalls(seen);
    this.drawSky();
    this.drawEdges(seen);
    this.marks.draw(seen, [this.canvas.width, this.canvas.height], ratio);
    if (this.sharpness === 1) this.smooth.end();
    ++this.pictures;
    this.awaitPicture(begin, this.sharpness);
  }

  /** Makes the drawing as large as it is to be. Returns its pixels for one of the page. */
  private fit(): number {
    const ratio = Math.min(devicePixelRatio, 2) * this.sharpness;
    const [width, height] = this.size.map((side) => Math.max(1, Math.round(side * ratio)));
    if (this.canvas.width !== width || this.canvas.height !== height) Object.assign(this.canvas, { width, height });
    return ratio;
  }

  /** Looks until a picture is done, of which the card tells nothing by itself, and learns from how long it took. */
  private awaitPicture(begin: number, sharpness: number): void {
    const { gl } = this;
    gl.deleteSync(this.awaited);
    const fence = this.awaited = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
    gl.flush();
    const look = (): void => {
      if (fence === null || this.awaited !== fence) return;
      if (gl.getSyncParameter(fence, gl.SYNC_STATUS) !== gl.SIGNALED && !gl.isContextLost()) {
        setTimeout(look, 4);
        return;
      }
      gl.deleteSync(fence);
      this.awaited = null;
      this.pace(performance.now() - begin, sharpness);
      // A picture that took long has held up the next step of whoever moves the camera.
      if (this.sharpness < 1) this.restLater();
    };
    setTimeout(look);
  }
  private awaited: WebGLSync | null = null;

  /** Time goes with pixels, nearly. A picture that is quick by far lets the next one be sharper again. */
  private pace(took: number, sharpness: number): void {
    const wanted = Math.max(roughest, Math.min(1, sharpness * Math.sqrt(slowPicture / Math.max(1, took))));
    if (took > slowPicture) this.movingSharpness = Math.min(this.movingSharpness, wanted);
    else if (took < slowPicture / 3 && sharpness === this.movingSharpness) this.movingSharpness = Math.min(1, 1.2 * sharpness);
  }

  private get key(): Triple {
    const azimuth = this.sunNow.azimuth * radians + this.camera.heading, altitude = this.sunNow.altitude * radians;
    return [Math.sin(azimuth) * Math.cos(altitude), Math.cos(azimuth) * Math.cos(altitude), Math.sin(altitude)];
  }

  private drawGround(seen: Seen, ratio: number): void {
    const { gl, ground, drawn } = this;
    if (ground === null || drawn === null) return;
    const { haze, hazeDistance } = this.air;
    const [x, y] = this.key;
    const common = {
      ...seen, haze, hazeDistance, key: this.key, fill: [-x * 0.8, -y * 0.8, 0.6], rampRange: this.ramp, isFlat: 0, paint: [0, 0, 0, 0],
      hatch: ratio, ...this.details,
    };
    gl.enable(gl.POLYGON_OFFSET_FILL);
    // The camera is above the ground.
    gl.enable(gl.CULL_FACE);
    const program = this.map !== null ? this.mapped ??= this.detailedMade(this.map) : this.hasDetails ? this.detailed ??= this.detailedMade() : this.plain;
    program.use(common);
    for (const tile of this.tilesInSight(drawn)) ground.draw(gl.TRIANGLES, drawn.parts[tile], drawn.parts[tile + 1] - drawn.parts[tile]);
    const tiles = tilesAcross * tilesAcross;
    for (const [part, paint] of [[tiles, [...waterColour, 1]], [tiles + 1, [...voidColour, 2]]] as const) {
      const count = drawn.parts[part + 1] - drawn.parts[part];
      if (count === 0) continue;
      // A base map shows water, too.
      (this.map !== null ? program : this.plain).use({ ...common, isFlat: 1, paint });
      ground.draw(gl.TRIANGLES, drawn.parts[part], count);
    }
    gl.disable(gl.POLYGON_OFFSET_FILL);
    gl.disable(gl.CULL_FACE);
  }

  private detailedMade(map?: DrawnMap): Program {
    const made = new Program(this.gl, groundVertex, groundFragment(true, map?.shader));
    const units = { ramp: rampUnit, slopeRamp: slopeUnit, drape: drapeUnit, ...map?.samplers };
    for (const [name, unit] of Object.entries(units)) made.sampler(name, unit);
    return made;
  }

  /** Something is drawn that is computed a pixel. */
  private get hasDetails(): boolean {
    return this.shadingNumber !== 0 || this.intervalHeight > 0 || this.drape !== null;
  }

  private get details(): Record<string, number | readonly number[]> {
    const { frame, intervalHeight } = this;
    const hasLines = frame !== null && intervalHeight > 0;
    const phase = hasLines ? frame.baseHeight / intervalHeight : 0;
    return {
      shading: this.shadingNumber, interval: hasLines ? intervalHeight * frame.scaleZ : 0, intervalPhase: phase - 5 * Math.floor(phase / 5),
      drapeWindow: this.drapeWindow, ...this.map?.uniforms,
    };
  }

  /** Tiles of land that may be in the picture, the nearest first: what they hide costs less. */
  private tilesInSight({ parts, tileExtents }: DrawnMesh): number[] {
    const { frame, camera, exaggeration } = this;
    if (frame === null) return [];
    const seen: Array<[distance: number, tile: number]> = [];
    const mayMeet = camera.sight(exaggeration);
    for (let tile = 0; tile < tilesAcross * tilesAcross; ++tile) {
      if (parts[tile] === parts[tile + 1]) continue;
      const [west, south, east, north] = tileExtents.subarray(4 * tile, 4 * tile + 4);
      if (!mayMeet([west, south, 0], [east, north, frame.relief])) continue;
      seen.push([lengthOf(sum([(west + east) / 2, (south + north) / 2, 0], camera.position, -1)), tile]);
    }
    return seen.sort((a, b) => a[0] - b[0]).map(([, tile]) => tile);
  }

  private drawEdges(seen: Seen): void {
    const { drawn } = this;
    if (!this.edgesShown || drawn === null) return;
    const { positions, corners, parts } = drawn;
    this.edges ??= new Vertices(
      this.gl, [{ at: 0, numbers: positions, size: 3 }], edgesOf(corners.subarray(0, surfaceEnd(parts)), positions.length / 3),
    );
    this.marks.drawEdges(this.edges, seen);
  }

  private drawWalls(seen: Seen): void {
    const { frame, air } = this;
    if (this.walls === null || frame === null) return;
    const foot = -0.03 * Math.hypot(frame.width, frame.depth);
    this.wall.use({ ...seen, haze: air.haze, hazeDistance: air.hazeDistance, key: this.key, foot, stone: stoneColour });
    this.walls.draw(this.gl.TRIANGLES);
  }

  private drawSky(): void {
    const { camera, air } = this;
    const { halfHeight } = camera;
    const scaled = (v: Triple, times: number): Triple => sum([0, 0, 0], v, times);
    this.sky.use({
      haze: air.haze, zenith: air.zenith, below: air.below, ahead: camera.forward,
      across: scaled(camera.right, halfHeight * camera.aspect), upwards: scaled(camera.up, halfHeight),
    });
    this.skyVertices.draw(this.gl.TRIANGLES);
  }
}

/** Snow is above these heights, metres: on lower land the colours end below it. */
const snowFrom = 700, snowAt = 2500;

/** The share of the colours that land has which reaches up to a height. */
function coloursFor(metres: number): number {
  return 0.76 + 0.24 * Math.max(0, Math.min(1, (metres - snowFrom) / (snowAt - snowFrom)));
}

/** Corners of quads of four vertices each. */
function quads(count: number): Uint32Array {
  const corners = new Uint32Array(6 * count);
  for (let i = 0; i < count; ++i) corners.set([0, 2, 1, 1, 2, 3].map((k) => 4 * i + k), 6 * i);
  return corners;
}
