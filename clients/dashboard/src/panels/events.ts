// What happened, the newest first.
import {card, el} from '../dom';
import type {Happening} from '../heard';
import type {Live} from '../live';

const SHOWN = 100;

function line({at, tone, who, text, times}: Happening): HTMLElement {
  return el('li', {'data-tone': tone}, el('time', {}, at.toTimeString().slice(0, 8)),
    el('span', {class: 'what'}, el('span', {class: 'who'}, who), ' ', el('span', {class: 'text'}, text),
      ...(times > 1 ? [' ', el('span', {class: 'times'}, `(${times} times)`)] : [])));
}

export class Events {
  readonly element: HTMLElement;
  private readonly list = el('ol', {class: 'happenings', tabindex: '0', 'aria-label': 'What happened, the newest first'});
  private drawn = 0;  // lines
  private times = 0;  // of the newest that is drawn

  constructor(private readonly live: Live) {
    this.element = card('Events', this.list);
  }

  draw(): void {
    const {lines, begun} = this.live.happenings;
    const fresh = Math.min(begun - this.drawn, SHOWN, lines.length);
    this.drawn = begun;
    const before = lines[fresh];  // was the newest, and may have been said again since
    if (before && before.times !== this.times) this.list.firstChild?.replaceWith(line(before));
    for (let i = fresh - 1; i >= 0; --i) this.list.prepend(line(lines[i]!));
    this.times = lines[0]?.times ?? 0;
    while (this.list.children.length > SHOWN) this.list.lastChild!.remove();
  }
}
