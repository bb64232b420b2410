// Who runs, how punctual, and what was lost.
import {card, duration, el, say} from '../dom';
import {DAEMONS, type Live} from '../live';
import {MODES} from '../messages';

const COLUMNS = ['service', 'mode', 'late p50 / p99 / max', 'works p50 / max', 'lost', 'heard'];

export class Daemons {
  readonly element: HTMLElement;
  private readonly body = el('tbody');
  private readonly link = el('p', {class: 'numbers'});

  constructor(private readonly live: Live) {
    this.element = card('Daemons', el('div', {class: 'scrolls', tabindex: '0', role: 'region', 'aria-label': 'Daemons'}, el('table', {},
      el('thead', {}, el('tr', {}, ...COLUMNS.map((name) => el('th', {scope: 'col'}, name)))), this.body)), this.link);
  }

  draw(): void {
    const rows = DAEMONS.flatMap((topic) => {
      const heard = this.live.status.get(topic);
      if (!heard) return [];
      const {value} = heard, age = this.live.age(heard), gone = age > 1;
      const lost = value.gaps.reduce((sum, gap) => sum + gap, 0n) + value.kernel_dropped;
      const late = value.lateness_max_ns > 0n
        ? `${duration(value.lateness_p50_ns)} / ${duration(value.lateness_p99_ns)} / ${duration(value.lateness_max_ns)}` : '';
      const works = value.compute_max_ns > 0n ? `${duration(value.compute_p50_ns)} / ${duration(value.compute_max_ns)}` : '';
      return [{gone, cells: [topic.slice(0, topic.indexOf('/')).toLowerCase(), gone ? '? silent' : MODES[value.mode] ?? '', late, works,
        String(lost), `${value.pid} on ${value.host}, ${gone ? `${age.toFixed(0)} s ago` : 'now'}`]}];
    });
    while (this.body.rows.length > rows.length) this.body.deleteRow(-1);
    rows.forEach(({gone, cells}, i) => {
      const row = this.body.rows[i] ?? this.body.insertRow();
      row.classList.toggle('gone', gone);
      cells.forEach((text, k) => say(row.cells[k] ?? row.insertCell(), text));
    });
    const link = this.live.age(this.live.link) < 2 ? this.live.link!.value : null;
    this.link.hidden = !link;
    if (link) {
      say(this.link, `line to the rig: ${link.connected ? 'connected' : `not connected: ${link.text}`}, ` +
        `round trip ${duration(link.round_trip_p50_ns)} (max ${duration(link.round_trip_max_ns)}), ` +
        `${link.samples_missed} samples missed, ${link.host_bad} bad frames, ${link.reconnects} reconnects`);
    }
  }
}
