// A machine in three dimensions: built once from the rig's numbers, then posed by every STATE.
import * as THREE from 'three';

import type {State} from '../messages';
import type {Rig} from '../rig';
import {buildGimballed} from './gimballed';
import {buildGyroscope} from './gyroscope';
import type {Skin} from './parts';
import {buildUmbrella} from './umbrella';

export interface Machine {
  root: THREE.Group;          // world frame: x forward, y left, z up, origin at the ground pivot
  structure: THREE.Object3D;  // what is pushed
  height: number;             // of all of it [m]
  reach: number;              // half its width [m]
  wheels: THREE.Object3D[];   // turn about their x
  pose(state: State): void;
  tips?: THREE.Object3D[];    // of the axles that ride on the ring
  restForce?: number;         // on one of them [N]
}

export function buildMachine(rig: Rig, skin: Skin): Machine {
  if (rig.family === 'umbrella') return buildUmbrella(rig, skin);
  return rig.family === 'gimballed' ? buildGimballed(rig, skin) : buildGyroscope(rig, skin);
}

/** Radius [m] of a wheel of this axial inertia and mass, most of it in the rim. */
export function wheelRadius(inertia: number, mass: number): number {
  return Math.sqrt(inertia / (0.62 * Math.max(mass, 1e-9)));
}

/** R = Rx(tilt[0]) Ry(tilt[1]), as state_t says. */
export function tiltTo(body: THREE.Object3D, tilt: ArrayLike<number>): void {
  body.rotation.set(tilt[0] ?? 0, tilt[1] ?? 0, 0, 'XYZ');
}
