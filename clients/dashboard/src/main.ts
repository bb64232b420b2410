// The page: one rig, live.
import 'uplot/dist/uPlot.min.css';
import './style.css';

import {StripChart, type TimeView, quantitiesOf} from './charts/strip_chart';
import {el, put, say} from './dom';
import {Live} from './live';
import {MODES} from './messages';
import {Bubble} from './panels/bubble';
import {Controls} from './panels/controls';
import {Daemons} from './panels/daemons';
import {Happenings} from './panels/happenings';
import {Readings} from './panels/readings';
import {TroublePanel} from './panels/trouble';
import {degrees, tiltOf} from './rig';
import {Scene} from './scene/scene';

const byId = <T extends HTMLElement>(id: string): T => document.getElementById(id) as T;
const view: TimeView = {span: 10, frozen: null};
const charts: StripChart[] = [];

const socket = new URL(location.href);
socket.protocol = socket.protocol === 'https:' ? 'wss:' : 'ws:';
socket.hash = '';
const live = new Live(socket.href, (ready, again) => {
  const rig = ready.rig!;
  document.title = `${rig.name} – gyrotwin`;
  say(byId('rig'), rig.name);
  say(byId('summary'), rig.summary);
  scene.build(rig);
  bubble.svg.classList.toggle('hidden', !rig.tilts);
  if (again) return;
  // Building the scene takes long on a slow machine: what came meanwhile would be old.
  requestAnimationFrame(() => requestAnimationFrame(() => ready.listen()));
  const quantities = quantitiesOf(rig);
  for (let i = 0; i < 3; ++i) charts.push(new StripChart(byId('charts'), ready, view, quantities, i, drawFreeze));
});
const scene = new Scene(byId('view'), live);
const bubble = new Bubble();
byId('view').append(bubble.svg);
const controls = new Controls(live), readings = new Readings(live), daemons = new Daemons(live),
  happenings = new Happenings(live), trouble = new TroublePanel(live);
byId('side').append(
  group('control', controls.element),
  group('state', readings.margins, readings.twin),
  group('control', controls.push, trouble.element, controls.recording),
  group('log', daemons.element, happenings.element));

function group(name: string, ...cards: HTMLElement[]): HTMLElement {
  return el('div', {class: 'group', 'data-tab': name}, ...cards);
}

// Tabs, where there is room for one column only.
for (const tab of document.querySelectorAll<HTMLButtonElement>('#tabs button')) {
  tab.onclick = () => {
    document.body.dataset['tab'] = tab.dataset['tab'];
    for (const other of document.querySelectorAll('#tabs button')) put(other, 'aria-pressed', String(other === tab));
  };
}

// Time.
const freeze = byId<HTMLButtonElement>('freeze'), span = byId<HTMLSelectElement>('span');
function drawFreeze(): void {
  say(freeze, view.frozen ? 'Live' : 'Hold');
  put(freeze, 'aria-pressed', String(view.frozen !== null));
}
freeze.onclick = () => {
  view.frozen = view.frozen ? null : [live.now() - view.span, live.now()];
  drawFreeze();
};
span.onchange = () => {
  view.span = Number(span.value);
  view.frozen = null;
  drawFreeze();
};

// Light and dark.
const theme = byId<HTMLButtonElement>('theme');
function setTheme(name: string): void {
  document.documentElement.dataset['theme'] = name;
  put(theme, 'aria-label', name === 'dark' ? 'Light colours' : 'Dark colours');
  charts.forEach((chart) => chart.rebuild());
}
setTheme(localStorage.getItem('theme') ?? (matchMedia('(prefers-color-scheme: light)').matches ? 'light' : 'dark'));
theme.onclick = () => {
  const name = document.documentElement.dataset['theme'] === 'dark' ? 'light' : 'dark';
  localStorage.setItem('theme', name);
  setTheme(name);
};

const help = byId<HTMLDialogElement>('help');
byId('help-button').onclick = () => help.showModal();
const ghost = byId<HTMLInputElement>('ghost');
ghost.onchange = () => { scene.ghostShown = ghost.checked; };

window.addEventListener('keydown', (event) => {
  const target = event.target as HTMLElement;
  if (event.ctrlKey || event.altKey || event.metaKey || help.open || /^(INPUT|SELECT|TEXTAREA)$/.test(target.tagName)) return;
  if (event.key === ' ' && target.tagName === 'BUTTON') return;
  const scrolls = event.key.startsWith('Arrow') && target.closest('.scrolls, .happenings');
  if (scrolls || event.repeat) return;
  if (event.key === '?') return help.showModal();
  if (event.key === 'h') return freeze.click();
  if (controls.press(event.key === ' ' ? 'Space' : event.key)) event.preventDefault();
});

/** The line across the top: mode, lean, how fresh. */
function drawHead(): void {
  const owner = live.owner?.value, mode = byId('mode');
  const stale = live.stale;
  say(mode, stale ? 'NO DATA' : owner ? MODES[owner.mode] ?? '' : '…');
  put(mode, 'data-mode', stale ? 'stale' : String(owner?.mode ?? ''));
  say(byId('plant'), owner ? (live.isReal ? 'real rig' : 'simulated') : '');
  say(byId('why'), stale ? '' : owner?.text ?? '');
  const state = live.state?.value;
  const tilts = live.rig?.tilts ?? true;
  say(byId('lean'), state && tilts && !stale ? `${degrees(tiltOf(state.tilt_rad)).toFixed(2)}°` : '–');
  say(byId('clock'), state ? `${(Number(state.header.sim_time_ns) * 1e-9).toFixed(1)} s` : '');
  const banner = byId('banner');
  banner.hidden = !stale;
  if (!stale) return;
  const age = live.age(live.state);
  say(banner, !live.connected
    ? (live.everConnected ? 'The connection to the gateway is lost; trying again. What is shown is old.' : 'Connecting to the gateway…')
    : Number.isFinite(age) ? `No data for ${age.toFixed(0)} s: what is shown is old. Does the owner of the rig still run?`
      : 'No owner of the rig is heard: start gyrotwin integrator or gyrotwin hardware.');
}

const CHARTS_EVERY = 50, PANELS_EVERY = 100;  // [ms]
let chartsAt = 0, panelsAt = 0;
function frame(now: number): void {
  requestAnimationFrame(frame);
  scene.draw(now);
  bubble.draw(live);
  if (now - chartsAt >= CHARTS_EVERY) {
    chartsAt = now;
    charts.forEach((chart) => chart.draw());
  }
  if (now - panelsAt < PANELS_EVERY) return;
  panelsAt = now;
  document.body.classList.toggle('stale', live.stale && live.everConnected);
  drawHead();
  for (const panel of [controls, readings, daemons, happenings, trouble]) panel.draw();
}
requestAnimationFrame(frame);
