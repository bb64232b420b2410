import {parse} from '@foxglove/rosmsg';
import {MessageReader, MessageWriter} from '@foxglove/rosmsg2-serialization';
import {describe, expect, it} from 'vitest';

import {Layout, Numbers} from '../src/layout';

const SCHEMA = `int32 ON=1
gyrotwin/Header header
int32 mode
float64[2] tilt
float64 angle
string text
float64 after
${'='.repeat(80)}
MSG: gyrotwin/Header
int32 rig
int64 epoch
`;

describe('Layout', () => {
  it('finds numbers where the decoder does', () => {
    const definitions = parse(SCHEMA, {ros2: true});
    const value = {header: {rig: 3, epoch: 1234567890123456789n}, mode: -7, tilt: [0.25, -0.5], angle: 9.75, text: 'x', after: 1};
    const bytes = new MessageWriter(definitions).writeMessage(value);
    expect(new MessageReader(definitions).readMessage(bytes)).toMatchObject({mode: -7, angle: 9.75});
    const layout = new Layout(definitions);
    const numbers = new Numbers(layout, bytes);
    expect(numbers.int64('header.epoch')).toBe(1234567890123456789n);
    expect(numbers.int32('mode')).toBe(-7);
    expect(numbers.double('tilt', 1)).toBe(-0.5);
    expect(numbers.double('angle')).toBe(9.75);
    expect(() => layout.at('after')).toThrow('after');
  });
});
