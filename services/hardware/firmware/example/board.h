// What example/main.c wants of a board's own code: its drivers, behind these names.
#ifndef GYROTWIN_EXAMPLE_BOARD_H
#define GYROTWIN_EXAMPLE_BOARD_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

void board_start(void);      // clocks, pins, converters, line, timer of the sample rate
int64_t board_random(void);  // not negative: a random number generator, or noise of a converter
int64_t board_now_ns(void);  // a hardware timer, extended to 64 bits
bool board_estop(void);      // pressed
void board_gyro(double rad_s[3]);  // IMU axes
void board_accelerometer(double m_s2[3]);
double board_disc_angle(void);       // [rad], not wrapped
double board_disc_speed(void);       // [rad/s]
double board_rotor_speed(int j);     // [rad/s]
double board_current(void);          // of the disc's motor [A]
void board_motor_off(void);          // power stage off
void board_motor_torque(double nm);  // within the board's current limit
void board_motor_voltage(double v);
void board_motor_short(void);
void board_rotors(bool on);
bool board_rotors_on(void);
size_t board_line_write(const uint8_t* bytes,
                        size_t size);  // into the driver's buffer; how many fit
void board_kick_watchdog(void);

#endif
