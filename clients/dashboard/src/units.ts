// Numbers as people read them.

/** "70 µs", "1.25 ms". */
export function duration(ns: bigint): string {
  const us = Number(ns) / 1000;
  if (us < 1000) return `${us.toFixed(us < 10 ? 1 : 0)} µs`;
  return us < 1e6 ? `${(us / 1000).toFixed(us < 1e4 ? 1 : 0)} ms` : `${(us / 1e6).toFixed(1)} s`;
}

/** So many digits that count, never with an exponent; a true minus. */
export function amount(value: number, counting = 3): string {
  if (!Number.isFinite(value)) return '–';
  const size = Math.abs(value);
  const digits = size < 1e-9 ? 0 : Math.max(0, Math.min(6, counting - 1 - Math.floor(Math.log10(size))));
  return value.toFixed(digits).replace('-', '−');
}
