// Who means harm is refused and counted; who means well does not notice.
//   node --test hostile.test.mjs      $GATEWAY_OPERATOR, $GATEWAY_OBSERVER: the gateway's addresses
import assert from 'node:assert/strict';
import {connect as dial} from 'node:net';
import {after, before, test} from 'node:test';
import {WebSocket} from 'ws';

import {Rig} from './rig.mjs';

const OPERATOR = process.env.GATEWAY_OPERATOR;
const OBSERVER = process.env.GATEWAY_OBSERVER;
const SOCKET = OBSERVER.replace('http:', 'ws:');
const {hostname, port} = new URL(OBSERVER);
const STATE = 'PROTOTYPE_B/LIVE/STATE';

let good;  // a client that must not notice
before(async () => {
  good = new Rig(SOCKET);
  await good.until('advertise', (e) => e.kind === 'advertise');
  good.subscribe(STATE);
  await good.message(STATE);
});
after(() => {
  const states = good.heard.filter((e) => e.topic === STATE).map((e) => e.value.header);
  good.close();
  for (let i = 1; i < states.length; ++i) {
    assert.equal(states[i].sequence - states[i - 1].sequence, 1n, 'the good client lost STATEs');
  }
  assert.ok(states.length > 1000);
});

async function metric(name) {
  const text = await (await fetch(new URL('/metrics', OBSERVER))).text();
  return Number(new RegExp(`^gyrotwin_${name.replace(/[{}"]/g, '\\$&')}.* (\\S+)$`, 'm').exec(text)[1]);
}
const refused = (reason) => metric(`gateway_refused_total{rig="prototype_b",reason="${reason}"}`);

// Sends bytes. @return all that comes until the other side closes
function raw(bytes) {
  return new Promise((resolve, reject) => {
    const socket = dial(Number(port), hostname, () => socket.write(bytes));
    let said = '';
    socket.on('data', (data) => { said += data.toString('latin1'); });
    socket.on('close', () => resolve(said));
    socket.on('error', (error) => (error.code === 'ECONNRESET' ? resolve(said) : reject(error)));
  });
}
const get = (target, headers = '') =>
  raw(`GET ${target} HTTP/1.1\r\nHost: ${hostname}:${port}\r\n${headers}Connection: close\r\n\r\n`);

// How a handshake ends: 'open', or the status of the refusal.
function handshake(url, options = {}, protocols = ['foxglove.websocket.v1']) {
  return new Promise((resolve) => {
    const socket = new WebSocket(url, protocols, options);
    socket.on('open', () => { socket.terminate(); resolve('open'); });
    socket.on('unexpected-response', (_, response) => { response.resume(); resolve(response.statusCode); });
    socket.on('error', () => resolve('error'));
  });
}

test('pages of other sites, wrong names, wrong tokens, wrong subprotocols', async () => {
  const before = await refused('access');
  assert.equal(await handshake(SOCKET, {origin: 'https://evil.example'}), 403);
  assert.equal(await handshake(SOCKET, {origin: 'null'}), 403);
  assert.equal(await handshake(SOCKET, {headers: {Host: 'evil.example'}}), 403);
  assert.equal(await handshake(SOCKET.replace(/token=.*/, 'token=0000')), 403);
  assert.equal(await refused('access'), before + 4);
  assert.equal(await handshake(SOCKET, {}, ['chat']), 400);
  assert.equal(await handshake(SOCKET, {origin: `http://${hostname}:${port}`}), 'open');
});

test('paths that lead elsewhere', async () => {
  for (const target of ['/../../../etc/passwd', '/..%2f..%2fetc/passwd', '/recordings/../../etc/passwd',
    '/recordings/%2e%2e%2fetc%2fpasswd', '/recordings/..', '/recordings/.hidden.lcm', '/recordings//etc/passwd',
    '/assets/../../../../etc/passwd', '//etc/passwd', `/${'a/'.repeat(2000)}`]) {
    const answer = await get(target);
    assert.match(answer, /^HTTP\/1\.1 404 /, target);
    assert.ok(!answer.includes('root:'), target);
  }
});

test('what is no HTTP, and what is too long of it', async () => {
  const before = await refused('malformed');
  await raw('\x00\x01\x02\x03\r\n\r\n');
  await raw(`GET / HTTP/1.1\r\nHost: x\r\nX: ${'a'.repeat(20000)}\r\n\r\n`);
  await raw('GET / HTTP/1.1\r\nContent-Length: 10000000\r\n\r\n' + 'x'.repeat(1000));
  assert.equal(await refused('malformed'), before + 3);
  assert.match(await raw(`POST / HTTP/1.1\r\nHost: ${hostname}:${port}\r\nConnection: close\r\n\r\n`), / 405 /);
});

test('messages that are nonsense, too large, or of another kind', async () => {
  const rig = new Rig(SOCKET);
  await rig.until('advertise', (e) => e.kind === 'advertise');
  const nonsense = ['', '{', 'null', '[]', '{"op":{}}', '{"op":"subscribe","subscriptions":{}}',
    `{"op":"subscribe","subscriptions":[${'{"id":1,"channelId":99},'.repeat(300)}{}]}`,
    '['.repeat(20000), '{"op":"getParameters","parameterNames":[{}]}'];
  for (const text of nonsense) rig.socket.send(text);
  for (let i = 0; i < 500; ++i) {
    rig.socket.send(Uint8Array.from({length: i % 50}, (_, k) => (k * 37 + i * 101) % 256));
  }
  await rig.until('errors', () => rig.heard.filter((e) => e.kind === 'status').length >= 500);
  rig.client.getParameters(['rig.id']);
  await rig.until('an answer', (e) => e.kind === 'parameterValues' && e.value.parameters.length === 1);
  rig.socket.send('x'.repeat(70000));
  await rig.until('the end', (e) => e.kind === 'close');
});

test('two hundred connections', async () => {
  const before = await refused('busy');
  const sockets = await Promise.all(Array.from({length: 200}, () => new Promise((resolve) => {
    const socket = dial(Number(port), hostname, () => resolve(socket));
    socket.on('error', () => {});
  })));
  await new Promise((resolve) => setTimeout(resolve, 500));
  sockets.forEach((socket) => socket.destroy());
  await new Promise((resolve) => setTimeout(resolve, 500));
  assert.ok(await refused('busy') - before >= 130);
  assert.equal(await handshake(SOCKET), 'open');
});

test('who does not read loses his own, and memory stays bounded', async () => {
  const slow = new Rig(SOCKET);
  await slow.until('advertise', (e) => e.kind === 'advertise');
  for (const topic of slow.channels.keys()) slow.subscribe(topic);
  await slow.message(STATE);
  const before = await metric('gateway_left_out_messages_total');
  slow.socket.pause();
  for (let waits = 0; await metric('gateway_left_out_messages_total') === before; ++waits) {
    assert.ok(waits < 100, 'nothing was left out');
    assert.ok(await metric('gateway_queued_bytes') < 1 << 20);
    await new Promise((resolve) => setTimeout(resolve, 200));
  }
  assert.ok(await metric('gateway_queued_bytes') < 1 << 20);
  slow.socket.terminate();
});

test('an operator token in the clear is needed to act, whatever the path', async () => {
  const rig = new Rig(OPERATOR.replace('http:', 'ws:').replace('/?', '/metrics?'));
  const info = (await rig.until('serverInfo', (e) => e.kind === 'serverInfo')).value;
  assert.equal(info.metadata.role, 'operator');
  rig.close();
});
