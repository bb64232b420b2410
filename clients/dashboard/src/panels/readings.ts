// How much is left before something gives, whether the twin agrees, and what comes next: in words.
import {card, el, put, say} from '../dom';
import type {Live} from '../live';
import {FALLEN, SENSORS, SENSOR_VERDICTS, VALID, seconds} from '../messages';
import {degrees, tiltOf} from '../rig';

type Room = 'fine' | 'close' | 'gone' | 'unknown';
const WORDS: Record<Room, string> = {fine: 'fine', close: 'little left', gone: 'none left', unknown: '–'};
const MARKS: Record<Room, string> = {fine: '✓', close: '▲', gone: '✕', unknown: '·'};

function room(left: number, whole: number, close: number): Room {
  if (!Number.isFinite(left) || whole <= 0) return 'unknown';
  if (left <= 1e-3 * whole) return 'gone';
  return left < close * whole ? 'close' : 'fine';
}

/** A line: name, bar of what is used, number, word. */
class Gauge {
  readonly row: HTMLElement;
  private readonly bar = el('span', {class: 'gauge-used'});
  private readonly number = el('span', {class: 'gauge-number'});
  private readonly word = el('span', {class: 'gauge-word'});

  constructor(name: string) {
    this.row = el('div', {class: 'gauge'}, el('span', {class: 'gauge-name'}, name),
      el('span', {class: 'gauge-bar', 'aria-hidden': 'true'}, this.bar), this.number, this.word);
  }

  show(left: number, whole: number, close: number, text: string): void {
    const is = room(left, whole, close);
    put(this.row, 'data-room', is);
    this.bar.style.width = is === 'unknown' ? '0' : `${Math.min(100, Math.max(0, 100 * (1 - left / whole)))}%`;
    say(this.number, text);
    say(this.word, `${MARKS[is]} ${WORDS[is]}`);
  }
}

export class Readings {
  readonly margins: HTMLElement;
  readonly twin: HTMLElement;
  private readonly tilt = new Gauge('Tilt');
  private readonly gimbal = new Gauge('Gimbals');
  private readonly drive = new Gauge('Drives');
  private readonly rotor = new Gauge('Flywheels');
  private readonly verdict = el('p', {class: 'verdict', role: 'status'});
  private readonly sensors = el('ul', {class: 'sensors', 'aria-label': 'Sensors'});
  private readonly forecast = el('p', {class: 'verdict'});
  private readonly numbers = el('p', {class: 'numbers'});

  constructor(private readonly live: Live) {
    this.margins = card('What is left', this.tilt.row, this.gimbal.row, this.drive.row, this.rotor.row);
    this.twin = card('Twin', this.verdict, this.forecast, this.numbers, this.sensors);
  }

  draw(): void {
    this.drawMargins();
    this.drawTwin();
  }

  private drawMargins(): void {
    const {live} = this;
    const rig = live.rig, state = live.stale ? null : live.state?.value;
    if (!rig || !state) {
      for (const gauge of [this.tilt, this.gimbal, this.drive, this.rotor]) gauge.show(NaN, 0, 0, '');
      return;
    }
    this.tilt.row.hidden = !rig.tilts;
    const lean = tiltOf(state.tilt_rad);
    this.tilt.show(rig.fallTilt - lean, rig.fallTilt, 0.5, `${degrees(lean).toFixed(1)}° of ${degrees(rig.fallTilt).toFixed(0)}°`);
    const [low, high] = rig.stops;
    const left = Math.min(...Array.from({length: rig.gyros}, (_, j) => rig.stopMargin(state.gimbal_angle_rad[j] ?? 0)));
    this.gimbal.show(left, 0.5 * (high - low), 0.2, `${degrees(left).toFixed(1)}° to the stop`);
    const truth = live.age(live.truth) < 1 ? live.truth!.value : null;
    const torque = Math.max(...Array.from({length: rig.drives}, (_, i) => Math.abs(state.drive_torque_nm[i] ?? 0)));
    const spare = truth
      ? Math.min(...Array.from({length: rig.drives}, (_, i) => truth.drive_margin_nm[i] ?? 0)) : rig.torqueLimit - torque;
    this.drive.show(spare, Math.max(rig.torqueLimit, spare), 0.2, `${torque.toPrecision(3)} N m, ${spare.toPrecision(3)} left`);
    const share = Math.min(...Array.from({length: rig.gyros}, (_, j) => Math.abs(state.rotor_speed_rad_s[j] ?? 0))) / rig.nominalSpeed;
    const known = (state.valid & VALID.rotors) !== 0;
    this.rotor.show(known ? share - 0.5 : NaN, 0.5, 0.8, known ? `${(100 * share).toFixed(0)} % of their speed` : '');
  }

  private drawTwin(): void {
    const {live} = this;
    const health = live.age(live.health) < 1 ? live.health!.value : null;
    const mood = !health || health.verdict === 0 ? 'unknown' : health.verdict === 1 ? 'fine' : 'gone';
    put(this.verdict, 'data-room', mood);
    say(this.verdict, !health ? '· no twin is heard: gyrotwin mirror'
      : `${mood === 'fine' ? '✓' : mood === 'gone' ? '✕' : '·'} ${health.text || 'settling'}`);
    const forecast = live.age(live.forecast) < 1 && live.mode !== FALLEN ? live.forecast!.value : null;
    this.forecast.hidden = !forecast;
    if (forecast) {
      const falls = forecast.outcome === 2;
      put(this.forecast, 'data-room', falls ? 'gone' : 'fine');
      say(this.forecast, falls ? `✕ falls in ${seconds(forecast.falls_in_ns).toFixed(2)} s`
        : `✓ stands for the next ${seconds(forecast.horizon_ns).toFixed(0)} s, peak ${degrees(forecast.peak_tilt_rad).toFixed(1)}° in ${seconds(forecast.peak_in_ns).toFixed(2)} s`);
    }
    this.numbers.hidden = !health || health.verdict === 0;
    if (!health) {
      this.sensors.replaceChildren();
      return;
    }
    const [mx, my] = [health.external_moment_nm[0]!, health.external_moment_nm[1]!];
    say(this.numbers, `unknown moment ${mx.toFixed(2)}, ${my.toFixed(2)} N m · misfit ${health.nis_total.toFixed(2)} (1 is right)`);
    const chips = SENSORS.flatMap((name, i) => {
      const verdict = health.sensor_verdict[i] ?? 0;
      return verdict === 0 ? [] : [`${verdict === 1 ? '✓' : '✕'} ${name}${verdict === 1 ? '' : ` ${SENSOR_VERDICTS[verdict]}`}`];
    });
    if (this.sensors.textContent !== chips.join('')) {
      this.sensors.replaceChildren(...chips.map((chip) => el('li', {'data-room': chip.startsWith('✓') ? 'fine' : 'gone'}, chip)));
    }
  }
}
