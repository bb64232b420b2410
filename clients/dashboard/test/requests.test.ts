import {describe, expect, it} from 'vitest';

import {parseData, publication} from '../src/foxglove';
import {Writer, impulse} from '../src/requests';
import {Rig, tiltOf} from '../src/rig';

const rig = (duration: number, rate: number) => new Rig(new Map<string, number | string>([
  ['loop.rate_hz', rate], ['disturbance.impulse_duration_s', duration], ['disturbance.reference_impulse_nms', 5],
  ['rig.machine', 'umbrella'], ['gyros.stop_lower_rad', -0.6], ['gyros.stop_upper_rad', 0.7]]));

describe('impulse', () => {
  it('is exact in whole ticks, whatever the duration', () => {
    for (const [duration, rate] of [[0.02, 1000], [0.0204, 1000], [0.0001, 500], [0.033, 250]] as const) {
      const {moment_nm, duration_ns} = impulse(rig(duration, rate), 5, -2) as unknown as {moment_nm: number[]; duration_ns: number};
      const ticks = duration_ns * 1e-9 * rate;
      expect(Math.abs(ticks - Math.round(ticks))).toBeLessThan(1e-6);
      expect(Math.round(ticks)).toBeGreaterThanOrEqual(1);
      expect(moment_nm[0]! * duration_ns * 1e-9).toBeCloseTo(5, 6);
      expect(moment_nm[1]! * duration_ns * 1e-9).toBeCloseTo(-2, 6);
    }
  });
});

describe('Writer', () => {
  it('counts up under one name that JSON can hold', () => {
    const writer = new Writer();
    const [a, b] = [writer.sign({verb: 'ARM'}), writer.sign({verb: 'ARM'})];
    expect(a.writer).toBe(b.writer);
    expect([a.counter, b.counter]).toEqual(['1', '2']);
    expect(BigInt(a.writer)).toBeGreaterThan(0n);
  });
});

describe('frames', () => {
  it('are those of the protocol', () => {
    expect(Array.from(publication(258, 'hi'))).toEqual([1, 2, 1, 0, 0, 104, 105]);
    const bytes = new Uint8Array([1, 2, 1, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 9, 8]);
    expect(parseData(bytes.buffer)).toEqual({subscription: 258, time: 1n, bytes: new Uint8Array([9, 8])});
    expect(parseData(new Uint8Array([2, 0, 0, 0, 0, 0, 0, 0, 0]).buffer)).toBeNull();
    expect(parseData(new Uint8Array(3).buffer)).toBeNull();
  });
});

describe('Rig', () => {
  it('knows what is left before a stop, and the lean of two tilts', () => {
    expect(rig(0.02, 1000).stopMargin(0.5)).toBeCloseTo(0.2);
    expect(rig(0.02, 1000).stopMargin(-0.5)).toBeCloseTo(0.1);
    expect(tiltOf([0.3, 0])).toBeCloseTo(0.3);
    expect(tiltOf([0.3, 0.4])).toBeCloseTo(Math.acos(Math.cos(0.3) * Math.cos(0.4)));
  });
});
