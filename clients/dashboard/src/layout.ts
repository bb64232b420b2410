// Where the numbers of a CDR message stand, so that a thousand a second need no whole decoding.
import type {MessageDefinition} from '@foxglove/message-definition';

const SIZES: Record<string, number> = {
  bool: 1, uint8: 1, int8: 1, int16: 2, uint16: 2, int32: 4, uint32: 4, float32: 4, int64: 8, uint64: 8, float64: 8,
};
const ENCAPSULATION = 4;  // [byte]

/** Offsets of the fields before the first one of variable length; `header.epoch` for one in another. */
export class Layout {
  private readonly offsets = new Map<string, number>();

  /** @param definitions as parsed from the schema, the message's own first */
  constructor(private readonly definitions: MessageDefinition[]) {
    this.place(definitions[0]!, '', 0);
  }

  private place(definition: MessageDefinition, prefix: string, begin: number): number | null {
    let at = begin;
    for (const field of definition.definitions) {
      if (field.isConstant) continue;
      if (field.isComplex) {
        const inner = this.definitions.find((each) => each.name === field.type);
        const end = inner && !field.isArray ? this.place(inner, `${prefix}${field.name}.`, at) : null;
        if (end === null) return null;
        at = end;
        continue;
      }
      const size = SIZES[field.type];
      if (size === undefined || (field.isArray && field.arrayLength === undefined)) return null;
      at = Math.ceil(at / size) * size;
      this.offsets.set(prefix + field.name, ENCAPSULATION + at);
      at += size * (field.isArray ? field.arrayLength! : 1);
    }
    return at;
  }

  /** @throws Error where the message has no such field, or none at a place that is known */
  at(name: string): number {
    const offset = this.offsets.get(name);
    if (offset === undefined) throw new Error(`no field ${name} at a known place`);
    return offset;
  }
}

/** The numbers of one message. */
export class Numbers {
  private readonly view: DataView;

  constructor(private readonly layout: Layout, bytes: Uint8Array) {
    this.view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  }

  double(name: string, index = 0): number { return this.view.getFloat64(this.layout.at(name) + 8 * index, true); }
  int32(name: string): number { return this.view.getInt32(this.layout.at(name), true); }
  int64(name: string): bigint { return this.view.getBigInt64(this.layout.at(name), true); }
}
