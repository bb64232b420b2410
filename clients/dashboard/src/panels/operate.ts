// What an operator does at once: arm, stop, pause, reset; how fast time goes.
import {button, el, put, say} from '../dom';
import type {Live} from '../live';
import {FALLEN, FAULT, HELD, PAUSED, RUNNING, SAFE_STOP} from '../messages';
import {speed, verb} from '../requests';

const PACES = [0.1, 0.25, 0.5, 1, 2];

export class Operate {
  private readonly hint = el('p', {class: 'hint', 'aria-live': 'polite'});
  private readonly arm = button('Arm', 'a', () => this.live.ask(verb('ARM'), 'arm'));
  private readonly pause = button('Pause', 'Space', () => this.pauseOrResume());
  private readonly reset = button('Reset', 'r', () => this.live.ask(verb('RESET'), 'reset'));
  private readonly stop = button('Stop', 'd', () => this.live.ask(verb('DISARM'), 'stop'), 'stop');
  private readonly pace = el('select', {id: 'pace', onchange: () => this.setPace()});

  constructor(private readonly live: Live, place: HTMLElement) {
    for (const factor of PACES) this.pace.add(new Option(`× ${factor}`, String(factor)));
    this.pace.value = '1';
    place.append(el('div', {class: 'acts'}, this.arm, this.pause, this.reset, this.stop),
      el('div', {class: 'acts-more'}, this.hint, el('label', {class: 'field', for: 'pace'}, 'Speed', this.pace)));
  }

  get buttons(): HTMLButtonElement[] { return [this.arm, this.pause, this.reset, this.stop]; }

  private pauseOrResume(): void {
    const paused = this.live.mode === PAUSED;
    this.live.ask(verb(paused ? 'RESUME' : 'PAUSE'), paused ? 'resume' : 'pause');
  }

  private setPace(): void { this.live.ask(speed(Number(this.pace.value)), `speed × ${this.pace.value}`); }

  draw(): void {
    const {live} = this;
    const mode = live.stale ? null : live.mode;
    const may = live.isOperator && live.connected, runs = mode === RUNNING || mode === PAUSED;
    this.arm.disabled = !may || mode !== HELD;
    this.pause.disabled = !may || !runs || live.isReal;
    this.reset.disabled = !may || mode === null;
    // A stop is worth asking for even where nothing has been heard for a while.
    this.stop.disabled = !may || mode === HELD || mode === FALLEN || mode === FAULT || mode === SAFE_STOP;
    this.pace.disabled = !may || live.isReal;
    put(this.arm, 'data-next', String(mode === HELD));
    put(this.reset, 'data-next', String(mode === FALLEN || mode === SAFE_STOP || mode === FAULT));
    put(this.pause, 'data-next', String(mode === PAUSED));
    say(this.pause, mode === PAUSED ? 'Resume' : 'Pause');
    const factor = live.owner?.value.speed_factor;
    if (factor && document.activeElement !== this.pace && PACES.includes(factor)) this.pace.value = String(factor);
    say(this.hint, this.advice(may, mode));
  }

  private advice(may: boolean, mode: number | null): string {
    const {live} = this;
    if (!live.connected) return 'There is no connection to the gateway.';
    if (!may) return 'You are looking on. To act, open the operator’s address: gyrotwin gateway --urls prints it.';
    switch (mode) {
      case FALLEN: return 'It has fallen: reset, then arm.';
      case SAFE_STOP: case FAULT: return 'Reset, then arm.';
      case HELD: return live.owner?.value.text || 'Held: arm to let it go.';
      case RUNNING: return live.rig?.tilts ? 'Pull it, or use the arrow keys.' : 'Push with the arrow keys.';
      case PAUSED: return 'Time stands still.';
      default: return '';
    }
  }
}
