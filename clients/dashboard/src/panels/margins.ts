// How much is left before something gives, in numbers and words.
import {card, el, put, say} from '../dom';
import type {Live} from '../live';
import {FAULT, VALID} from '../messages';
import {degrees, tiltOf} from '../rig';
import {amount} from '../units';

export type Room = 'fine' | 'close' | 'gone' | 'unknown';
export const WORDS: Record<Room, string> = {fine: 'fine', close: 'little left', gone: 'none left', unknown: 'unknown'};
export const MARKS: Record<Room, string> = {fine: '✓', close: '▲', gone: '✕', unknown: '·'};
const ORDER: readonly Room[] = ['unknown', 'fine', 'close', 'gone'];
// Less than this share of the whole is little.
const LITTLE = {tilt: 0.5, gimbals: 0.2, drives: 0.2, flywheels: 0.8};

/** @param little share of `whole` below which `left` is little */
export function room(left: number, whole: number, little: number): Room {
  if (!Number.isFinite(left) || whole <= 0) return 'unknown';
  if (left <= 1e-3 * whole) return 'gone';
  return left < little * whole ? 'close' : 'fine';
}

/** A line: name, bar of what is used, number, word. */
class Gauge {
  readonly row: HTMLElement;
  is: Room = 'unknown';
  private readonly bar = el('span', {class: 'gauge-used'});
  private readonly number = el('span', {class: 'gauge-number'});
  private readonly word = el('span', {class: 'gauge-word'});

  constructor(readonly name: string) {
    this.row = el('div', {class: 'gauge'}, el('span', {class: 'gauge-name'}, name),
      el('span', {class: 'gauge-bar', 'aria-hidden': 'true'}, this.bar), this.number, this.word);
  }

  show(left: number, whole: number, little: number, text: string): void {
    this.is = room(left, whole, little);
    put(this.row, 'data-room', this.is);
    this.bar.style.width = this.is === 'unknown' ? '0' : `${Math.min(100, Math.max(0, 100 * (1 - left / whole)))}%`;
    say(this.number, text);
    say(this.word, `${MARKS[this.is]} ${WORDS[this.is]}`);
  }
}

export class Margins {
  readonly element: HTMLElement;
  private readonly tilt = new Gauge('Tilt');
  private readonly gimbal = new Gauge('Gimbals');
  private readonly drive = new Gauge('Drives');
  private readonly rotor = new Gauge('Flywheels');
  private readonly all = [this.tilt, this.gimbal, this.drive, this.rotor];

  constructor(private readonly live: Live) {
    this.element = card('Margins', ...this.all.map(({row}) => row));
    this.element.dataset['group'] = 'state';
  }

  /** The least of them. */
  get worst(): {is: Room; name: string} {
    return this.all.reduce<{is: Room; name: string}>((worst, {is, name}) =>
      (ORDER.indexOf(is) > ORDER.indexOf(worst.is) ? {is, name} : worst), {is: 'unknown', name: ''});
  }

  draw(): void {
    const {live} = this;
    const rig = live.rig, state = live.stale || live.mode === FAULT ? null : live.state?.value;
    if (!rig || !state) {
      for (const gauge of this.all) gauge.show(NaN, 0, 0, '');
      return;
    }
    this.tilt.row.hidden = !rig.tilts;
    const lean = tiltOf(state.tilt_rad);
    this.tilt.show(rig.tilts && state.valid & VALID.tilt ? rig.fallTilt - lean : NaN, rig.fallTilt, LITTLE.tilt,
      `${degrees(lean).toFixed(1)}° of ${degrees(rig.fallTilt).toFixed(0)}°`);
    const [low, high] = rig.stops;
    const left = Math.min(...Array.from({length: rig.gyros}, (_, j) => rig.stopMargin(state.gimbal_angle_rad[j] ?? 0)));
    this.gimbal.show(state.valid & VALID.gimbals ? left : NaN, 0.5 * (high - low), LITTLE.gimbals,
      left < 0 ? `${degrees(-left).toFixed(1)}° beyond` : `${degrees(left).toFixed(1)}° left`);
    const truth = live.age(live.truth) < 1 ? live.truth!.value : null;
    // The drive with the smallest share left.
    let spare = NaN, whole = 0;
    for (let i = 0; i < rig.drives; ++i) {
      const used = Math.abs(state.drive_torque_nm[i] ?? 0);
      const more = truth ? truth.drive_margin_nm[i] ?? 0 : Math.max(0, rig.torqueLimit - used), of = more + used || rig.torqueLimit;
      if (i > 0 && more / of >= spare / whole) continue;
      [spare, whole] = [more, of];
    }
    this.drive.show(spare, whole, LITTLE.drives, `${amount(spare)} N m left`);
    const known = (state.valid & VALID.rotors) !== 0 && rig.nominalSpeed !== 0;
    const share = Math.min(...Array.from({length: rig.gyros}, (_, j) => Math.abs(state.rotor_speed_rad_s[j] ?? 0))) / Math.abs(rig.nominalSpeed);
    this.rotor.show(known ? Math.min(share, 1) : NaN, 1, LITTLE.flywheels, known ? `${(100 * share).toFixed(0)} %` : '');
  }
}
