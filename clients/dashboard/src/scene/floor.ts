// Ground, its grid, which way is forward, and the light.
import * as THREE from 'three';

import {label} from './parts';

const MUTED = 0x8391a7;

/** @param size of the machine, @param reach half its width [m] */
export function floorOf(size: number, reach: number): THREE.Object3D[] {
  const ground = new THREE.Mesh(new THREE.CircleGeometry(3.2 * size, 96), new THREE.ShadowMaterial({opacity: 0.3}));
  ground.receiveShadow = true;
  ground.position.z = -0.001 * size;
  const grid = new THREE.PolarGridHelper(2 * size, 12, 6, 96, MUTED, MUTED);
  grid.rotation.x = Math.PI / 2;
  for (const material of [grid.material].flat()) {
    material.transparent = true;
    material.opacity = 0.2;
  }
  const sun = new THREE.DirectionalLight(0xffffff, 2.4);
  sun.position.set(1.4 * size, -1.1 * size, 3 * size);
  sun.castShadow = true;
  sun.shadow.mapSize.set(1024, 1024);
  const {camera} = sun.shadow;
  camera.left = camera.bottom = -1.6 * size;
  camera.right = camera.top = 1.6 * size;
  camera.near = 0.1 * size;
  camera.far = 8 * size;
  sun.shadow.bias = -0.001;
  sun.shadow.normalBias = 0.012 * size;
  const fill = new THREE.DirectionalLight(0xbfd4ff, 0.8);
  fill.position.set(-2 * size, size, size);
  return [ground, grid, compass(reach), sun, fill];
}

/** A flat arrow along x, and the axes' names. */
function compass(reach: number): THREE.Group {
  const made = new THREE.Group();
  const [from, to, half] = [1.08 * reach, 1.4 * reach, 0.06 * reach];
  const shape = new THREE.Shape([[from, -half / 3], [to - 2 * half, -half / 3], [to - 2 * half, -half], [to, 0], [to - 2 * half, half],
    [to - 2 * half, half / 3], [from, half / 3]].map(([x, y]) => new THREE.Vector2(x, y)));
  const arrow = new THREE.Mesh(new THREE.ShapeGeometry(shape),
    new THREE.MeshBasicMaterial({color: MUTED, transparent: true, opacity: 0.75, side: THREE.DoubleSide}));
  arrow.position.z = 0.001 * reach;
  const name = label('forward, x', 0.14 * reach, '#8391a7');
  name.position.set((from + to) / 2, 0, 0.13 * reach);
  made.add(arrow, name);
  return made;
}
