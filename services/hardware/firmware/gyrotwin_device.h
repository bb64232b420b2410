// The firmware's side of a rig: measures at every sample, lets commands act while all is well, and
// stops by itself when it is not. Rules: README.md. It allocates nothing, waits for nothing, and
// touches the world through the board's functions alone.
//
// All functions of one device are called from one context: the main loop, or one task. Bytes that
// an interrupt receives go through a ring of its own first (example/main.c).
#ifndef GYROTWIN_DEVICE_H
#define GYROTWIN_DEVICE_H

#include "gyrotwin_frame.h"
#include "gyrotwin_outbox.h"
#include "gyrotwin_wire.h"

#ifdef __cplusplus
extern "C" {
#endif

#define GYROTWIN_BEAT_PERIOD_NS 10000000    // between two beats of the device
#define GYROTWIN_BEAT_TIMEOUT_NS 100000000  // of the host's silence, until a safe stop
#define GYROTWIN_COMMAND_TIMEOUT_MAX 10     // samples; a beat that asks for more is refused

// What the drives shall do from now on. What a board must never exceed (current, speed, end stops)
// it limits itself.
typedef enum gyrotwin_drive_mode {
  GYROTWIN_DRIVES_OFF = 0,      // no torque, power stages off where the board can
  GYROTWIN_DRIVES_TORQUE = 1,   // value: torque of drive i [N m]
  GYROTWIN_DRIVES_VOLTAGE = 2,  // value: voltage of motor i [V]
  GYROTWIN_DRIVES_BRAKE = 3     // motors shorted; where there is none, value: damping [N m s/rad]
} gyrotwin_drive_mode;

typedef struct gyrotwin_drives {
  gyrotwin_drive_mode mode;
  double value[GYROTWIN_DRIVES];  // of drives that the rig does not have: 0
} gyrotwin_drives;

// The functions of a board. Each returns at once; all but `request` must be there.
typedef struct gyrotwin_board {
  void* context;  // handed to each of them
  // A clock that never stops or jumps, from any zero [ns].
  int64_t (*now_ns)(void* context);
  // Fills what it has, with its VALID_* bits, E-stop included; everything else is 0 already, and
  // the header is the core's.
  void (*read_sensors)(void* context, gyrotwin_sensors* sensors);
  // At least once a sample. The last one holds until the next.
  void (*drive)(void* context, const gyrotwin_drives* drives);
  // What drive i turns at [rad/s]: of the disc against the structure, or of its gimbal coordinate.
  double (*drive_speed)(void* context, int drive);
  // The flywheels' motors: switches them; tells what they are.
  void (*power_rotors)(void* context, bool on);
  bool (*rotors_powered)(void* context);
  // Gives the line as many of these bytes as it takes without waiting. @return how many
  size_t (*write)(void* context, const uint8_t* bytes, size_t size);
  // DISTURB, FAULT, CANCEL or CLEAR: fills result, id, applied_tick and text. Ticks are the
  // device's. Null: all are refused, as a real machine does.
  void (*request)(void* context, const gyrotwin_request* request, gyrotwin_reply* reply);
} gyrotwin_board;

// Why the device is in a safe stop.
typedef enum gyrotwin_stop {
  GYROTWIN_STOP_NONE = 0,
  GYROTWIN_STOP_HOST,      // the host said so
  GYROTWIN_STOP_COMMANDS,  // no valid command in time
  GYROTWIN_STOP_SILENCE,   // no beat of the host in time, or one that echoes an old one
  GYROTWIN_STOP_ESTOP,     // pressed
  GYROTWIN_STOP_NOT_HELD,  // it was to run without having been held: the device has restarted
  GYROTWIN_STOP_OTHER_RUN  // while running, a beat of another run of the owner
} gyrotwin_stop;

// To be read, not written; begins with gyrotwin_device_init().
typedef struct gyrotwin_device {
  const gyrotwin_board* board;
  gyrotwin_decoder decoder;
  gyrotwin_outbox outbox;

  int32_t rig_id;
  int64_t epoch;    // of this run of the device
  int64_t samples;  // taken: the tick of the next one
  int32_t mode;     // GYROTWIN_HELD, GYROTWIN_RUNNING or GYROTWIN_SAFE_STOP
  gyrotwin_stop stop;
  bool estop;        // pressed at the last sample, or not to be read any more
  bool estop_heard;  // it could be read since the start
  bool was_held;     // the host has said HELD since the start

  gyrotwin_beat host;     // its last beat, as decoded; header.epoch 0: none yet
  int64_t host_heard_ns;  // when
  int64_t run_epoch;      // the owner's, since RUNNING
  int32_t rotors_asked;   // the request of the last beat, obeyed or not

  gyrotwin_drives drives;              // what they do
  double held_speed[GYROTWIN_DRIVES];  // at the safe stop [rad/s]
  int64_t command_sample;  // `samples` when the last command was obeyed, or RUNNING began
  int64_t command_tick;    // its for_tick, likewise
  int32_t command_valid;   // its valid_ticks, from command_tick on

  int64_t beat_due_ns;
  int64_t first_beat_ns;  // when the first one was sent
  int64_t beats;
  int64_t replies;
  int64_t frames_refused;  // of a good checksum, but no message for this device
  int64_t commands_obeyed;
  int64_t commands_refused;  // while running: not finite, unknown mode, of another run, or too old
  int64_t safe_stops;        // entered by itself
} gyrotwin_device;

// HELD, drives off.
// @param board outlives the device
// @param rig_id of the rig file; frames of other rigs are refused
// @param epoch random, not negative: another one at every start of the device
void gyrotwin_device_init(gyrotwin_device* device, const gyrotwin_board* board, int32_t rig_id,
                          int64_t epoch);

// Bytes that have come, in order; as soon as they have come, since commands act at once.
void gyrotwin_device_receive(gyrotwin_device* device, const uint8_t* bytes, size_t size);

// Once each sample period, by the board's timer: measures, watches, drives, sends.
void gyrotwin_device_sample(gyrotwin_device* device);

// Hands over what the line takes now. For the main loop, as often as it likes.
void gyrotwin_device_flush(gyrotwin_device* device);

#ifdef __cplusplus
}
#endif

#endif
