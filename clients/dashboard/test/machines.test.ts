// Kinematics against the definitions in state_t and services/model.
import * as THREE from 'three';
import {describe, expect, it} from 'vitest';

import type {State} from '../src/messages';
import {Rig} from '../src/rig';
import {buildMachine} from '../src/scene/machine';
import {ghostSkin} from '../src/scene/parts';

const state = (given: Partial<State>): State => ({valid: 63, tilt_rad: [0, 0], disc_tilt_rad: [0, 0], disc_angle_rad: 0,
  gimbal_angle_rad: [0, 0, 0, 0], rotor_speed_rad_s: [0, 0, 0, 0], ...given} as unknown as State);

function machine(values: Record<string, number | string>) {
  return buildMachine(new Rig(new Map(Object.entries(values))), ghostSkin());
}
const world = (object: THREE.Object3D, at: [number, number, number]) => object.localToWorld(new THREE.Vector3(...at));
const near = (a: THREE.Vector3, b: [number, number, number]) => expect(a.distanceTo(new THREE.Vector3(...b))).toBeLessThan(1e-9);

const umbrella = {'rig.machine': 'umbrella', 'disc.joint_height_m': 0.2, 'gyros.count': 4, 'gyros.pivot_radius_m': 0.09,
  'gyros.axle_length_m': 0.06, 'gyros.mass_kg': 1.35, 'gyros.rotor_inertia_kgm2': 0.0021};

describe('the umbrella', () => {
  it('tilts its structure by Rx Ry', () => {
    const made = machine(umbrella);
    made.pose(state({tilt_rad: [0.3, 0.2]} as unknown as Partial<State>));
    made.root.updateMatrixWorld(true);
    // Rx(0.3) Ry(0.2) z = (sin .2, -sin .3 cos .2, cos .3 cos .2)
    near(world(made.structure, [0, 0, 1]), [Math.sin(0.2), -Math.sin(0.3) * Math.cos(0.2), Math.cos(0.3) * Math.cos(0.2)]);
  });
  it('keeps the disc level on the tilted joint, and raises the outer ends', () => {
    const made = machine(umbrella);
    made.pose(state({tilt_rad: [0.3, 0], disc_angle_rad: Math.PI / 2, gimbal_angle_rad: [0.1, 0, 0, 0]} as unknown as Partial<State>));
    made.root.updateMatrixWorld(true);
    const gyro = made.wheels[0]!.parent!;
    const joint: [number, number, number] = [0, -0.2 * Math.sin(0.3), 0.2 * Math.cos(0.3)];
    // Gyro 0 is on x, the disc turned by a quarter: outward is y.
    near(world(gyro, [0, 0, 0]), [joint[0], joint[1] + 0.09, joint[2]]);
    near(world(gyro, [0.06, 0, 0]), [0, joint[1] + 0.09 + 0.06 * Math.cos(0.1), joint[2] + 0.06 * Math.sin(0.1)]);
  });
});

describe('gimballed machines', () => {
  it('turn the spin axis as the model does', () => {
    const single = machine({'rig.machine': 'gimballed', 'gimballed.arrangement': 'single', 'structure.cm_height_m': 0.5,
      'gyros.mass_kg': 143, 'gyros.rotor_inertia_kgm2': 5.4});
    single.pose(state({gimbal_angle_rad: [0.4, 0, 0, 0]} as unknown as Partial<State>));
    single.root.updateMatrixWorld(true);
    const spin = (wheel: THREE.Object3D) => world(wheel, [1, 0, 0]).sub(world(wheel, [0, 0, 0]));
    near(spin(single.wheels[0]!), [Math.sin(0.4), 0, Math.cos(0.4)]);  // Ry(0.4) z

    const pairs = machine({'rig.machine': 'gimballed', 'gimballed.arrangement': 'two_pairs', 'structure.cm_height_m': 0.22,
      'gyros.mass_kg': 1.04, 'gyros.rotor_inertia_kgm2': 0.0021});
    pairs.pose(state({gimbal_angle_rad: [0.3, -0.3, 0.2, -0.2]} as unknown as Partial<State>));
    pairs.root.updateMatrixWorld(true);
    near(spin(pairs.wheels[0]!), [-Math.sin(0.3), Math.cos(0.3), 0]);  // Rz(0.3) y
    near(spin(pairs.wheels[1]!), [Math.sin(0.3), Math.cos(0.3), 0]);
    near(spin(pairs.wheels[2]!), [Math.cos(0.2), Math.sin(0.2), 0]);   // Rz(0.2) x
  });
});

describe('the gyroscope', () => {
  it('turns about its post and raises its tip', () => {
    const made = machine({'rig.machine': 'gyroscope', 'gyroscope.axle_length_m': 0.25});
    made.pose(state({disc_angle_rad: Math.PI / 2, gimbal_angle_rad: [0.3, 0, 0, 0]} as unknown as Partial<State>));
    made.root.updateMatrixWorld(true);
    const tip = world(made.structure, [0.25, 0, 0]).sub(world(made.structure, [0, 0, 0]));
    near(tip, [0, 0.25 * Math.cos(0.3), 0.25 * Math.sin(0.3)]);
  });
});
