import {afterEach, beforeEach, describe, expect, it, vi} from 'vitest';

import {Live} from '../src/live';

type Message = {op: string; id?: string; subscriptions?: {channelId: number}[]; subscriptionIds?: number[]};

/** The gateway's end of the socket. */
class Gateway {
  static readonly OPEN = 1;
  static now: Gateway;
  readonly heard: Message[] = [];
  readyState = 1;
  onopen = () => {};
  onclose = () => {};
  onmessage: (event: {data: string}) => void = () => {};

  constructor() { Gateway.now = this; }
  send(text: string): void { this.heard.push(JSON.parse(text) as Message); }
  say(message: object): void { this.onmessage({data: JSON.stringify(message)}); }
  open(): void {
    this.onopen();
    this.say({op: 'serverInfo', name: 'gyrotwin', metadata: {prefix: 'LAB', role: 'observer'}});
    const topics = ['LIVE/STATE', 'SIM/TRUTH', 'REPLY', 'GATEWAY/STATUS'];
    this.say({op: 'advertise', channels: topics.map((topic, id) => ({id, topic: `LAB/${topic}`, encoding: 'cdr', schema: 'float64 x'}))});
    this.say({op: 'parameterValues', parameters: [{name: 'rig.name', value: 'trial'}]});
  }
  close(): void {
    this.readyState = 3;
    this.onclose();
  }
  /** Questions that have no answer yet. */
  get questions(): string[] { return this.heard.flatMap(({op, id}) => (op === 'getParameters' && id?.startsWith('delay') ? [id] : [])); }
  answer(): void {
    for (const id of this.questions) this.say({op: 'parameterValues', parameters: [], id});
    this.heard.length = 0;
  }
  get subscribed(): number[] { return this.heard.flatMap(({subscriptions}) => (subscriptions ?? []).map(({channelId}) => channelId)); }
  get unsubscribed(): number[] { return this.heard.flatMap(({subscriptionIds}) => subscriptionIds ?? []); }
}

const STATE = 0, TRUTH = 1;

describe('a page that cannot follow', () => {
  let live: Live;
  const second = () => vi.advanceTimersByTime(1000);
  /** For so many seconds every question is answered before the next one. */
  function follow(seconds: number): void {
    for (let i = 0; i < 4 * seconds; ++i) {
      Gateway.now.answer();
      vi.advanceTimersByTime(250);
      expect(Gateway.now.unsubscribed).toEqual([]);
    }
  }
  beforeEach(() => {
    vi.useFakeTimers();
    vi.stubGlobal('WebSocket', Gateway);
    live = new Live('ws://lab', (ready) => ready.listen());
    Gateway.now.open();
  });
  afterEach(() => {
    vi.unstubAllGlobals();
    vi.useRealTimers();
  });

  it('listens to all that it knows', () => {
    expect(Gateway.now.subscribed).toEqual([0, 1, 2, 3]);
    follow(5);
    expect(live.late).toBe(0);
  });
  it('lets go of floods once, reads what has come, and listens again', () => {
    Gateway.now.answer();
    second();
    second();
    expect(Gateway.now.unsubscribed).toEqual([STATE, TRUTH]);
    expect(live.late).toBeGreaterThan(1);
    Gateway.now.heard.splice(0, Gateway.now.heard.length, ...Gateway.now.heard.filter(({op}) => op === 'getParameters'));
    second();
    expect(Gateway.now.unsubscribed).toEqual([]);

    const [, ...later] = Gateway.now.questions;
    Gateway.now.say({op: 'parameterValues', parameters: [], id: Gateway.now.questions[0]});
    expect(Gateway.now.subscribed).toEqual([]);  // asked before it let go
    for (const id of later) Gateway.now.say({op: 'parameterValues', parameters: [], id});
    expect(Gateway.now.subscribed).toEqual([STATE, TRUTH]);
  });
  it('listens to everything on a new connection', () => {
    second();
    second();
    Gateway.now.close();
    vi.advanceTimersByTime(600);
    Gateway.now.open();
    expect(Gateway.now.subscribed).toEqual([0, 1, 2, 3]);
    expect(live.late).toBe(0);
    follow(3);
  });
  it('asks no more where nothing is answered', () => {
    for (let s = 0; s < 60; ++s) second();
    expect(Gateway.now.questions.length).toBe(20);
  });
});
