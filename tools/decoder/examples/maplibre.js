// SPDX-License-Identifier: GPL-3.0-or-later
//
// A terrain on a MapLibre map: a custom layer with a mesh of its own. Mercator coordinates are made in 64 bits, around the middle of
// the terrain.
import 'maplibre-gl/dist/maplibre-gl.css';
import { Map, MercatorCoordinate, setWorkerUrl } from 'maplibre-gl';
import { toGeographic } from './geographic.js';
import { refineTerrain } from './terrain.js';

// MapLibre's styles and its Worker lie beside the bundle.
document.head.append(Object.assign(document.createElement('link'), { rel: 'stylesheet', href: 'maplibre.css' }));
setWorkerUrl(new URL('maplibre-gl-worker.mjs', import.meta.url).href);
const map = new Map({
  container: 'view', pitch: 55, bearing: -20, zoom: 11, maxPitch: 80, attributionControl: false,
  style: { version: 8, sources: {}, layers: [{ id: 'ground', type: 'background', paint: { 'background-color': '#c9d6c3' } }] },
});

const vertexShader = `#version 300 es
in vec3 position;
uniform mat4 matrix;
uniform float metre;
out vec3 place;
void main() {
  place = vec3(position.xy / metre, position.z / metre);
  gl_Position = matrix * vec4(position, 1.0);
}`;
const fragmentShader = `#version 300 es
precision highp float;
in vec3 place;
out vec4 colour;
void main() {
  // Mercator's y is to the south.
  vec3 up = normalize(cross(dFdx(place), dFdy(place)));
  if (up.z < 0.0) up = -up;
  float light = 0.35 + 0.75 * max(0.0, dot(up, normalize(vec3(-1.0, -1.0, 1.2))));
  colour = vec4(vec3(0.62, 0.57, 0.48) * light, 1.0);
}`;

const layer = {
  id: 'terrain', type: 'custom', renderingMode: '3d', count: 0, middle: [0, 0],
  onAdd(_map, gl) {
    this.gl = gl;
    this.program = gl.createProgram();
    for (const [type, source] of [[gl.VERTEX_SHADER, vertexShader], [gl.FRAGMENT_SHADER, fragmentShader]]) {
      const shader = gl.createShader(type);
      gl.shaderSource(shader, source);
      gl.compileShader(shader);
      gl.attachShader(this.program, shader);
    }
    gl.linkProgram(this.program);
    this.positions = gl.createBuffer();
    this.indices = gl.createBuffer();
    this.array = gl.createVertexArray();
    gl.bindVertexArray(this.array);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.positions);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.indices);
    const at = gl.getAttribLocation(this.program, 'position');
    gl.enableVertexAttribArray(at);
    gl.vertexAttribPointer(at, 3, gl.FLOAT, false, 0, 0);
    gl.bindVertexArray(null);
  },
  /** `positions`: Mercator coordinates around `middle`. */
  setMesh(positions, indices, middle, metre) {
    const { gl } = this;
    gl.bindVertexArray(this.array);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.positions);
    gl.bufferData(gl.ARRAY_BUFFER, positions, gl.STATIC_DRAW);
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, indices, gl.STATIC_DRAW);
    gl.bindVertexArray(null);
    Object.assign(this, { count: indices.length, middle, metre });
  },
  render(gl, { defaultProjectionData: { mainMatrix } }) {
    if (this.count === 0) return;
    const [x, y] = this.middle, m = Array.from(mainMatrix);
    for (let i = 0; i < 4; ++i) m[12 + i] += m[i] * x + m[4 + i] * y;
    gl.useProgram(this.program);
    gl.uniformMatrix4fv(gl.getUniformLocation(this.program, 'matrix'), false, m);
    gl.uniform1f(gl.getUniformLocation(this.program, 'metre'), this.metre);
    gl.enable(gl.DEPTH_TEST);
    gl.bindVertexArray(this.array);
    gl.drawElements(gl.TRIANGLES, this.count, gl.UNSIGNED_INT, 0);
    gl.bindVertexArray(null);
  },
};

map.on('load', () => {
  map.addLayer(layer);
  let isFirst = true;
  refineTerrain(({ positions: onMap, indices }, terrain) => {
    const toLngLat = toGeographic(terrain);
    const { origin: [middleX, middleY, base], scale: [, , scale] } = terrain.frame;
    const lngLat = toLngLat([middleX, middleY]);
    const middle = MercatorCoordinate.fromLngLat(lngLat, 0);
    const metre = middle.meterInMercatorCoordinateUnits();
    const positions = new Float32Array(onMap.length);
    for (let i = 0; i < onMap.length; i += 3) {
      const { x, y } = MercatorCoordinate.fromLngLat(toLngLat([onMap[i], onMap[i + 1]]));
      positions[i] = x - middle.x;
      positions[i + 1] = y - middle.y;
      // The map is flat at the terrain's least height.
      positions[i + 2] = (onMap[i + 2] - base) * scale * metre;
    }
    layer.setMesh(positions, indices, [middle.x, middle.y], metre);
    if (isFirst) map.jumpTo({ center: lngLat });
    isFirst = false;
    map.triggerRepaint();
  }, { positions: 'map' });
});
