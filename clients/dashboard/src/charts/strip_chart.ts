// One strip chart: a choice of quantities over the last seconds; pause, zoom, readings under the cursor.
import uPlot from 'uplot';

import type {Live} from '../live';
import type {Rig} from '../rig';
import {type Ring, decimate} from './series';

interface Line { label: string; column: number; colour: string; dashed?: boolean; ring?: (live: Live) => Ring }
export interface Quantity { name: string; unit: string; lines: Line[]; ring: (live: Live) => Ring }

// Told apart by people of any colour vision (Okabe and Ito).
const BLUE = '#4f9cf9', ORANGE = '#e69f00', GREEN = '#1fb58f', PINK = '#d67fb4';
const FOUR = [BLUE, ORANGE, GREEN, PINK];
const several = (name: string, first: number, count: number): Line[] =>
  Array.from({length: count}, (_, j) => ({label: count > 1 ? `${name} ${j}` : name, column: first + j, colour: FOUR[j]!}));

/** What this rig has to show, the most telling first. */
export function quantitiesOf(rig: Rig): Quantity[] {
  const states = (live: Live) => live.states, truths = (live: Live) => live.truths, healths = (live: Live) => live.healths;
  const twins = (live: Live) => live.twins;
  const all: Quantity[] = [];
  if (rig.tilts) {
    const two = rig.tiltsTwoWays;
    all.push({name: 'Tilt', unit: '°', ring: states, lines: [
      {label: 'roll', column: 0, colour: BLUE}, ...(two ? [{label: 'pitch', column: 1, colour: ORANGE}] : []),
      {label: 'twin roll', column: 0, colour: GREEN, dashed: true, ring: twins},
      ...(two ? [{label: 'twin pitch', column: 1, colour: PINK, dashed: true, ring: twins}] : [])]});
  }
  const gimbals = {name: 'Gimbals', unit: '°', ring: states, lines: several('gimbal', 5, rig.gyros)};
  if (rig.family !== 'gimballed') {
    const name = rig.family === 'umbrella' ? 'Disc' : 'Post';
    all.push({name: `${name} speed`, unit: 'rad/s', ring: states, lines: [{label: name.toLowerCase(), column: 4, colour: BLUE}]});
  } else {
    all.push(gimbals);
  }
  all.push({name: 'Drive torque', unit: 'N m', ring: states, lines: several('drive', 9, rig.drives)});
  if (rig.family === 'umbrella') {
    all.push({name: 'Contact forces', unit: 'N', ring: truths, lines: several('axle', 0, rig.gyros)});
  }
  if (rig.family !== 'gimballed') all.push(gimbals);
  if (rig.tilts) {
    all.push({name: 'Tilt rate', unit: '°/s', ring: states, lines: [
      {label: 'roll', column: 2, colour: BLUE}, ...(rig.tiltsTwoWays ? [{label: 'pitch', column: 3, colour: ORANGE}] : [])]});
    all.push({name: 'Unknown moment (twin)', unit: 'N m', ring: healths, lines: [
      {label: 'about x', column: 1, colour: BLUE}, {label: 'about y', column: 2, colour: ORANGE}]});
  }
  all.push({name: 'Misfit (twin, NIS)', unit: '', ring: healths, lines: [{label: 'NIS', column: 0, colour: PINK}]});
  all.push({name: 'Flywheels', unit: '%', ring: states, lines: several('rotor', 11, rig.gyros)});
  return all;
}

/** What all charts of the page share: the stretch of time, and whether it moves. */
export interface TimeView {
  span: number;                       // [s]
  frozen: [number, number] | null;    // a stretch that stays [s]
}

export class StripChart {
  private plot: uPlot | null = null;
  private quantity: Quantity;
  private readonly body: HTMLElement;
  private told = 0;  // when [ms]

  constructor(parent: HTMLElement, private readonly live: Live, private readonly view: TimeView,
    quantities: Quantity[], first: number, private readonly onFreeze: () => void) {
    const card = document.createElement('section');
    card.className = 'chart';
    const choice = document.createElement('select');
    choice.setAttribute('aria-label', 'What this chart shows');
    quantities.forEach(({name, unit}, i) => choice.add(new Option(unit ? `${name} [${unit}]` : name, String(i))));
    this.body = document.createElement('div');
    this.body.className = 'plot';
    this.body.setAttribute('role', 'figure');
    card.append(choice, this.body);
    parent.append(card);
    this.quantity = quantities[first]!;
    choice.value = String(first);
    choice.onchange = () => {
      this.quantity = quantities[Number(choice.value)]!;
      this.rebuild();
    };
    new ResizeObserver(() => this.resize()).observe(this.body);
    this.rebuild();
  }

  /** Colours of the page may have changed. */
  rebuild(): void {
    this.plot?.destroy();
    const style = getComputedStyle(document.documentElement);
    const ink = style.getPropertyValue('--muted'), grid = style.getPropertyValue('--line');
    const axis = {stroke: ink, grid: {stroke: grid, width: 1}, ticks: {stroke: grid, width: 1, size: 4},
      font: '11px system-ui, sans-serif'};
    const unit = this.quantity.unit;
    this.plot = new uPlot({
      width: Math.max(50, this.body.clientWidth), height: Math.max(50, this.body.clientHeight),
      padding: [8, 10, 0, 0],
      cursor: {drag: {x: true, y: false, setScale: false}, points: {size: 6}, sync: {key: 'strips'}},
      select: {show: true, left: 0, top: 0, width: 0, height: 0},
      scales: {x: {time: false}, y: {range: (_, low, high) => rangeOf(low, high)}},
      axes: [{...axis, size: 22, splits: splitsOf, values: (u, ticks) => ticks.map((t) => ago(u, t))},
        {...axis, size: 50, space: 24}],
      legend: {live: true},
      series: [{label: 'time', value: (u, t) => (t === null ? '' : ago(u, t))},
        ...this.quantity.lines.map(({label, colour, dashed}) => ({label, stroke: colour, width: dashed ? 1.2 : 1.5,
          ...(dashed ? {dash: [4, 4]} : {}), spanGaps: false, points: {show: false},
          value: (u: uPlot, y: number | null, k: number) => reading(y === null || Number.isNaN(y) ? lastOf(u.data[k]!) : y, unit)}))],
      hooks: {setSelect: [(u) => this.zoom(u)]},
    }, [[0], ...this.quantity.lines.map(() => [NaN])] as uPlot.AlignedData, this.body);
    this.plot.over.ondblclick = () => {
      this.view.frozen = null;
      this.onFreeze();
    };
  }

  private zoom(plot: uPlot): void {
    if (plot.select.width < 4) return;
    this.view.frozen = [plot.posToVal(plot.select.left, 'x'), plot.posToVal(plot.select.left + plot.select.width, 'x')];
    plot.setSelect({left: 0, top: 0, width: 0, height: 0}, false);
    this.onFreeze();
  }

  private resize(): void {
    const {clientWidth: width, clientHeight: height} = this.body;
    const legend = this.body.querySelector<HTMLElement>('.u-legend')?.offsetHeight ?? 0;
    if (width > 50 && height > 50) this.plot?.setSize({width, height: Math.max(50, height - legend)});
  }

  /** For who cannot see it: what is between which limits. */
  private tell(lines: Float64Array[]): void {
    const now = performance.now();
    if (now - this.told < 500) return;
    this.told = now;
    // Without a cursor the legend has the newest.
    if ((this.plot!.cursor.left ?? -1) < 0) this.plot!.setLegend({idx: this.plot!.data[0]!.length - 1});
    const {name, unit} = this.quantity;
    const parts = this.quantity.lines.flatMap(({label}, k) => {
      const between = extremes(lines[k]!);
      return between ? [`${label} from ${reading(between[0], unit)} to ${reading(between[1], unit)}`] : [];
    });
    this.body.setAttribute('aria-label', `${name}: ${parts.join(', ') || 'nothing yet'}`);
  }

  draw(): void {
    const plot = this.plot;
    if (!plot || this.body.clientWidth === 0) return;
    const now = this.live.now();
    const [from, to] = this.view.frozen ?? [now - this.view.span, now];
    const pixels = Math.max(50, Math.floor(plot.bbox.width / devicePixelRatio / 1.5));
    const drawn = this.quantity.lines.map((line) =>
      decimate((line.ring ?? this.quantity.ring)(this.live), [line.column], from, to, pixels));
    const times = drawn[0]![0]!, lines = drawn.map(([, values]) => values!);
    this.tell(lines);
    plot.batch(() => {
      plot.setData([times, ...lines.map(blank)] as uPlot.AlignedData, false);
      plot.setScale('x', {min: from, max: to});
    });
  }
}

/** Smallest and largest; null where there is nothing. */
function extremes(values: Float64Array): [number, number] | null {
  let low = Infinity, high = -Infinity;
  for (const value of values) {
    if (value < low) low = value;
    if (value > high) high = value;
  }
  return low <= high ? [low, high] : null;
}

/** Gaps as uPlot wants them. */
function blank(values: Float64Array): (number | null)[] {
  return Array.from(values, (value) => (Number.isNaN(value) ? null : value));
}

/** Never so narrow that noise fills the chart. */
function rangeOf(low: number | null, high: number | null): [number, number] {
  if (low === null || high === null || !Number.isFinite(low) || !Number.isFinite(high)) return [-1, 1];
  const room = Math.max(0.12 * (high - low), 0.02 * Math.max(Math.abs(low), Math.abs(high)), 0.02);
  return [low - room, high + room];
}

/** From the right edge back in round steps. */
function splitsOf(plot: uPlot): number[] {
  const {min, max} = plot.scales['x']!;
  if (min === undefined || max === undefined) return [];
  const most = Math.max(2, plot.bbox.width / devicePixelRatio / 60);
  const step = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 30].find((each) => (max - min) / each <= most) ?? 60;
  const splits = [];
  for (let t = max; t >= min; t -= step) splits.unshift(t);
  return splits;
}

function reading(value: number | null, unit: string): string {
  if (value === null) return '–';
  const text = Math.abs(value) >= 1000 ? value.toFixed(0) : Math.abs(value) < 5e-4 ? '0' : value.toPrecision(3);
  return unit ? `${text} ${unit}` : text;
}

function lastOf(values: ArrayLike<number | null | undefined>): number | null {
  for (let i = values.length - 1; i >= 0; --i) {
    const value = values[i];
    if (value !== null && value !== undefined && !Number.isNaN(value)) return value;
  }
  return null;
}

function ago(plot: uPlot, time: number): string {
  const end = plot.scales['x']!.max ?? time;
  const before = time - end;
  return Math.abs(before) < 1e-9 ? '0 s' : `${before.toFixed(Number.isInteger(Math.round(before * 100) / 100) ? 0 : 2)} s`;
}
