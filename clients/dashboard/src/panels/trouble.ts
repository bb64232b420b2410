// Disturbances and faults that an operator chooses.
import {card, el} from '../dom';
import type {Live} from '../live';
import {RUNNING, SAFE_STOP} from '../messages';
import {type Request, SENSOR_BITS, commandLost, gust, load, rotorLoss, sensorFault, sine, verb, weakDrive} from '../requests';

interface Trouble {
  name: string;
  of: (live: Live, share: number, duration: number) => Request;
  scaled?: string;  // what the strength means
  timed: boolean;
}

/** A moment that is felt: the reference push spread over a second. */
const moment = (live: Live, share: number) => share * (live.rig?.impulse ?? 1);
const TROUBLES: Trouble[] = [
  {name: 'Step moment (roll)', of: (live, s, d) => load(moment(live, s), 0, d), scaled: 'moment', timed: true},
  {name: 'Step moment (pitch)', of: (live, s, d) => load(0, moment(live, s), d), scaled: 'moment', timed: true},
  {name: 'Sine, 1 Hz (roll)', of: (live, s, d) => sine(moment(live, s), 0, 1, d), scaled: 'moment', timed: true},
  {name: 'Gust', of: (live, s, d) => gust(moment(live, 0.5 * s), moment(live, 0.5 * s), d, 1 + Math.floor(1e6 * Math.random())), scaled: 'moment', timed: true},
  ...Object.keys(SENSOR_BITS).map((sensor) => ({name: `Fault: ${sensor} stuck`, timed: true,
    of: (_: Live, __: number, d: number) => sensorFault('SENSOR_STUCK', sensor, d)})),
  {name: 'Fault: gyro silent', of: (_, __, d) => sensorFault('SENSOR_DROPPED', 'gyro', d), timed: true},
  {name: 'Fault: drives at half', of: (_, __, d) => weakDrive(0.5, d), timed: true},
  {name: 'Fault: flywheel 0 unpowered', of: () => rotorLoss(0, 0), timed: false},
  {name: 'Fault: commands lost', of: (_, __, d) => commandLost(d), timed: true},
];

export class TroublePanel {
  readonly element: HTMLElement;
  private readonly kind = el('select', {'aria-label': 'Disturbance or fault', onchange: () => this.fit()});
  private readonly share = el('input', {type: 'number', min: '0.1', max: '5', step: '0.1', value: '0.5', 'aria-label': 'Strength, in reference pushes a second'});
  private readonly duration = el('input', {type: 'number', min: '0.1', max: '60', step: '0.1', value: '2', 'aria-label': 'Duration in seconds'});
  private readonly go = el('button', {type: 'button', onclick: () => this.cause()}, 'Cause it');
  private readonly clear = el('button', {type: 'button', onclick: () => this.live.ask(verb('CLEAR'), 'clear')}, 'End all');
  private readonly strength = el('label', {class: 'field'}, 'Strength', this.share);

  constructor(private readonly live: Live) {
    TROUBLES.forEach(({name}, i) => this.kind.add(new Option(name, String(i))));
    this.element = card('Disturb', el('div', {class: 'fields'}, el('label', {class: 'field wide'}, 'What', this.kind), this.strength,
      el('label', {class: 'field'}, 'For [s]', this.duration)), el('div', {class: 'buttons'}, this.go, this.clear));
  }

  private get chosen(): Trouble { return TROUBLES[Number(this.kind.value)]!; }

  private fit(): void {
    this.strength.hidden = !this.chosen.scaled;
    this.duration.disabled = !this.chosen.timed;
  }

  private cause(): void {
    const share = Number(this.share.value), duration = Number(this.duration.value);
    if (!(share > 0) || !(duration > 0)) return this.live.happen('bad', 'disturb', 'strength and duration must be above 0');
    this.live.ask(this.chosen.of(this.live, share, duration), this.chosen.name.toLowerCase());
  }

  draw(): void {
    const may = this.live.isOperator && !this.live.stale;
    const mode = this.live.mode;
    this.go.disabled = !may || (mode !== RUNNING && mode !== SAFE_STOP);
    this.clear.disabled = !may;
  }
}
