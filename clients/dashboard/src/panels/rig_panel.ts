// What concerns the rig as a whole: its flywheels, and recordings of it.
import {button, card, el, put, say} from '../dom';
import type {Live} from '../live';
import {rotors} from '../requests';

export class RigPanel {
  readonly element: HTMLElement;
  readonly record = button('Record', 'w', () => this.live.record(!this.live.recording.on));
  private readonly up = button('Spin up', '', () => this.live.ask(rotors(true), 'spin the flywheels up'));
  private readonly down = button('Run down', '', () => this.live.ask(rotors(false), 'let the flywheels run down'));
  private readonly flywheels = el('div', {class: 'buttons'}, el('span', {class: 'field'}, 'Flywheels'), this.up, this.down);
  private readonly state = el('p', {class: 'numbers', id: 'recording'});
  private readonly files = el('ul', {class: 'files', 'aria-label': 'Recordings, the newest first'});
  private listed = '';  // for which state of the recording

  constructor(private readonly live: Live) {
    this.element = card('Recording and rig', el('div', {class: 'buttons'}, this.record,
      this.state), this.files, this.flywheels);
  }

  /** What can be fetched: asked for when a recording begins or ends. */
  private async list(): Promise<void> {
    const answer = await fetch(`recordings${location.search}`).catch(() => null);
    if (!answer?.ok) return;
    const found = await answer.json() as {name: string; bytes: number}[];
    this.files.replaceChildren(...found.slice(0, 5).map(({name, bytes}) => el('li', {},
      el('a', {href: `recordings/${name}${location.search}`, download: name}, name), ` ${(bytes / 1e6).toFixed(1)} MB`)));
  }

  draw(): void {
    const {live} = this;
    const may = live.isOperator && live.connected;
    const {on, file, bytes, error} = live.recording;
    const state = `${live.connected} ${on} ${file}`;
    if (live.connected && state !== this.listed) void this.list();
    this.listed = state;
    this.record.disabled = !may;
    this.up.disabled = this.down.disabled = !may || live.mode === null;
    this.flywheels.hidden = !live.rig?.has('rotor_drive');
    say(this.record, on ? 'End recording' : 'Record');
    this.record.classList.toggle('danger', on);
    say(this.state, error ?? (file ? `${on ? '● ' : ''}${file}, ${((bytes ?? 0) / 1e6).toFixed(1)} MB` : 'nothing recorded from here yet'));
    put(this.state, 'data-room', error ? 'gone' : on ? 'close' : 'unknown');
  }
}
