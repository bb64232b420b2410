import {describe, expect, it} from 'vitest';

import {marks, rangeOf, reading} from '../src/charts/axes';
import {room} from '../src/panels/margins';
import {leaning} from '../src/scene/ahead';
import {amount, duration} from '../src/units';

describe('numbers', () => {
  it('read without exponents and with a true minus', () => {
    expect([150, 1.5, 0.0213, -4.105, 0, 12345, NaN].map((each) => amount(each))).toEqual(['150', '1.50', '0.0213', '−4.11', '0', '12345', '–']);
    expect([900n, 70000n, 1250000n, 2500000000n].map(duration)).toEqual(['0.9 µs', '70 µs', '1.3 ms', '2.5 s']);
    expect([null, -0.00001, -2.3164, 1234.5].map(reading)).toEqual(['–', '0', '−2.316', '1235']);
  });
  it('stand on an axis with as many digits as its step needs', () => {
    expect(marks([-0.2, 0, 0.2], 0.2)).toEqual(['−0.2', '0', '0.2']);
    expect(marks([-20, 0], 20)).toEqual(['−20', '0']);
    expect(marks([0.005], 0.005)).toEqual(['0.005']);
  });
  it('have an axis that shows no less than it should', () => {
    const [low, high] = rangeOf(-0.01, 0.01, 1);
    expect(high - low).toBeGreaterThanOrEqual(1);
    expect(rangeOf(null, null, 4)).toEqual([-2, 2]);
    const [bottom, top] = rangeOf(-10, 30, 1);
    expect(bottom).toBeLessThan(-10);
    expect(top).toBeGreaterThan(30);
  });
});

describe('margins', () => {
  it('are fine, little or none, and not known without numbers', () => {
    expect(room(0.6, 1, 0.5)).toBe('fine');
    expect(room(0.4, 1, 0.5)).toBe('close');
    expect(room(0, 1, 0.5)).toBe('gone');
    expect(room(-0.1, 1, 0.5)).toBe('gone');
    expect(room(NaN, 1, 0.5)).toBe('unknown');
  });
});

describe('the arc of the forecast', () => {
  it('leads from the vertical towards the lean', () => {
    const at = leaning(3, -4, 0.2, 2);
    expect(at.length()).toBeCloseTo(2, 12);
    expect(Math.acos(at.z / 2)).toBeCloseTo(0.2, 12);
    expect(at.x / at.y).toBeCloseTo(-0.75, 12);
  });
});
