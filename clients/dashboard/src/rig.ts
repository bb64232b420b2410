// The rig file's numbers as the page needs them, from the gateway's parameters.
import type {Value} from './foxglove';

export type Family = 'umbrella' | 'gimballed' | 'gyroscope';

export class Rig {
  constructor(private readonly values: ReadonlyMap<string, Value>) {}

  number(name: string, otherwise = 0): number {
    const value = this.values.get(name);
    return typeof value === 'number' ? value : otherwise;
  }
  text(name: string, otherwise = ''): string {
    const value = this.values.get(name);
    return typeof value === 'string' ? value : otherwise;
  }
  has(section: string): boolean {
    for (const name of this.values.keys()) if (name.startsWith(`${section}.`)) return true;
    return false;
  }

  /** The same for the same numbers. */
  get key(): string { return JSON.stringify([...this.values].filter(([name]) => name !== 'recording').sort(([a], [b]) => (a < b ? -1 : 1))); }
  get name(): string { return this.text('rig.name'); }
  get summary(): string { return this.text('rig.summary'); }
  get family(): Family { return this.text('rig.machine', 'umbrella') as Family; }
  get arrangement(): string { return this.text('gimballed.arrangement'); }
  get tick(): number { return 1 / this.number('loop.rate_hz', 1000); }  // [s]
  get fallTilt(): number { return this.number('safety.fall_tilt_rad', 0.7); }
  get impulse(): number { return this.number('disturbance.reference_impulse_nms', 1); }
  get impulseDuration(): number { return this.number('disturbance.impulse_duration_s', 0.02); }
  get torqueLimit(): number { return this.number('drive.torque_limit_nm', 1); }
  get nominalSpeed(): number { return this.number('gyros.rotor_speed_rad_s', this.number('gyroscope.rotor_speed_rad_s')); }

  /** How many there are. */
  get gyros(): number {
    if (this.family === 'umbrella') return this.number('gyros.count', 4);
    if (this.family === 'gyroscope') return 1;
    return {single: 1, pair: 2, two_pairs: 4}[this.arrangement] ?? 1;
  }
  get drives(): number { return this.arrangement === 'two_pairs' ? 2 : 1; }
  /** Whether it stands on a point, so that it can fall to all sides. */
  get tiltsTwoWays(): boolean {
    return this.family === 'umbrella' || this.arrangement === 'two_pairs';
  }
  get tilts(): boolean { return this.family !== 'gyroscope'; }

  /** Angle that is left before a gimbal's stop [rad]. */
  stopMargin(angle: number): number {
    const [lower, upper] = this.stops;
    return Math.min(angle - lower, upper - angle);
  }
  get stops(): [number, number] {
    if (this.family === 'umbrella') {
      return [this.number('gyros.stop_lower_rad', -1), this.number('gyros.stop_upper_rad', 1)];
    }
    const stop = this.number('gyros.stop_rad', this.number('gyroscope.stop_rad', 1));
    return [-stop, stop];
  }
}

/** Angle of the structure's axis to the vertical [rad], R = Rx(tilt[0]) Ry(tilt[1]). */
export function tiltOf(tilt: ArrayLike<number>): number {
  return Math.acos(Math.min(1, Math.cos(tilt[0] ?? 0) * Math.cos(tilt[1] ?? 0)));
}
export const degrees = (radians: number): number => radians * 180 / Math.PI;
