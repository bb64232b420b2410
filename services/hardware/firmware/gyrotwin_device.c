#include "gyrotwin_device.h"

#include <string.h>

// By its bits: isfinite() is constant where a compiler takes all numbers for finite.
static bool is_finite(double value) {
  uint64_t bits;
  memcpy(&bits, &value, sizeof bits);
  return ((bits >> 52) & 0x7ff) != 0x7ff;
}

static void apply(gyrotwin_device* device) {
  device->board->drive(device->board->context, &device->drives);
}

static void set_drives(gyrotwin_device* device, gyrotwin_drive_mode mode, double value) {
  device->drives.mode = mode;
  for (int i = 0; i < GYROTWIN_DRIVES; ++i) device->drives.value[i] = value;
}

static double speed_of(const gyrotwin_device* device, int drive) {
  return device->board->drive_speed(device->board->context, drive);
}

// What the last beat asked for; a speed is held by a torque against every departure from it.
static void drive_safely(gyrotwin_device* device) {
  const gyrotwin_beat* const host = &device->host;
  set_drives(device, GYROTWIN_DRIVES_TORQUE, 0.0);
  if (host->safe_stop == GYROTWIN_BRAKE) {
    set_drives(device, GYROTWIN_DRIVES_BRAKE, host->safe_stop_gain);
  } else if (host->safe_stop == GYROTWIN_HOLD_SPEED) {
    for (int i = 0; i < GYROTWIN_DRIVES; ++i) {
      const double torque = host->safe_stop_gain * (device->held_speed[i] - speed_of(device, i));
      if (is_finite(torque)) device->drives.value[i] = torque;
    }
  }
}

// Each way into another mode sets the drives at once.
static void hold(gyrotwin_device* device) {
  device->mode = GYROTWIN_HELD;
  device->stop = GYROTWIN_STOP_NONE;
  device->was_held = true;
  set_drives(device, GYROTWIN_DRIVES_OFF, 0.0);
  apply(device);
}

static void run(gyrotwin_device* device) {
  device->mode = GYROTWIN_RUNNING;
  device->run_epoch = device->host.header.epoch;
  device->command_sample = device->samples;
  device->command_tick = device->samples;
  device->command_valid = 0;
  set_drives(device, GYROTWIN_DRIVES_TORQUE, 0.0);
  apply(device);
}

static void stop(gyrotwin_device* device, gyrotwin_stop why) {
  device->mode = GYROTWIN_SAFE_STOP;
  device->stop = why;
  if (why != GYROTWIN_STOP_HOST) ++device->safe_stops;
  for (int i = 0; i < GYROTWIN_DRIVES; ++i) device->held_speed[i] = speed_of(device, i);
  drive_safely(device);
  apply(device);
}

static gyrotwin_header header_of(const gyrotwin_device* device, int64_t sequence, int64_t now) {
  const gyrotwin_header header = {
      device->rig_id, GYROTWIN_HARDWARE, device->epoch, sequence, device->samples, now, now};
  return header;
}

static void send_beat(gyrotwin_device* device) {
  const gyrotwin_board* const board = device->board;
  const int64_t now = board->now_ns(board->context);
  uint8_t payload[GYROTWIN_BEAT_SIZE];
  gyrotwin_beat beat;
  if (device->beats == 0) device->first_beat_ns = now;
  beat.header = header_of(device, device->beats++, now);
  beat.mode = device->mode;
  beat.rotors = board->rotors_powered(board->context) ? GYROTWIN_ROTORS_ON : GYROTWIN_ROTORS_OFF;
  beat.command_timeout_ticks = device->host.command_timeout_ticks;
  beat.safe_stop = device->host.safe_stop;
  beat.safe_stop_gain = device->host.safe_stop_gain;
  beat.sent_ns = now;
  beat.echo_ns = device->host.sent_ns;
  beat.heard_ns = device->host_heard_ns;
  beat.frames_received = device->decoder.good - device->frames_refused;
  beat.frames_bad = device->decoder.bad + device->frames_refused;
  beat.frames_dropped = device->outbox.dropped;
  beat.commands_obeyed = device->commands_obeyed;
  beat.safe_stops = device->safe_stops;
  gyrotwin_beat_encode(&beat, payload);
  gyrotwin_outbox_add(&device->outbox, payload, sizeof payload);
}

static void follow(gyrotwin_device* device) {
  const gyrotwin_beat* const host = &device->host;
  if (host->mode == GYROTWIN_HELD) {
    if (device->mode != GYROTWIN_HELD || !device->was_held) hold(device);
  } else if (host->mode != GYROTWIN_RUNNING) {
    if (device->mode != GYROTWIN_SAFE_STOP) stop(device, GYROTWIN_STOP_HOST);
  } else if (device->mode == GYROTWIN_HELD) {
    if (!device->was_held) {
      stop(device, GYROTWIN_STOP_NOT_HELD);
    } else if (device->estop) {
      stop(device, GYROTWIN_STOP_ESTOP);
    } else {
      run(device);
    }
  } else if (device->mode == GYROTWIN_RUNNING && host->header.epoch != device->run_epoch) {
    stop(device, GYROTWIN_STOP_OTHER_RUN);
  }
}

// A beat that repeats its request asks for nothing: a board that has cut the rotors itself keeps
// them cut. Nor may a request that was ignored come to act when the E-stop is released.
static void switch_rotors(gyrotwin_device* device) {
  const gyrotwin_board* const board = device->board;
  const bool changed = device->host.rotors != device->rotors_asked;
  device->rotors_asked = device->host.rotors;
  if (!changed || device->host.rotors == GYROTWIN_ROTORS_AS_THEY_ARE) return;
  const bool on = device->host.rotors == GYROTWIN_ROTORS_ON;
  if (on && device->estop) return;
  if (board->rotors_powered(board->context) != on) board->power_rotors(board->context, on);
}

static bool sensible(const gyrotwin_beat* beat) {
  return beat->mode >= GYROTWIN_HELD && beat->mode <= GYROTWIN_FAULT &&
         beat->rotors >= GYROTWIN_ROTORS_AS_THEY_ARE && beat->rotors <= GYROTWIN_ROTORS_OFF &&
         beat->command_timeout_ticks >= 1 &&
         beat->command_timeout_ticks <= GYROTWIN_COMMAND_TIMEOUT_MAX &&
         beat->safe_stop >= GYROTWIN_ZERO_TORQUE && beat->safe_stop <= GYROTWIN_HOLD_SPEED &&
         is_finite(beat->safe_stop_gain) && beat->safe_stop_gain >= 0.0;
}

// A line that echoes must not let the device follow itself.
static bool for_us(const gyrotwin_device* device, const gyrotwin_header* header) {
  return header->rig_id == device->rig_id && header->epoch != device->epoch;
}

static bool on_beat(gyrotwin_device* device, const uint8_t* payload, size_t size) {
  gyrotwin_beat beat;
  if (!gyrotwin_beat_decode(payload, size, &beat)) return false;
  if (!for_us(device, &beat.header) || !sensible(&beat)) return false;
  device->host = beat;
  device->host_heard_ns = device->board->now_ns(device->board->context);
  switch_rotors(device);
  follow(device);
  return true;
}

// It answers the sample `for_tick`, and may act in `valid_ticks` ticks from there: the one after
// the newest sample must be among them. The range first, so that the difference cannot overflow.
static bool of_now(const gyrotwin_device* device, const gyrotwin_command* command) {
  return command->for_tick >= 0 && command->for_tick <= device->samples &&
         device->samples - 1 - command->for_tick < command->valid_ticks;
}

static bool can_be_meant(const gyrotwin_device* device, const gyrotwin_command* command) {
  if (command->mode != GYROTWIN_TORQUE_NM && command->mode != GYROTWIN_VOLTAGE_V) return false;
  if (command->valid_ticks < 1 || command->owner_epoch != device->run_epoch) return false;
  for (int i = 0; i < GYROTWIN_DRIVES; ++i) {
    if (!is_finite(command->value[i])) return false;
  }
  return true;
}

static bool on_command(gyrotwin_device* device, const uint8_t* payload, size_t size) {
  gyrotwin_command command;
  if (!gyrotwin_command_decode(payload, size, &command)) return false;
  if (!for_us(device, &command.header)) return false;
  if (device->mode != GYROTWIN_RUNNING) return true;
  if (!can_be_meant(device, &command) || !of_now(device, &command)) {
    ++device->commands_refused;
    return true;
  }
  ++device->commands_obeyed;
  device->command_sample = device->samples;
  device->command_tick = command.for_tick;
  device->command_valid = command.valid_ticks;
  device->drives.mode =
      command.mode == GYROTWIN_VOLTAGE_V ? GYROTWIN_DRIVES_VOLTAGE : GYROTWIN_DRIVES_TORQUE;
  memcpy(device->drives.value, command.value, sizeof command.value);
  apply(device);
  return true;
}

static void answer(gyrotwin_device* device, const gyrotwin_request* request,
                   gyrotwin_reply* reply) {
  static const char kNoOperator[] = "the device takes DISTURB, FAULT, CANCEL and CLEAR alone";
  static const char kReal[] = "the plant is real: it can neither be pushed nor broken by request";
  const bool known = request->verb == GYROTWIN_VERB_DISTURB ||
                     request->verb == GYROTWIN_VERB_FAULT ||
                     request->verb == GYROTWIN_VERB_CANCEL || request->verb == GYROTWIN_VERB_CLEAR;
  reply->result = GYROTWIN_REFUSED;
  if (!known) {
    memcpy(reply->text, kNoOperator, sizeof kNoOperator);
  } else if (device->board->request == NULL) {
    memcpy(reply->text, kReal, sizeof kReal);
  } else {
    device->board->request(device->board->context, request, reply);
  }
}

static bool on_request(gyrotwin_device* device, const uint8_t* payload, size_t size) {
  gyrotwin_request request;
  gyrotwin_reply reply;
  uint8_t out[GYROTWIN_REPLY_SIZE];
  if (!gyrotwin_request_decode(payload, size, &request)) return false;
  if (!for_us(device, &request.header)) return false;
  memset(&reply, 0, sizeof reply);
  reply.header =
      header_of(device, device->replies++, device->board->now_ns(device->board->context));
  reply.request_writer = request.writer;
  reply.request_counter = request.counter;
  reply.verb = request.verb;
  answer(device, &request, &reply);
  gyrotwin_reply_encode(&reply, out);
  gyrotwin_outbox_add(&device->outbox, out, sizeof out);
  return true;
}

void gyrotwin_device_init(gyrotwin_device* device, const gyrotwin_board* board, int32_t rig_id,
                          int64_t epoch) {
  memset(device, 0, sizeof *device);
  device->board = board;
  device->rig_id = rig_id;
  device->epoch = epoch;
  device->host.command_timeout_ticks = 1;
  device->host.safe_stop = GYROTWIN_ZERO_TORQUE;
  gyrotwin_decoder_init(&device->decoder);
  gyrotwin_outbox_init(&device->outbox);
  device->mode = GYROTWIN_HELD;
  device->beat_due_ns = board->now_ns(board->context);
  apply(device);
}

void gyrotwin_device_receive(gyrotwin_device* device, const uint8_t* bytes, size_t size) {
  for (size_t i = 0; i < size; ++i) {
    const size_t found = gyrotwin_decoder_take(&device->decoder, bytes[i]);
    if (found == 0) continue;
    const uint8_t* const payload = device->decoder.bytes;
    if (!on_command(device, payload, found) && !on_beat(device, payload, found) &&
        !on_request(device, payload, found)) {
      ++device->frames_refused;
    }
  }
  gyrotwin_device_flush(device);
}

static bool command_lost(const gyrotwin_device* device) {
  return device->samples - device->command_sample >= device->host.command_timeout_ticks;
}

// What comes is stale although it keeps coming: the host's beats echo one of the device's that is
// long gone. Its first beats need their time to be echoed.
static bool host_is_behind(const gyrotwin_device* device, int64_t now) {
  const int64_t oldest = now - 2 * (int64_t)GYROTWIN_BEAT_TIMEOUT_NS;
  return device->beats > 0 && device->first_beat_ns < oldest && device->host.echo_ns < oldest;
}

static void watch(gyrotwin_device* device, int64_t now) {
  if (device->mode != GYROTWIN_RUNNING) return;
  if (device->estop) {
    stop(device, GYROTWIN_STOP_ESTOP);
  } else if (command_lost(device)) {
    stop(device, GYROTWIN_STOP_COMMANDS);
  } else if (now - device->host_heard_ns > GYROTWIN_BEAT_TIMEOUT_NS ||
             host_is_behind(device, now)) {
    stop(device, GYROTWIN_STOP_SILENCE);
  }
}

// One that has been read and is no more (a wire, a failed input) counts as pressed.
static void read_estop(gyrotwin_device* device, const gyrotwin_sensors* sensors) {
  const bool heard = (sensors->valid & GYROTWIN_VALID_ESTOP) != 0;
  device->estop_heard = device->estop_heard || heard;
  device->estop = heard ? sensors->estop != 0 : device->estop_heard;
}

void gyrotwin_device_sample(gyrotwin_device* device) {
  const gyrotwin_board* const board = device->board;
  uint8_t payload[GYROTWIN_SENSORS_SIZE];
  gyrotwin_sensors sensors;
  memset(&sensors, 0, sizeof sensors);
  board->read_sensors(board->context, &sensors);
  const int64_t now = board->now_ns(board->context);
  sensors.header = header_of(device, device->samples, now);
  read_estop(device, &sensors);

  watch(device, now);
  if (device->mode == GYROTWIN_SAFE_STOP) {
    drive_safely(device);
  } else if (device->samples - device->command_tick >= device->command_valid &&
             device->mode == GYROTWIN_RUNNING) {
    set_drives(device, GYROTWIN_DRIVES_TORQUE, 0.0);
  }
  apply(device);

  gyrotwin_sensors_encode(&sensors, payload);
  gyrotwin_outbox_add(&device->outbox, payload, sizeof payload);
  if (now - device->beat_due_ns >= 0) {
    const bool far_behind = now - device->beat_due_ns > GYROTWIN_BEAT_PERIOD_NS;
    device->beat_due_ns = (far_behind ? now : device->beat_due_ns) + GYROTWIN_BEAT_PERIOD_NS;
    send_beat(device);
  }
  ++device->samples;
  gyrotwin_device_flush(device);
}

void gyrotwin_device_flush(gyrotwin_device* device) {
  gyrotwin_outbox_flush(&device->outbox, device->board->write, device->board->context);
}
