// The umbrella platform: structure with its ring, disc on the central joint, gyros hinged to the disc.
import * as THREE from 'three';

import {type State, VALID} from '../messages';
import type {Rig} from '../rig';
import {type Machine, tiltTo, wheelRadius} from './machine';
import {type Skin, ball, flywheel, gimbalFrame, plate, ring, rod} from './parts';

export function buildUmbrella(rig: Rig, skin: Skin): Machine {
  const hd = rig.number('disc.joint_height_m', 0.2), count = rig.gyros;
  const rp = rig.number('gyros.pivot_radius_m', 0.09), zp = rig.number('gyros.pivot_height_m');
  const l = rig.number('gyros.axle_length_m', 0.06), elevation = rig.number('gyros.ring_elevation_rad');
  const ringRadius = rp + l * Math.cos(elevation);
  const ringHeight = hd + zp + l * Math.sin(elevation);
  const wheel = Math.min(wheelRadius(rig.number('gyros.rotor_inertia_kgm2', 0.002), rig.number('gyros.mass_kg', 1)),
    rp * 0.85);
  const thin = ringRadius * 0.03;
  const tip = thin * 0.9;

  const root = new THREE.Group();
  const structure = new THREE.Group();
  root.add(structure);
  const v = (x: number, y: number, z: number) => new THREE.Vector3(x, y, z);
  const foot = v(0, 0, 0);
  structure.add(ball(thin * 1.3, skin.dark));
  structure.add(rod(foot, v(0, 0, hd), thin * 0.9, skin.frame));
  const waist = ringRadius * 0.5;
  for (let i = 0; i < 4; ++i) {
    const angle = Math.PI / 4 + i * Math.PI / 2;
    const [c, s] = [Math.cos(angle), Math.sin(angle)];
    const elbow = v(1.12 * ringRadius * c, 1.12 * ringRadius * s, ringHeight * 0.55);
    structure.add(rod(v(0, 0, thin), elbow, thin * 0.5, skin.frame));
    structure.add(rod(elbow, v(ringRadius * c, ringRadius * s, ringHeight - tip - thin), thin * 0.5, skin.frame));
  }
  const band = ring(waist, thin * 0.35, skin.frame);
  band.position.z = ringHeight * 0.27;
  structure.add(band);
  // The axles' tips ride on its upper side.
  const track = ring(ringRadius, thin, skin.accent);
  track.position.z = ringHeight - tip - thin;
  structure.add(track);
  if (rig.text('umbrella.track') === 'slot') {
    const upper = ring(ringRadius, thin * 0.6, skin.accent);
    upper.position.z = ringHeight + tip + thin * 0.6 + rig.number('contact.slot_clearance_m');
    structure.add(upper);
  }

  const disc = new THREE.Group();
  root.add(disc);
  disc.add(plate(rp * 0.42, thin * 0.9, skin.dark));
  disc.add(ball(thin * 1.4, skin.metal));
  const gyros: THREE.Group[] = [], wheels: THREE.Object3D[] = [], tips: THREE.Object3D[] = [];
  for (let j = 0; j < count; ++j) {
    const azimuth = 2 * Math.PI * j / count;
    const arm = new THREE.Group();
    arm.rotation.z = azimuth;
    disc.add(arm);
    arm.add(rod(v(rp * 0.3, 0, 0), v(rp, -wheel * 0.28, zp), thin * 0.45, skin.dark));
    arm.add(rod(v(rp * 0.3, 0, 0), v(rp, wheel * 0.28, zp), thin * 0.45, skin.dark));
    arm.add(rod(v(rp, -wheel * 0.34, zp), v(rp, wheel * 0.34, zp), thin * 0.4, skin.metal));
    const gyro = new THREE.Group();
    gyro.position.set(rp, 0, zp);
    arm.add(gyro);
    gyro.add(rod(v(-wheel * 0.7, 0, 0), v(l, 0, 0), thin * 0.38, skin.metal));
    const spin = flywheel(wheel, wheel * 0.42, skin);
    const frame = gimbalFrame(wheel * 0.9, 'z', skin, j);
    spin.position.x = frame.position.x = rig.number('gyros.cm_distance_m');
    gyro.add(spin, frame);
    const mark = ball(tip, skin.metal);
    mark.position.x = l;
    gyro.add(mark);
    gyros.push(gyro);
    wheels.push(spin);
    tips.push(mark);
  }

  const joint = v(0, 0, hd);
  const weight = 9.81 * (rig.number('disc.mass_kg', 1) + count * rig.number('gyros.mass_kg', 1));
  const pose = (state: State): void => {
    tiltTo(structure, state.tilt_rad);
    structure.updateMatrix();
    disc.position.copy(joint).applyMatrix4(structure.matrix);
    const tilt = (state.valid & VALID.discTilt) !== 0 ? state.disc_tilt_rad : [0, 0];
    disc.rotation.set(tilt[0]!, tilt[1]!, 0, 'XYZ');
    disc.rotateZ(state.disc_angle_rad);
    // Raising the outer end is a turn about -y.
    gyros.forEach((gyro, j) => { gyro.rotation.y = -(state.gimbal_angle_rad[j] ?? 0); });
  };
  return {root, structure, height: hd + wheel, reach: ringRadius * 1.25, wheels, pose, tips, restForce: weight / count};
}
