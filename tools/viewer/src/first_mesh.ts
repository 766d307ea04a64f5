// SPDX-License-Identifier: GPL-3.0-or-later
//
// The first picture that lies in the page (../first_mesh.h): a coarse mesh with its facts and its certificate, drawn before the
// decoder is there.
import type { Certified, Facts, MeshView, Told } from 'ptin-decoder';
import { boundsOf, factNames, none, onMap, toldBy, triangleWords, vertexWords } from 'ptin-decoder/values';
import type { Earth } from './earth';
import { Frame } from './frame';

export interface FirstMesh {
  /** Heights of some places alone. */
  isPreview: boolean;
  frame: Frame;
  mesh: MeshView;
  certified: Certified;
}

interface Written {
  facts: number[];
  metadata: string;
  /** Null of a preview, of which nothing is certified. */
  error: number | null;
  deviation: number;
  vertices: number;
  triangles: number;
  mesh: string;
}

/** @param text  The element's content. */
export function firstMeshOf(text: string): FirstMesh {
  const written = JSON.parse(text) as Written;
  const facts = Object.fromEntries(factNames.map((name, i) => [name, written.facts[i]])) as Facts;
  const told = toldBy(JSON.parse(written.metadata));
  const { error, deviation } = written;
  return {
    isPreview: error === null,
    frame: new Frame(facts, told.units, roughEarth(facts, told)),
    mesh: meshOf(written),
    certified: error === null || told.request.levels !== undefined ? [] : [{ window: told.request.window ?? boundsOf(facts), error, deviation }],
  };
}

/** Numbers of seven bits a byte, the lowest first. */
function* numbersOf(base64: string): Generator<number> {
  const bytes = atob(base64);
  for (let i = 0, number = 0, times = 1; i < bytes.length; ++i) {
    const byte = bytes.charCodeAt(i);
    number += (byte & 127) * times;
    times *= 128;
    if (byte >= 128) continue;
    yield number;
    number = 0;
    times = 1;
  }
}

const unfolded = (n: number): number => (n % 2 === 0 ? n / 2 : -(n + 1) / 2);

function meshOf({ vertices: vertexCount, triangles: triangleCount, mesh }: Written): MeshView {
  const numbers = numbersOf(mesh);
  const next = (): number => numbers.next().value as number;
  const vertices = new Int32Array(vertexCount * vertexWords), hasHeight = new Uint8Array(vertexCount);
  for (let v = 0, x = 0, y = 0, z = 0; v < vertexCount; ++v) {
    const first = next();
    hasHeight[v] = first % 2;
    x += unfolded(Math.floor(first / 2));
    y += unfolded(next());
    z += unfolded(next());
    vertices.set([x, y, z], v * vertexWords);
  }
  const triangles = new Uint32Array(triangleCount * triangleWords).fill(none), classes = new Uint8Array(triangleCount);
  for (let t = 0, a = 0; t < triangleCount; ++t) {
    const first = next();
    classes[t] = first % 2;
    a += unfolded(Math.floor(first / 2));
    triangles.set([a, a + unfolded(next()), a + unfolded(next())], t * triangleWords);
  }
  joinNeighbours(triangles, vertexCount);
  return { vertexCount, triangleCount, vertices, hasHeight, triangles, classes, facts: new Uint8Array(0) };
}

/** Across from each corner the triangle on the other side of the edge. */
function joinNeighbours(triangles: Uint32Array, vertexCount: number): void {
  const edges = new Map<number, number>();
  for (let at = 0; at < triangles.length; at += triangleWords) {
    for (let k = 0; k < 3; ++k) {
      const a = triangles[at + (k + 1) % 3], b = triangles[at + (k + 2) % 3];
      const other = edges.get(b * vertexCount + a);
      edges.set(a * vertexCount + b, at + 3 + k);
      if (other === undefined) continue;
      triangles[at + 3 + k] = Math.floor(other / triangleWords);
      triangles[other] = at / triangleWords;
    }
  }
}

/** A sphere as the Earth; the decoder knows better, and takes its place. For a picture alone. */
function roughEarth(facts: Facts, { ground, units }: Told): Earth {
  const isDegrees = ground?.geographic ?? units.horizontal === 'degree';
  const metres = ground?.metres_per_map_unit ?? 1, degree = 111195;
  const y = [facts.minY, facts.maxY].map((v) => onMap(facts, facts.minX, v).y);
  const scales = Array.from({ length: 9 }, (_, i) => {
    const at = y[0] + i / 8 * (y[1] - y[0]);
    return isDegrees ? { y: at, x: degree * Math.max(0.01, Math.cos(at * Math.PI / 180)), perY: degree } : { y: at, x: metres, perY: metres };
  });
  return {
    isDegrees, lengths: { unit: 'metre', metres: null }, metresPerHeight: ground?.metres_per_height ?? 1, curvature: 0, lightSpeed: 1,
    size: null, scales,
  };
}
