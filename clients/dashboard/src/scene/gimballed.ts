// Gimballed gyros in a body on a line or a point. The model has their pivots in one place; here they stand
// side by side.
import * as THREE from 'three';

import type {State} from '../messages';
import type {Rig} from '../rig';
import {type Machine, tiltTo, wheelRadius} from './machine';
import {type Skin, ball, box, flywheel, gimbalFrame, plate, rod} from './parts';

type Place = {at: [number, number]; aligned: number};

/** Where the gyros stand, in wheel radii, and how far their spin axis is turned from x about z. */
const PLACES: Record<string, Place[]> = {
  single: [{at: [0, 0], aligned: 0}],
  pair: [{at: [1.6, 0], aligned: Math.PI / 2}, {at: [-1.6, 0], aligned: Math.PI / 2}],
  two_pairs: [{at: [2, 0], aligned: Math.PI / 2}, {at: [-2, 0], aligned: Math.PI / 2}, {at: [0, 2], aligned: 0},
    {at: [0, -2], aligned: 0}],
};

export function buildGimballed(rig: Rig, skin: Skin): Machine {
  const zc = rig.number('structure.cm_height_m', 0.2);
  const kind = rig.arrangement;
  const places = PLACES[kind] ?? PLACES['single']!;
  const r = Math.min(wheelRadius(rig.number('gyros.rotor_inertia_kgm2', 0.002), rig.number('gyros.mass_kg', 1)),
    zc * (kind === 'two_pairs' ? 0.3 : 0.42));
  const root = new THREE.Group();
  const structure = new THREE.Group();
  root.add(structure);
  const v = (x: number, y: number, z: number) => new THREE.Vector3(x, y, z);
  const floor = zc - 1.45 * r, thin = r * 0.09;
  let reach = 3.6 * r;

  if (kind === 'two_pairs') {
    const deck = plate(3.3 * r, thin * 1.6, skin.dark);
    deck.position.z = floor;
    structure.add(deck, ball(thin * 1.6, skin.metal));
    for (let i = 0; i < 4; ++i) {
      const angle = Math.PI / 4 + i * Math.PI / 2;
      structure.add(rod(v(0, 0, thin), v(2.4 * r * Math.cos(angle), 2.4 * r * Math.sin(angle), floor), thin, skin.frame));
    }
  } else {
    const length = kind === 'single' ? 7 * r : 8.5 * r, width = kind === 'single' ? 3.1 * r : 2.9 * r;
    reach = length / 2;
    const wheelSize = Math.max(zc * 0.22, floor * 0.62);
    const deck = box(length, width, thin * 2, skin.dark);
    deck.position.z = Math.max(floor, wheelSize * 1.2);
    structure.add(deck);
    const roof = zc + 1.7 * r;
    for (const x of [-0.46, 0.46]) {
      for (const y of [-0.44, 0.44]) {
        structure.add(rod(v(x * length, y * width, floor), v(x * 0.92 * length, y * width, roof), thin, skin.frame));
      }
      structure.add(rod(v(x * 0.92 * length, -0.44 * width, roof), v(x * 0.92 * length, 0.44 * width, roof), thin, skin.frame));
      const tyre = flywheel(wheelSize / 2, wheelSize * 0.16, {...skin, wheel: skin.dark});
      tyre.rotation.z = Math.PI / 2;
      tyre.position.set(x * 0.78 * length, 0, wheelSize / 2);
      structure.add(tyre);
    }
    for (const y of [-0.44, 0.44]) {
      structure.add(rod(v(-0.42 * length, y * width, roof), v(0.42 * length, y * width, roof), thin, skin.frame));
    }
    if (kind === 'pair') root.add(rail(length * 1.9, thin, skin));
  }

  const gimbals: THREE.Group[] = [], wheels: THREE.Object3D[] = [];
  places.forEach(({at, aligned}, j) => {
    const post = new THREE.Group();
    post.position.set(at[0] * r, at[1] * r, zc);
    structure.add(post);
    const gimbal = new THREE.Group();
    post.add(gimbal);
    const unit = new THREE.Group();
    if (kind === 'single') unit.rotation.y = -Math.PI / 2;  // spin axis up
    else unit.rotation.z = aligned;
    gimbal.add(unit);
    const spin = flywheel(r, r * 0.45, skin);
    unit.add(spin, gimbalFrame(r, kind === 'single' ? 'y' : 'z', skin, j));
    if (kind === 'single') {
      post.add(rod(v(0, -1.5 * r, 0), v(0, -1.22 * r, 0), thin, skin.accent), rod(v(0, 1.22 * r, 0), v(0, 1.5 * r, 0), thin, skin.accent));
      post.add(rod(v(0, -1.5 * r, floor - zc), v(0, -1.5 * r, 0), thin, skin.frame), rod(v(0, 1.5 * r, floor - zc), v(0, 1.5 * r, 0), thin, skin.frame));
    } else {
      post.add(rod(v(0, 0, floor - zc), v(0, 0, -1.22 * r), thin * 1.3, skin.accent));
      gimbal.add(rod(v(0, 0, -1.22 * r), v(0, 0, -1.1 * r), thin, skin.frame));
    }
    gimbals.push(gimbal);
    wheels.push(spin);
  });

  const pose = (state: State): void => {
    tiltTo(structure, state.tilt_rad);
    gimbals.forEach((gimbal, j) => {
      const angle = state.gimbal_angle_rad[j] ?? 0;
      if (kind === 'single') gimbal.rotation.y = angle;
      else gimbal.rotation.z = angle;
    });
  };
  return {root, structure, height: zc + 1.8 * r, reach, wheels, pose};
}

function rail(length: number, thin: number, skin: Skin): THREE.Object3D {
  const made = box(length, thin * 3, thin * 2, skin.metal);
  made.position.z = -thin;
  return made;
}
