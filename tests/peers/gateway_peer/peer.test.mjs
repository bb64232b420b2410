// The gateway as Foxglove's own client and decoder see it, on a running rig.
//   node --test peer.test.mjs      $GATEWAY_OPERATOR, $GATEWAY_OBSERVER: the gateway's addresses
import assert from 'node:assert/strict';
import {after, test} from 'node:test';

import {Rig} from './rig.mjs';

const open = [];
function connect(url, ...rest) {
  const rig = new Rig(url.replace('http:', 'ws:'), ...rest);
  open.push(rig);
  return rig;
}
after(() => open.forEach((rig) => rig.close()));

const OPERATOR = process.env.GATEWAY_OPERATOR;
const OBSERVER = process.env.GATEWAY_OBSERVER;
const number = (x) => Number(x);

test('both subprotocols are spoken, and say the same', async () => {
  for (const name of ['foxglove.websocket.v1', 'foxglove.sdk.v1']) {
    const rig = connect(OBSERVER, name);
    const info = (await rig.until('serverInfo', (e) => e.kind === 'serverInfo')).value;
    assert.equal(rig.socket.protocol, name);
    assert.deepEqual(info.capabilities, ['clientPublish', 'parameters', 'parametersSubscribe', 'time']);
    assert.equal(info.metadata.role, 'observer');
    const offered = (await rig.until('advertise', (e) => e.kind === 'advertise')).value;
    assert.equal(offered.length, 15);
    for (const channel of offered) {
      assert.equal(channel.encoding, 'cdr');
      assert.equal(channel.schemaEncoding, 'ros2msg');
      assert.match(channel.schemaName, /^gyrotwin\/msg\/[A-Z][A-Za-z]*$/);
    }
    await rig.until('time', (e) => e.kind === 'time');
  }
});

test('STATE is decoded field by field, in order, with nothing lost', async () => {
  const rig = connect(OBSERVER);
  await rig.until('advertise', (e) => e.kind === 'advertise');
  rig.subscribe('PROTOTYPE_B/LIVE/STATE');
  rig.subscribe('PROTOTYPE_B/INTEGRATOR/STATUS');
  const status = (await rig.message('PROTOTYPE_B/INTEGRATOR/STATUS')).value;
  assert.equal(status.service, 1);
  assert.ok(status.host.length > 0 && !status.host.includes('\0'));
  await rig.until('500 STATEs', () =>
    rig.heard.filter((e) => e.topic === 'PROTOTYPE_B/LIVE/STATE').length >= 500);
  const states = rig.heard.filter((e) => e.topic === 'PROTOTYPE_B/LIVE/STATE').map((e) => e.value);
  for (let i = 1; i < states.length; ++i) {
    assert.equal(states[i].header.sequence - states[i - 1].header.sequence, 1n);
  }
  const state = states.at(-1);
  assert.equal(state.header.rig_id, 1);
  assert.equal(state.valid, 63);
  assert.equal(number(state.header.sim_time_ns), 1e6 * number(state.header.tick));
  assert.ok(Math.abs(state.rotor_speed_rad_s[0] - 1256.6) < 13, `${state.rotor_speed_rad_s}`);
  assert.ok(Math.abs(state.tilt_rad[0]) < 0.2);
});

test('an operator pushes and reads the answer and the tilt; constants by name', async () => {
  const rig = connect(OPERATOR);
  await rig.until('advertise', (e) => e.kind === 'advertise');
  rig.subscribe('PROTOTYPE_B/REPLY');
  rig.subscribe('PROTOTYPE_B/SIM/TRUTH');
  const ask = rig.asks('PROTOTYPE_B/REQUEST');
  ask({verb: 'DISTURB', kind: 'LOAD', moment_nm: [100, 0, 0], duration_ns: 20000000,
    writer: '123456789012345678', counter: 1});
  const reply = (await rig.message('PROTOTYPE_B/REPLY',
    (r) => r.request_writer === 123456789012345678n)).value;
  assert.equal(reply.request_counter, 1n);
  assert.equal(reply.result, 1);
  assert.match(reply.text, /ticks/);
  await rig.message('PROTOTYPE_B/SIM/TRUTH', (t) => t.external_moment_nm[0] === 100);
});

test('what cannot be meant is answered with the field that is wrong', async () => {
  const rig = connect(OPERATOR);
  await rig.until('advertise', (e) => e.kind === 'advertise');
  const ask = rig.asks('PROTOTYPE_B/REQUEST');
  for (const [request, says] of [[{moment: 1}, /did you mean `moment_nm`/], ['NaN', /parse error/],
    ['{"moment_nm":[NaN,0,0]}', /parse error/], [{verb: 'FLY'}, /verb: expected/]]) {
    ask(request);
    await rig.until(`${says}`, (e) => e.kind === 'status' && says.test(e.value.message));
  }
});

test('an observer only looks', async () => {
  const rig = connect(OBSERVER);
  await rig.until('advertise', (e) => e.kind === 'advertise');
  rig.asks('PROTOTYPE_B/REQUEST')({verb: 'DISARM'});
  await rig.until('refusal', (e) => e.kind === 'status' && /only an operator/.test(e.value.message));
});

test('parameters are the rig file; a recording is one that can be set, and fetched', async () => {
  const rig = connect(OPERATOR);
  await rig.until('advertise', (e) => e.kind === 'advertise');
  rig.client.getParameters(['structure.mass_kg', 'initial.q'], 'question');
  const {value} = await rig.until('parameters', (e) => e.kind === 'parameterValues');
  assert.equal(value.id, 'question');
  assert.equal(value.parameters[0].value, 2.5);
  assert.equal(value.parameters[1].value.length, 4);

  const recording = (holds) => rig.until('recording', (e) => e.kind === 'parameterValues' &&
    e.value.parameters.some((p) => p.name === 'recording' && holds(p.value))).then((e) =>
    e.value.parameters.find((p) => p.name === 'recording').value);
  rig.client.subscribeParameterUpdates(['recording']);
  rig.client.setParameters([{name: 'recording', value: true}]);
  const {file} = await recording((r) => r.on && r.bytes > 100000);
  rig.client.setParameters([{name: 'recording', value: false}]);
  await recording((r) => !r.on && r.file === file);
  const list = await (await fetch(new URL('/recordings', OPERATOR))).json();
  assert.ok(list.some(({name}) => name === file));
  const log = Buffer.from(await (await fetch(new URL(`/recordings/${file}`, OPERATOR))).arrayBuffer());
  assert.equal(log.readUInt32BE(0), 0xeda1da01);  // LCM's event log
});
