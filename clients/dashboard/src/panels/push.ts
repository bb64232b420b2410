// Pushes of the rig's own size, in four directions.
import {button, card, el, say} from '../dom';
import type {Live} from '../live';
import {RUNNING, SAFE_STOP} from '../messages';
import {impulse} from '../requests';
import {amount} from '../units';

export class Push {
  readonly element: HTMLElement;
  readonly buttons: HTMLButtonElement[];
  private readonly size = el('input', {id: 'push-size', type: 'range', min: '0.1', max: '2', step: '0.1', value: '1'});
  private readonly sizeText = el('output', {for: 'push-size'});
  private readonly push = button('Push', 'p', () => this.give(1, 0), 'primary');
  private readonly forward = this.arrow('▲', 'Push forward', 'ArrowUp', 0, 1);
  private readonly left = this.arrow('◀', 'Push to the left', 'ArrowLeft', -1, 0);
  private readonly back = this.arrow('▼', 'Push backward', 'ArrowDown', 0, -1);
  private readonly right = this.arrow('▶', 'Push to the right', 'ArrowRight', 1, 0);

  constructor(private readonly live: Live) {
    this.buttons = [this.push, this.forward, this.left, this.back, this.right];
    this.element = card('Push', el('div', {class: 'push'},
      el('div', {class: 'push-size'}, el('label', {for: 'push-size'}, 'Strength'), this.size, this.sizeText), this.push,
      el('div', {class: 'pad'}, this.forward, this.left, this.back, this.right)));
  }

  private arrow(sign: string, text: string, key: string, roll: number, pitch: number): HTMLButtonElement {
    const made = button(sign, key, () => this.give(roll, pitch));
    made.setAttribute('aria-label', text);
    return made;
  }

  /** In reference pushes about x and y. */
  private give(roll: number, pitch: number): void {
    const rig = this.live.rig;
    if (!rig) return;
    const size = Number(this.size.value) * rig.impulse;
    this.live.ask(impulse(rig, roll * size, pitch * size), `push of ${amount(size)} N m s`);
  }

  draw(): void {
    const {live} = this;
    const mode = live.stale ? null : live.mode;
    const may = live.isOperator && (mode === RUNNING || mode === SAFE_STOP);
    const twoWays = live.rig?.tiltsTwoWays ?? true;
    for (const each of this.buttons) each.disabled = !may || (!twoWays && (each === this.forward || each === this.back));
    if (live.rig) say(this.sizeText, `${amount(Number(this.size.value) * live.rig.impulse)} N m s`);
  }
}
