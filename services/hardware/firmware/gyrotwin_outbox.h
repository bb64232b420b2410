// Frames that wait to go out on a line that takes what it likes. A line that takes nothing costs
// the oldest frames, whole, never time.
#ifndef GYROTWIN_OUTBOX_H
#define GYROTWIN_OUTBOX_H

#include <stddef.h>
#include <stdint.h>

#include "gyrotwin_frame.h"
#include "gyrotwin_wire.h"

#ifdef __cplusplus
extern "C" {
#endif

// Frames that may wait, the one that is going out included: 2 to 255.
#ifndef GYROTWIN_OUTBOX_FRAMES
#define GYROTWIN_OUTBOX_FRAMES 8
#endif
#if GYROTWIN_OUTBOX_FRAMES < 2 || GYROTWIN_OUTBOX_FRAMES > 255
#error "GYROTWIN_OUTBOX_FRAMES must be from 2 to 255: places are counted in a byte"
#endif
// The longest frame of a device, a reply.
#define GYROTWIN_OUTBOX_FRAME_SIZE GYROTWIN_FRAME_SIZE(GYROTWIN_REPLY_SIZE)

typedef struct gyrotwin_outbox {
  struct {
    uint16_t size;
    uint8_t bytes[GYROTWIN_OUTBOX_FRAME_SIZE];
  } frames[GYROTWIN_OUTBOX_FRAMES];
  uint8_t order[GYROTWIN_OUTBOX_FRAMES];  // places in `frames`; those that wait first, oldest first
  uint8_t count;                          // of those that wait
  uint16_t sent;                          // bytes of the oldest that are out
  int64_t dropped;                        // frames that never went out, since the start
} gyrotwin_outbox;

void gyrotwin_outbox_init(gyrotwin_outbox* outbox);

// Queues the frame of a payload. Where there is no room, the oldest frame of which nothing is out
// is dropped.
void gyrotwin_outbox_add(gyrotwin_outbox* outbox, const uint8_t* payload, size_t size);

// Takes at most `size` bytes, now and without waiting. @return how many it took
typedef size_t (*gyrotwin_write)(void* context, const uint8_t* bytes, size_t size);

// Hands over what the line takes.
void gyrotwin_outbox_flush(gyrotwin_outbox* outbox, gyrotwin_write write, void* context);

#ifdef __cplusplus
}
#endif

#endif
