// The messages on the line, as C structs and as bytes: exactly those of LCM, whose types are in
// messages/*.lcm, where every field has its unit. `mac` is left out: on a line it is 0.
#ifndef GYROTWIN_WIRE_H
#define GYROTWIN_WIRE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

// First 8 bytes of a payload: which type it is.
#define GYROTWIN_SENSORS_FINGERPRINT UINT64_C(0xe3b842d4a4e31296)
#define GYROTWIN_BEAT_FINGERPRINT UINT64_C(0x3404e151a3c136a3)
#define GYROTWIN_REPLY_FINGERPRINT UINT64_C(0xc8c719de690f4a8d)
#define GYROTWIN_COMMAND_FINGERPRINT UINT64_C(0x5dda31ec6c26fc3b)
#define GYROTWIN_REQUEST_FINGERPRINT UINT64_C(0xff7f8b44a5fafc27)

// Bytes of a payload, fingerprint included.
#define GYROTWIN_SENSORS_SIZE 264
#define GYROTWIN_BEAT_SIZE 176
#define GYROTWIN_REPLY_SIZE 288
#define GYROTWIN_COMMAND_SIZE 160
#define GYROTWIN_REQUEST_SIZE 448

enum { GYROTWIN_HARDWARE = 2 };  // header.source of the daemon and of the device
enum { GYROTWIN_DRIVES = 4, GYROTWIN_GYROS = 4 };

// beat.mode, as status_t's.
enum {
  GYROTWIN_HELD = 0,
  GYROTWIN_RUNNING = 1,
  GYROTWIN_PAUSED = 2,
  GYROTWIN_SAFE_STOP = 3,
  GYROTWIN_FALLEN = 4,
  GYROTWIN_FAULT = 5
};
enum { GYROTWIN_ZERO_TORQUE = 1, GYROTWIN_BRAKE = 2, GYROTWIN_HOLD_SPEED = 3 };  // beat.safe_stop
enum {
  GYROTWIN_ROTORS_AS_THEY_ARE = 0,
  GYROTWIN_ROTORS_ON = 1,
  GYROTWIN_ROTORS_OFF = 2
};                                                        // beat.rotors
enum { GYROTWIN_TORQUE_NM = 1, GYROTWIN_VOLTAGE_V = 2 };  // command.mode
enum { GYROTWIN_APPLIED = 1, GYROTWIN_REFUSED = 2 };      // reply.result
// request.verb, those that pass the line.
enum {
  GYROTWIN_VERB_DISTURB = 8,
  GYROTWIN_VERB_CLEAR = 9,
  GYROTWIN_VERB_CANCEL = 10,
  GYROTWIN_VERB_FAULT = 12
};
// sensors.valid is a sum of these.
enum {
  GYROTWIN_VALID_GYRO = 1,
  GYROTWIN_VALID_ACCELEROMETER = 2,
  GYROTWIN_VALID_DISC = 4,
  GYROTWIN_VALID_GIMBALS = 8,
  GYROTWIN_VALID_ROTORS = 16,
  GYROTWIN_VALID_CURRENTS = 32,
  GYROTWIN_VALID_BUS_VOLTAGE = 64,
  GYROTWIN_VALID_LOAD_CELL = 128,
  GYROTWIN_VALID_ESTOP = 256
};

typedef struct gyrotwin_header {
  int32_t rig_id;
  int32_t source;
  int64_t epoch;
  int64_t sequence;
  int64_t tick;
  int64_t sim_time_ns;
  int64_t sender_mono_ns;
} gyrotwin_header;

typedef struct gyrotwin_sensors {
  gyrotwin_header header;
  int32_t valid;
  int32_t estop;
  double gyro_rad_s[3];
  double acceleration_m_s2[3];
  double disc_angle_rad;
  double gimbal_angle_rad[GYROTWIN_GYROS];
  double rotor_speed_rad_s[GYROTWIN_GYROS];
  double drive_current_a[GYROTWIN_DRIVES];
  double bus_voltage_v;
  double load_cell_n;
} gyrotwin_sensors;

typedef struct gyrotwin_beat {
  gyrotwin_header header;
  int32_t mode;
  int32_t rotors;
  int32_t command_timeout_ticks;
  int32_t safe_stop;
  double safe_stop_gain;
  int64_t sent_ns;
  int64_t echo_ns;
  int64_t heard_ns;
  int64_t frames_received;
  int64_t frames_bad;
  int64_t frames_dropped;
  int64_t commands_obeyed;
  int64_t safe_stops;
} gyrotwin_beat;

typedef struct gyrotwin_command {
  gyrotwin_header header;
  int32_t mode;
  int32_t valid_ticks;
  double value[GYROTWIN_DRIVES];
  int64_t for_tick;
  int64_t owner_epoch;
  int64_t writer;
  int64_t counter;
} gyrotwin_command;

typedef struct gyrotwin_request {
  gyrotwin_header header;
  int32_t verb;
  int32_t kind;
  int32_t initial_given;
  int32_t target;
  double initial_q[6];
  double initial_v[6];
  double speed_factor;
  int64_t step_ticks;
  int64_t id;
  int64_t start_tick;
  int64_t duration_ns;
  int64_t rise_ns;
  int64_t seed;
  double force_n[3];
  double moment_nm[3];
  double frequency_hz[2];
  double speed_m_s;
  double direction_rad;
  double turbulence_m_s;
  double length_m;
  double correlation_s;
  double yaw_rate_rad_s;
  double deceleration_m_s2;
  double mass_kg;
  double position_m[3];
  double level;
  int64_t delay_ns;
  int64_t owner_epoch;
  int64_t writer;
  int64_t counter;
} gyrotwin_request;

typedef struct gyrotwin_reply {
  gyrotwin_header header;
  int64_t request_writer;
  int64_t request_counter;
  int32_t verb;
  int32_t result;
  int64_t applied_tick;
  int64_t id;
  uint8_t text[160];
} gyrotwin_reply;

// The type of a payload; 0 where it is too short to have one.
uint64_t gyrotwin_fingerprint(const uint8_t* payload, size_t size);

// Write GYROTWIN_..._SIZE bytes.
void gyrotwin_sensors_encode(const gyrotwin_sensors* sensors, uint8_t* payload);
void gyrotwin_beat_encode(const gyrotwin_beat* beat, uint8_t* payload);
void gyrotwin_reply_encode(const gyrotwin_reply* reply, uint8_t* payload);
void gyrotwin_command_encode(const gyrotwin_command* command, uint8_t* payload);
void gyrotwin_request_encode(const gyrotwin_request* request, uint8_t* payload);

// @return false, with the struct as it was: the payload is not of this type and size
bool gyrotwin_sensors_decode(const uint8_t* payload, size_t size, gyrotwin_sensors* sensors);
bool gyrotwin_beat_decode(const uint8_t* payload, size_t size, gyrotwin_beat* beat);
bool gyrotwin_reply_decode(const uint8_t* payload, size_t size, gyrotwin_reply* reply);
bool gyrotwin_command_decode(const uint8_t* payload, size_t size, gyrotwin_command* command);
bool gyrotwin_request_decode(const uint8_t* payload, size_t size, gyrotwin_request* request);

#ifdef __cplusplus
}
#endif

#endif
