import {describe, expect, it} from 'vitest';

import {Rig} from '../src/rig';
import {TROUBLES} from '../src/troubles';

const rig = new Rig(new Map<string, number | string>([['rig.machine', 'umbrella'], ['gyros.count', 4], ['wind.area_m2', 1], ['sensors.seed', 1],
  ['disturbance.reference_impulse_nms', 5], ['structure.mass_kg', 2.5], ['structure.cm_height_m', 0.2]]));
const ask = (name: string, size: number, seconds: number, which = '') =>
  TROUBLES.find((each) => each.name === name)!.ask(rig, size, seconds, which);

describe('troubles', () => {
  it('ask in the units of request_t', () => {
    expect(ask('Step', 2.5, 2, 'pitch')).toEqual({verb: 'DISTURB', kind: 'LOAD', moment_nm: [0, 2.5, 0], duration_ns: 2e9});
    expect(ask('Fault: drives weak', 20, 1)).toMatchObject({verb: 'FAULT', kind: 'DRIVE_WEAK', target: -1, level: 0.2});
    expect(ask('Fault: sensor late', 20, 1, 'gimbals')).toMatchObject({kind: 'SENSOR_DELAYED', target: 8, delay_ns: 2e7});
    expect(ask('Fault: flywheel unpowered', 0.01, 1, 'gyro 2')).toMatchObject({kind: 'ROTOR_LOSS', target: 2, level: 0.01});
  });
  it('have all a duration and a usual strength', () => {
    for (const {name, unit, usual, which, ask: request} of TROUBLES) {
      const first = which?.(rig)[0] ?? '';
      expect(request(rig, usual?.(rig, first) ?? 0, 0.5, first).duration_ns, name).toBe(5e8);
      if (unit) expect(usual!(rig, first), name).toBeGreaterThan(0);
    }
  });
});
