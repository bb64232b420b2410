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

/** How long what comes has waited, at the gateway and here: a question's answer queues behind all of it. */
export class Delay {
  private static readonly most = 100;    // questions on their way
  private static readonly held = 5000;   // for which the longest is told [ms]
  private readonly asked = new Map<string, number>();  // when [ms]
  private count = 0;
  private last = 0;         // that an answer took [ms]
  private least = Infinity;  // likewise: the way alone
  private longest = {ms: 0, at: 0};

  /** @returns by what to know the answer; null: enough are on their way */
  ask(): string | null {
    if (this.asked.size >= Delay.most) return null;
    const id = `delay ${++this.count}`;
    this.asked.set(id, performance.now());
    return id;
  }
  answered(id: string): void {
    const at = this.asked.get(id);
    if (at === undefined) return;
    this.asked.delete(id);
    this.last = performance.now() - at;
    this.least = Math.min(this.least, this.last);
  }
  /** What was asked before is about what waits no more. */
  begin(): void {
    this.asked.clear();
    this.last = 0;
  }
  /** By the last answer, or by one that has not come yet if that is longer [s]. */
  get seconds(): number {
    const [oldest] = this.asked.values(), now = performance.now();
    const took = Math.max(this.last, oldest === undefined ? 0 : now - oldest);
    const ms = Math.max(0, took - (Number.isFinite(this.least) ? this.least : 0));
    if (ms >= this.longest.ms || now - this.longest.at > Delay.held) this.longest = {ms, at: now};
    return 1e-3 * ms;
  }
  /** The longest of the last seconds [s]. */
  get recent(): number {
    return Math.max(this.seconds, 1e-3 * this.longest.ms);
  }
}

/** From the page's clock to the gateway's [s]: the least delayed message of the last 10 to 20 s tells it best. */
export class ClockDifference {
  private static readonly window = 10;  // [s]
  private best = -Infinity;
  private before = -Infinity;
  private since = 0;

  get offset(): number {
    const best = Math.max(this.best, this.before);
    return best === -Infinity ? 0 : best;
  }
  /** @param at when a message came to the gateway, its clock [s] */
  hear(at: number): void {
    const here = performance.now() * 1e-3;
    if (here - this.since > ClockDifference.window) {
      this.before = this.best;
      this.best = -Infinity;
      this.since = here;
    }
    this.best = Math.max(this.best, at - here);
  }
}
