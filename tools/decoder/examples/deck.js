// SPDX-License-Identifier: GPL-3.0-or-later
//
// A terrain in deck.gl: one SimpleMeshLayer with one mesh, in metres of Mercator around the middle of the terrain.
import { AmbientLight, Deck, DirectionalLight, LightingEffect, MapView } from '@deck.gl/core';
import { SimpleMeshLayer } from '@deck.gl/mesh-layers';
import { getDistanceScales, lngLatToWorld } from '@math.gl/web-mercator';
import { toGeographic } from './geographic.js';
import { refineTerrain } from './terrain.js';

const sun = new DirectionalLight({ color: [255, 255, 255], intensity: 1.1, direction: [1, -1, -0.8] });
const deck = new Deck({
  parent: document.getElementById('view'), views: new MapView(), controller: true,
  initialViewState: { longitude: 0, latitude: 0, zoom: 1 },
  effects: [new LightingEffect({ ambient: new AmbientLight({ intensity: 0.9 }), sun })],
});

let view = null;
refineTerrain(({ positions: onMap, indices }, terrain) => {
  const toLngLat = toGeographic(terrain);
  const { origin: [middleX, middleY, base], scale: [, , scale] } = terrain.frame;
  const [longitude, latitude] = toLngLat([middleX, middleY]);
  const [x0, y0] = lngLatToWorld([longitude, latitude]);
  const { unitsPerMeter: [unit] } = getDistanceScales({ longitude, latitude });
  const positions = new Float32Array(onMap.length);
  for (let i = 0; i < onMap.length; i += 3) {
    const [x, y] = lngLatToWorld(toLngLat([onMap[i], onMap[i + 1]]));
    positions[i] = (x - x0) / unit;
    positions[i + 1] = (y - y0) / unit;
    positions[i + 2] = (onMap[i + 2] - base) * scale;
  }
  view ??= { longitude, latitude, zoom: 11, pitch: 55, bearing: -20, maxPitch: 80 };
  deck.setProps({
    initialViewState: view,
    layers: [new SimpleMeshLayer({
      id: 'terrain', data: [{ position: [longitude, latitude, 0] }], getPosition: (d) => d.position, getColor: [158, 146, 122],
      mesh: { attributes: { positions: { value: positions, size: 3 } }, indices: { value: indices, size: 1 } },
      material: { ambient: 0.4, diffuse: 0.7, shininess: 1, specularColor: [0, 0, 0] },
    })],
  });
}, { positions: 'map' });
