// Whether the twin agrees with the rig, who is to blame, and what comes next: in words.
import {card, el, put, say} from '../dom';
import type {Live} from '../live';
import {FALLEN, FALLS, FAULT, type Forecast, SENSORS, SENSOR_VERDICTS, seconds} from '../messages';
import {degrees} from '../rig';
import {amount} from '../units';

/** "stands; peak 4.1° in 0.30 s" */
export function outlook(forecast: Forecast): {falls: boolean; text: string} {
  const falls = forecast.outcome === FALLS;
  const angle = `${degrees(forecast.peak_tilt_rad).toFixed(1)}°`, when = seconds(forecast.peak_in_ns);
  return {falls, text: falls ? `FALLS in ${seconds(forecast.falls_in_ns).toFixed(2)} s`
    : when < 0.05 ? `stands; peak ${angle}, now` : `stands; peak ${angle} in ${when.toFixed(2)} s`};
}

/** The newest that still says something; null: none. */
export function forecastOf(live: Live): Forecast | null {
  return live.age(live.forecast) < 1 && live.mode !== FALLEN && !live.stale && live.rig?.tilts ? live.forecast!.value : null;
}

export class Twin {
  readonly element: HTMLElement;
  private readonly verdict = el('p', {class: 'verdict', role: 'status'});
  private readonly outlook = el('span');
  private readonly more = el('span', {class: 'numbers'});
  private readonly forecast = el('p', {class: 'verdict'}, this.outlook, ' ', this.more);
  private readonly numbers = el('p', {class: 'numbers'});
  private readonly sensors = el('ul', {class: 'sensors', 'aria-label': 'Sensors'});

  constructor(private readonly live: Live) {
    this.element = card('Twin', this.verdict, this.forecast, this.sensors, this.numbers);
    this.element.dataset['group'] = 'state';
  }

  draw(): void {
    this.drawForecast();
    const {live} = this;
    const health = live.age(live.health) < 1 && !live.stale ? live.health!.value : null;
    const mood = !health || health.verdict === 0 ? 'unknown' : health.verdict === 1 ? 'fine' : 'gone';
    put(this.verdict, 'data-room', mood);
    say(this.verdict, !health ? absence(live)
      : `${mood === 'fine' ? '✓' : mood === 'gone' ? '✕' : '·'} ${mood === 'fine' ? `The rig is as the model says${said(health.text)}`
        : health.text || 'settling'}`);
    this.numbers.hidden = !health || health.verdict === 0;
    if (!health) {
      this.sensors.replaceChildren();
      return;
    }
    const [mx, my] = [health.external_moment_nm[0]!, health.external_moment_nm[1]!];
    say(this.numbers, `misfit ${health.nis_total.toFixed(2)}, 1 is right · unknown moment ${amount(mx, 2)}, ${amount(my, 2)}\u00a0N\u00a0m`);
    const chips = SENSORS.flatMap((name, i) => {
      const verdict = health.sensor_verdict[i] ?? 0;
      return verdict === 0 ? [] : [`${verdict === 1 ? '✓' : '✕'} ${name}${verdict === 1 ? '' : `: ${SENSOR_VERDICTS[verdict]}`}`];
    });
    if (this.sensors.textContent !== chips.join('')) {
      this.sensors.replaceChildren(...chips.map((chip) => el('li', {'data-room': chip.startsWith('✓') ? 'fine' : 'gone'}, chip)));
    }
  }

  private drawForecast(): void {
    const forecast = forecastOf(this.live);
    this.forecast.hidden = !forecast;
    if (!forecast) return;
    const {falls, text} = outlook(forecast);
    put(this.forecast, 'data-room', falls ? 'gone' : 'fine');
    say(this.outlook, `${falls ? '✕' : '✓'} ${falls ? text : text.replace('stands', 'Stands')}`);
    const full = seconds(forecast.saturates_in_ns);
    say(this.more, [`next ${seconds(forecast.horizon_ns).toFixed(0)} s ${forecast.law ? 'with its law' : 'with its drives in their safe stop'}`,
      ...(forecast.fall_probability > 0.005 ? [`falls with ${(100 * forecast.fall_probability).toFixed(0)} %`] : []),
      ...(full >= 0 ? [full < 0.05 ? 'a drive is at its limit' : `a drive reaches its limit in ${full.toFixed(2)} s`] : [])].join(' · '));
  }
}

/** Why nothing is known of it. */
function absence(live: Live): string {
  if (live.stale) return '· unknown';
  return live.mode === FAULT ? '· waits: the rig is in FAULT' : '· no twin is heard: start gyrotwin mirror';
}

/** What the mirror adds to its "agrees". */
function said(text: string): string {
  const more = text.replace(/^agrees[;,]?\s*/, '');
  return more ? `; ${more}` : '';
}
