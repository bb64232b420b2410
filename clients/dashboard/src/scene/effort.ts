// How much may be drawn so that the page stays quick.
interface Level { pixelRatio: number; shadows: boolean; every: number }
const LEVELS: readonly Level[] = [
  {pixelRatio: 2, shadows: true, every: 1}, {pixelRatio: 1, shadows: true, every: 1},
  {pixelRatio: 1, shadows: false, every: 2}, {pixelRatio: 0.75, shadows: false, every: 4}];
const SLOW = 24;         // frames a second
const MOST = 3000;       // a longer second is one in which the page was not seen [ms]

/** Less with every two seconds in a row in which frames come slowly. */
export class Effort {
  private level: number;
  private since = 0;
  private frames = 0;
  private slow = 0;

  /** @param slow known from the start */
  constructor(slow: boolean) { this.level = slow ? LEVELS.length - 1 : 0; }

  get now(): Level { return LEVELS[this.level]!; }

  /** To be asked once a frame: whether less is to be drawn from now on. */
  changed(now: number): boolean {
    this.frames += 1;
    const took = now - this.since;
    if (took < 1000) return false;
    const rate = 1000 * this.frames / took;
    this.since = now;
    this.frames = 0;
    this.slow = took < MOST && rate < SLOW ? this.slow + 1 : 0;
    if (this.slow < 2 || this.level === LEVELS.length - 1) return false;
    this.slow = 0;
    this.level += 1;
    return true;
  }
}
