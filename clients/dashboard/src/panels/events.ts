// What happened, the newest first.
import {card, el} from '../dom';
import type {Live} from '../live';

const SHOWN = 100;

export class Events {
  readonly element: HTMLElement;
  private readonly list = el('ol', {class: 'happenings', tabindex: '0', 'aria-label': 'What happened, the newest first'});
  private drawn = 0;

  constructor(private readonly live: Live) {
    this.element = card('Events', this.list);
  }

  draw(): void {
    const fresh = Math.min(this.live.happened - this.drawn, SHOWN, this.live.happenings.length);
    this.drawn = this.live.happened;
    for (let i = fresh - 1; i >= 0; --i) {
      const {at, tone, who, text} = this.live.happenings[i]!;
      this.list.prepend(el('li', {'data-tone': tone}, el('time', {}, at.toTimeString().slice(0, 8)),
        el('span', {class: 'what'}, el('span', {class: 'who'}, who), ' ', el('span', {class: 'text'}, text))));
    }
    while (this.list.children.length > SHOWN) this.list.lastChild!.remove();
  }
}
