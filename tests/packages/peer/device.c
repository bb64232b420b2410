// A frame of the line goes out and comes back.
#include <gyrotwin_frame.h>
#include <string.h>

int main(void) {
  const uint8_t payload[] = {1, 0, 0, 2, 3, 0, 4, 5, 6};
  uint8_t frame[GYROTWIN_FRAME_MAX];
  const size_t n = gyrotwin_frame_encode(payload, sizeof payload, frame, sizeof frame);
  gyrotwin_decoder decoder;
  gyrotwin_decoder_init(&decoder);
  size_t size = 0;
  for (size_t i = 0; i < n && size == 0; ++i) size = gyrotwin_decoder_take(&decoder, frame[i]);
  return size == sizeof payload && memcmp(decoder.bytes, payload, size) == 0 ? 0 : 1;
}
