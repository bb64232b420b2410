import {describe, expect, it} from 'vitest';

import {bridged, decimate} from '../src/charts/decimate';
import {Ring} from '../src/charts/ring_buffer';

function filled(count: number, value: (i: number) => number): Ring {
  const ring = new Ring(1000, 1);
  for (let i = 0; i < count; ++i) ring.push(i * 0.001, [value(i)]);
  return ring;
}

describe('Ring', () => {
  it('keeps the newest, in order', () => {
    const ring = filled(2500, (i) => i);
    expect(ring.size).toBe(1000);
    expect(ring.columns[0]![ring.at(0)]).toBe(1500);
    expect(ring.columns[0]![ring.at(999)]).toBe(2499);
    expect(ring.before(1.5)).toBe(0);
    expect(ring.before(2.0)).toBe(500);
    expect(ring.before(9)).toBe(1000);
  });
});

/** Without the pixels that nothing fell into. */
const known = (values: Float64Array | undefined): number[] => Array.from(values!).filter((value) => !Number.isNaN(value));

describe('decimate', () => {
  it('loses no spike, however few the pixels', () => {
    for (const at of [0, 1, 499, 998, 999]) {
      const ring = filled(1000, (i) => (i === at ? 7 : i === 500 ? -3 : 0));
      const [, values] = decimate(ring, [0], 0, 1.0001, 20);
      expect(Math.max(...known(values))).toBe(7);
      expect(Math.min(...known(values))).toBe(-3);
    }
  });
  it('draws the smallest and the largest in the order they came', () => {
    const [times, values] = decimate(filled(1000, (i) => i), [0], 0, 1, 10);
    expect(known(values)).toEqual(known(values).sort((a, b) => a - b));
    expect(Array.from(times!)).toEqual([...times!].sort((a, b) => a - b));
    const [, falling] = decimate(filled(1000, (i) => -i), [0], 0, 1, 10);
    expect(known(falling)).toEqual(known(falling).sort((a, b) => b - a));
  });
  it('leaves gaps where nothing was, and takes what is not a number for nothing', () => {
    const ring = new Ring(10, 2);
    ring.push(0.05, [1, NaN]);
    ring.push(0.95, [2, NaN]);
    const [, first, second] = decimate(ring, [0, 1], 0, 1, 10);
    expect(Array.from(first!).map((x) => (Number.isNaN(x) ? null : x)).slice(0, 20)).toEqual(
      [1, 1, ...Array<null>(16).fill(null), 2, 2]);
    expect(second!.every(Number.isNaN)).toBe(true);
  });
  it('puts what was heard into the same pixels, wherever the window stands', () => {
    const ring = filled(1000, (i) => Math.sin(i * i));
    const [early, one] = decimate(ring, [0], 0.1, 0.6, 50), [late, other] = decimate(ring, [0], 0.1037, 0.6037, 50);
    const shift = Math.round((late![0]! - early![0]!) / 0.01) * 2;
    for (let i = 4; i < 80; ++i) expect(other![i]).toBe(one![i + shift]);
  });
  it('reaches to both ends of the window', () => {
    const ring = filled(1000, (i) => i);
    const [, values] = decimate(ring, [0], 0.2034, 0.6034, 7);
    expect(Math.min(...known(values))).toBeLessThanOrEqual(204);
    expect(Math.max(...known(values))).toBeGreaterThanOrEqual(603);
  });
});

describe('a line', () => {
  const at = Float64Array.from([0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6]);
  it('goes on over a short silence, and breaks at a long one', () => {
    const values = Float64Array.from([NaN, 1, NaN, 2, NaN, NaN, 3]);
    expect(bridged(at, values, 0.25)).toEqual([null, 1, undefined, 2, null, null, 3]);
  });
  it('ends where nothing has come since', () => {
    expect(bridged(at, Float64Array.from([1, 2, NaN, NaN, NaN, NaN, NaN]), 9)).toEqual([1, 2, null, null, null, null, null]);
    expect(bridged(at, new Float64Array(7).fill(NaN), 9)).toEqual(Array(7).fill(null));
  });
});
