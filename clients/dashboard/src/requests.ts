// Requests as request_t names their fields; the gateway fills in and signs the rest.
import type {Rig} from './rig';

export type Request = {verb: string} & Record<string, unknown>;
export type Vector = [number, number, number];

export const verb = (name: string): Request => ({verb: name});
export const speed = (factor: number): Request => ({verb: 'SPEED', speed_factor: factor});
export const rotors = (on: boolean): Request => ({verb: 'ROTORS', kind: on ? 'SPIN_UP' : 'SPIN_DOWN'});

/** A push of exactly this much [N m s], in whole ticks of about the rig's own duration. */
export function impulse(rig: Rig, roll: number, pitch: number): Request {
  const ticks = Math.max(1, Math.round(rig.impulseDuration / rig.tick));
  const duration = ticks * rig.tick;
  const moment: Vector = [roll / duration, pitch / duration, 0];
  return {verb: 'DISTURB', kind: 'LOAD', moment_nm: moment, duration_ns: Math.round(duration * 1e9)};
}

export function load(roll: number, pitch: number, duration: number): Request {
  return {verb: 'DISTURB', kind: 'LOAD', moment_nm: [roll, pitch, 0], duration_ns: Math.round(duration * 1e9)};
}
export function sine(roll: number, pitch: number, hertz: number, duration: number): Request {
  return {...load(roll, pitch, duration), kind: 'SINE', frequency_hz: [hertz, 0]};
}
/** Dryden gust, root mean square. */
export function gust(roll: number, pitch: number, duration: number, seed: number): Request {
  return {...load(roll, pitch, duration), kind: 'GUST', correlation_s: 0.5, seed};
}

/** VALID_* bit of a sensor of sensors_t. */
export const SENSOR_BITS: Record<string, number> = {gyro: 1, accelerometer: 2, disc: 4, gimbals: 8, rotors: 16};

export function sensorFault(kind: 'SENSOR_STUCK' | 'SENSOR_DROPPED', sensor: string, duration: number): Request {
  return {verb: 'FAULT', kind, target: SENSOR_BITS[sensor], duration_ns: Math.round(duration * 1e9)};
}
export function weakDrive(share: number, duration: number): Request {
  return {verb: 'FAULT', kind: 'DRIVE_WEAK', target: -1, level: share, duration_ns: Math.round(duration * 1e9)};
}
export function rotorLoss(rotor: number, drag: number): Request {
  return {verb: 'FAULT', kind: 'ROTOR_LOSS', target: rotor, level: drag};
}
export function commandLost(duration: number): Request {
  return {verb: 'FAULT', kind: 'COMMAND_LOST', duration_ns: Math.round(duration * 1e9)};
}

/** Who asks: drawn once, so that answers are known as one's own. */
export class Writer {
  readonly id = BigInt(Math.floor(Math.random() * 2 ** 52) + 1);
  private counter = 0n;

  sign(request: Request): Request & {writer: string; counter: string} {
    this.counter += 1n;
    return {...request, writer: this.id.toString(), counter: this.counter.toString()};
  }
}
