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
export interface Happening { at: Date; tone: Tone; who: string; text: string }
export interface Recording { on: boolean; file?: string; bytes?: number; error?: string }

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
