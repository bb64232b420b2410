// The page: one rig, live.
import 'uplot/dist/uPlot.min.css';
import './style/base.css';
import './style/layout.css';
import './style/parts.css';
import './style/narrow.css';

import {quantitiesOf} from './charts/quantities';
import {StripChart, type TimeView} from './charts/strip_chart';
import {el, put, say} from './dom';
import {Live} from './live';
import {Bubble} from './panels/bubble';
import {Daemons} from './panels/daemons';
import {Disturb} from './panels/disturb';
import {Events} from './panels/events';
import {Head} from './panels/head';
import {Margins} from './panels/margins';
import {Operate} from './panels/operate';
import {Push} from './panels/push';
import {RigPanel} from './panels/rig_panel';
import {Twin} from './panels/twin';
import {type Eye, Scene} from './scene/scene';

const byId = <T extends HTMLElement>(id: string): T => document.getElementById(id) as T;
const CHARTS = 3;
const view: TimeView = {span: 10, frozen: null};
const charts: StripChart[] = [];

const socket = new URL(location.href);
socket.protocol = socket.protocol === 'https:' ? 'wss:' : 'ws:';
socket.hash = '';
let shown = '';  // the rig that is drawn
const live = new Live(socket.href, (ready) => {
  const rig = ready.rig!;
  if (shown === rig.key) return;
  if (shown !== '') return location.reload();
  shown = rig.key;
  document.title = `${rig.name} – gyrotwin`;
  say(byId('rig'), rig.name);
  say(byId('summary'), rig.summary);
  scene?.build(rig);
  bubble.svg.classList.toggle('hidden', !rig.tilts);
  // Building the scene takes long on a slow machine: what came meanwhile would be old.
  requestAnimationFrame(() => requestAnimationFrame(() => ready.listen()));
  const quantities = quantitiesOf(rig);
  for (let i = 0; i < CHARTS; ++i) charts.push(new StripChart(byId('charts'), ready, view, quantities, i, drawFreeze));
});

/** null: the browser draws nothing in three dimensions; all else works. */
function sceneOrNone(): Scene | null {
  try {
    return new Scene(byId('view'), live);
  } catch {
    byId('view').append(el('p', {class: 'without'}, 'This browser has no WebGL: the platform is not drawn.'));
    return null;
  }
}
const scene = sceneOrNone();
const bubble = new Bubble();
byId('view').append(bubble.svg);

// The side: what is always looked at, then one of four.
const operate = new Operate(live, byId('acts'));
const margins = new Margins(live), twin = new Twin(live), push = new Push(live);
const events = new Events(live), disturb = new Disturb(live), daemons = new Daemons(live), rigPanel = new RigPanel(live);
const panes = {Events: events, Disturb: disturb, Daemons: daemons, Rig: rigPanel};
push.element.dataset['group'] = 'control';
const choice = el('nav', {id: 'panes', 'aria-label': 'More'});
byId('side').append(margins.element, twin.element, push.element, choice);
for (const [name, {element}] of Object.entries(panes)) {
  element.dataset['pane'] = name;
  element.dataset['group'] = name === 'Events' || name === 'Daemons' ? 'log' : 'control';
  byId('side').append(element);
  choice.append(el('button', {type: 'button', onclick: () => showPane(name)}, name));
}
function showPane(name: string): void {
  for (const [each, {element}] of Object.entries(panes)) element.classList.toggle('chosen', each === name);
  for (const tab of choice.children) put(tab, 'aria-pressed', String(tab.textContent === name));
}
showPane('Events');

/** Makes the pressed one of some buttons the only one. */
function press(buttons: Iterable<Element>, pressed: Element): void {
  for (const each of buttons) put(each, 'aria-pressed', String(each === pressed));
}
const tabs = document.querySelectorAll<HTMLButtonElement>('#tabs button');
for (const tab of tabs) {
  tab.onclick = () => {
    document.body.dataset['tab'] = tab.dataset['tab'];
    press(tabs, tab);
  };
}
const eyes = document.querySelectorAll<HTMLButtonElement>('.eyes button');
for (const eye of eyes) {
  eye.onclick = () => {
    scene?.look(eye.dataset['eye'] as Eye);
    press(eyes, eye);
  };
}
const ghost = byId<HTMLInputElement>('ghost');
ghost.onchange = () => { if (scene) scene.ghostShown = ghost.checked; };

// Time.
const freeze = byId<HTMLButtonElement>('freeze'), span = byId<HTMLSelectElement>('span');
function drawFreeze(): void {
  say(freeze, view.frozen ? 'Live' : 'Hold');
  put(freeze, 'aria-pressed', String(view.frozen !== null));
  say(byId('chart-hint'), view.frozen ? 'held: double-click for live' : 'drag to zoom, double-click for live');
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
  const other = name === 'dark' ? 'Light colours' : 'Dark colours';
  put(theme, 'aria-label', other);
  put(theme, 'title', other);
  charts.forEach((chart) => chart.rebuild());
}
setTheme(localStorage.getItem('theme') ?? (matchMedia('(prefers-color-scheme: light)').matches ? 'light' : 'dark'));
theme.onclick = () => {
  const name = document.documentElement.dataset['theme'] === 'dark' ? 'light' : 'dark';
  localStorage.setItem('theme', name);
  setTheme(name);
};

// Keys.
const help = byId<HTMLDialogElement>('help');
byId('help-button').onclick = () => help.showModal();
const keyed = [...operate.buttons, ...push.buttons, rigPanel.record, freeze];
window.addEventListener('keydown', (event) => {
  const target = event.target as HTMLElement;
  if (event.ctrlKey || event.altKey || event.metaKey || help.open || /^(INPUT|SELECT|TEXTAREA)$/.test(target.tagName)) return;
  if (event.key === ' ' && target.tagName === 'BUTTON') return;
  const scrolls = event.key.startsWith('Arrow') && target.closest('.daemons, .happenings');
  if (scrolls || event.repeat) return;
  if (event.key === '?') return help.showModal();
  const key = event.key === ' ' ? 'Space' : event.key.length === 1 ? event.key.toLowerCase() : event.key;
  const button = keyed.find((each) => each.getAttribute('aria-keyshortcuts') === key);
  if (!button) return;
  button.click();
  event.preventDefault();
});

const CHARTS_EVERY = 50, PANELS_EVERY = 100;  // [ms]
const head = new Head(live, margins);
let chartsAt = 0, panelsAt = 0;
function frame(now: number): void {
  requestAnimationFrame(frame);
  scene?.draw(now);
  bubble.draw(live);
  if (now - chartsAt >= CHARTS_EVERY) {
    chartsAt = now;
    charts.forEach((chart) => chart.draw());
  }
  if (now - panelsAt < PANELS_EVERY) return;
  panelsAt = now;
  document.body.classList.toggle('stale', live.stale && live.everConnected);
  for (const panel of [operate, push, margins, twin, events, disturb, daemons, rigPanel, head]) panel.draw();
}
requestAnimationFrame(frame);
