#include "gyrotwin_frame.h"

// Four bits at a time: a table of 64 bytes.
uint32_t gyrotwin_crc32(const uint8_t* bytes, size_t size) {
  static const uint32_t kTable[16] = {0x00000000, 0x1db71064, 0x3b6e20c8, 0x26d930ac,
                                      0x76dc4190, 0x6b6b51f4, 0x4db26158, 0x5005713c,
                                      0xedb88320, 0xf00f9344, 0xd6d6a3e8, 0xcb61b38c,
                                      0x9b64c2b0, 0x86d3d2d4, 0xa00ae278, 0xbdbdf21c};
  uint32_t crc = 0xffffffff;
  for (size_t i = 0; i < size; ++i) {
    crc ^= bytes[i];
    crc = (crc >> 4) ^ kTable[crc & 15u];
    crc = (crc >> 4) ^ kTable[crc & 15u];
  }
  return ~crc;
}

// Consistent Overhead Byte Stuffing (Cheshire and Baker 1999), written byte by byte.
typedef struct {
  uint8_t* frame;
  size_t size;  // written
  size_t code;  // where the code byte of the open block stands
} stuffer;

static void close_block(stuffer* out) { out->frame[out->code] = (uint8_t)(out->size - out->code); }

static void open_block(stuffer* out) { out->code = out->size++; }

static void stuff(stuffer* out, uint8_t byte) {
  // A full block is followed by no 0; it is closed only when something follows.
  if (out->size - out->code == 255) {
    close_block(out);
    open_block(out);
  }
  if (byte == 0) {
    close_block(out);
    open_block(out);
  } else {
    out->frame[out->size++] = byte;
  }
}

size_t gyrotwin_frame_encode(const uint8_t* payload, size_t size, uint8_t* frame, size_t capacity) {
  if (size == 0 || size > GYROTWIN_PAYLOAD_MAX || capacity < GYROTWIN_FRAME_SIZE(size)) return 0;
  const uint32_t crc = gyrotwin_crc32(payload, size);
  stuffer out = {frame, 0, 0};
  open_block(&out);
  for (size_t i = 0; i < size; ++i) stuff(&out, payload[i]);
  for (unsigned shift = 0; shift < 32; shift += 8) stuff(&out, (uint8_t)(crc >> shift));
  close_block(&out);
  frame[out.size++] = 0;
  return out.size;
}

static void begin(gyrotwin_decoder* decoder) {
  decoder->size = 0;
  decoder->block_left = 0;
  decoder->zero_due = false;
  decoder->begun = false;
  decoder->too_long = false;
}

void gyrotwin_decoder_init(gyrotwin_decoder* decoder) {
  begin(decoder);
  decoder->good = 0;
  decoder->bad = 0;
}

static void put(gyrotwin_decoder* decoder, uint8_t byte) {
  if (decoder->size == sizeof decoder->bytes) {
    decoder->too_long = true;
  } else {
    decoder->bytes[decoder->size++] = byte;
  }
}

// Of what has come since the last 0x00; 0: it is damaged.
static size_t payload_size(const gyrotwin_decoder* decoder) {
  if (decoder->too_long || decoder->block_left != 0) return 0;
  if (decoder->size <= GYROTWIN_CRC_SIZE) return 0;
  const size_t size = decoder->size - (size_t)GYROTWIN_CRC_SIZE;
  uint32_t crc = 0;
  for (unsigned i = 0; i < GYROTWIN_CRC_SIZE; ++i) {
    crc |= (uint32_t)decoder->bytes[size + i] << (8 * i);
  }
  return crc == gyrotwin_crc32(decoder->bytes, size) ? size : 0;
}

size_t gyrotwin_decoder_take(gyrotwin_decoder* decoder, uint8_t byte) {
  if (byte == 0) {
    const bool empty = !decoder->begun;
    const size_t size = payload_size(decoder);
    begin(decoder);
    if (empty) return 0;
    if (size == 0) {
      ++decoder->bad;
    } else {
      ++decoder->good;
    }
    return size;
  }
  decoder->begun = true;
  if (decoder->block_left != 0) {
    put(decoder, byte);
    --decoder->block_left;
    return 0;
  }
  if (decoder->zero_due) put(decoder, 0);
  decoder->block_left = (uint8_t)(byte - 1);
  decoder->zero_due = byte != 255;
  return 0;
}
