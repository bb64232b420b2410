// The last minute of some numbers.

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
