// Disturbances and faults that an operator chooses.
import {card, el, put, say} from '../dom';
import type {Live} from '../live';
import {RUNNING, SAFE_STOP} from '../messages';
import {verb} from '../requests';
import type {Rig} from '../rig';
import {SENSORS, TROUBLES, type Trouble} from '../troubles';
import {amount} from '../units';

export class Disturb {
  readonly element: HTMLElement;
  private readonly kind = el('select', {id: 'trouble', onchange: () => this.fit()});
  private readonly which = el('select', {'aria-label': 'Which', onchange: () => this.fitStrength()});
  private readonly size = el('input', {id: 'trouble-size', type: 'number', min: '0', step: 'any'});
  private readonly unit = el('span', {class: 'unit'});
  private readonly strength = el('label', {class: 'field', for: 'trouble-size'}, 'Strength', this.size, this.unit);
  private readonly duration = el('input', {type: 'number', min: '0.01', step: 'any', value: '2', 'aria-label': 'Duration in seconds'});
  private readonly go = el('button', {type: 'button', class: 'primary', onclick: () => this.cause()}, 'Cause it');
  private readonly clear = el('button', {type: 'button', onclick: () => this.live.ask(verb('CLEAR'), 'clear')}, 'End all');
  private readonly acting = el('p', {class: 'numbers'});
  private offered: Trouble[] = [];
  private rig: Rig | null = null;

  constructor(private readonly live: Live) {
    this.element = card('Disturb', el('div', {class: 'fields'}, el('label', {class: 'sr', for: 'trouble'}, 'Disturbance or fault'), this.kind, this.which),
      el('div', {class: 'fields'}, this.strength, el('label', {class: 'field'}, 'For', this.duration, 's')),
      el('div', {class: 'buttons'}, this.go, this.clear, this.acting));
  }

  private get chosen(): Trouble | undefined { return this.offered[Number(this.kind.value)]; }

  private offer(rig: Rig): void {
    this.rig = rig;
    this.offered = TROUBLES.filter(({fits}) => !fits || fits(rig));
    this.kind.replaceChildren(...this.offered.map(({name}, i) => new Option(name, String(i))));
    this.fit();
  }

  private fit(): void {
    const of = this.rig && this.chosen ? this.chosen.which?.(this.rig) ?? [] : [];
    this.which.hidden = of.length < 2;
    this.which.replaceChildren(...of.map((name) => new Option(name, name)));
    this.fitStrength();
  }

  private fitStrength(): void {
    const {chosen, rig} = this;
    this.strength.hidden = !chosen?.unit;
    if (!chosen?.unit || !rig) return;
    this.size.value = String(Number(amount(chosen.usual?.(rig, this.which.value) ?? 1)));
    say(this.unit, chosen.unit === 'of its unit' ? SENSORS[this.which.value]?.unit ?? '' : chosen.unit);
  }

  private cause(): void {
    const {chosen, rig} = this;
    if (!chosen || !rig) return;
    const size = chosen.unit ? Number(this.size.value) : 0, seconds = Number(this.duration.value);
    const wrong = !(seconds > 0) || !Number.isFinite(size) || (chosen.unit !== undefined && this.size.value === '');
    put(this.size, 'aria-invalid', String(wrong));
    if (wrong) return this.live.happen('bad', 'disturb', 'needs a number for its strength, and a duration above 0');
    const words = [chosen.name.toLowerCase(), ...(this.which.value ? [this.which.value] : []),
      ...(chosen.unit ? [`${this.size.value} ${this.unit.textContent}`] : [])].join(', ');
    this.live.ask(chosen.ask(rig, size, seconds, this.which.value), words);
  }

  draw(): void {
    const {live} = this;
    if (live.rig && live.rig !== this.rig) {
      if (live.rig.key !== this.rig?.key) this.offer(live.rig);
      this.rig = live.rig;
    }
    const may = live.isOperator && !live.stale, mode = live.mode;
    this.go.disabled = !may || (mode !== RUNNING && mode !== SAFE_STOP);
    this.clear.disabled = !may;
    const owner = live.owner?.value;
    say(this.acting, owner && owner.disturbances + owner.faults > 0 ? `${owner.disturbances} act, ${owner.faults} faults` : 'nothing acts');
  }
}
