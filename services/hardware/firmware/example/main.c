// Example: the main loop of a rig with one disc drive, four flywheels, an IMU and an encoder. The
// board's own code calls example_on_byte() from the line's interrupt and example_on_timer() from
// that of the sample timer.
#include "board.h"
#include "gyrotwin_device.h"

enum { kRigId = 1 };    // rig.id of the rig file
enum { kRing = 1024 };  // a power of two; more than the host sends between two turns of the loop

// Of a width that the core loads and stores in one instruction, or the loop reads half of an old
// value and half of a new one: uint32_t on 32-bit cores; on 8-bit ones uint8_t, and kRing 128.
typedef uint32_t ring_index;

// One writer, the interrupt, and one reader, the loop; on one core that is all it takes.
static volatile uint8_t ring[kRing];
static volatile ring_index received, taken;
static volatile ring_index timer_fired;

void example_on_byte(uint8_t byte);
void example_on_timer(void);
int main(void);

void example_on_byte(uint8_t byte) {
  // A byte lost is a frame lost, which the next 0 mends.
  if ((ring_index)(received - taken) == kRing) return;
  ring[received % kRing] = byte;
  ++received;
}

void example_on_timer(void) { ++timer_fired; }

static int64_t now_ns(void* context) {
  (void)context;
  return board_now_ns();
}

static void read_sensors(void* context, gyrotwin_sensors* sensors) {
  (void)context;
  board_gyro(sensors->gyro_rad_s);
  board_accelerometer(sensors->acceleration_m_s2);
  sensors->disc_angle_rad = board_disc_angle();
  for (int j = 0; j < GYROTWIN_GYROS; ++j) sensors->rotor_speed_rad_s[j] = board_rotor_speed(j);
  sensors->drive_current_a[0] = board_current();
  sensors->estop = board_estop() ? 1 : 0;
  sensors->valid = GYROTWIN_VALID_GYRO | GYROTWIN_VALID_ACCELEROMETER | GYROTWIN_VALID_DISC |
                   GYROTWIN_VALID_ROTORS | GYROTWIN_VALID_CURRENTS | GYROTWIN_VALID_ESTOP;
}

static void drive(void* context, const gyrotwin_drives* drives) {
  (void)context;
  switch (drives->mode) {
    case GYROTWIN_DRIVES_TORQUE:
      board_motor_torque(drives->value[0]);
      break;
    case GYROTWIN_DRIVES_VOLTAGE:
      board_motor_voltage(drives->value[0]);
      break;
    case GYROTWIN_DRIVES_BRAKE:
      board_motor_short();
      break;
    case GYROTWIN_DRIVES_OFF:
    default:
      board_motor_off();
      break;
  }
}

static double drive_speed(void* context, int index) {
  (void)context;
  return index == 0 ? board_disc_speed() : 0.0;
}

static void power_rotors(void* context, bool on) {
  (void)context;
  board_rotors(on);
}

static bool rotors_powered(void* context) {
  (void)context;
  return board_rotors_on();
}

static size_t write_line(void* context, const uint8_t* bytes, size_t size) {
  (void)context;
  return board_line_write(bytes, size);
}

int main(void) {
  static const gyrotwin_board board = {
      .now_ns = now_ns,
      .read_sensors = read_sensors,
      .drive = drive,
      .drive_speed = drive_speed,
      .power_rotors = power_rotors,
      .rotors_powered = rotors_powered,
      .write = write_line,
  };
  static gyrotwin_device device;
  ring_index sampled = 0;

  board_start();
  gyrotwin_device_init(&device, &board, kRigId, board_random());
  for (;;) {
    // No more than a ring of them: the sample must have its turn.
    const ring_index until = received;
    for (int n = 0; n < kRing && taken != until; ++n) {
      const uint8_t byte = ring[taken % kRing];
      ++taken;
      gyrotwin_device_receive(&device, &byte, 1);
    }
    if (sampled != timer_fired) {
      sampled = timer_fired;  // what the loop was too late for is left out
      gyrotwin_device_sample(&device);
      board_kick_watchdog();
    }
    gyrotwin_device_flush(&device);
  }
}
