// Reads an MCAP file with @mcap/core, with and without its index, decodes every message by the
// schema in the file, and compares with the lines of `gyrotwin log cat --json` on the same log.
//   node read.mjs FILE.mcap CAT.jsonl COMPRESSION RIG.toml      COMPRESSION: zstd or none
import assert from 'node:assert/strict';
import {readFileSync} from 'node:fs';

import {crc32} from '@foxglove/crc';
import {parse} from '@foxglove/rosmsg';
import {MessageReader} from '@foxglove/rosmsg2-serialization';
import {McapIndexedReader, McapStreamReader} from '@mcap/core';
import {decompress} from 'fzstd';

const [file, cat, compression, rig] = process.argv.slice(2);
const bytes = readFileSync(file);
const decompressHandlers = {zstd: (data) => decompress(data)};

// JSON's numbers are doubles here: long integers are kept as texts.
const lines = readFileSync(cat, 'utf8').trimEnd().split('\n')
  .map((line) => JSON.parse(line.replace(/(?<=[:,[])-?\d{16,}(?=[,}\]])/g, '"$&"')))
  .filter((line) => line.message);
assert.ok(lines.length > 0);

const NUMBERS = {inf: Infinity, '-inf': -Infinity, nan: NaN};

// What a value of ours is in the terms of the JSON lines.
function compare(ours, theirs, path) {
  if (typeof ours === 'bigint') return assert.equal(String(ours), String(theirs), path);
  if (typeof ours === 'number') return assert.ok(Object.is(ours, NUMBERS[theirs] ?? theirs), path);
  if (typeof ours === 'string') return assert.equal(ours.replace(/[^ -~]/g, '?'), theirs, path);
  if (typeof theirs === 'string') return assert.equal(Buffer.from(ours).toString('hex'), theirs, path);
  const names = ArrayBuffer.isView(ours) || Array.isArray(ours) ? [...ours.keys()] : Object.keys(ours);
  assert.deepEqual(names.map(String), Object.keys(theirs), path);
  for (const name of names) compare(ours[name], theirs[name], `${path}.${name}`);
}

function check(messages, channels, schemas) {
  assert.equal(messages.length, lines.length);
  const readers = new Map();
  const seen = new Map();
  for (const message of messages) {
    const channel = channels.get(message.channelId);
    const schema = schemas.get(channel.schemaId);
    assert.equal(schema.encoding, 'ros2msg');
    assert.equal(channel.messageEncoding, 'cdr');
    if (!readers.has(schema.id)) {
      readers.set(schema.id,
                  new MessageReader(parse(new TextDecoder().decode(schema.data), {ros2: true})));
    }
    const expected = lines.filter((line) => line.channel === channel.topic);
    const count = seen.get(channel.topic) ?? 0;
    const line = expected[count];
    seen.set(channel.topic, count + 1);
    assert.equal(message.logTime, BigInt(line.time_us) * 1000n);
    assert.equal(message.publishTime, message.logTime);
    const sequence = BigInt(line.message.header.sequence);
    assert.equal(BigInt(message.sequence), sequence < 2n ** 32n ? sequence : 0n);
    compare(readers.get(schema.id).readMessage(message.data), line.message, channel.topic);
  }
}

// By the index.
const readable = {
  size: async () => BigInt(bytes.length),
  read: async (offset, size) => bytes.subarray(Number(offset), Number(offset + size)),
};
const reader = await McapIndexedReader.Initialize({readable, decompressHandlers});
assert.equal(reader.header.profile, 'ros2');
const indexed = [];
for await (const message of reader.readMessages({validateCrcs: true})) indexed.push(message);
check(indexed, reader.channelsById, reader.schemasById);

assert.ok(reader.chunkIndexes.length > 1);
for (const chunk of reader.chunkIndexes) {
  assert.equal(chunk.compression, compression === 'none' ? '' : compression);
}
assert.equal(reader.statistics.messageCount, BigInt(lines.length));
assert.equal(reader.statistics.chunkCount, reader.chunkIndexes.length);
assert.equal(reader.statistics.channelCount, reader.channelsById.size);
assert.equal(reader.statistics.schemaCount, reader.schemasById.size);
assert.equal(reader.statistics.messageStartTime, BigInt(lines[0].time_us) * 1000n);
assert.equal(reader.statistics.messageEndTime, BigInt(lines.at(-1).time_us) * 1000n);
for (const [id, channel] of reader.channelsById) {
  assert.equal(reader.statistics.channelMessageCounts.get(id),
               BigInt(lines.filter((line) => line.channel === channel.topic).length));
}

// One topic, and a stretch of time.
const states = lines.filter((line) => line.channel.endsWith('/LIVE/STATE'));
const [from, to] = [states[10], states[20]].map((line) => BigInt(line.time_us) * 1000n);
let picked = 0;
for await (const message of reader.readMessages(
    {topics: [states[0].channel], startTime: from, endTime: to, reverse: true})) {
  assert.ok(message.logTime >= from && message.logTime <= to);
  ++picked;
}
assert.equal(picked, 11);

// The rig file and who recorded it.
const attachments = [];
for await (const attachment of reader.readAttachments({validateCrcs: true})) {
  attachments.push(attachment);
}
assert.equal(attachments.length, 1);
assert.equal(attachments[0].name, 'rig.toml');
assert.deepEqual(Buffer.from(attachments[0].data), readFileSync(rig));
for await (const metadata of reader.readMetadata({name: 'gyrotwin'})) {
  assert.equal(metadata.metadata.get('rig'), 'test');
  assert.equal(metadata.metadata.get('host'), 'here');
}
assert.equal(reader.statistics.attachmentCount, 1);
assert.equal(reader.statistics.metadataCount, 1);

// From start to end, as a reader without the index does.
const stream = new McapStreamReader({decompressHandlers, validateCrcs: true});
stream.append(bytes);
const streamed = [], channels = new Map(), schemas = new Map(), kinds = [];
for (let record = stream.nextRecord(); record; record = stream.nextRecord()) {
  if (record.type === 'Message') streamed.push(record);
  if (record.type === 'Channel') channels.set(record.id, record);
  if (record.type === 'Schema') schemas.set(record.id, record);
  if (record.type !== 'Message') kinds.push(record.type);
}
assert.ok(stream.done());
check(streamed, channels, schemas);

// Every group of the summary is where the summary offsets say.
const groups = {Schema: 3, Channel: 4, Statistics: 11, ChunkIndex: 8, AttachmentIndex: 10, MetadataIndex: 13};
const end = kinds.indexOf('DataEnd');
for (const [kind, opcode] of Object.entries(groups)) {
  assert.ok(kinds.indexOf(kind, end) > end, kind);
  const {groupStart, groupLength} = reader.summaryOffsetsByOpcode.get(opcode);
  let at = Number(groupStart);
  while (at < Number(groupStart + groupLength)) {
    assert.equal(bytes[at], opcode, kind);
    at += 9 + Number(bytes.readBigUInt64LE(at + 1));
  }
  assert.equal(at, Number(groupStart + groupLength), kind);
}

// The sums that @mcap/core does not check.
const data = bytes.subarray(0, Number(reader.dataEndOffset));
assert.equal(reader.dataSectionCrc, crc32(data));
assert.notEqual(reader.footer.summaryCrc, 0);
console.log(`${lines.length} messages on ${reader.channelsById.size} topics agree`);
