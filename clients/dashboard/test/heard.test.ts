import {describe, expect, it} from 'vitest';

import {Happenings} from '../src/heard';

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
