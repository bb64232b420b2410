// LCM types read from their .lcm files: fingerprint, encoder and decoder, from LCM's own description of
// its format and from nothing else of this project. Structs with fixed arrays, as messages/ has them.
import {readFileSync} from 'node:fs';
import {join} from 'node:path';

const MASK = 0xffffffffffffffffn;
const signed = (x) => BigInt.asIntN(64, x);

// hash_update() and hash_string_update() of lcm-gen.
const update = (v, c) => signed((((v << 8n) & MASK) ^ (signed(v) >> 55n)) + BigInt(c));
const updateText = (v, text) => [...text].reduce((h, c) => update(h, c.charCodeAt(0)), update(v, text.length));

const PRIMITIVES = {
  int32_t: {size: 4, get: (view, at) => view.getInt32(at), put: (view, at, x) => view.setInt32(at, x)},
  int64_t: {size: 8, get: (view, at) => view.getBigInt64(at), put: (view, at, x) => view.setBigInt64(at, BigInt(x))},
  double: {size: 8, get: (view, at) => view.getFloat64(at), put: (view, at, x) => view.setFloat64(at, x)},
  byte: {size: 1, get: (view, at) => view.getUint8(at), put: (view, at, x) => view.setUint8(at, x)},
};

export class LcmTypes {
  constructor(folder) {
    this.folder = folder;
    this.types = new Map();
  }

  // {name, members: [{name, type, length}], constants}
  type(name) {
    if (!this.types.has(name)) this.types.set(name, this.read(name));
    return this.types.get(name);
  }

  read(name) {
    const text = readFileSync(join(this.folder, `${name}.lcm`), 'utf8').replace(/\/\/.*$/gm, '');
    const body = /struct\s+\w+\s*\{([^]*)\}/.exec(text)[1];
    const members = [];
    const constants = {};
    for (const statement of body.split(';').map((s) => s.trim()).filter((s) => s !== '')) {
      const [, constant, type, names] = /^(const\s+)?(\w+)\s+([^]*)$/.exec(statement);
      for (const declared of names.split(',').map((s) => s.trim())) {
        if (constant) {
          const [key, value] = declared.split('=').map((s) => s.trim());
          constants[key] = Number(value);
        } else {
          const [, member, , length] = /^(\w+)\s*(\[(\d+)\])?$/.exec(declared);
          members.push({name: member, type, length});
        }
      }
    }
    return {name, members, constants};
  }

  hash(name) {
    let base = 0x12345678n;
    let nested = 0n;
    for (const {name: member, type, length} of this.type(name).members) {
      base = updateText(base, member);
      if (type in PRIMITIVES) {
        base = updateText(base, type);
      } else {
        nested += this.hash(type);
      }
      base = update(base, length === undefined ? 0 : 1);  // dimensions
      if (length !== undefined) base = updateText(update(base, 0), length);  // 0: a constant
    }
    const sum = signed(base + nested);
    return signed((sum << 1n) + ((sum >> 63n) & 1n));
  }

  size(name) {
    return this.type(name).members.reduce((sum, {type, length}) => {
      const one = type in PRIMITIVES ? PRIMITIVES[type].size : this.size(type);
      return sum + one * Number(length ?? 1);
    }, 0);
  }

  // Members that are not given are 0.
  encode(name, message) {
    const payload = Buffer.alloc(8 + this.size(name));
    const view = new DataView(payload.buffer, payload.byteOffset, payload.length);
    view.setBigInt64(0, this.hash(name));
    this.put(name, message, view, 8);
    return payload;
  }

  put(name, message, view, at) {
    for (const {name: member, type, length} of this.type(name).members) {
      for (let i = 0; i < Number(length ?? 1); ++i) {
        const value = length === undefined ? message?.[member] : message?.[member]?.[i];
        if (type in PRIMITIVES) {
          PRIMITIVES[type].put(view, at, value ?? 0);
          at += PRIMITIVES[type].size;
        } else {
          at = this.put(type, value, view, at);
        }
      }
    }
    return at;
  }

  // {type, message}: the first of `names` that the payload is; null where it is none of them.
  decode(names, payload) {
    if (payload.length < 8) return null;
    const view = new DataView(payload.buffer, payload.byteOffset, payload.length);
    const type = names.find((name) => view.getBigInt64(0) === this.hash(name));
    if (type === undefined || payload.length !== 8 + this.size(type)) return null;
    return {type, message: this.get(type, view, {at: 8})};
  }

  get(name, view, cursor) {
    const message = {};
    for (const {name: member, type, length} of this.type(name).members) {
      const one = () => {
        if (!(type in PRIMITIVES)) return this.get(type, view, cursor);
        const value = PRIMITIVES[type].get(view, cursor.at);
        cursor.at += PRIMITIVES[type].size;
        return value;
      };
      message[member] = length === undefined ? one() : Array.from({length: Number(length)}, one);
    }
    return message;
  }
}
