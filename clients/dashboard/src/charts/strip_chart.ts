// One strip chart: a choice of quantities over the last seconds; zoom, and readings under the cursor.
import uPlot from 'uplot';

import {el, say} from '../dom';
import type {Live} from '../live';
import {seriesColour} from '../palette';
import {ago, extremes, lastOf, marks, rangeOf, reading, splitsOf} from './axes';
import {bridged, decimate} from './decimate';
import type {Quantity} from './quantities';

/** What all charts of the page share: the stretch of time, and whether it moves. */
export interface TimeView {
  span: number;                       // [s]
  frozen: [number, number] | null;    // a stretch that stays [s]
}

const TELL_EVERY = 500;  // [ms]
const BREAK = 0.25;      // where nothing came for longer, the line breaks [s]

export class StripChart {
  private plot: uPlot | null = null;
  private quantity: Quantity;
  private readonly body = el('div', {class: 'plot', role: 'figure'});
  private readonly when = el('span', {class: 'reading-when'});
  private readonly readings = el('div', {class: 'readings'});
  private values: HTMLElement[] = [];
  private told = 0;  // when [ms]

  constructor(parent: HTMLElement, private readonly live: Live, private readonly view: TimeView,
    quantities: Quantity[], first: number, private readonly onFreeze: () => void) {
    const choice = el('select', {'aria-label': `What chart ${first + 1} shows`});
    quantities.forEach(({name, unit}, i) => choice.add(new Option(unit ? `${name}, ${unit}` : name, String(i))));
    parent.append(el('section', {class: 'chart', 'aria-label': `Chart ${first + 1}`}, el('div', {class: 'chart-head'}, choice, this.when),
      this.readings, this.body));
    this.quantity = quantities[first] ?? quantities[0]!;
    choice.value = String(quantities.indexOf(this.quantity));
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
    const ink = style.getPropertyValue('--muted'), grid = style.getPropertyValue('--grid');
    const axis = {stroke: ink, grid: {stroke: grid, width: 1}, ticks: {show: false}, font: '11px system-ui, sans-serif'};
    this.plot = new uPlot({
      width: Math.max(50, this.body.clientWidth), height: Math.max(50, this.body.clientHeight),
      padding: [6, 12, 0, 0],
      cursor: {drag: {x: true, y: false, setScale: false}, points: {size: 6}, sync: {key: 'strips'}},
      select: {show: true, left: 0, top: 0, width: 0, height: 0},
      scales: {x: {time: false}, y: {range: (_, low, high) => rangeOf(low, high, this.quantity.least)}},
      axes: [{...axis, size: 24, gap: 4, splits: splitsOf, values: (u, ticks) => ticks.map((t) => ago(u, t))},
        {...axis, size: 46, gap: 4, space: 28, values: (_, ticks, __, ___, step) => marks(ticks, step)}],
      legend: {show: false},
      series: [{}, ...this.quantity.lines.map(({label, colour, twin}) => ({label, stroke: `${seriesColour(colour)}${twin ? '59' : ''}`,
        width: twin ? 5 : 1.5, spanGaps: false, points: {show: false}}))],
      hooks: {setSelect: [(u) => this.zoom(u)], setCursor: [() => this.read()]},
    }, [[0], ...this.quantity.lines.map(() => [null])] as uPlot.AlignedData, this.body);
    this.plot.over.ondblclick = () => {
      this.view.frozen = null;
      this.onFreeze();
    };
    const shown = this.quantity.lines.filter(({twin}) => !twin);
    this.values = shown.map(() => el('span', {class: 'reading-value'}));
    this.readings.replaceChildren(...shown.map(({label, colour}, i) => el('span', {class: 'reading'},
      el('i', {style: `background: var(--series-${colour % 4})`}), el('span', {}, label), this.values[i]!)),
    ...(shown.length < this.quantity.lines.length ? [el('span', {class: 'reading'}, el('i', {class: 'band'}), el('span', {}, 'band: twin'))] : []));
  }

  private zoom(plot: uPlot): void {
    if (plot.select.width < 4) return;
    this.view.frozen = [plot.posToVal(plot.select.left, 'x'), plot.posToVal(plot.select.left + plot.select.width, 'x')];
    plot.setSelect({left: 0, top: 0, width: 0, height: 0}, false);
    this.onFreeze();
  }

  private resize(): void {
    const {clientWidth: width, clientHeight: height} = this.body;
    if (width > 50 && height > 50) this.plot?.setSize({width, height});
  }

  /** What is under the cursor; without one, the newest. */
  private read(): void {
    const plot = this.plot;
    if (!plot) return;
    const over = (plot.cursor.left ?? -1) >= 0 ? plot.cursor.idx ?? null : null;
    say(this.when, over === null ? '' : `at ${ago(plot, plot.data[0]![over]!, 3)}`);
    let shown = 0;
    this.quantity.lines.forEach(({twin}, k) => {
      if (twin) return;
      const values = plot.data[k + 1]!;
      say(this.values[shown++]!, reading(over === null ? lastOf(values) : values[over] ?? null));
    });
  }

  /** For who cannot see it: what is between which limits. */
  private tell(lines: (number | null | undefined)[][]): void {
    const now = performance.now();
    if (now - this.told < TELL_EVERY) return;
    this.told = now;
    this.read();
    const {name, unit} = this.quantity;
    const parts = this.quantity.lines.flatMap(({label}, k) => {
      const between = extremes(lines[k]!);
      return between ? [`${label} from ${reading(between[0])} ${unit} to ${reading(between[1])} ${unit}`] : [];
    });
    this.body.setAttribute('aria-label', `${name}: ${parts.join(', ') || 'nothing yet'}`);
  }

  draw(): void {
    const plot = this.plot;
    if (!plot || this.body.clientWidth === 0) return;
    const now = this.live.now();
    const [from, to] = this.view.frozen ?? [now - this.view.span, now];
    const pixels = Math.max(50, Math.floor(plot.bbox.width / devicePixelRatio / 1.5));
    let times: Float64Array | null = null;
    const lines = this.quantity.lines.map((line) => {
      const [at, values] = decimate((line.ring ?? this.quantity.ring)(this.live), [line.column], from, to, pixels);
      times ??= at!;
      return bridged(at!, values!, BREAK);
    });
    plot.batch(() => {
      plot.setData([times!, ...lines] as uPlot.AlignedData, false);
      plot.setScale('x', {min: from, max: to});
    });
    this.tell(lines);
  }
}
