// SPDX-License-Identifier: GPL-3.0-or-later
//
// A terrain in three.js: z is up, metres around its middle.
import {
  BufferAttribute, BufferGeometry, DirectionalLight, HemisphereLight, Mesh, MeshStandardMaterial, PerspectiveCamera, Scene, WebGLRenderer,
} from 'three';
import { MapControls } from 'three/addons/controls/MapControls.js';
import { refineTerrain } from './terrain.js';

const view = document.getElementById('view');
const renderer = new WebGLRenderer({ antialias: true });
view.append(renderer.domElement);
renderer.setClearColor('#dfe7ee');
const scene = new Scene();
scene.add(new HemisphereLight('#cfe0ff', '#806040', 1.2));
const sun = new DirectionalLight('white', 2.5);
sun.position.set(-2, 2, 1.5);
scene.add(sun);
const terrain = new Mesh(new BufferGeometry(), new MeshStandardMaterial({ color: '#9a8f7a', roughness: 1, flatShading: true }));
scene.add(terrain);
const camera = new PerspectiveCamera(40, 1, 10, 1e6);
camera.up.set(0, 0, 1);
const controls = new MapControls(camera, renderer.domElement);

function render() {
  renderer.render(scene, camera);
}
function resize() {
  const { clientWidth, clientHeight } = view;
  renderer.setSize(clientWidth, clientHeight);
  camera.aspect = clientWidth / clientHeight;
  camera.updateProjectionMatrix();
  render();
}
controls.addEventListener('change', render);
addEventListener('resize', resize);
resize();

let isFirst = true;
refineTerrain(({ positions, indices }) => {
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(positions, 3));
  geometry.setIndex(new BufferAttribute(indices, 1));
  terrain.geometry.dispose();
  terrain.geometry = geometry;
  if (isFirst) {
    geometry.computeBoundingSphere();
    const { radius } = geometry.boundingSphere;
    camera.position.set(-0.4 * radius, -1.7 * radius, 1.5 * radius);
    controls.target.set(0, 0, 0);
    controls.update();
    isFirst = false;
  }
  render();
});
