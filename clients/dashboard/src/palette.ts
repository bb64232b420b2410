// Colours that tell things of one kind apart, for people of any colour vision (Okabe and Ito): gyro j has colour j
// in the scene and in every chart.
export const SERIES = [0x4f9cf9, 0xe69f00, 0x1fb58f, 0xd67fb4] as const;

/** Colour j as the page's theme has it. */
export function seriesColour(j: number): string {
  return getComputedStyle(document.documentElement).getPropertyValue(`--series-${j % SERIES.length}`).trim();
}
