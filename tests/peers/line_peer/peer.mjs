// A host on the line to a device, which shares no code with it: takes it through a run, and says what
// it saw. tests/protocol/line_peer_test.cpp is the device; it takes one sample for each frame it hears,
// so that nothing here hangs on how fast either is.
//   node peer.mjs TTY MESSAGES
import {SerialPort} from 'serialport';

import {frame, payloadOf} from './frames.mjs';
import {LcmTypes} from './lcm_types.mjs';

const [tty, messages] = process.argv.slice(2);
const lcm = new LcmTypes(messages);
const {constants: status} = lcm.type('status_t');
const {constants: beats} = lcm.type('beat_t');
const {constants: commands} = lcm.type('command_t');
const {constants: requests} = lcm.type('request_t');
const {constants: replies} = lcm.type('reply_t');

const RIG = 7, OWNER = 4321n;
const header = (tick) => ({rig_id: RIG, source: 2, epoch: OWNER, tick, sequence: tick});
const port = new SerialPort({path: tty, baudRate: 115200});
const samples = [];
const heard = {sensors_t: 0, beat_t: 0, reply_t: 0, unknown: 0};
let sentBeats = 0;
let stuffed = [];
let waiting = null;  // {type, resolve}

function expect(condition, what) {
  if (condition) return;
  console.error(`peer: ${what}`);
  process.exit(1);
}

port.on('error', (error) => expect(false, error.message));
port.on('data', (bytes) => {
  for (const byte of bytes) {
    if (byte !== 0) {
      stuffed.push(byte);
      continue;
    }
    const payload = stuffed.length > 0 ? payloadOf(Buffer.from(stuffed)) : null;
    if (stuffed.length > 0) take(payload && lcm.decode(['sensors_t', 'beat_t', 'reply_t'], payload));
    stuffed = [];
  }
});

const newest = {};

function take(found) {
  if (found === null) {
    ++heard.unknown;
    return;
  }
  ++heard[found.type];
  newest[found.type] = found.message;
  if (found.type === 'sensors_t') samples.push(found.message);
  if (waiting !== null && waiting.type === found.type) {
    const {resolve} = waiting;
    waiting = null;
    resolve(found.message);
  }
}

// Sends bytes and waits for what comes of them, a sample unless said otherwise.
function exchange(bytes, type = 'sensors_t') {
  return new Promise((resolve) => {
    waiting = {type, resolve};
    port.write(bytes);
  });
}

function beat(mode) {
  ++sentBeats;
  return frame(lcm.encode('beat_t', {
    header: header(samples.length), mode, rotors: beats.ROTORS_ON, command_timeout_ticks: 5,
    safe_stop: beats.BRAKE, safe_stop_gain: 0.5, sent_ns: 1000 + sentBeats,
    echo_ns: newest.beat_t ? newest.beat_t.sent_ns : 0,
  }));
}

function command(counter, value) {
  return frame(lcm.encode('command_t', {
    header: header(samples.length), mode: commands.TORQUE_NM, valid_ticks: 5, value,
    for_tick: samples.length, owner_epoch: OWNER, writer: 77, counter,
  }));
}

// Beats of the host until one of the device says what is awaited.
async function until(mode, done, what) {
  for (let i = 0; i < 40; ++i) {
    await exchange(beat(mode));
    if (newest.beat_t && done(newest.beat_t)) return;
  }
  expect(false, `no beat of the device says ${what}`);
}

async function run() {
  // Held: it measures, and says so.
  await until(status.MODE_HELD, (b) => b.mode === status.MODE_HELD && b.echo_ns > 0n, 'HELD');
  expect(newest.beat_t.echo_ns <= 1000n + BigInt(sentBeats), 'echo_ns was never sent');
  expect(newest.beat_t.safe_stop === beats.BRAKE && newest.beat_t.safe_stop_gain === 0.5, 'safe stop');
  expect(newest.beat_t.rotors === beats.ROTORS_ON, 'rotors');

  // Running: commands act.
  await exchange(beat(status.MODE_RUNNING));
  for (let k = 1; k <= 200; ++k) {
    if (k % 5 === 0) await exchange(beat(status.MODE_RUNNING));
    await exchange(command(k, [-k / 8, 1 / k, Math.PI, -0.0]));
  }
  await exchange(command(201, [NaN, 0, 0, 0]));
  expect(newest.beat_t.mode === status.MODE_RUNNING, 'RUNNING');

  // Damage is counted, and what follows is whole.
  const bad = newest.beat_t.frames_bad;
  await exchange(Buffer.concat([Buffer.from([9, 1, 2, 3, 0])]));
  const cut = command(202, [1, 2, 3, 4]);
  await exchange(Buffer.concat([cut.subarray(0, 50), Buffer.from([0])]));

  // No more commands: it stops by itself and stays so.
  await until(status.MODE_RUNNING, (b) => b.mode === status.MODE_SAFE_STOP, 'SAFE_STOP');
  expect(newest.beat_t.safe_stops === 1n, 'one safe stop');
  expect(newest.beat_t.commands_obeyed === 200n, `200 commands obeyed, not ${newest.beat_t.commands_obeyed}`);
  expect(newest.beat_t.frames_bad === bad + 2n, 'two bad frames');

  // A request is answered.
  const request = {header: header(0), verb: requests.DISTURB, kind: requests.LOAD, writer: 5, counter: 6};
  const reply = await exchange(frame(lcm.encode('request_t', request)), 'reply_t');
  const text = Buffer.from(reply.text).toString('ascii').replace(/\0*$/, '');
  expect(reply.result === replies.REFUSED && reply.request_writer === 5n && reply.request_counter === 6n, 'reply');
  expect(/real/.test(text), `reply text: ${text}`);

  await until(status.MODE_HELD, (b) => b.mode === status.MODE_HELD, 'HELD again');

  // Every sample came, once, with what was measured.
  samples.forEach((s, k) => {
    expect(s.header.tick === BigInt(k), `tick ${s.header.tick} at place ${k}`);
    expect(s.gyro_rad_s[2] === k / 1000 && s.load_cell_n === -k, `values of sample ${k}`);
  });
  expect(heard.unknown === 0, 'damaged frames of the device');
  console.log(JSON.stringify({samples: samples.length, beats: heard.beat_t, text}));
  port.close(() => process.exit(0));
}

port.on('open', run);
