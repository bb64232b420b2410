// Who runs, how punctual, and what was lost.
import {card, el, put, say} from '../dom';
import {DAEMONS, type Live} from '../live';
import {MODES, type Status} from '../messages';
import {duration} from '../units';

const SILENT = 1;  // [s]

class Row {
  readonly element: HTMLElement;
  private readonly mode = el('span', {class: 'daemon-mode'});
  private readonly where = el('span', {class: 'daemon-where'});
  private readonly facts = el('dl', {class: 'daemon-facts'});
  private readonly values = new Map<string, HTMLElement>();

  constructor(name: string) {
    this.element = el('li', {class: 'daemon'}, el('div', {class: 'daemon-head'}, el('strong', {}, name), this.mode, this.where), this.facts);
  }

  show(status: Status, age: number): void {
    const gone = age > SILENT;
    put(this.element, 'data-gone', String(gone));
    say(this.mode, gone ? `✕ silent for ${age.toFixed(0)} s` : `✓ ${MODES[status.mode] ?? status.mode}`);
    say(this.where, `${status.pid} on ${status.host}`);
    const late = status.lateness_max_ns > 0n
      ? `${duration(status.lateness_p50_ns)} / ${duration(status.lateness_p99_ns)} / ${duration(status.lateness_max_ns)}` : '–';
    const works = status.compute_max_ns > 0n
      ? `${duration(status.compute_p50_ns)} / ${duration(status.compute_p99_ns)} / ${duration(status.compute_max_ns)}` : '–';
    const gaps = status.gaps.reduce((sum, gap) => sum + gap, 0n);
    this.fact('Late, p50 / p99 / max', late);
    this.fact('Works, p50 / p99 / max', works);
    const refused = status.malformed + status.unauthentic;
    this.fact('Lost', `${gaps} never came, ${status.kernel_dropped} dropped by the kernel${
      status.overruns > 0n ? `, ${status.overruns} overruns` : ''}${refused > 0n ? `, ${refused} refused` : ''}`);
  }

  private fact(name: string, text: string): void {
    let value = this.values.get(name);
    if (!value) {
      value = el('dd');
      this.values.set(name, value);
      this.facts.append(el('div', {}, el('dt', {}, name), value));
    }
    say(value, text);
  }
}

export class Daemons {
  readonly element: HTMLElement;
  private readonly rows = new Map<string, Row>();
  private readonly list = el('ul', {class: 'daemons', tabindex: '0', 'aria-label': 'Daemons'});
  private readonly none = el('p', {class: 'numbers'}, 'no daemon is heard');
  private readonly here = el('p', {class: 'numbers'});
  private readonly link = el('p', {class: 'numbers'});

  constructor(private readonly live: Live) {
    this.element = card('Daemons', this.here, this.none, this.list, this.link);
  }

  draw(): void {
    const {lost} = this.live, rate = Math.round(this.live.rate);
    say(this.here, `this page: ${rate} states a second, ${lost} never came here${lost > 0 ? ' (a slow page or line)' : ''}`);
    for (const topic of DAEMONS) {
      const heard = this.live.status.get(topic);
      if (!heard) continue;
      let row = this.rows.get(topic);
      if (!row) {
        row = new Row(topic.slice(0, topic.indexOf('/')).toLowerCase());
        this.rows.set(topic, row);
        this.list.append(row.element);
        this.none.hidden = true;
      }
      row.show(heard.value, this.live.age(heard));
    }
    const link = this.live.age(this.live.link) < 2 ? this.live.link!.value : null;
    this.link.hidden = !link;
    if (link) {
      say(this.link, `line to the rig: ${link.connected ? 'connected' : `not connected: ${link.text}`}, ` +
        `round trip ${duration(link.round_trip_p50_ns)} (max ${duration(link.round_trip_max_ns)}), ` +
        `${link.samples_missed} samples missed, ${link.host_bad} bad frames, ${link.reconnects} reconnects`);
    }
  }
}
