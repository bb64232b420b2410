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

describe('how long what comes has been on its way', () => {
  beforeEach(() => { vi.useFakeTimers({toFake: ['performance']}); });
  afterEach(() => { vi.useRealTimers(); });

  it('is what the last answer took', () => {
    const delay = new Delay();
    const first = delay.ask()!;
    vi.advanceTimersByTime(300);
    delay.answered(first);
    expect(delay.seconds).toBeCloseTo(0.3);
    vi.advanceTimersByTime(5000);
    expect(delay.seconds).toBeCloseTo(0.3);
  });
  it('is at least for how long the oldest question has waited', () => {
    const delay = new Delay();
    const first = delay.ask()!;
    vi.advanceTimersByTime(1000);
    const second = delay.ask()!;
    vi.advanceTimersByTime(1000);
    expect(delay.seconds).toBeCloseTo(2);
    delay.answered(first);
    delay.answered(second);
    expect(delay.seconds).toBeCloseTo(1);
  });
  it('knows its own answers alone, and nothing of a connection that is gone', () => {
    const delay = new Delay();
    delay.ask();
    vi.advanceTimersByTime(2000);
    delay.answered('rig');
    expect(delay.seconds).toBeCloseTo(2);
    delay.forget();
    expect(delay.seconds).toBe(0);
  });
  it('asks no more where nothing is answered', () => {
    const delay = new Delay();
    const asked = Array.from({length: 200}, () => delay.ask());
    expect(asked.filter((id) => id !== null).length).toBe(100);
    delay.answered(asked[0]!);
    expect(delay.ask()).not.toBeNull();
  });
});
