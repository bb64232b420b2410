import {afterEach, beforeEach, describe, expect, it, vi} from 'vitest';

import {Delay, Happenings} from '../src/heard';

const told = (happenings: Happenings) => happenings.lines.map(({text, times}) => `${times} x ${text}`);

describe('what happened', () => {
  it('counts on in one line where the same is said again, and adds up the amounts it begins with', () => {
    const happenings = new Happenings();
    happenings.add('info', 'gateway', 'connected');
    for (const left of [31, 7, 12]) happenings.add('bad', 'gateway', `${left} messages were left out`);
    expect(told(happenings)).toEqual(['3 x 50 messages were left out', '1 x connected']);
    expect(happenings.begun).toBe(2);
  });
  it('counts on without an amount', () => {
    const happenings = new Happenings();
    for (const text of ['connected', 'connected', '3D is off', '3D is off']) happenings.add('info', 'gateway', text);
    expect(told(happenings)).toEqual(['2 x 3D is off', '2 x connected']);
  });
  it('keeps everything else a line of its own', () => {
    const happenings = new Happenings();
    happenings.add('bad', 'gateway', '31 messages were left out');
    happenings.add('good', 'push of 5 N m s', 'applied: number 1');
    happenings.add('good', 'push of 5 N m s', 'applied: number 2');
    happenings.add('bad', 'gateway', '8 messages were left out');
    happenings.add('bad', 'recording', '8 messages were left out');
    happenings.add('info', 'recording', '8 messages were left out');
    expect(happenings.lines.map(({times}) => times)).toEqual([1, 1, 1, 1, 1, 1]);
    expect(happenings.begun).toBe(6);
  });
});

describe('how long what comes has waited', () => {
  beforeEach(() => { vi.useFakeTimers({toFake: ['performance']}); });
  afterEach(() => { vi.useRealTimers(); });
  const after = (ms: number) => vi.advanceTimersByTime(ms);
  function answer(delay: Delay, ms: number): void {
    const id = delay.ask();
    after(ms);
    delay.answered(id);
  }

  it('is what the last answer took, but for the way', () => {
    const delay = new Delay();
    answer(delay, 200);
    expect(delay.waited).toBe(0);
    answer(delay, 500);
    expect(delay.waited).toBeCloseTo(0.3);
    after(5000);
    expect(delay.waited).toBeCloseTo(0.3);
  });
  it('is at least for how long the oldest question has waited', () => {
    const delay = new Delay();
    answer(delay, 200);
    const first = delay.ask();
    after(1200);
    const second = delay.ask();
    after(1000);
    expect(delay.waited).toBeCloseTo(2);
    expect(delay.open).toBe(2);
    delay.answered(first);
    delay.answered(second);
    expect(delay.waited).toBeCloseTo(0.8);
    expect(delay.open).toBe(0);
  });
  it('takes a way that has become longer for the way, in time', () => {
    const delay = new Delay();
    answer(delay, 100);
    for (let s = 0; s < 30; ++s) answer(delay, 1000);
    expect(delay.waited).toBe(0);
  });
  it('is told for some seconds where it was long', () => {
    const delay = new Delay();
    answer(delay, 200);
    answer(delay, 2200);
    for (let s = 0; s < 3; ++s) answer(delay, 1000);
    expect(delay.waited).toBeCloseTo(0.8);
    expect(delay.recent).toBeCloseTo(2);
    for (let s = 0; s < 8; ++s) answer(delay, 1000);
    expect(delay.recent).toBeCloseTo(0.8);
  });
  it('knows its own answers alone, and on a new way nothing of the old one', () => {
    const delay = new Delay();
    answer(delay, 200);
    delay.ask();
    after(2200);
    delay.answered('rig');
    expect(delay.waited).toBeCloseTo(2);
    delay.forget();
    expect([delay.waited, delay.recent, delay.open]).toEqual([0, 0, 0]);
  });
});
