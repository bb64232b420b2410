// What a chart can show.
import type {Live} from '../live';
import {SENSORS} from '../messages';
import type {Rig} from '../rig';
import type {Ring} from './ring_buffer';

/** @param colour which of the palette's. A twin's line lies as a pale band under the live one of the same colour. */
export interface Line { label: string; column: number; colour: number; twin?: boolean; ring?: (live: Live) => Ring }
/** @param least range of its axis */
export interface Quantity { name: string; unit: string; least: number; lines: Line[]; ring: (live: Live) => Ring }

const states = (live: Live): Ring => live.states, twins = (live: Live): Ring => live.twins;
const truths = (live: Live): Ring => live.truths, healths = (live: Live): Ring => live.healths;
const FIRST_NIS = 3;

function several(name: string, first: number, count: number): Line[] {
  return Array.from({length: count}, (_, j) => ({label: count > 1 ? `${name} ${j}` : name, column: first + j, colour: j}));
}

/** What this rig has to show, the most telling first. */
export function quantitiesOf(rig: Rig): Quantity[] {
  const all: Quantity[] = [];
  const two = rig.tiltsTwoWays;
  const both = (first: string, second: string, column: number): Line[] =>
    [{label: first, column, colour: 0}, ...(two ? [{label: second, column: column + 1, colour: 1}] : [])];
  if (rig.tilts) {
    const twin = both('twin roll', 'twin pitch', 0).map((line) => ({...line, twin: true, ring: twins}));
    all.push({name: 'Tilt', unit: '°', least: 1, ring: states, lines: [...twin, ...both('roll', 'pitch', 0)]});
  }
  const gimbals = {name: 'Gimbals', unit: '°', least: 4, ring: states, lines: several('gyro', 5, rig.gyros)};
  if (rig.family === 'gimballed') {
    all.push(gimbals);
  } else {
    const name = rig.family === 'umbrella' ? 'Disc' : 'Post';
    all.push({name: `${name} speed`, unit: 'rad/s', least: 1, ring: states, lines: [{label: name.toLowerCase(), column: 4, colour: 0}]});
  }
  all.push({name: 'Drive torque', unit: 'N m', least: 0.1 * rig.torqueLimit, ring: states, lines: several('drive', 9, rig.drives)});
  if (rig.family === 'umbrella') {
    all.push({name: 'Contact forces', unit: 'N', least: 10, ring: truths, lines: several('axle', 0, rig.gyros)});
    if (rig.text('umbrella.mount') === 'level') {
      all.push({name: 'Holding moment', unit: 'N m', least: 1, ring: truths, lines: both('about x', 'about y', 4)});
    }
  }
  if (rig.family !== 'gimballed') all.push(gimbals);
  if (rig.tilts) {
    all.push({name: 'Tilt rate', unit: '°/s', least: 10, ring: states, lines: both('roll', 'pitch', 2)});
    all.push({name: 'Unknown moment', unit: 'N m', least: 0.4, ring: healths, lines: both('about x', 'about y', 1)});
  }
  all.push({name: 'Misfit of the twin (1 is right)', unit: '', least: 1, ring: healths, lines: [{label: 'all', column: 0, colour: 3}]});
  all.push({name: 'Misfit: motion sensors', unit: '', least: 1, ring: healths, lines: [0, 1, 2, 3].map((i) =>
    ({label: SENSORS[i]!, column: FIRST_NIS + i, colour: i}))});
  all.push({name: 'Misfit: other sensors', unit: '', least: 1, ring: healths, lines: [4, 5, 6, 7].map((i) =>
    ({label: SENSORS[i]!, column: FIRST_NIS + i, colour: i - 4}))});
  all.push({name: 'Flywheels', unit: '%', least: 4, ring: states, lines: several('gyro', 11, rig.gyros)});
  all.push({name: 'Energy', unit: 'J', least: 1, ring: truths, lines: [{label: 'kinetic', column: 6, colour: 0},
    {label: 'potential', column: 7, colour: 1}]});
  return all;
}
