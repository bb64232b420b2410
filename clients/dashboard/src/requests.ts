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

/** Who asks: drawn once, so that answers are known as one's own. */
export class Writer {
  readonly id = BigInt(Math.floor(Math.random() * 2 ** 52) + 1);
  private counter = 0n;

  sign(request: Request): Request & {writer: string; counter: string} {
    this.counter += 1n;
    return {...request, writer: this.id.toString(), counter: this.counter.toString()};
  }
}
