// SPDX-License-Identifier: GPL-3.0-or-later
//
// The scene: the relief, its edges, and the marks on it. Drawn only when something changed.
import {
  BufferAttribute, BufferGeometry, CanvasTexture, Color, DoubleSide, FloatType, Group, LineSegments, LinearFilter, Mesh,
  NearestFilter, PerspectiveCamera, Points, RGBAFormat, Scene, ShaderMaterial, Sphere, Texture, Vector2, Vector3, Vector4,
  WebGLRenderTarget, WebGLRenderer,
} from 'three';
import type { DrawnMesh } from './drawn_mesh';
import { GroundBelow } from './ground_below';
import type { Frame } from './frame';
import { heightStops, rampTexture, slopeStops } from './ramps';
import { lineFragment, lineVertex, markFragment, placeFragment, reliefFragment, reliefVertex, ribbonVertex } from './shaders';

export type Shading = 'height' | 'slope' | 'shade';

export interface Place {
  x: number;
  y: number;
  z: number;
}

/** Two directions, in degrees: clockwise from north, and above the horizon. */
export interface Sun {
  azimuth: number;
  altitude: number;
}

export class Relief {
  readonly scene = new Scene();
  readonly camera = new PerspectiveCamera(42, 1, 1, 1e6);
  private readonly renderer: WebGLRenderer;
  private readonly geometry = new BufferGeometry();
  private readonly edgeGeometry = new BufferGeometry();
  private readonly marks = new Group();
  private readonly edges: LineSegments;
  private readonly mesh: Mesh;
  private readonly pickTarget = new WebGLRenderTarget(1, 1, {
    type: FloatType, format: RGBAFormat, minFilter: NearestFilter, magFilter: NearestFilter,
  });
  private readonly material: ShaderMaterial;
  private readonly pickMaterial: ShaderMaterial;
  private readonly edgeMaterial: ShaderMaterial;
  /** In pixels of the drawing. */
  private readonly pictureSize = new Vector2(1, 1);
  private frame: Frame | null = null;
  private intervalHeight = 0;
  private ground: GroundBelow | null = null;
  private pending = false;
  /** Called before each picture, for what follows the camera. Returns true when another picture is due. */
  beforeDrawing: (() => boolean) | null = null;
  pictures = 0;

  constructor(readonly canvas: HTMLCanvasElement) {
    this.renderer = new WebGLRenderer({ canvas, antialias: true, alpha: true, powerPreference: 'high-performance' });
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.camera.up.set(0, 0, 1);
    this.material = new ShaderMaterial({
      vertexShader: reliefVertex, fragmentShader: reliefFragment, side: DoubleSide,
      polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1,
      uniforms: {
        exaggeration: { value: 1 }, shading: { value: 0 }, ramp: { value: rampTexture(heightStops) },
        slopeRamp: { value: rampTexture(slopeStops) }, rampRange: { value: [0, 1] }, sun: { value: new Vector3(0, 0, 1) },
        haze: { value: new Color() }, hazeDistance: { value: 1 }, interval: { value: 0 }, intervalPhase: { value: 0 },
        isolineColour: { value: new Color(0.16, 0.1, 0.06) }, drape: { value: null },
        drapeWindow: { value: new Vector4(0, 0, 0, 0) },
      },
    });
    this.pickMaterial = new ShaderMaterial({ vertexShader: reliefVertex, fragmentShader: placeFragment, side: DoubleSide });
    this.edgeMaterial = this.lineMaterial(new Color(0x0d1b2a), 0.24, 0);
    this.mesh = new Mesh(this.geometry, this.material);
    this.edges = new LineSegments(this.edgeGeometry, this.edgeMaterial);
    for (const object of [this.mesh, this.edges]) object.frustumCulled = false;
    this.edges.visible = false;
    this.scene.add(this.mesh, this.edges, this.marks);
  }

  setFrame(frame: Frame): void {
    this.frame = frame;
    this.material.uniforms.rampRange.value = [0, Math.max(frame.relief, 1e-3)];
    this.geometry.boundingSphere = new Sphere(new Vector3(), Math.hypot(frame.width, frame.depth, frame.relief) / 2);
    this.draw();
  }

  setMesh(mesh: DrawnMesh): void {
    this.ground = new GroundBelow(mesh, Math.max((this.frame?.width ?? 0) / 64, 1e-3));
    for (const geometry of [this.geometry, this.edgeGeometry]) geometry.dispose();
    const positions = new BufferAttribute(mesh.positions, 3);
    this.geometry.setAttribute('position', positions);
    this.geometry.setAttribute('normal', new BufferAttribute(mesh.normals, 4, true));
    this.geometry.setIndex(new BufferAttribute(mesh.corners, 1));
    this.edgeGeometry.setAttribute('position', positions);
    this.edgeGeometry.setIndex(null);
    this.edgeGeometry.setDrawRange(0, 0);
    this.draw();
  }

  /** z of the picture's ground at a place of the scene, without exaggeration; null where there is none. */
  groundAt(x: number, y: number): number | null {
    return this.ground?.at(x, y) ?? null;
  }

  /** Edges of the mesh that was set last. */
  setEdges(edges: Uint32Array): void {
    this.edgeGeometry.setIndex(new BufferAttribute(edges, 1));
    this.edgeGeometry.setDrawRange(0, Infinity);
    this.draw();
  }

  set wireframe(on: boolean) {
    this.edges.visible = on;
    this.draw();
  }

  set shading(shading: Shading) {
    this.material.uniforms.shading.value = { height: 0, slope: 1, shade: 2 }[shading];
    this.draw();
  }

  set verticalScale(factor: number) {
    this.scene.scale.z = this.material.uniforms.exaggeration.value = factor;
    this.draw();
  }

  set sun(sun: Sun) {
    const azimuth = sun.azimuth * Math.PI / 180, altitude = sun.altitude * Math.PI / 180;
    this.material.uniforms.sun.value.set(
      Math.sin(azimuth) * Math.cos(altitude), Math.cos(azimuth) * Math.cos(altitude), Math.sin(altitude));
    this.draw();
  }

  /** Heights between isolines, in the height's unit; 0: none. */
  set isolines(interval: number) {
    this.intervalHeight = interval;
    this.draw();
  }

  private placeIsolines(): void {
    const { frame, intervalHeight } = this;
    this.material.uniforms.interval.value = frame === null ? 0 : intervalHeight * frame.scaleZ;
    if (frame === null || intervalHeight <= 0) return;
    const phase = frame.baseHeight / intervalHeight;
    this.material.uniforms.intervalPhase.value = phase - 5 * Math.floor(phase / 5);
  }

  set haze(colour: string) {
    this.material.uniforms.haze.value.setStyle(colour);
    // The picture goes out as it is computed, without a colour space: so do the colours of the page.
    this.material.uniforms.haze.value.convertLinearToSRGB();
    this.draw();
  }

  /** Lays a picture over the terrain; null: none. Its window is on the map. */
  setDrape(picture: ImageBitmap | null, window: readonly number[]): void {
    const { uniforms } = this.material;
    (uniforms.drape.value as Texture | null)?.dispose();
    uniforms.drape.value = null;
    uniforms.drapeWindow.value.set(0, 0, 0, 0);
    if (picture !== null && this.frame !== null) {
      const { frame } = this;
      const texture = new CanvasTexture(picture as unknown as HTMLCanvasElement);
      texture.minFilter = texture.magFilter = LinearFilter;
      texture.generateMipmaps = false;
      texture.flipY = false;
      uniforms.drape.value = texture;
      const x = frame.sceneX(window[0]), top = frame.sceneY(window[3]);
      uniforms.drapeWindow.value.set(x, top, frame.sceneX(window[2]) - x, frame.sceneY(window[1]) - top);
    }
    this.draw();
  }

  resize(width: number, height: number): void {
    this.renderer.setSize(width, height, false);
    this.renderer.getDrawingBufferSize(this.pictureSize);
    this.camera.aspect = width / Math.max(1, height);
    this.camera.updateProjectionMatrix();
    this.draw();
  }

  /** Distance from which on the air is seen. */
  set hazeFrom(distance: number) {
    this.material.uniforms.hazeDistance.value = distance;
  }

  /** Asks for a picture; however often it is asked, there is one a frame of the screen. */
  draw(): void {
    if (this.pending) return;
    this.pending = true;
    requestAnimationFrame(() => {
      this.pending = false;
      this.placeIsolines();
      const again = this.beforeDrawing?.() ?? false;
      this.renderer.render(this.scene, this.camera);
      ++this.pictures;
      if (again) this.draw();
    });
  }

  /** The place of the terrain under a point of the canvas, in CSS pixels; null where there is none. */
  pick(x: number, y: number): Place | null {
    const { clientWidth, clientHeight } = this.canvas;
    const { camera, renderer } = this;
    const before = { material: this.mesh.material, edges: this.edges.visible };
    camera.setViewOffset(clientWidth, clientHeight, Math.floor(x), Math.floor(y), 1, 1);
    this.mesh.material = this.pickMaterial;
    this.edges.visible = this.marks.visible = false;
    renderer.setRenderTarget(this.pickTarget);
    renderer.setClearColor(0, 0);
    renderer.clear();
    renderer.render(this.scene, camera);
    const pixel = new Float32Array(4);
    renderer.readRenderTargetPixels(this.pickTarget, 0, 0, 1, 1, pixel);
    renderer.setRenderTarget(null);
    camera.clearViewOffset();
    this.mesh.material = before.material;
    this.edges.visible = before.edges;
    this.marks.visible = true;
    return pixel[3] > 0 ? { x: pixel[0], y: pixel[1], z: pixel[2] } : null;
  }

  clearMarks(): void {
    for (const mark of [...this.marks.children]) {
      this.marks.remove(mark);
      (mark as Mesh).geometry.dispose();
      ((mark as Mesh).material as ShaderMaterial).dispose();
    }
    this.draw();
  }

  addMark(place: Place, colour: string, size = 13): void {
    const material = this.lineMaterial(pageColour(colour), 1, 0.005);
    material.fragmentShader = markFragment;
    material.depthTest = false;
    material.uniforms.size.value = size * Math.min(devicePixelRatio, 2);
    this.addObject(new Points(geometryOf([place]), material), 3);
  }

  /** A line through places, which is seen through the terrain, faintly. */
  addLine(places: readonly Place[], colour: string): void {
    const geometry = ribbonOf(places);
    const above = this.ribbonMaterial(pageColour(colour), 1, 0.0015);
    const hidden = this.ribbonMaterial(pageColour(colour), 0.3, 0);
    hidden.depthTest = false;
    this.addObject(new Mesh(geometry, above), 2);
    this.addObject(new Mesh(geometry, hidden), 1);
  }

  /** A translucent surface of triangles. */
  addBody(places: readonly Place[], corners: readonly number[], colour: string): void {
    const geometry = geometryOf(places);
    geometry.setIndex([...corners]);
    const material = this.lineMaterial(pageColour(colour), 0.22, 0);
    material.side = DoubleSide;
    this.addObject(new Mesh(geometry, material), 1);
  }

  private addObject(object: Points | Mesh, order: number): void {
    object.frustumCulled = false;
    object.renderOrder = order;
    this.marks.add(object);
    this.draw();
  }

  private ribbonMaterial(colour: Color, opacity: number, lift: number): ShaderMaterial {
    const material = this.lineMaterial(colour, opacity, lift);
    material.vertexShader = ribbonVertex;
    material.side = DoubleSide;
    Object.assign(material.uniforms, {
      width: { value: 2.6 * Math.min(devicePixelRatio, 2) }, picture: { value: this.pictureSize },
    });
    return material;
  }

  private lineMaterial(colour: Color, opacity: number, lift: number): ShaderMaterial {
    return new ShaderMaterial({
      vertexShader: lineVertex, fragmentShader: lineFragment, transparent: true, depthWrite: false,
      uniforms: { colour: { value: colour }, opacity: { value: opacity }, lift: { value: lift }, size: { value: 0 } },
    });
  }
}

function pageColour(colour: string): Color {
  return new Color(colour).convertLinearToSRGB();
}

function geometryOf(places: readonly Place[]): BufferGeometry {
  const geometry = new BufferGeometry();
  const numbers = new Float32Array(3 * places.length);
  places.forEach((p, i) => { numbers.set([p.x, p.y, p.z], 3 * i); });
  geometry.setAttribute('position', new BufferAttribute(numbers, 3));
  return geometry;
}

/** Each stretch of the line as two triangles. */
function ribbonOf(places: readonly Place[]): BufferGeometry {
  const geometry = new BufferGeometry();
  const here: number[] = [], other: number[] = [], turn: number[] = [], corners: number[] = [];
  for (let i = 1; i < places.length; ++i) {
    const a = places[i - 1], b = places[i], first = turn.length;
    for (const [p, q, side] of [[a, b, 1], [a, b, -1], [b, a, -1], [b, a, 1]] as const) {
      here.push(p.x, p.y, p.z);
      other.push(q.x, q.y, q.z);
      turn.push(side);
    }
    corners.push(first, first + 1, first + 2, first + 2, first + 1, first + 3);
  }
  geometry.setAttribute('position', new BufferAttribute(new Float32Array(here), 3));
  geometry.setAttribute('other', new BufferAttribute(new Float32Array(other), 3));
  geometry.setAttribute('turn', new BufferAttribute(new Float32Array(turn), 1));
  geometry.setIndex(corners);
  return geometry;
}
