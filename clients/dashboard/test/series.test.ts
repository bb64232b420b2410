import {describe, expect, it} from 'vitest';

import {Ring, decimate} from '../src/charts/series';

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

describe('decimate', () => {
  it('loses no spike, however few the pixels', () => {
    for (const at of [0, 1, 499, 998, 999]) {
      const ring = filled(1000, (i) => (i === at ? 7 : i === 500 ? -3 : 0));
      const [, values] = decimate(ring, [0], 0, 1.0001, 20);
      expect(Math.max(...values!)).toBe(7);
      expect(Math.min(...values!)).toBe(-3);
    }
  });
  it('draws the smallest and the largest in the order they came', () => {
    const [times, values] = decimate(filled(1000, (i) => i), [0], 0, 1, 10);
    expect(Array.from(values!)).toEqual([...values!].sort((a, b) => a - b));
    expect(Array.from(times!)).toEqual([...times!].sort((a, b) => a - b));
    const [, falling] = decimate(filled(1000, (i) => -i), [0], 0, 1, 10);
    expect(Array.from(falling!)).toEqual([...falling!].sort((a, b) => b - a));
  });
  it('leaves gaps where nothing was, and takes what is not a number for nothing', () => {
    const ring = new Ring(10, 2);
    ring.push(0.05, [1, NaN]);
    ring.push(0.95, [2, NaN]);
    const [, first, second] = decimate(ring, [0, 1], 0, 1, 10);
    expect(Array.from(first!).map((x) => (Number.isNaN(x) ? null : x))).toEqual(
      [1, 1, ...Array<null>(16).fill(null), 2, 2]);
    expect(second!.every(Number.isNaN)).toBe(true);
  });
});
