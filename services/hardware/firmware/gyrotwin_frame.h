// Frames on the line between the hardware daemon and a rig's firmware, both ways:
//   COBS(payload, CRC-32 of the payload little endian), 0x00
// A payload is one encoded message (gyrotwin_wire.h). Byte by byte: README.md.
#ifndef GYROTWIN_FRAME_H
#define GYROTWIN_FRAME_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

// Bytes of the longest payload, a request, and of the checksum behind it.
#define GYROTWIN_PAYLOAD_MAX 448
#define GYROTWIN_CRC_SIZE 4
// Bytes of the frame of a payload of n bytes, at most: a code byte for each 254, and the 0x00.
#define GYROTWIN_FRAME_SIZE(n) ((n) + GYROTWIN_CRC_SIZE + ((n) + GYROTWIN_CRC_SIZE) / 254 + 2)
#define GYROTWIN_FRAME_MAX GYROTWIN_FRAME_SIZE(GYROTWIN_PAYLOAD_MAX)

// CRC-32 of IEEE 802.3: of "123456789" it is 0xcbf43926.
uint32_t gyrotwin_crc32(const uint8_t* bytes, size_t size);

// Writes the frame of a payload, its 0x00 included.
// @param capacity bytes that `frame` takes; GYROTWIN_FRAME_SIZE(size) always do
// @return bytes written; 0: the frame does not fit, or the payload is empty or longer than any is
size_t gyrotwin_frame_encode(const uint8_t* payload, size_t size, uint8_t* frame, size_t capacity);

// Finds frames in a stream of bytes that may begin anywhere and may be damaged anywhere.
typedef struct gyrotwin_decoder {
  uint8_t bytes[GYROTWIN_PAYLOAD_MAX + GYROTWIN_CRC_SIZE];  // decoded so far; the payload first
  uint16_t size;                                            // of these
  uint8_t block_left;  // bytes to come of the present COBS block
  bool zero_due;       // a 0 stands between the present block and the next, if there is one
  bool begun;          // since the last 0x00
  bool too_long;
  int64_t good;  // frames since the start whose checksum was right
  int64_t bad;   // frames since the start that were not
} gyrotwin_decoder;

void gyrotwin_decoder_init(gyrotwin_decoder* decoder);

// Takes the next byte of the stream. Between two 0x00 there is nothing, or a frame, or damage,
// which costs no more than itself: with the next 0x00 a new frame begins.
// @return bytes of a payload that this byte completes, at the beginning of decoder->bytes until the
// next call; 0: none
size_t gyrotwin_decoder_take(gyrotwin_decoder* decoder, uint8_t byte);

#ifdef __cplusplus
}
#endif

#endif
