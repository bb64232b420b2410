// The last minute of some numbers, and how it is drawn: no spike is lost, however narrow the chart.

/** Columns over time, the oldest pushed out. */
export class Ring {
  readonly time: Float64Array;
  readonly columns: Float64Array[];
  private next = 0;
  size = 0;

  constructor(readonly capacity: number, columns: number) {
    this.time = new Float64Array(capacity);
    this.columns = Array.from({length: columns}, () => new Float64Array(capacity));
  }

  push(time: number, values: ArrayLike<number>): void {
    this.time[this.next] = time;
    this.columns.forEach((column, i) => { column[this.next] = values[i] ?? NaN; });
    this.next = (this.next + 1) % this.capacity;
    this.size = Math.min(this.size + 1, this.capacity);
  }

  clear(): void {
    this.next = this.size = 0;
  }

  /** Place of the i-th oldest. */
  at(i: number): number {
    return (this.next - this.size + i + this.capacity) % this.capacity;
  }

  /** How many are older than `time`. */
  before(time: number): number {
    let low = 0, high = this.size;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.time[this.at(middle)]! < time) low = middle + 1;
      else high = middle;
    }
    return low;
  }
}

/**
 * Two points a pixel: the smallest and the largest there, in the order they came; NaN where nothing was.
 * @returns times, then a list for each of the columns that are wanted
 */
export function decimate(ring: Ring, wanted: readonly number[], from: number, to: number, pixels: number): Float64Array[] {
  const width = (to - from) / pixels;
  const times = new Float64Array(2 * pixels);
  const columns = wanted.map((k) => ring.columns[k]!);
  const drawn = columns.map(() => new Float64Array(2 * pixels).fill(NaN));
  let i = ring.before(from);
  for (let pixel = 0; pixel < pixels; ++pixel) {
    const begin = from + pixel * width;
    times[2 * pixel] = begin + 0.25 * width;
    times[2 * pixel + 1] = begin + 0.75 * width;
    const first = i;
    while (i < ring.size && ring.time[ring.at(i)]! < begin + width) ++i;
    if (first === i) continue;
    columns.forEach((column, k) => {
      let low = Infinity, high = -Infinity, lowAt = 0, highAt = 0;
      for (let j = first; j < i; ++j) {
        const value = column[ring.at(j)]!;
        if (value < low) { low = value; lowAt = j; }
        if (value > high) { high = value; highAt = j; }
      }
      if (low > high) return;  // not a number
      const target = drawn[k]!;
      target[2 * pixel] = lowAt <= highAt ? low : high;
      target[2 * pixel + 1] = lowAt <= highAt ? high : low;
    });
  }
  return [times, ...drawn];
}
