// The line across the top and what lies over the platform: mode, tilt, outlook, and how fresh all that is.
import {put, say} from '../dom';
import type {Live} from '../live';
import {FALLEN, FAULT, MODES, MODE_WORDS, SAFE_STOP, VALID} from '../messages';
import {degrees, tiltOf} from '../rig';
import {MARKS, type Margins, WORDS} from './margins';
import {forecastOf, outlook} from './twin';

const byId = <T extends HTMLElement>(id: string): T => document.getElementById(id) as T;

const BANNER_FROM = 3;  // what is late by more must not be overlooked [s]

/** What is wrong with the data, old or late, in words; '': nothing. */
export function troubleWords(live: Live): string {
  if (!live.stale) return live.late > BANNER_FROM ? `This browser or its line is too slow: what is shown comes ${live.late.toFixed(0)} s late, with gaps.` : '';
  if (!live.connected) {
    return live.everConnected ? 'The connection to the gateway is lost; trying again. What is shown is old.' : 'Connecting to the gateway…';
  }
  const age = live.age(live.state);
  return Number.isFinite(age) ? `No data for ${age.toFixed(0)} s: what is shown is old. Does the owner of the rig still run?`
    : 'No owner of the rig is heard: start gyrotwin integrator or gyrotwin hardware.';
}

export class Head {
  private readonly born = performance.now();

  constructor(private readonly live: Live, private readonly margins: Margins) {}

  draw(): void {
    this.drawMode();
    this.drawReadout();
    const words = troubleWords(this.live), banner = byId('banner');
    // Nobody needs to be warned of the first half second.
    const shown = words !== '' && performance.now() - this.born > 1500;
    banner.hidden = !shown;
    if (shown) say(banner, words);
    this.drawCall(shown && this.live.stale);
  }

  private drawMode(): void {
    const {live} = this;
    const owner = live.owner?.value, stale = live.stale, mode = byId('mode');
    say(mode, stale ? 'NO DATA' : owner ? MODES[owner.mode] ?? '' : '…');
    put(mode, 'data-mode', stale ? 'stale' : String(owner?.mode ?? ''));
    say(byId('why'), stale || !owner ? '' : owner.text || (MODE_WORDS[owner.mode] ?? ''));
    const plant = byId('plant');
    plant.hidden = !owner;
    say(plant, live.isReal ? 'real rig' : 'simulated');
    const link = byId('link');
    put(link, 'data-room', !live.connected ? 'gone' : stale || live.late || live.gaps ? 'close' : 'fine');
    const rate = live.rate >= 100 ? Math.round(live.rate / 10) * 10 : Math.round(live.rate);
    say(link, !live.connected ? '✕ offline' : stale ? '▲ connected, no data' : live.late ? `▲ ${live.late.toFixed(1)} s late, with gaps`
      : live.gaps ? `▲ live with gaps, ${rate}/s` : `✓ live, ${rate}/s`);
    link.title = `${live.isOperator ? 'operator' : 'observer'} of ${live.prefix}; states a second that come here; with gaps where this browser or its line is too slow`;
  }

  private drawReadout(): void {
    const {live} = this;
    const state = live.stale ? null : live.state?.value, tilts = live.rig?.tilts ?? true;
    const known = state && (tilts ? state.valid & VALID.tilt : state.valid & VALID.gimbals);
    say(byId('lean-name'), tilts ? 'tilt' : 'elevation');
    say(byId('lean'), known ? `${degrees(tilts ? tiltOf(state.tilt_rad) : state.gimbal_angle_rad[0] ?? 0).toFixed(2).replace('-', '−')}°` : '–');
    say(byId('clock'), live.state ? `${(Number(live.state.value.header.sim_time_ns) * 1e-9).toFixed(1)} s` : '–');
    const forecast = forecastOf(live), chip = byId('chip-forecast');
    chip.hidden = !forecast || !tilts;
    if (forecast) {
      const {falls, text} = outlook(forecast);
      put(chip, 'data-room', falls ? 'gone' : 'fine');
      say(chip, `${falls ? '✕' : '✓'} ${text}`);
    }
    const {is, name} = this.margins.worst, margin = byId('chip-margin');
    margin.hidden = is === 'unknown';
    put(margin, 'data-room', is);
    say(margin, is === 'fine' ? `${MARKS.fine} margins fine` : `${MARKS[is]} ${name.toLowerCase()}: ${WORDS[is]}`);
  }

  /** What must not be missed, over the platform. */
  private drawCall(stale: boolean): void {
    const {live} = this;
    const call = byId('call'), mode = live.mode, age = live.age(live.state);
    let text = '';
    if (stale) text = Number.isFinite(age) ? `No data for ${age.toFixed(0)} s` : 'No data';
    else if (mode === FALLEN) text = 'Fallen: reset, then arm';
    else if (mode === SAFE_STOP) text = 'Safe stop: reset, then arm';
    else if (mode === FAULT) text = 'Fault: reset, then arm';
    call.hidden = text === '';
    put(call, 'data-room', stale ? 'unknown' : 'gone');
    if (text) say(call, text);
  }
}
