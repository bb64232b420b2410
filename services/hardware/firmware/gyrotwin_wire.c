#include "gyrotwin_wire.h"

#include <float.h>
#include <string.h>

// One word of the wire is one word of the struct, whatever it holds.
typedef char double_is_ieee_64_bit[sizeof(double) == 8 && DBL_MANT_DIG == 53 ? 1 : -1];

enum { kFingerprint = 8, kMac = 32 };

// Fields in the order of the wire that have the same width.
typedef struct {
  uint16_t offset;  // in the struct
  uint8_t width;    // of one of them [bytes]
  uint8_t count;    // of words
} field;

typedef struct {
  uint64_t fingerprint;
  const field* fields;
  size_t count;
} message;

#define FIELD(type, name) \
  { (uint16_t) offsetof(type, name), (uint8_t)sizeof(((type*)0)->name), 1 }
#define ARRAY(type, name)                                                  \
  {                                                                        \
    (uint16_t) offsetof(type, name), (uint8_t)sizeof(((type*)0)->name[0]), \
        (uint8_t)(sizeof(((type*)0)->name) / sizeof(((type*)0)->name[0]))  \
  }
#define HEADER(type)                                                                           \
  FIELD(type, header.rig_id), FIELD(type, header.source), FIELD(type, header.epoch),           \
      FIELD(type, header.sequence), FIELD(type, header.tick), FIELD(type, header.sim_time_ns), \
      FIELD(type, header.sender_mono_ns)
#define MESSAGE(fingerprint, fields) \
  { fingerprint, fields, sizeof(fields) / sizeof((fields)[0]) }

static const field kSensorsFields[] = {HEADER(gyrotwin_sensors),
                                       FIELD(gyrotwin_sensors, valid),
                                       FIELD(gyrotwin_sensors, estop),
                                       ARRAY(gyrotwin_sensors, gyro_rad_s),
                                       ARRAY(gyrotwin_sensors, acceleration_m_s2),
                                       FIELD(gyrotwin_sensors, disc_angle_rad),
                                       ARRAY(gyrotwin_sensors, gimbal_angle_rad),
                                       ARRAY(gyrotwin_sensors, rotor_speed_rad_s),
                                       ARRAY(gyrotwin_sensors, drive_current_a),
                                       FIELD(gyrotwin_sensors, bus_voltage_v),
                                       FIELD(gyrotwin_sensors, load_cell_n)};

static const field kBeatFields[] = {HEADER(gyrotwin_beat),
                                    FIELD(gyrotwin_beat, mode),
                                    FIELD(gyrotwin_beat, rotors),
                                    FIELD(gyrotwin_beat, command_timeout_ticks),
                                    FIELD(gyrotwin_beat, safe_stop),
                                    FIELD(gyrotwin_beat, safe_stop_gain),
                                    FIELD(gyrotwin_beat, sent_ns),
                                    FIELD(gyrotwin_beat, echo_ns),
                                    FIELD(gyrotwin_beat, heard_ns),
                                    FIELD(gyrotwin_beat, frames_received),
                                    FIELD(gyrotwin_beat, frames_bad),
                                    FIELD(gyrotwin_beat, frames_dropped),
                                    FIELD(gyrotwin_beat, commands_obeyed),
                                    FIELD(gyrotwin_beat, safe_stops)};

static const field kReplyFields[] = {HEADER(gyrotwin_reply),
                                     FIELD(gyrotwin_reply, request_writer),
                                     FIELD(gyrotwin_reply, request_counter),
                                     FIELD(gyrotwin_reply, verb),
                                     FIELD(gyrotwin_reply, result),
                                     FIELD(gyrotwin_reply, applied_tick),
                                     FIELD(gyrotwin_reply, id),
                                     ARRAY(gyrotwin_reply, text)};

static const field kCommandFields[] = {HEADER(gyrotwin_command),
                                       FIELD(gyrotwin_command, mode),
                                       FIELD(gyrotwin_command, valid_ticks),
                                       ARRAY(gyrotwin_command, value),
                                       FIELD(gyrotwin_command, for_tick),
                                       FIELD(gyrotwin_command, owner_epoch),
                                       FIELD(gyrotwin_command, writer),
                                       FIELD(gyrotwin_command, counter)};

static const field kRequestFields[] = {HEADER(gyrotwin_request),
                                       FIELD(gyrotwin_request, verb),
                                       FIELD(gyrotwin_request, kind),
                                       FIELD(gyrotwin_request, initial_given),
                                       FIELD(gyrotwin_request, target),
                                       ARRAY(gyrotwin_request, initial_q),
                                       ARRAY(gyrotwin_request, initial_v),
                                       FIELD(gyrotwin_request, speed_factor),
                                       FIELD(gyrotwin_request, step_ticks),
                                       FIELD(gyrotwin_request, id),
                                       FIELD(gyrotwin_request, start_tick),
                                       FIELD(gyrotwin_request, duration_ns),
                                       FIELD(gyrotwin_request, rise_ns),
                                       FIELD(gyrotwin_request, seed),
                                       ARRAY(gyrotwin_request, force_n),
                                       ARRAY(gyrotwin_request, moment_nm),
                                       ARRAY(gyrotwin_request, frequency_hz),
                                       FIELD(gyrotwin_request, speed_m_s),
                                       FIELD(gyrotwin_request, direction_rad),
                                       FIELD(gyrotwin_request, turbulence_m_s),
                                       FIELD(gyrotwin_request, length_m),
                                       FIELD(gyrotwin_request, correlation_s),
                                       FIELD(gyrotwin_request, yaw_rate_rad_s),
                                       FIELD(gyrotwin_request, deceleration_m_s2),
                                       FIELD(gyrotwin_request, mass_kg),
                                       ARRAY(gyrotwin_request, position_m),
                                       FIELD(gyrotwin_request, level),
                                       FIELD(gyrotwin_request, delay_ns),
                                       FIELD(gyrotwin_request, owner_epoch),
                                       FIELD(gyrotwin_request, writer),
                                       FIELD(gyrotwin_request, counter)};

static const message kSensors = MESSAGE(GYROTWIN_SENSORS_FINGERPRINT, kSensorsFields);
static const message kBeat = MESSAGE(GYROTWIN_BEAT_FINGERPRINT, kBeatFields);
static const message kReply = MESSAGE(GYROTWIN_REPLY_FINGERPRINT, kReplyFields);
static const message kCommand = MESSAGE(GYROTWIN_COMMAND_FINGERPRINT, kCommandFields);
static const message kRequest = MESSAGE(GYROTWIN_REQUEST_FINGERPRINT, kRequestFields);

static void put_word(uint8_t* bytes, uint64_t word, unsigned width) {
  for (unsigned i = width; i > 0; --i) {
    bytes[i - 1] = (uint8_t)word;
    word >>= 8;
  }
}

static uint64_t get_word(const uint8_t* bytes, unsigned width) {
  uint64_t word = 0;
  for (unsigned i = 0; i < width; ++i) word = (word << 8) | bytes[i];
  return word;
}

// memcpy: a word is an int32, an int64, a double or a byte of text.
static uint64_t load(const uint8_t* from, unsigned width) {
  uint32_t narrow;
  uint64_t wide;
  if (width == 1) return *from;
  if (width == 4) {
    memcpy(&narrow, from, sizeof narrow);
    return narrow;
  }
  memcpy(&wide, from, sizeof wide);
  return wide;
}

static void store(uint8_t* to, uint64_t word, unsigned width) {
  const uint32_t narrow = (uint32_t)word;
  if (width == 1) {
    *to = (uint8_t)word;
  } else if (width == 4) {
    memcpy(to, &narrow, sizeof narrow);
  } else {
    memcpy(to, &word, sizeof word);
  }
}

static void encode(const message* type, const void* from, uint8_t* payload) {
  put_word(payload, type->fingerprint, kFingerprint);
  payload += kFingerprint;
  for (size_t i = 0; i < type->count; ++i) {
    const field* const f = &type->fields[i];
    const uint8_t* word = (const uint8_t*)from + f->offset;
    for (unsigned n = 0; n < f->count; ++n) {
      put_word(payload, load(word, f->width), f->width);
      payload += f->width;
      word += f->width;
    }
  }
  memset(payload, 0, kMac);
}

static void decode(const message* type, const uint8_t* payload, void* to) {
  payload += kFingerprint;
  for (size_t i = 0; i < type->count; ++i) {
    const field* const f = &type->fields[i];
    uint8_t* word = (uint8_t*)to + f->offset;
    for (unsigned n = 0; n < f->count; ++n) {
      store(word, get_word(payload, f->width), f->width);
      payload += f->width;
      word += f->width;
    }
  }
}

uint64_t gyrotwin_fingerprint(const uint8_t* payload, size_t size) {
  return size < kFingerprint ? 0 : get_word(payload, kFingerprint);
}

static bool is(const message* type, const uint8_t* payload, size_t size, size_t expected) {
  return size == expected && gyrotwin_fingerprint(payload, size) == type->fingerprint;
}

void gyrotwin_sensors_encode(const gyrotwin_sensors* sensors, uint8_t* payload) {
  encode(&kSensors, sensors, payload);
}

void gyrotwin_beat_encode(const gyrotwin_beat* beat, uint8_t* payload) {
  encode(&kBeat, beat, payload);
}

void gyrotwin_reply_encode(const gyrotwin_reply* reply, uint8_t* payload) {
  encode(&kReply, reply, payload);
}

void gyrotwin_command_encode(const gyrotwin_command* command, uint8_t* payload) {
  encode(&kCommand, command, payload);
}

void gyrotwin_request_encode(const gyrotwin_request* request, uint8_t* payload) {
  encode(&kRequest, request, payload);
}

bool gyrotwin_sensors_decode(const uint8_t* payload, size_t size, gyrotwin_sensors* sensors) {
  if (!is(&kSensors, payload, size, GYROTWIN_SENSORS_SIZE)) return false;
  decode(&kSensors, payload, sensors);
  return true;
}

bool gyrotwin_beat_decode(const uint8_t* payload, size_t size, gyrotwin_beat* beat) {
  if (!is(&kBeat, payload, size, GYROTWIN_BEAT_SIZE)) return false;
  decode(&kBeat, payload, beat);
  return true;
}

bool gyrotwin_reply_decode(const uint8_t* payload, size_t size, gyrotwin_reply* reply) {
  if (!is(&kReply, payload, size, GYROTWIN_REPLY_SIZE)) return false;
  decode(&kReply, payload, reply);
  return true;
}

bool gyrotwin_command_decode(const uint8_t* payload, size_t size, gyrotwin_command* command) {
  if (!is(&kCommand, payload, size, GYROTWIN_COMMAND_SIZE)) return false;
  decode(&kCommand, payload, command);
  return true;
}

bool gyrotwin_request_decode(const uint8_t* payload, size_t size, gyrotwin_request* request) {
  if (!is(&kRequest, payload, size, GYROTWIN_REQUEST_SIZE)) return false;
  decode(&kRequest, payload, request);
  return true;
}
