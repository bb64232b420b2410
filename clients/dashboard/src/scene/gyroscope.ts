// The demonstration gyroscope: a post that turns, an axle that tips on it, a flywheel and its counterweight.
import * as THREE from 'three';

import type {State} from '../messages';
import type {Rig} from '../rig';
import {type Machine, wheelRadius} from './machine';
import {type Skin, ball, flywheel, plate, rod} from './parts';

export function buildGyroscope(rig: Rig, skin: Skin): Machine {
  const l = rig.number('gyroscope.axle_length_m', 0.25);
  const r = Math.min(wheelRadius(rig.number('gyroscope.rotor_inertia_kgm2', 0.01), 0.5 * rig.number('gyroscope.mass_kg', 3)), 0.55 * l);
  const top = 1.6 * r + 0.4 * l, thin = l * 0.03;
  const v = (x: number, y: number, z: number) => new THREE.Vector3(x, y, z);
  const root = new THREE.Group();
  const foot = plate(0.7 * l, thin, skin.dark);
  foot.position.z = thin / 2;
  root.add(foot, rod(v(0, 0, 0), v(0, 0, top - 2 * thin), thin, skin.frame));
  const yoke = new THREE.Group();
  yoke.position.z = top;
  root.add(yoke);
  yoke.add(rod(v(0, -2.4 * thin, -2 * thin), v(0, -2.4 * thin, thin), thin * 0.6, skin.accent));
  yoke.add(rod(v(0, 2.4 * thin, -2 * thin), v(0, 2.4 * thin, thin), thin * 0.6, skin.accent));
  const axle = new THREE.Group();
  yoke.add(axle);
  axle.add(rod(v(-0.85 * l, 0, 0), v(l, 0, 0), thin * 0.6, skin.metal));
  const spin = flywheel(r, r * 0.2, skin);
  spin.position.x = 0.45 * l;
  axle.add(spin);
  const counter = ball(r * 0.28, skin.dark);
  counter.position.x = -0.75 * l;
  axle.add(counter);
  const pose = (state: State): void => {
    yoke.rotation.z = state.disc_angle_rad;
    axle.rotation.y = -(state.gimbal_angle_rad[0] ?? 0);
  };
  return {root, structure: axle, height: top + r, reach: l * 1.1, wheels: [spin], pose};
}
