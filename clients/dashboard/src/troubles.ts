// Disturbances and faults that can be asked for, each with one strength in its own unit.
import type {Request, Vector} from './requests';
import type {Rig} from './rig';

export interface Trouble {
  name: string;
  unit?: string;                       // of the strength; none: it has no strength
  usual?: (rig: Rig, which: string) => number;
  which?: (rig: Rig) => string[];      // of these one is chosen
  fits?: (rig: Rig) => boolean;
  ask: (rig: Rig, strength: number, seconds: number, which: string) => Request;
}

interface Sensor { bit: number; unit: string; bias: number }
/** VALID_* bit of sensors_t, unit, and a bias that is felt. */
export const SENSORS: Record<string, Sensor> = {
  gyro: {bit: 1, unit: 'rad/s', bias: 0.02}, accelerometer: {bit: 2, unit: 'm/s²', bias: 0.3}, disc: {bit: 4, unit: 'rad', bias: 0.02},
  gimbals: {bit: 8, unit: 'rad', bias: 0.02}, rotors: {bit: 16, unit: 'rad/s', bias: 20},
};
const GUST_CORRELATION = 0.5;  // [s]
const WIND_LENGTH = 20;        // of its turbulence [m]
const YAW_RATE = 0.2;          // of a turn [rad/s]

const ns = (seconds: number): number => Math.round(seconds * 1e9);
const seed = (): number => 1 + Math.floor(1e6 * Math.random());
const disturb = (kind: string, seconds: number, rest: Record<string, unknown>): Request =>
  ({verb: 'DISTURB', kind, duration_ns: ns(seconds), ...rest});
const fault = (kind: string, seconds: number, rest: Record<string, unknown>): Request =>
  ({verb: 'FAULT', kind, duration_ns: ns(seconds), ...rest});

/** One that is felt: half the reference push in a second. */
const moment = (rig: Rig): number => 0.5 * rig.impulse;
const axes = (rig: Rig): string[] => (rig.tiltsTwoWays ? ['roll', 'pitch'] : ['roll']);
const about = (which: string, size: number): Vector => (which === 'pitch' ? [0, size, 0] : [size, 0, 0]);
const stands = (rig: Rig): boolean => rig.tilts;

const sensors = (rig: Rig): string[] => Object.keys(SENSORS).filter((name) => name !== 'disc' || rig.family !== 'gimballed');
const sensed = (rig: Rig): boolean => rig.has('sensors');
const target = (which: string): number => SENSORS[which]?.bit ?? 1;

export const TROUBLES: readonly Trouble[] = [
  {name: 'Step', unit: 'N m', usual: moment, which: axes, ask: (_, size, s, which) => disturb('LOAD', s, {moment_nm: about(which, size)})},
  {name: 'Ramp', unit: 'N m', usual: moment, which: axes,
    ask: (_, size, s, which) => disturb('LOAD', s, {moment_nm: about(which, size), rise_ns: ns(s)})},
  {name: 'Sine, 1 Hz', unit: 'N m', usual: moment, which: axes,
    ask: (_, size, s, which) => disturb('SINE', s, {moment_nm: about(which, size), frequency_hz: [1, 0]})},
  {name: 'Chirp, 0.2 to 5 Hz', unit: 'N m', usual: moment, which: axes,
    ask: (_, size, s, which) => disturb('CHIRP', s, {moment_nm: about(which, size), frequency_hz: [0.2, 5]})},
  {name: 'Gust', unit: 'N m', usual: (rig) => 0.5 * moment(rig), which: axes,
    ask: (_, size, s, which) => disturb('GUST', s, {moment_nm: about(which, size), correlation_s: GUST_CORRELATION, seed: seed()})},
  {name: 'Wind from the right', unit: 'm/s', usual: () => 3, fits: (rig) => rig.has('wind'),
    ask: (_, size, s) => disturb('WIND', s, {speed_m_s: size, direction_rad: Math.PI / 2, turbulence_m_s: 0.2 * size, length_m: WIND_LENGTH, seed: seed()})},
  {name: 'Turn to the left', unit: 'm/s', usual: () => 1, fits: stands,
    ask: (_, size, s) => disturb('TURN', s, {speed_m_s: size, yaw_rate_rad_s: YAW_RATE})},
  {name: 'Brake', unit: 'm/s²', usual: () => 0.3, fits: (rig) => rig.tiltsTwoWays,
    ask: (_, size, s) => disturb('DECELERATION', s, {deceleration_m_s2: size})},
  {name: 'Mass put on, left', unit: 'kg', usual: (rig) => 0.02 * rig.number('structure.mass_kg', 1), fits: stands,
    ask: (rig, size, s) => {
      const height = rig.number('structure.cm_height_m', 0.2);
      return disturb('ADDED_MASS', s, {mass_kg: size, position_m: [0, 0.5 * height, height]});
    }},
  {name: 'Fault: sensor stuck', which: sensors, fits: sensed, ask: (_, __, s, which) => fault('SENSOR_STUCK', s, {target: target(which)})},
  {name: 'Fault: sensor silent', which: sensors, fits: sensed, ask: (_, __, s, which) => fault('SENSOR_DROPPED', s, {target: target(which)})},
  {name: 'Fault: sensor biased', unit: 'of its unit', usual: (_, which) => SENSORS[which]?.bias ?? 0, which: sensors, fits: sensed,
    ask: (_, size, s, which) => fault('SENSOR_BIASED', s, {target: target(which), level: size})},
  {name: 'Fault: sensor noisy', unit: 'of its unit', usual: (_, which) => SENSORS[which]?.bias ?? 0, which: sensors, fits: sensed,
    ask: (_, size, s, which) => fault('SENSOR_NOISY', s, {target: target(which), level: size, seed: seed()})},
  {name: 'Fault: sensor late', unit: 'ms', usual: () => 20, which: sensors, fits: sensed,
    ask: (_, size, s, which) => fault('SENSOR_DELAYED', s, {target: target(which), delay_ns: ns(size * 1e-3)})},
  {name: 'Fault: drives weak', unit: '% left', usual: () => 50, ask: (_, size, s) => fault('DRIVE_WEAK', s, {target: -1, level: size / 100})},
  {name: 'Fault: flywheel unpowered', unit: 'N m drag', usual: (rig) => rig.number('rotor_drive.coulomb_drag_nm', 0.01),
    which: (rig) => Array.from({length: rig.gyros}, (_, j) => `gyro ${j}`),
    ask: (_, size, s, which) => fault('ROTOR_LOSS', s, {target: Number(which.replace('gyro ', '')) || 0, level: size})},
  {name: 'Fault: commands lost', ask: (_, __, s) => fault('COMMAND_LOST', s, {})},
];
