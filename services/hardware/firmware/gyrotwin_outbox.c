#include "gyrotwin_outbox.h"

#include <string.h>

void gyrotwin_outbox_init(gyrotwin_outbox* outbox) {
  memset(outbox, 0, sizeof *outbox);
  for (unsigned i = 0; i < GYROTWIN_OUTBOX_FRAMES; ++i) outbox->order[i] = (uint8_t)i;
}

// Takes a frame out of those that wait; its place becomes the first free one.
static void remove_frame(gyrotwin_outbox* outbox, unsigned index) {
  const uint8_t place = outbox->order[index];
  const unsigned behind = outbox->count - index - 1u;
  memmove(&outbox->order[index], &outbox->order[index + 1], behind);
  --outbox->count;
  outbox->order[outbox->count] = place;
}

void gyrotwin_outbox_add(gyrotwin_outbox* outbox, const uint8_t* payload, size_t size) {
  if (outbox->count == GYROTWIN_OUTBOX_FRAMES) {
    remove_frame(outbox, outbox->sent > 0 ? 1 : 0);
    ++outbox->dropped;
  }
  const uint8_t place = outbox->order[outbox->count];
  const size_t framed =
      gyrotwin_frame_encode(payload, size, outbox->frames[place].bytes, GYROTWIN_OUTBOX_FRAME_SIZE);
  if (framed == 0) {
    ++outbox->dropped;
    return;
  }
  outbox->frames[place].size = (uint16_t)framed;
  ++outbox->count;
}

void gyrotwin_outbox_flush(gyrotwin_outbox* outbox, gyrotwin_write write, void* context) {
  while (outbox->count > 0) {
    const uint8_t place = outbox->order[0];
    const size_t left = (size_t)outbox->frames[place].size - outbox->sent;
    const size_t taken = write(context, outbox->frames[place].bytes + outbox->sent, left);
    if (taken < left) {
      outbox->sent = (uint16_t)(outbox->sent + taken);
      return;
    }
    outbox->sent = 0;
    remove_frame(outbox, 0);
  }
}
