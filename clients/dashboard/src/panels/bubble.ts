// A bubble level: where the structure leans, where the twin has it, how far it may, and what is forecast.
import type {Live} from '../live';
import {FALLS, seconds} from '../messages';
import {degrees, tiltOf} from '../rig';

const NS = 'http://www.w3.org/2000/svg';
const TRAIL = 60;

function shape(name: string, attributes: Record<string, string | number>): SVGElement {
  const made = document.createElementNS(NS, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, String(value));
  return made;
}

export class Bubble {
  readonly svg = shape('svg', {viewBox: '-1.2 -1.2 2.4 2.4', class: 'bubble', role: 'img', 'aria-label': 'Lean'});
  private readonly dot = shape('circle', {r: 0.085, class: 'bubble-dot'});
  private readonly twin = shape('circle', {r: 0.125, class: 'bubble-twin'});
  private readonly next = shape('circle', {r: 0.06, class: 'bubble-next'});
  private readonly trail = shape('polyline', {class: 'bubble-trail'});
  private readonly points: [number, number][] = [];

  constructor() {
    this.svg.append(shape('circle', {r: 1, class: 'bubble-limit'}), shape('circle', {r: 0.5, class: 'bubble-ring'}),
      shape('path', {d: 'M-1 0H1M0-1V1', class: 'bubble-ring'}), this.trail, this.next, this.twin, this.dot);
  }

  draw(live: Live): void {
    const rig = live.rig, state = live.state?.value;
    if (!rig || !state || !rig.tilts) return;
    // Seen from above, x up and y to the left: a roll about x leans to -y, a pitch about y to +x. The square
    // root shows small angles too.
    const place = (tilt: ArrayLike<number>): [number, number] => {
      const lean = tiltOf(tilt), share = Math.min(1.05, Math.sqrt(lean / rig.fallTilt));
      const direction = Math.atan2(tilt[0] ?? 0, tilt[1] ?? 0);
      return [share * Math.sin(direction), -share * Math.cos(direction)];
    };
    const move = (circle: SVGElement, [x, y]: [number, number]) => {
      circle.setAttribute('cx', x.toFixed(4));
      circle.setAttribute('cy', y.toFixed(4));
    };
    const at = place(state.tilt_rad);
    move(this.dot, at);
    this.points.push(at);
    if (this.points.length > TRAIL) this.points.shift();
    this.trail.setAttribute('points', this.points.map(([x, y]) => `${x.toFixed(3)},${y.toFixed(3)}`).join(' '));
    const followed = live.age(live.twin) < 1;
    this.twin.classList.toggle('hidden', !followed);
    if (followed) move(this.twin, place(live.twin!.value.tilt_rad));
    const forecast = live.age(live.forecast) < 1 ? live.forecast!.value : null;
    this.next.classList.toggle('hidden', !forecast);
    if (!forecast) return;
    this.next.classList.toggle('bad', forecast.outcome === FALLS);
    const share = Math.min(1.05, Math.sqrt(forecast.peak_tilt_rad / rig.fallTilt));
    const length = Math.hypot(at[0], at[1]);
    move(this.next, length > 1e-6 ? [share * at[0] / length, share * at[1] / length] : [0, -share]);
    this.svg.setAttribute('aria-label', `Leans ${degrees(tiltOf(state.tilt_rad)).toFixed(1)} degrees; peak forecast ` +
      `${degrees(forecast.peak_tilt_rad).toFixed(1)} degrees in ${seconds(forecast.peak_in_ns).toFixed(1)} s`);
  }
}
