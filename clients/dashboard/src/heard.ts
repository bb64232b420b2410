// What was heard, and what happened.
import type {MessageReader} from '@foxglove/rosmsg2-serialization';

/** A message, taken apart when somebody looks at it. */
export class Heard<T> {
  private known: T | null = null;
  readonly here = performance.now();  // when it came to the page [ms]
  /** @param at when it came to the gateway, its clock [s] */
  constructor(private readonly reader: MessageReader, private readonly bytes: Uint8Array, readonly at: number) {}
  get value(): T {
    this.known ??= this.reader.readMessage(this.bytes) as T;
    return this.known;
  }
}

export type Tone = 'info' | 'good' | 'bad';
/** @property at of the last time it was said */
export interface Happening { at: Date; tone: Tone; who: string; text: string; times: number }
export interface Recording { on: boolean; file?: string; bytes?: number; error?: string }

/** What happened, a line each. Who says the same again counts on in the line it has; amounts that both begin with add up. */
export class Happenings {
  private static readonly most = 200;
  private static readonly amount = /^\d+(?= )/;
  readonly lines: Happening[] = [];  // the newest first
  begun = 0;                         // lines so far

  add(tone: Tone, who: string, text: string): void {
    const said = {at: new Date(), tone, who, text, times: 1};
    const newest = this.lines[0];
    if (newest && newest.tone === tone && newest.who === who && Happenings.what(newest.text) === Happenings.what(text)) {
      const all = text.replace(Happenings.amount, (more) => String(Number(more) + parseInt(newest.text, 10)));
      Object.assign(newest, said, {text: all, times: newest.times + 1});
      return;
    }
    this.lines.unshift(said);
    this.lines.length = Math.min(this.lines.length, Happenings.most);
    this.begun += 1;
  }
  private static what(text: string): string { return text.replace(Happenings.amount, '#'); }
}

/** The greatest of the last seconds, between once and twice as many as its span. */
export class Greatest {
  private best = -Infinity;
  private before = -Infinity;
  private since = 0;

  /** @param span [s] */
  constructor(private readonly span: number) {}

  hear(value: number): void {
    const here = performance.now() * 1e-3;
    if (here - this.since > this.span) {
      this.before = this.best;
      this.best = -Infinity;
      this.since = here;
    }
    this.best = Math.max(this.best, value);
  }
  /** null: none was heard. */
  get value(): number | null {
    const best = Math.max(this.best, this.before);
    return best === -Infinity ? null : best;
  }
}

/** How long what comes has waited, at the gateway and here: a question's answer queues behind all of it. */
export class Delay {
  private asked = new Map<string, number>();  // when [s]
  private count = 0;
  private last = 0;                           // that an answer took [s]
  private least = new Greatest(10);           // likewise, less than 0: the way alone
  private longest = new Greatest(3);          // that was waited [s]

  /** @returns by what to know the answer */
  ask(): string {
    this.longest.hear(this.waited);
    const id = `delay ${++this.count}`;
    this.asked.set(id, performance.now() * 1e-3);
    return id;
  }
  answered(id: string): void {
    const at = this.asked.get(id);
    if (at === undefined) return;
    this.asked.delete(id);
    this.last = performance.now() * 1e-3 - at;
    this.least.hear(-this.last);
  }
  /** Answers that have not come. */
  get open(): number { return this.asked.size; }
  /** What was asked before is about what waits no more. */
  begin(): void {
    this.asked = new Map();
    this.last = 0;
  }
  /** A new way. */
  forget(): void {
    this.begin();
    this.least = new Greatest(10);
    this.longest = new Greatest(3);
  }
  /** By the last answer, or by one that has not come yet if that is longer [s]. */
  get waited(): number {
    const [oldest] = this.asked.values();
    const took = Math.max(this.last, oldest === undefined ? 0 : performance.now() * 1e-3 - oldest);
    return Math.max(0, took + (this.least.value ?? 0));
  }
  /** The longest of the last seconds [s]. */
  get recent(): number { return Math.max(this.waited, this.longest.value ?? 0); }
}

/** From the page's clock to the gateway's [s]: the least delayed message tells it best. */
export class ClockDifference {
  private readonly best = new Greatest(10);

  get offset(): number { return this.best.value ?? 0; }
  /** @param at when a message came to the gateway, its clock [s] */
  hear(at: number): void { this.best.hear(at - performance.now() * 1e-3); }
}
