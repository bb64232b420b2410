// Frames: COBS by npm's `cobs`, CRC-32 by its definition.
import cobs from 'cobs';

export function crc32(bytes) {
  let crc = 0xffffffff;
  for (const byte of bytes) {
    crc ^= byte;
    for (let bit = 0; bit < 8; ++bit) crc = (crc >>> 1) ^ (crc & 1 ? 0xedb88320 : 0);
  }
  return ~crc >>> 0;
}

export function frame(payload) {
  const checked = Buffer.alloc(payload.length + 4);
  payload.copy(checked);
  checked.writeUInt32LE(crc32(payload), payload.length);
  return Buffer.concat([cobs.encode(checked), Buffer.from([0])]);
}

// What stands between two zeros, without them; null where it is damaged.
export function payloadOf(stuffed) {
  const checked = cobs.decode(stuffed);
  if (checked.length < 5) return null;
  const payload = checked.subarray(0, -4);
  return checked.readUInt32LE(payload.length) === crc32(payload) ? Buffer.from(payload) : null;
}
