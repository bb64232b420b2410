// What an operator does: arm, stop, pause, reset, pace, push; record.
import {card, el, put, say} from '../dom';
import type {Live} from '../live';
import {FALLEN, FAULT, HELD, PAUSED, RUNNING, SAFE_STOP} from '../messages';
import {impulse, rotors, speed, verb} from '../requests';

const PACES = [0.1, 0.25, 0.5, 1, 2];

export class Controls {
  readonly element: HTMLElement;
  readonly push: HTMLElement;
  readonly recording: HTMLElement;
  private readonly hint = el('p', {class: 'hint', 'aria-live': 'polite'});
  private readonly buttons: Record<string, HTMLButtonElement> = {};
  private readonly pace = el('select', {'aria-label': 'Speed of the simulation', onchange: () => this.setPace()});
  private readonly size = el('input', {type: 'range', min: '0.1', max: '2', step: '0.1', value: '1', 'aria-label': 'Strength of a push'});
  private readonly sizeText = el('output');
  private readonly recordState = el('p', {class: 'numbers'});
  private readonly files = el('ul', {class: 'files', 'aria-label': 'Recordings, the newest first'});
  private listed = '';  // for which state of the recording

  constructor(private readonly live: Live) {
    for (const factor of PACES) this.pace.add(new Option(`× ${factor}`, String(factor)));
    this.pace.value = '1';
    this.element = card('Control', el('div', {class: 'buttons'},
      this.button('arm', 'Arm', 'a', () => this.arm(), 'primary'),
      this.button('stop', 'Stop', 'd', () => this.stop(), 'danger'),
      this.button('pause', 'Pause', 'Space', () => this.pauseOrResume()),
      this.button('reset', 'Reset', 'r', () => live.ask(verb('RESET'), 'reset')),
      el('label', {class: 'field'}, 'Speed', this.pace)), el('div', {class: 'buttons'}, el('span', {class: 'label'}, 'Flywheels'),
      this.button('up', 'Spin up', '', () => this.spin(true)), this.button('down', 'Run down', '', () => this.spin(false))), this.hint);
    this.push = card('Push', this.pad(), el('label', {class: 'field wide'}, 'Strength', this.size, this.sizeText));
    this.recording = card('Recording', el('div', {class: 'buttons'},
      this.button('record', 'Record', 'w', () => live.record(!live.recording.on)),
      this.recordState), this.files);
  }

  private button(name: string, text: string, key: string, act: () => void, kind = ''): HTMLButtonElement {
    const made = el('button', {type: 'button', class: kind, onclick: act,
      ...(key ? {'aria-keyshortcuts': key, title: `${text} (${key})`} : {})}, text);
    this.buttons[name] = made;
    return made;
  }

  private pad(): HTMLElement {
    const arrow = (name: string, sign: string, text: string, key: string, roll: number, pitch: number) => {
      const made = this.button(name, sign, key, () => this.pushNow(roll, pitch));
      made.setAttribute('aria-label', text);
      return made;
    };
    return el('div', {class: 'pad'},
      arrow('forward', '▲', 'Push forward', 'ArrowUp', 0, 1), arrow('left', '◀', 'Push to the left', 'ArrowLeft', -1, 0),
      this.button('push', 'Push', 'p', () => this.pushNow(1, 0), 'primary'),
      arrow('right', '▶', 'Push to the right', 'ArrowRight', 1, 0), arrow('back', '▼', 'Push backward', 'ArrowDown', 0, -1));
  }

  arm(): void { this.live.ask(verb('ARM'), 'arm'); }
  stop(): void { this.live.ask(verb('DISARM'), 'stop'); }
  pauseOrResume(): void {
    this.live.ask(verb(this.live.mode === PAUSED ? 'RESUME' : 'PAUSE'), this.live.mode === PAUSED ? 'resume' : 'pause');
  }

  /** In reference pushes about x and y. */
  pushNow(roll: number, pitch: number): void {
    const rig = this.live.rig;
    if (!rig) return;
    const size = Number(this.size.value) * rig.impulse;
    this.live.ask(impulse(rig, roll * size, pitch * size), `push of ${size.toPrecision(3)} N m s`);
  }

  private setPace(): void { this.live.ask(speed(Number(this.pace.value)), `speed × ${this.pace.value}`); }
  private spin(on: boolean): void { this.live.ask(rotors(on), on ? 'spin the flywheels up' : 'let the flywheels run down'); }

  press(key: string): boolean {
    const name = Object.keys(this.buttons).find((each) => this.buttons[each]!.getAttribute('aria-keyshortcuts') === key);
    if (!name) return false;
    this.buttons[name]!.click();
    return true;
  }

  draw(): void {
    const {live, buttons} = this;
    const mode = live.stale ? null : live.mode;
    const may = live.isOperator && live.connected;
    const able: Record<string, boolean> = {
      arm: mode === HELD, stop: mode === RUNNING || mode === PAUSED, pause: mode === RUNNING || mode === PAUSED,
      reset: mode !== null, record: true, up: mode !== null, down: mode !== null};
    for (const [name, button] of Object.entries(buttons)) {
      const pushes = !(name in able);
      const twoWays = live.rig?.tiltsTwoWays ?? true;
      const blocked = (name === 'forward' || name === 'back') && !twoWays;
      button.disabled = !may || blocked || !(pushes ? mode === RUNNING || mode === SAFE_STOP : able[name]!);
    }
    this.pace.disabled = !may || live.isReal;
    say(buttons['pause']!, mode === PAUSED ? 'Resume' : 'Pause');
    say(buttons['record']!, live.recording.on ? 'End recording' : 'Record');
    buttons['record']!.classList.toggle('danger', live.recording.on);
    const factor = live.owner?.value.speed_factor;
    if (factor && document.activeElement !== this.pace && PACES.includes(factor)) this.pace.value = String(factor);
    const rig = live.rig;
    if (rig) say(this.sizeText, `${(Number(this.size.value) * rig.impulse).toPrecision(3)} N m s`);
    this.drawHint(may, mode);
    const {on, file, bytes, error} = live.recording;
    const state = `${live.connected} ${on} ${file}`;
    if (live.connected && state !== this.listed) void this.list();
    this.listed = state;
    say(this.recordState, error ?? (file ? `${on ? '● ' : ''}${file}, ${((bytes ?? 0) / 1e6).toFixed(1)} MB` : 'nothing recorded from here yet'));
    put(this.recordState, 'data-room', error ? 'gone' : on ? 'close' : 'unknown');
  }

  /** What can be fetched: asked for when a recording begins or ends. */
  private async list(): Promise<void> {
    const answer = await fetch(`recordings${location.search}`).catch(() => null);
    if (!answer?.ok) return;
    const found = await answer.json() as {name: string; bytes: number}[];
    this.files.replaceChildren(...found.slice(0, 5).map(({name, bytes}) => el('li', {},
      el('a', {href: `recordings/${name}${location.search}`, download: name}, name), ` ${(bytes / 1e6).toFixed(1)} MB`)));
  }

  private drawHint(may: boolean, mode: number | null): void {
    const {live} = this;
    let text = '';
    if (!live.connected) text = 'There is no connection to the gateway.';
    else if (!may) text = 'You are looking on. To act, open the operator’s address: gyrotwin gateway --urls prints it.';
    else if (mode === FALLEN) text = 'It has fallen: reset, then arm.';
    else if (mode === SAFE_STOP || mode === FAULT) text = 'Reset, then arm.';
    else if (mode === HELD) text = live.owner?.value.text || 'Held in its initial state: arm to let it go.';
    else if (mode === RUNNING) text = 'Pull the platform with the mouse, or push it with the arrow keys.';
    say(this.hint, text);
  }
}
