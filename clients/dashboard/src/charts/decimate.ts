// How a ring of numbers is drawn: no spike is lost, however narrow the chart.
import type {Ring} from './ring_buffer';

/**
 * Two points a pixel: the smallest and the largest there, in the order they came; NaN where nothing was.
 * Pixels begin at whole multiples of their width, so that what moves by is drawn the same from frame to frame.
 * @returns times, then a list for each of the columns that are wanted
 */
export function decimate(ring: Ring, wanted: readonly number[], from: number, to: number, pixels: number): Float64Array[] {
  const width = (to - from) / pixels;
  const start = Math.floor(from / width) * width, places = pixels + 1;
  const times = new Float64Array(2 * places);
  const columns = wanted.map((k) => ring.columns[k]!);
  const drawn = columns.map(() => new Float64Array(2 * places).fill(NaN));
  let i = ring.before(start);
  for (let pixel = 0; pixel < places; ++pixel) {
    const begin = start + pixel * width;
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

/**
 * As uPlot wants it: null breaks the line, undefined does not. A line breaks only where nothing came for longer than
 * `longest` [s].
 */
export function bridged(times: Float64Array, values: Float64Array, longest: number): (number | null | undefined)[] {
  const drawn: (number | null | undefined)[] = Array.from(values, (value) => (Number.isNaN(value) ? undefined : value));
  let last = -1;
  for (let i = 0; i <= drawn.length; ++i) {
    if (i < drawn.length && drawn[i] === undefined) continue;
    const inside = last >= 0 && i < drawn.length;
    if (!inside || times[i]! - times[last]! > longest) drawn.fill(null, last + 1, i);
    last = i;
  }
  return drawn;
}
