// How numbers and times read on a chart.
import type uPlot from 'uplot';

/** @param least range that is shown, so that noise does not fill the chart */
export function rangeOf(low: number | null, high: number | null, least: number): [number, number] {
  if (low === null || high === null || !Number.isFinite(low) || !Number.isFinite(high)) return [-least / 2, least / 2];
  const room = Math.max(0.12 * (high - low), 0.02 * Math.max(Math.abs(low), Math.abs(high)), (least - (high - low)) / 2);
  return [low - room, high + room];
}

/** Marks of an axis, with as many digits as their step needs. */
export function marks(values: readonly number[], step: number): string[] {
  const digits = Math.max(0, Math.min(6, -Math.floor(Math.log10(step) + 1e-9)));
  return values.map((value) => (Math.abs(value) < step / 1000 ? '0' : value.toFixed(digits).replace('-', '−')));
}

/** From the right edge back in round steps. */
export function splitsOf(plot: uPlot): number[] {
  const {min, max} = plot.scales['x']!;
  if (min === undefined || max === undefined) return [];
  const most = Math.max(2, plot.bbox.width / devicePixelRatio / 60);
  const step = [0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 30].find((each) => (max - min) / each <= most) ?? 60;
  const splits = [];
  for (let t = max; t >= min; t -= step) splits.unshift(t);
  return splits;
}

/** "-2.5 s": before the right edge. */
export function ago(plot: uPlot, time: number, digits = 2): string {
  const before = time - (plot.scales['x']!.max ?? time);
  return Math.abs(before) < 1e-9 ? '0 s' : `${trimmed(before.toFixed(digits))} s`;
}

export function reading(value: number | null): string {
  if (value === null || Number.isNaN(value)) return '–';
  const size = Math.abs(value);
  const text = size < 5e-4 ? '0' : size >= 1000 ? value.toFixed(0) : size < 1 ? value.toFixed(3) : value.toPrecision(4);
  return text.replace('-', '−');
}

/** Smallest and largest; null where there is nothing. */
export function extremes(values: ArrayLike<number | null | undefined>): [number, number] | null {
  let low = Infinity, high = -Infinity;
  for (let i = 0; i < values.length; ++i) {
    const value = values[i];
    if (value === null || value === undefined) continue;
    if (value < low) low = value;
    if (value > high) high = value;
  }
  return low <= high ? [low, high] : null;
}

export function lastOf(values: ArrayLike<number | null | undefined>): number | null {
  for (let i = values.length - 1; i >= 0; --i) {
    const value = values[i];
    if (value !== null && value !== undefined && !Number.isNaN(value)) return value;
  }
  return null;
}

function trimmed(number: string): string {
  return number.replace(/\.?0+$/, '').replace('-', '−');
}
